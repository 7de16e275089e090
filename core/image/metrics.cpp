#include "core/image/metrics.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <vector>

#include "core/base/check.h"
#include "core/image/tone_map.h"

namespace rimlight {
namespace {

/// The 8-bit sRGB code of a linear value: how many of the 255 boundaries between codes it reaches.
class DisplayCode {
 public:
  DisplayCode() {
    for (std::size_t i = 0; i < boundaries_.size(); ++i) {
      boundaries_[i] = linear_from_srgb((static_cast<double>(i) + 0.5) / 255);
    }
  }
  int operator()(double linear) const {
    if (!(linear > 0)) return 0;
    return static_cast<int>(std::upper_bound(boundaries_.begin(), boundaries_.end(), linear) -
                            boundaries_.begin());
  }

 private:
  std::array<double, 255> boundaries_;
};

}  // namespace

double auto_exposure_scale(std::span<const Vec3f> radiance) {
  constexpr double kMiddleGrey = 0.18;
  if (radiance.empty()) return 1;
  std::vector<float> values;
  values.reserve(3 * radiance.size());
  for (const Vec3f& value : radiance) {
    for (int c = 0; c < 3; ++c) values.push_back(std::isnan(value[c]) ? 0 : value[c]);
  }
  const auto percentile =
      values.begin() + static_cast<std::ptrdiff_t>((values.size() - 1) * 99 / 100);
  std::nth_element(values.begin(), percentile, values.end());
  const float most = *percentile;
  double sum = 0;
  for (const float value : values) sum += static_cast<double>(std::min(value, most));
  const double scale = kMiddleGrey * static_cast<double>(values.size()) / sum;
  return scale > 0 && std::isfinite(scale) ? scale : 1;
}

double display_psnr(std::span<const Vec3f> image, std::span<const Vec3f> reference, double scale) {
  constexpr double kCap = 99;
  RIMLIGHT_CHECK_EQ(image.size(), reference.size());
  static const DisplayCode code;
  double sum = 0;  // whole numbers: exact in any order
  for (std::size_t i = 0; i < image.size(); ++i) {
    for (int c = 0; c < 3; ++c) {
      const double difference = code(static_cast<double>(image[i][c]) * scale) -
                                code(static_cast<double>(reference[i][c]) * scale);
      sum += difference * difference;
    }
  }
  if (sum == 0) return kCap;
  const double mean = sum / (3 * static_cast<double>(image.size()));
  return std::min(kCap, 10 * std::log10(255.0 * 255.0 / mean));
}

double relative_l2(std::span<const Vec3f> image, std::span<const Vec3f> reference) {
  RIMLIGHT_CHECK_EQ(image.size(), reference.size());
  double error = 0;
  double energy = 0;
  for (std::size_t i = 0; i < image.size(); ++i) {
    const Vec3d truth(reference[i]);
    const Vec3d difference = Vec3d(image[i]) - truth;
    error += dot(difference, difference);
    energy += dot(truth, truth);
  }
  if (energy == 0) return error == 0 ? 0 : std::numeric_limits<double>::infinity();
  return std::sqrt(error / energy);
}

}  // namespace rimlight
