#include "core/material/measured_lobe.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "core/material/half_vector.h"

namespace rimlight {

MeasuredLobe::MeasuredLobe(FactoredBrdf factors) : factors_(std::move(factors)) {
  for (std::size_t i = 0; i <= kCurveBins; ++i) {
    const double sine = std::sin(bin_begin(CurveAxis::half_angle, static_cast<double>(i)));
    sine_squared_[i] = sine * sine;
  }
  const auto sum_up = [this](const auto& weight) {
    for (std::size_t i = 0; i < kCurveBins; ++i) {
      cumulative_[i + 1] = cumulative_[i] + weight(i) * (sine_squared_[i + 1] - sine_squared_[i]);
    }
  };
  sum_up([this](std::size_t i) {
    const Vec3d value(factors_.half_angle.values[i]);
    return value.x + value.y + value.z;
  });
  if (!(cumulative_.back() > 0)) sum_up([](std::size_t) { return 1.0; });
  const double all = cumulative_.back();
  for (double& sum : cumulative_) sum /= all;
}

Vec3f MeasuredLobe::evaluate(const Vec3f& in, const Vec3f& out) const {
  return Vec3f(rimlight::evaluate(factors_, Vec3d(in), Vec3d(out)));
}

float MeasuredLobe::density(const Vec3f& in, const Vec3f& out) const {
  const Vec3d sum = Vec3d(in) + Vec3d(out);
  const double squared = dot(sum, sum);
  if (!(squared > 1e-12)) return 0;
  const double size = std::sqrt(squared), across = std::hypot(sum.x, sum.y);
  const std::size_t bin = bin_of(CurveAxis::half_angle, std::atan2(across, sum.z));
  const double probability = cumulative_[bin + 1] - cumulative_[bin];
  const double ring = std::numbers::pi * (sine_squared_[bin + 1] - sine_squared_[bin]);
  // cos θ_h / (4 cos θ_d), with cos θ_d = |sum| / 2.
  return static_cast<float>(probability / ring * (sum.z / size) / (2 * size));
}

Vec3f MeasuredLobe::draw(const Vec3f& out, const Sample2& at) const {
  // The last bin that begins at or before u; empty ones, which begin where the next does, are
  // passed over.
  const auto next = std::upper_bound(cumulative_.begin() + 1, cumulative_.end() - 1, at.u);
  const auto bin = static_cast<std::size_t>(next - cumulative_.begin() - 1);
  const double probability = cumulative_[bin + 1] - cumulative_[bin];
  const double within =
      probability > 0 ? std::clamp((at.u - cumulative_[bin]) / probability, 0.0, 1.0) : 0.5;
  const double squared =
      sine_squared_[bin] + within * (sine_squared_[bin + 1] - sine_squared_[bin]);
  const double sine = std::sqrt(squared), turn = 2 * std::numbers::pi * at.v;
  return mirrored(
      {sine * std::cos(turn), sine * std::sin(turn), std::sqrt(std::max(0.0, 1 - squared))}, out);
}

float MeasuredLobe::roughness() const {
  const auto next = std::upper_bound(cumulative_.begin() + 1, cumulative_.end() - 1, 0.5);
  const auto bin = static_cast<double>(next - cumulative_.begin()) - 0.5;
  // Beckmann's median is at tan² θ_h = m² ln 2.
  const double tangent = std::tan(bin_begin(CurveAxis::half_angle, bin));
  return static_cast<float>(tangent / std::sqrt(std::numbers::ln2));
}

}  // namespace rimlight
