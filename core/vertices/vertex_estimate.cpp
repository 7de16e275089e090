#include "core/vertices/vertex_estimate.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "core/base/check.h"
#include "core/basis/sh.h"
#include "core/vertices/sampling_weights.h"

namespace rimlight {
namespace {

constexpr double kPi = std::numbers::pi;
/// What is spread over a hemisphere is twice as dense there as over the sphere.
constexpr double kInHemisphere = 2;
using Powers = std::array<double, sh::kLargestLightDegree + 1>;

/// Σ_m L_lm² of each band; the last one stands for those beyond it.
Powers powers_of(std::span<const float> light) {
  Powers powers{};
  for (std::size_t l = 0; l < powers.size(); ++l) {
    if ((l + 1) * (l + 1) > light.size()) {
      powers[l] = powers[l - 1];
      continue;
    }
    for (const float value : light.subspan(l * l, 2 * l + 1)) {
      powers[l] += static_cast<double>(value) * static_cast<double>(value);
    }
  }
  return powers;
}

/// Σ_l P_l s_l over bands to `last`.
double under_light(const std::vector<double>& squares, const Powers& powers, int last) {
  double sum = 0;
  for (std::size_t l = 0; l < squares.size() && static_cast<int>(l) <= last; ++l) {
    sum += squares[l] * powers[l];
  }
  return sum;
}

/// ln n!, of n ≥ 0.
double log_factorial(int n) {
  double sum = 0;
  for (int i = 2; i <= n; ++i) sum += std::log(static_cast<double>(i));
  return sum;
}

}  // namespace

double three_j_squared(int a, int b, int c) {
  const int sum = a + b + c, half = sum / 2;
  if (sum % 2 != 0 || c > a + b || a > b + c || b > a + c) return 0;
  const double log_of_root = log_factorial(half) - log_factorial(half - a) -
                             log_factorial(half - b) - log_factorial(half - c);
  return std::exp(log_factorial(sum - 2 * a) + log_factorial(sum - 2 * b) +
                  log_factorial(sum - 2 * c) - log_factorial(sum + 1) + 2 * log_of_root);
}

VertexEstimator::VertexEstimator(const VertexScene& scene)
    : error_(scene.error),
      sampling_(sampling_weights(scene)),
      irradiance_degree_(scene.transport.irradiance_degree),
      visibility_degree_(scene.transport.visibility_degree),
      material_count_(scene.materials.size()),
      by_chance_(table_of(error_.sampling.visibility, 0, visibility_degree_)),
      left_out_(table_of(error_.visibility_left_out, visibility_degree_ + 1, sh::kLargestDegree)) {}

VertexEstimator::Table VertexEstimator::table_of(const std::vector<double>& squares, int first,
                                                 int last) const {
  const int lobe_bands = visibility_degree_ + 1, light_bands = 2 * visibility_degree_ + 1;
  Table table(static_cast<std::size_t>(lobe_bands * light_bands));
  last = std::min(last, static_cast<int>(squares.size()) - 1);
  for (int a = 0; a < lobe_bands; ++a) {
    for (int b = 0; b < light_bands; ++b) {
      double& sum = table[static_cast<std::size_t>(a * light_bands + b)];
      for (int k = first; k <= last; ++k) {
        sum += squares[static_cast<std::size_t>(k)] * (2 * k + 1) / (4 * kPi) *
               three_j_squared(a, b, k);
      }
    }
  }
  return table;
}

double VertexEstimator::of_table(const Table& table, const float* lobe,
                                 std::span<const double> powers) const {
  const auto lobe_bands = static_cast<std::size_t>(visibility_degree_) + 1;
  const std::size_t light_bands = table.size() / lobe_bands;
  double sum = 0;
  for (std::size_t a = 0; a < lobe_bands; ++a) {
    // `lobe` holds √(4π/(2a + 1)) h_a0, for each of its band's coefficients.
    const double factor = lobe[a * a];
    const double power_of_lobe = factor * factor * static_cast<double>(2 * a + 1) / (4 * kPi);
    for (std::size_t b = 0; b < light_bands; ++b) {
      sum += power_of_lobe * powers[b] * table[a * light_bands + b];
    }
  }
  return sum;
}

double VertexEstimator::square(const ViewWeights& weights, const VertexMaterials& materials,
                               std::span<const float> light) const {
  RIMLIGHT_CHECK(!light.empty() && light.size() % 3 == 0);
  double sum = 0;
  for (int c = 0; c < 3; ++c) {
    const std::size_t count = light.size() / 3;
    const Powers powers = powers_of(light.subspan(static_cast<std::size_t>(c) * count, count));
    const double matt = under_light(error_.sampling.matt, powers, irradiance_degree_);
    const double glossy = under_light(error_.sampling.glossy, powers, irradiance_degree_);
    const double left_out = under_light(error_.irradiance_left_out, powers, sh::kLargestDegree);
    for (std::size_t m = 0; m < material_count_; ++m) {
      const auto index = static_cast<std::uint32_t>(m);
      const MaterialWeights& of = weights.of(m);
      const double albedo = materials.at(index).albedo[c] / kPi;
      sum +=
          albedo * albedo *
          (matt * of.matt_by_chance[c] + glossy * of.glossy_by_chance[c] + left_out * of.shared[c]);
      if (!materials.has_highlight(index)) continue;
      const double highlight = materials.at(index).highlight[c];
      const float* const lobe = materials.lobe(index);
      sum += highlight * highlight *
             (kInHemisphere * of_table(by_chance_, lobe, powers) * of.highlight_by_chance +
              of_table(left_out_, lobe, powers) * of.highlight_shared);
    }
  }
  return sum;
}

}  // namespace rimlight
