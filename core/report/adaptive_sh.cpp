#include "core/report/adaptive_sh.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "core/base/check.h"
#include "core/base/stopwatch.h"
#include "core/basis/sh_rotation.h"
#include "core/basis/sh_zonal.h"
#include "core/image/metrics.h"
#include "core/image/tone_map.h"
#include "core/math/rotation.h"
#include "core/report/fma_peak.h"
#include "core/vertices/multi_level_light.h"
#include "core/vertices/view_transport.h"

namespace rimlight {
namespace {

constexpr std::size_t kSums = kLightChannels * kBatchVertices;
constexpr int kRepetitions = 3;

double median(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::ranges::nth_element(values, middle);
  return *middle;
}

template <typename Calculate>
double best_seconds(const Calculate& calculate) {
  double best = std::numeric_limits<double>::infinity();
  for (int i = 0; i < kRepetitions; ++i) {
    const Stopwatch watch;
    calculate();
    best = std::min(best, watch.elapsed_seconds());
  }
  return best;
}

/// What is the same for all degrees and lights.
struct Sight {
  const AdaptiveShSettings& settings;
  const LitMesh& lit;  // to the highest degree
  MeshView view;
  VertexSelection selection;
  VertexGraph graph;
};

/// Light of the visible vertices, and their colours.
struct VertexImage {
  explicit VertexImage(const VertexSelection& selection)
      : irradiance(selection.panel_count() * kSums),
        highlights(irradiance.size()),
        colours(selection.vertex_count()) {}

  void blend(const MeasuredMaterial& material) {
    const auto diffuse = static_cast<float>(material.albedo / std::numbers::pi);
    for (std::size_t v = 0; v < colours.size(); ++v) {
      for (std::size_t c = 0; c < kLightChannels; ++c) {
        const std::size_t at = v / kBatchVertices * kSums + c * kBatchVertices + v % kBatchVertices;
        colours[v][static_cast<int>(c)] =
            diffuse * irradiance[at] + material.highlight * highlights[at];
      }
    }
  }

  std::vector<float> irradiance, highlights;
  std::vector<Vec3f> colours;
};

/// How far one policy is from the full calculation, frame by frame.
class Comparison {
 public:
  Comparison(const VertexSelection& selection, double scale) : image(selection), scale_(scale) {}

  void add(const VertexImage& full, bool follows_last) {
    const double psnr = display_psnr(image.colours, full.colours, scale_);
    psnr_sum_ += psnr;
    least_psnr_ = std::min(least_psnr_, psnr);
    ++frames_;
    error_.resize(image.colours.size() * kLightChannels, 0.0);
    for (std::size_t k = 0; k < error_.size(); ++k) {
      const std::size_t v = k / kLightChannels;
      const int c = static_cast<int>(k % kLightChannels);
      const double error = shown(image.colours[v][c]) - shown(full.colours[v][c]);
      if (follows_last) flicker_ = std::max(flicker_, std::abs(error - error_[k]));
      error_[k] = error;
    }
  }
  void write(AdaptiveShRow& row) const {
    row.fps_adaptive = 1 / median(seconds);
    row.fps_view_moves = 1 / (median(seconds) + row.view_ms / 1e3);
    row.speedup = median(speedups);
    row.psnr_db = psnr_sum_ / frames_;
    row.least_psnr_db = least_psnr_;
    row.flicker = flicker_;
  }

  VertexImage image;
  std::vector<double> seconds, speedups;

 private:
  double shown(float value) const {
    return srgb_from_linear(std::clamp(static_cast<double>(value) * scale_, 0.0, 1.0));
  }

  double scale_;
  double psnr_sum_ = 0, least_psnr_ = std::numeric_limits<double>::infinity(), flicker_ = 0;
  int frames_ = 0;
  std::vector<double> error_;
};

/// All calculations of one mesh to one degree.
class Contest {
 public:
  Contest(const Sight& sight, const LitMesh& lit)
      : sight_(sight),
        lit_(lit),
        lobes_(convolution_factors(sh::phong_lobe(sight.settings.material.exponent, lit.degree))),
        gloss_{sight.view.mirrored, lobes_, {}},
        products_(lit.view()),
        multi_level_(products_, sight.graph),
        view_(lit.view()) {
    view_seconds_ = best_seconds([&] { view_.set_view(sight_.selection, gloss_); });
  }

  /// Appends two rows.
  void measure(const Environment& light, std::vector<AdaptiveShRow>& rows);

 private:
  void calculate_full(std::span<const float> light, VertexImage& image) {
    products_.set_light(light);
    products_.irradiance(sight_.selection, image.irradiance);
    products_.highlights(sight_.selection, gloss_, image.highlights);
  }
  double full_flops() const {
    const double sums =
        2.0 * kLightChannels * static_cast<double>(sh::coefficient_count(lit_.degree));
    return static_cast<double>(sight_.selection.vertex_count()) *
           (products_.highlight_flops() + sums);
  }
  /// Thresholds on irradiance and highlights that are so much as displayed.
  struct Limits {
    float irradiance, highlight;
  };
  Limits limits(float shown) const {
    const double value = static_cast<double>(shown) / scale_;
    return {static_cast<float>(value * std::numbers::pi / sight_.settings.material.albedo),
            static_cast<float>(value / sight_.settings.material.highlight)};
  }
  AdaptiveShRow full_row(const Environment& light) const;
  void measure_frame(std::span<const float> light, bool follows_last, VertexImage& full,
                     std::array<Comparison, 2>& policies);

  const Sight& sight_;
  const LitMesh& lit_;
  std::vector<float> lobes_;
  VertexGloss gloss_;
  VertexProducts products_;
  MultiLevelLight multi_level_;
  ViewTransport view_;
  double scale_ = 1, view_seconds_ = 0;
  std::vector<double> full_seconds_, of_peak_, filtered_irradiance_, filtered_highlights_;
};

void Contest::measure_frame(std::span<const float> light, bool follows_last, VertexImage& full,
                            std::array<Comparison, 2>& policies) {
  auto& multi_level = policies[0];
  auto& view = policies[1];
  const Limits threshold = limits(sight_.settings.threshold);
  const Limits tolerance = limits(sight_.settings.tolerance);
  full_seconds_.push_back(best_seconds([&] { calculate_full(light, full); }));
  of_peak_.push_back(full_flops() / full_seconds_.back() / fma_peak());
  multi_level.seconds.push_back(best_seconds([&] {
    products_.set_light(light);
    multi_level_.calculate(sight_.selection, gloss_, {2, threshold.irradiance, threshold.highlight},
                           multi_level.image.irradiance, multi_level.image.highlights);
  }));
  view.seconds.push_back(best_seconds([&] {
    view_.calculate(light, {tolerance.irradiance, tolerance.highlight}, view.image.irradiance,
                    view.image.highlights);
  }));
  filtered_irradiance_.push_back(multi_level_.filtered_irradiance());
  filtered_highlights_.push_back(multi_level_.filtered_highlights());
  full.blend(sight_.settings.material);
  for (Comparison& policy : policies) {
    policy.speedups.push_back(full_seconds_.back() / policy.seconds.back());
    policy.image.blend(sight_.settings.material);
    policy.add(full, follows_last);
  }
}

void Contest::measure(const Environment& light, std::vector<AdaptiveShRow>& rows) {
  const AdaptiveShSettings& settings = sight_.settings;
  const auto coefficients = light_coefficients(light, 2 * lit_.degree);
  VertexImage full(sight_.selection);
  calculate_full(coefficients, full);
  full.blend(settings.material);
  scale_ = auto_exposure_scale(full.colours);
  std::array<Comparison, 2> policies = {Comparison(sight_.selection, scale_),
                                        Comparison(sight_.selection, scale_)};
  for (auto* list : {&full_seconds_, &of_peak_, &filtered_irradiance_, &filtered_highlights_}) {
    list->clear();
  }
  std::vector<float> turned(coefficients.size());
  for (int place = 0; place < settings.places; ++place) {
    for (int frame = 0; frame < settings.frames; ++frame) {
      const double degrees = 360.0 * place / settings.places + settings.step_degrees * frame;
      sh::Rotation(axis_angle({0, 1, 0}, degrees * std::numbers::pi / 180), 2 * lit_.degree)
          .apply(coefficients, turned);
      measure_frame(turned, frame > 0, full, policies);
    }
  }
  AdaptiveShRow row = full_row(light);
  row.policy = "multi-level";
  row.filtered_diffuse = median(filtered_irradiance_);
  row.filtered_specular = median(filtered_highlights_);
  policies[0].write(row);
  rows.push_back(row);
  row.policy = "view";
  row.filtered_diffuse = view_.irradiance().left_out();
  row.filtered_specular = view_.highlights().left_out();
  row.view_ms = 1e3 * view_seconds_;
  policies[1].write(row);
  rows.push_back(row);
}

AdaptiveShRow Contest::full_row(const Environment& light) const {
  AdaptiveShRow row;
  row.mesh = lit_.name;
  row.light = light.name();
  row.degree = lit_.degree;
  row.coefficients = sh::coefficient_count(lit_.degree);
  row.vertices = lit_.mesh.positions.size();
  row.visible = sight_.selection.vertex_count();
  row.fps_full = 1 / median(full_seconds_);
  row.full_of_peak = median(of_peak_);
  return row;
}

}  // namespace

std::vector<AdaptiveShRow> measure_adaptive_sh(
    const AdaptiveShSettings& settings,
    const std::function<void(const std::string& stage, double share)>& progress) {
  RIMLIGHT_CHECK(!settings.meshes.empty() && !settings.lights.empty());
  RIMLIGHT_CHECK(!settings.degrees.empty() && settings.places > 0 && settings.frames > 0);
  const auto [lowest, highest] = std::ranges::minmax(settings.degrees);
  RIMLIGHT_CHECK(lowest >= 1 && highest <= sh::kLargestDegree);
  std::vector<AdaptiveShRow> rows;
  const std::size_t rounds =
      settings.meshes.size() * settings.degrees.size() * settings.lights.size();
  for (const auto& mesh : settings.meshes) {
    progress("tracing " + mesh.name,
             static_cast<double>(rows.size() / 2) / static_cast<double>(rounds));
    const LitMesh lit = light_mesh(mesh.name, mesh.meshes, highest);
    Sight sight = {
        settings, lit, view_mesh(lit, settings.eye_direction), {}, VertexGraph(lit.mesh)};
    sight.selection.select_vertices(sight.view.visible);
    for (const int degree : settings.degrees) {
      const LitMesh cut = lit.to_degree(degree);
      Contest contest(sight, cut);
      for (const auto& light : settings.lights) {
        progress("measuring " + mesh.name,
                 static_cast<double>(rows.size() / 2) / static_cast<double>(rounds));
        contest.measure(*light, rows);
      }
    }
  }
  return rows;
}

}  // namespace rimlight
