#include "core/vertices/sampling_weights.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <span>

#include "core/base/half.h"
#include "core/basis/sh.h"

namespace rimlight {
namespace {

constexpr double kPi = std::numbers::pi;
/// Rounds end when the error is below the one asked for: on average it is then this share of it.
constexpr double kReached = 0.8;
constexpr double kFewestRays = 64;
/// Less than this is the rounding of half floats.
constexpr double kLeastBlocked = 0.001;

/// The blocked share at which a vertex' error is as large as it gets. With a highlight rays are
/// even over the hemisphere and both errors count together: 4/3 · πb/N.
double blocked_enough(double error, bool has_highlight) {
  const double rays = std::max(kFewestRays, std::sqrt(kPi) / error);
  return std::pow(kReached * error, 2) * rays * (has_highlight ? 0.75 : 4) / kPi;
}

/// The mean over channels of a vertex' first coefficient.
double first_coefficient(std::span<const Half> transport, std::size_t vertex, int degree,
                         std::size_t channels) {
  const std::size_t of_channel = sh::coefficient_count(degree) * kBatchVertices;
  double sum = 0;
  for (std::size_t c = 0; c < channels; ++c) {
    sum += to_float(
        transport[(vertex / kBatchVertices * channels + c) * of_channel + vertex % kBatchVertices]);
  }
  return sum / static_cast<double>(channels);
}

/// Divides by the mean; ones where all are zero.
void normalize(std::span<float> weights) {
  double sum = 0;
  for (const float weight : weights) sum += static_cast<double>(weight);
  const double mean = sum / static_cast<double>(weights.size());
  for (float& weight : weights) {
    weight = mean > 0 ? static_cast<float>(static_cast<double>(weight) / mean) : 1;
  }
}

}  // namespace

std::vector<float> sampling_weights(const VertexScene& scene) {
  const VertexTransportView& transport = scene.transport;
  std::vector<float> weights(transport.vertex_count, 1.0f);
  if (transport.irradiance_channels == 0) return weights;
  for (std::size_t vertex = 0; vertex < weights.size(); ++vertex) {
    const bool has_highlight = vertex < transport.highlight_count;
    // Of an open vertex: ∫ Y_00 over the hemisphere, and of the clamped cosine.
    const double seen =
        has_highlight
            ? first_coefficient(transport.visibility, vertex, transport.visibility_degree, 1) /
                  std::sqrt(kPi)
            : first_coefficient(transport.irradiance, vertex, transport.irradiance_degree,
                                transport.irradiance_channels) /
                  (std::sqrt(kPi) / 2);
    const double blocked = std::clamp(1 - seen, 0.0, 1.0);
    const double enough =
        scene.error.asked > 0 ? blocked_enough(scene.error.asked, has_highlight) : kLeastBlocked;
    weights[vertex] =
        blocked < kLeastBlocked ? 0 : static_cast<float>(std::min(1.0, blocked / enough));
  }
  normalize(std::span(weights).first(transport.highlight_count));
  normalize(std::span(weights).subspan(transport.highlight_count));
  return weights;
}

}  // namespace rimlight
