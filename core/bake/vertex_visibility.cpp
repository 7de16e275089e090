#include "core/bake/vertex_visibility.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <numbers>

#include "core/bake/share_counter.h"
#include "core/base/aligned_vector.h"
#include "core/base/parallel.h"
#include "core/basis/sh.h"
#include "core/basis/sh_kernel.h"
#include "core/basis/sh_sum_kernel.h"
#include "core/basis/sh_zonal.h"

namespace rimlight {
namespace {

constexpr double kPi = std::numbers::pi;
/// Directions whose basis is evaluated at once: the values stay in the cache.
constexpr std::size_t kBlock = 128;
/// Positions are off by a few 2^-24 of their coordinates; see ray_scene.cpp.
constexpr float kOffsetScale = 0x1p-16f;

sh::ZonalLobe hemisphere_lobe(int degree) {
  return sh::sampled_lobe([](double cosine) { return cosine > 0 ? 1.0 : 0.0; }, degree);
}

/// Uniform over the hemisphere about +z, by the area-preserving map of the disc (Shirley and Chiu
/// 1997): z = 1 − r².
Vec3d uniform_hemisphere(const Sample2& sample) {
  const DiscPoint p = uniform_disc(sample);
  const double squared = p.x * p.x + p.y * p.y;
  const double scale = std::sqrt(std::max(0.0, 2 - squared));
  return {p.x * scale, p.y * scale, std::max(0.0, 1 - squared)};
}

/// The blocked rays of a vertex, summed up in spherical harmonics.
class BlockedRays {
 public:
  BlockedRays(int degree, std::size_t signals)
      : degree_(degree),
        signals_(signals),
        values_(sh::coefficient_count(degree) * kBlock),
        x_(kBlock),
        y_(kBlock),
        z_(kBlock),
        samples_(signals * kBlock) {}

  /// One more; `weights`: one for each signal. Adds to `sums`, [signal][coefficients], when full.
  void add(const Vec3d& direction, const double* weights, double* sums) {
    x_[count_] = static_cast<float>(direction.x);
    y_[count_] = static_cast<float>(direction.y);
    z_[count_] = static_cast<float>(direction.z);
    for (std::size_t s = 0; s < signals_; ++s) {
      samples_[s * kBlock + count_] = static_cast<float>(weights[s]);
    }
    if (++count_ == kBlock) flush(sums);
  }

  void flush(double* sums) {
    if (count_ == 0) return;
    const std::size_t padded = sh::padded(count_);
    for (std::size_t i = count_; i < padded; ++i) {
      x_[i] = y_[i] = 0;
      z_[i] = 1;
      for (std::size_t s = 0; s < signals_; ++s) samples_[s * kBlock + i] = 0;
    }
    const auto part = [padded](const AlignedVector<float>& v) {
      return std::span<const float>(v).first(padded);
    };
    sh::evaluate({part(x_), part(y_), part(z_)}, degree_, values_, kBlock);
    sh::add_projection({values_.data(), sh::coefficient_count(degree_), padded, kBlock},
                       samples_.data(), signals_, sums);
    count_ = 0;
  }

 private:
  int degree_;
  std::size_t signals_;
  std::size_t count_ = 0;
  AlignedVector<float> values_, x_, y_, z_, samples_;
};

/// One vertex after the other, on one thread.
class Tracer {
 public:
  Tracer(const RayScene& scene, const VertexMesh& mesh, const RaySettings& settings,
         bool has_highlight)
      : scene_(scene),
        mesh_(mesh),
        settings_(settings),
        has_highlight_(has_highlight),
        signals_(has_highlight ? 2 : 1),
        coefficients_(sh::coefficient_count(settings.degree)),
        cosine_(sh::clamped_cosine_lobe(settings.degree)),
        hemisphere_(hemisphere_lobe(settings.degree)),
        blocked_rays_(settings.degree, signals_),
        sums_(signals_ * coefficients_),
        squares_(signals_ * coefficients_) {}

  /// [signal][coefficients], summed over the vertices so far: of their errors.
  const std::vector<double>& squares() const { return squares_; }

  void trace(std::size_t vertex, VertexVisibility& result) {
    int s = first_round(settings_);
    while (true) {
      const std::size_t blocked = trace_round(vertex, s);
      const double error = sums_.error() * std::sqrt(signals_);  // of both over one: not less
      const int next = next_round(settings_, s, error);
      if (next == 0) {
        result.rays[vertex] = static_cast<std::uint32_t>(4 * s * s);
        result.blocked[vertex] = static_cast<std::uint32_t>(blocked);
        result.error[vertex] = static_cast<float>(error);
        break;
      }
      s = next;
    }
    add_squares();
    store(cosine_, vertex, 0, result.irradiance);
    if (has_highlight_) store(hemisphere_, vertex, coefficients_, result.visibility);
  }

 private:
  /// Sums of what is blocked, all replicates; returns how many rays are.
  std::size_t trace_round(std::size_t vertex, int s) {
    Random random(settings_.seed, vertex * 0x10000 + static_cast<std::uint64_t>(s));
    const std::vector<Sample2> points = round_points(s, random);
    const std::size_t cells = points.size() / kReplicates;
    const Frame<double> frame{Vec3d(mesh_.normals[vertex])};
    origin_ = vertex_ray_origin(mesh_, vertex, scene_.extent());
    sums_.clear();
    std::size_t blocked = 0;
    for (std::size_t r = 0; r < kReplicates; ++r) {
      double* const sums = sums_.replicate(r).data();
      for (std::size_t first = 0; first < cells; first += SkyRays::kCapacity) {
        const std::size_t count = std::min(SkyRays::kCapacity, cells - first);
        blocked += trace_some({points.data() + r * cells + first, count}, frame,
                              1 / static_cast<double>(cells), sums);
      }
      blocked_rays_.flush(sums);
    }
    return blocked;
  }

  std::size_t trace_some(std::span<const Sample2> points, const Frame<double>& frame, double share,
                         double* sums) {
    for (std::size_t i = 0; i < points.size(); ++i) {
      const Vec3d local =
          has_highlight_ ? uniform_hemisphere(points[i]) : cosine_hemisphere(points[i]);
      cosines_[i] = local.z;
      directions_[i] = frame.to_world(local);
      for (int axis = 0; axis < 3; ++axis) {
        const auto a = static_cast<std::size_t>(axis);
        rays_.origin[a][i] = origin_[axis];
        rays_.direction[a][i] = static_cast<float>(directions_[i][axis]);
      }
    }
    rays_.count = points.size();
    scene_.visible(rays_, Coherence::low, visible_);
    std::size_t blocked = 0;
    for (std::size_t i = 0; i < points.size(); ++i) {
      if (visible_[i] != 0) continue;
      ++blocked;
      // Uniform: density 1/2π. By the cosine: cos θ/π.
      const std::array<double, 2> weights =
          has_highlight_ ? std::array{2 * kPi * cosines_[i] * share, 2 * kPi * share}
                         : std::array{kPi * share, 0.0};
      blocked_rays_.add(directions_[i], weights.data(), sums);
    }
    return blocked;
  }

  void add_squares() {
    for (std::size_t i = 0; i < squares_.size(); ++i) squares_[i] += sums_.error_squared(i);
  }

  void store(const sh::ZonalLobe& lobe, std::size_t vertex, std::size_t first,
             std::vector<float>& result) const {
    const std::vector<double> whole = sh::turned_lobe(lobe, Vec3d(mesh_.normals[vertex]));
    for (std::size_t i = 0; i < coefficients_; ++i) {
      result[vertex * coefficients_ + i] = static_cast<float>(whole[i] - sums_.mean(first + i));
    }
  }

  const RayScene& scene_;
  const VertexMesh& mesh_;
  const RaySettings& settings_;
  bool has_highlight_;
  std::size_t signals_;
  std::size_t coefficients_;
  sh::ZonalLobe cosine_, hemisphere_;
  BlockedRays blocked_rays_;
  ReplicateMean sums_;
  std::vector<double> squares_;
  Vec3f origin_;
  SkyRays rays_;
  std::array<std::uint8_t, SkyRays::kCapacity> visible_{};
  std::array<double, SkyRays::kCapacity> cosines_{};
  std::array<Vec3d, SkyRays::kCapacity> directions_{};
};

/// Adds to sums by band, [degree + 1], those of coefficients.
void add_bands(std::span<const double> coefficients, std::vector<double>& bands) {
  for (std::size_t i = 0; i < coefficients.size(); ++i) {
    bands[static_cast<std::size_t>(sh::degree_of(i))] += coefficients[i];
  }
}

/// Root mean squares over so many vertices, from sums over them.
void average(std::size_t vertices, std::vector<double>& bands) {
  for (std::size_t l = 0; l < bands.size(); ++l) {
    const auto count = static_cast<double>(vertices * (2 * l + 1));
    bands[l] = count > 0 ? std::sqrt(bands[l] / count) : 0;
  }
}

VertexVisibility::ByBand by_band(const std::vector<std::vector<double>>& matt,
                                 const std::vector<std::vector<double>>& glossy,
                                 std::size_t matt_count, std::size_t glossy_count, int degree) {
  const std::vector<double> none(static_cast<std::size_t>(degree) + 1);
  VertexVisibility::ByBand bands{none, none, none};
  const std::size_t coefficients = sh::coefficient_count(degree);
  for (std::size_t batch = 0; batch < matt.size(); ++batch) {
    add_bands(matt[batch], bands.irradiance);
    if (glossy[batch].empty()) continue;
    const std::span<const double> both(glossy[batch]);
    add_bands(both.first(coefficients), bands.irradiance_beside_highlight);
    add_bands(both.subspan(coefficients), bands.visibility);
  }
  average(matt_count, bands.irradiance);
  average(glossy_count, bands.irradiance_beside_highlight);
  average(glossy_count, bands.visibility);
  return bands;
}

}  // namespace

Vec3f vertex_ray_origin(const VertexMesh& mesh, std::size_t vertex, float extent) {
  const Vec3f& p = mesh.positions[vertex];
  const float coordinate = std::max({std::abs(p.x), std::abs(p.y), std::abs(p.z), extent / 4});
  return p + mesh.normals[vertex] * (coordinate * kOffsetScale);
}

VertexVisibility unshadowed_visibility(const VertexMesh& mesh, std::size_t highlight_count,
                                       int degree) {
  const std::size_t vertices = mesh.positions.size();
  const std::size_t coefficients = sh::coefficient_count(degree);
  VertexVisibility result;
  result.irradiance.resize(vertices * coefficients);
  result.visibility.resize(highlight_count * coefficients);
  const auto fill = [&](const sh::ZonalLobe& lobe, std::vector<float>& values) {
    parallel_for(values.size() / coefficients, [&](std::size_t vertex) {
      const auto turned = sh::turned_lobe(lobe, Vec3d(mesh.normals[vertex]));
      for (std::size_t i = 0; i < coefficients; ++i) {
        values[vertex * coefficients + i] = static_cast<float>(turned[i]);
      }
    });
  };
  fill(sh::clamped_cosine_lobe(degree), result.irradiance);
  fill(hemisphere_lobe(degree), result.visibility);
  return result;
}

VertexVisibility shadowed_visibility(const RayScene& scene, const VertexMesh& mesh,
                                     std::size_t highlight_count, const RaySettings& settings,
                                     const ShareDone& done) {
  const std::size_t vertices = mesh.positions.size();
  const std::size_t coefficients = sh::coefficient_count(settings.degree);
  VertexVisibility result;
  result.irradiance.resize(vertices * coefficients);
  result.visibility.resize(highlight_count * coefficients);
  result.rays.resize(vertices);
  result.blocked.resize(vertices);
  result.error.resize(vertices);
  ShareCounter counter(batch_count(vertices), done);
  // Of errors, batch by batch, so that their sums do not depend on threads.
  std::vector<std::vector<double>> matt(batch_count(vertices)), glossy(batch_count(vertices));
  parallel_for(batch_count(vertices), [&](std::size_t batch) {
    const std::size_t first = batch * kBatchVertices;
    const std::size_t last = std::min(vertices, first + kBatchVertices);
    const std::size_t middle = std::clamp(highlight_count, first, last);
    if (first < middle) {
      const auto tracer = std::make_unique<Tracer>(scene, mesh, settings, true);
      for (std::size_t vertex = first; vertex < middle; ++vertex) tracer->trace(vertex, result);
      glossy[batch] = tracer->squares();
    }
    if (middle < last) {
      const auto tracer = std::make_unique<Tracer>(scene, mesh, settings, false);
      for (std::size_t vertex = middle; vertex < last; ++vertex) tracer->trace(vertex, result);
      matt[batch] = tracer->squares();
    }
    counter.add_one();
  });
  result.rms_by_band =
      by_band(matt, glossy, vertices - highlight_count, highlight_count, settings.degree);
  return result;
}

}  // namespace rimlight
