#include "core/curves/lobe_width.h"

#include <array>
#include <cmath>

#include "core/base/check.h"

namespace rimlight {

std::optional<double> median_half_angle(const BrdfCurve& curve) {
  RIMLIGHT_CHECK(curve.axis == CurveAxis::half_angle);
  std::array<double, kCurveBins + 1> sum{};  // up to each bin
  for (std::size_t bin = 0; bin < kCurveBins; ++bin) {
    const double begin = std::sin(bin_begin(curve.axis, static_cast<double>(bin)));
    const double end = std::sin(bin_begin(curve.axis, static_cast<double>(bin + 1)));
    const Vec3d value(curve.values[bin]);
    sum[bin + 1] = sum[bin] + (value.x + value.y + value.z) * (end * end - begin * begin);
  }
  const double half = sum.back() / 2;
  if (!(half > 0)) return std::nullopt;
  std::size_t bin = 0;
  while (sum[bin + 1] < half) ++bin;
  const double part = (half - sum[bin]) / (sum[bin + 1] - sum[bin]);
  return bin_begin(curve.axis, static_cast<double>(bin) + part);
}

double texel_width(int cube_size) { return 2.0 / cube_size; }

bool is_finer_than_texels(const BrdfCurve& curve, int cube_size) {
  const auto angle = median_half_angle(curve);
  return angle && 4 * *angle < texel_width(cube_size);
}

}  // namespace rimlight
