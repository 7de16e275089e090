#include "core/bake/vertex_packing.h"

#include <cmath>
#include <numbers>

#include "core/base/check.h"
#include "core/base/parallel.h"
#include "core/basis/sh.h"

namespace rimlight {
namespace {

using Channels = std::vector<std::vector<float>>;

/// L2 over the sphere, of what is not shadowed: ∫ cos² over the hemisphere is 2π/3, ∫ 1 is 2π.
const double kCosineNorm = std::sqrt(2 * std::numbers::pi / 3);
const double kHemisphereNorm = std::sqrt(2 * std::numbers::pi);

/// Σ over channels and vertices of each band's energy.
std::vector<double> band_energies(const Channels& channels, int degree) {
  const std::size_t coefficients = sh::coefficient_count(degree);
  std::vector<double> energies(static_cast<std::size_t>(degree) + 1);
  for (const std::vector<float>& values : channels) {
    for (std::size_t i = 0; i < values.size(); ++i) {
      const auto band = static_cast<std::size_t>(std::sqrt(static_cast<double>(i % coefficients)));
      energies[band] += static_cast<double>(values[i]) * values[i];
    }
  }
  return energies;
}

struct KeptBands {
  int degree = 0;    // the last
  double error = 0;  // relative, of those left out
};

/// `norm`: of what errors are a share.
KeptBands keep_bands(const Channels& channels, int degree, double norm,
                     const LeavingOut& leaving_out) {
  KeptBands kept{degree, 0};
  std::size_t rows = 0;  // vertices and channels
  for (const auto& values : channels) rows += values.size() / sh::coefficient_count(degree);
  if (leaving_out.keep_bands || rows == 0) return kept;
  const std::vector<double> energies = band_energies(channels, degree);
  double dropped = 0;
  while (kept.degree > 0) {
    dropped += energies[static_cast<std::size_t>(kept.degree)];
    const double error = std::sqrt(dropped / static_cast<double>(rows)) / norm;
    if (!(error <= leaving_out.error)) break;
    kept = {kept.degree - 1, error};
  }
  return kept;
}

/// The mean of three channels, and how far they are from it, as a share of the clamped cosine.
std::pair<std::vector<float>, double> grey_of(const Channels& channels, std::size_t vertices) {
  std::vector<float> grey(channels[0].size());
  double squares = 0;
  for (std::size_t i = 0; i < grey.size(); ++i) {
    grey[i] = (channels[0][i] + channels[1][i] + channels[2][i]) / 3;
    for (const auto& values : channels) {
      const double difference = static_cast<double>(values[i]) - grey[i];
      squares += difference * difference;
    }
  }
  return {std::move(grey), std::sqrt(squares / (3 * static_cast<double>(vertices))) / kCosineNorm};
}

/// [batch][channel][coefficients to `stored`][lane]; padding stays zero.
AlignedVector<Half> to_batches(const Channels& channels, std::size_t vertices, int degree,
                               int stored) {
  const std::size_t from = sh::coefficient_count(degree), to = sh::coefficient_count(stored);
  AlignedVector<Half> halves(batch_count(vertices) * channels.size() * to * kBatchVertices);
  parallel_for(vertices, [&](std::size_t vertex) {
    const std::size_t batch = vertex / kBatchVertices, lane = vertex % kBatchVertices;
    for (std::size_t c = 0; c < channels.size(); ++c) {
      Half* const rows = halves.data() + (batch * channels.size() + c) * to * kBatchVertices + lane;
      for (std::size_t i = 0; i < to; ++i) {
        rows[i * kBatchVertices] = to_half(channels[c][vertex * from + i]);
        RIMLIGHT_CHECK(is_finite(rows[i * kBatchVertices]));
      }
    }
  });
  return halves;
}

nlohmann::json describe(const KeptBands& kept, int degree) {
  return {
      {"degree_asked", degree},
      {"degree_stored", kept.degree},
      {"coefficients_left_out", sh::coefficient_count(degree) - sh::coefficient_count(kept.degree)},
      {"relative_error", kept.error}};
}

}  // namespace

StoredTransport pack(const CalculatedTransport& transport, const LeavingOut& leaving_out) {
  StoredTransport stored;
  Channels grey;
  const Channels* irradiance = &transport.irradiance;
  double colour_error = 0;
  if (irradiance->size() == 3) {
    auto [values, error] = grey_of(*irradiance, transport.vertex_count);
    if (error <= leaving_out.error && !leaving_out.keep_bands) {
      grey.push_back(std::move(values));
      irradiance = &grey;
      colour_error = error;
    }
  }
  const KeptBands kept = keep_bands(*irradiance, transport.degree, kCosineNorm, leaving_out);
  const Channels visibility = {transport.visibility};
  const KeptBands kept_visibility =
      keep_bands(visibility, transport.degree, kHemisphereNorm, leaving_out);
  if (!transport.is_open) {
    stored.irradiance =
        to_batches(*irradiance, transport.vertex_count, transport.degree, kept.degree);
  }
  stored.visibility =
      to_batches(visibility, transport.highlight_count, transport.degree, kept_visibility.degree);
  stored.left_out = {
      {"irradiance", describe(kept, transport.degree)},
      {"irradiance_colour",
       {{"channels_left_out", 3 - irradiance->size()}, {"relative_error", colour_error}}},
      {"visibility", describe(kept_visibility, transport.degree)}};
  stored.left_out["irradiance"]["follows_from_normals"] = transport.is_open;
  stored.left_out["visibility"]["vertices_left_out"] =
      transport.vertex_count - transport.highlight_count;
  stored.view = {.vertex_count = transport.vertex_count,
                 .highlight_count = transport.highlight_count,
                 .irradiance_degree = kept.degree,
                 .visibility_degree = kept_visibility.degree,
                 .irradiance_channels = transport.is_open ? 0 : irradiance->size(),
                 .irradiance = stored.irradiance,
                 .visibility = stored.visibility};
  return stored;
}

}  // namespace rimlight
