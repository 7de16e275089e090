#include <algorithm>
#include <cmath>
#include <vector>

#include "core/base/check.h"
#include "core/base/parallel.h"
#include "core/light/environment.h"
#include "core/light/environment_samples.h"

namespace rimlight {
namespace {

/// Radiance above this many times the mean is projected as energy, below as radiance.
constexpr double kCapOfMean = 16;

/// Parts across a texel of the least solid angle: 8 at 128 texels a side. What a texel got differs
/// from its true solid angle by a rounding at its outline, of relative size (parts across)^−1.5,
/// and the error of the whole sphere is that over the square root of the number of texels: fewer
/// texels need finer parts.
double parts_across_texel(int size) { return std::max(8.0, 8 * std::pow(128.0 / size, 0.75)); }

/// What one texel got.
struct TexelSums {
  Vec3d base;  // radiance below the cap times solid angle
  Vec3d excess;
  double solid_angle = 0;
};

/// Shares parts of pixels out to texels; one for each chunk of rows.
class TexelSink {
 public:
  TexelSink(int size, const Vec3d& cap) : size_(size), cap_(cap), sums_(cube::texel_count(size)) {}

  void begin_pixel(const Vec3f& pixel) {
    base_ = Vec3d(pixel);
    for (int c = 0; c < 3; ++c) base_[c] = std::min(base_[c], cap_[c]);
    excess_ = Vec3d(pixel) - base_;
    has_excess_ = max_component(excess_) > 0;
  }

  void add(const Vec3d& direction, double solid_angle) {
    TexelSums& sums = sums_[cube::texel_of(direction, size_)];
    sums.base += base_ * solid_angle;
    sums.solid_angle += solid_angle;
    if (has_excess_) sums.excess += excess_ * solid_angle;
  }

  const TexelSums& operator[](std::size_t texel) const { return sums_[texel]; }

 private:
  int size_;
  Vec3d cap_;
  Vec3d base_, excess_;
  bool has_excess_ = false;
  std::vector<TexelSums> sums_;
};

/// Chunks of rows, each with sums of its own: a number that depends on the sizes only, so that the
/// order of addition does not depend on the threads; bounded by the memory that the sums take.
int chunk_count(int size, int height) {
  constexpr std::size_t kMostBytes = std::size_t{1} << 27;
  const std::size_t fitting = kMostBytes / (cube::texel_count(size) * sizeof(TexelSums));
  return std::min(static_cast<int>(std::clamp<std::size_t>(fitting, 1, 16)), height);
}

}  // namespace

CubeLight Environment::project(int size) const {
  RIMLIGHT_CHECK(size >= 2 && size <= cube::kLargestSize);
  const Vec3d cap = integral(*this) * (kCapOfMean / (4 * std::numbers::pi));
  const double texel_width = std::sqrt(cube::texel_solid_angle(0, size));  // at a face's corner
  const int chunks = chunk_count(size, image_.height);
  std::vector<TexelSink> sinks(static_cast<std::size_t>(chunks), TexelSink(size, cap));
  parallel_for(sinks.size(), [&](std::size_t i) {
    const auto row_of = [&](std::size_t chunk) {
      return static_cast<int>(chunk * static_cast<std::size_t>(image_.height) / sinks.size());
    };
    sample_rows(*this, {row_of(i), row_of(i + 1), texel_width / parts_across_texel(size)},
                sinks[i]);
  });

  CubeLight light(size);
  for (std::size_t texel = 0; texel < light.count(); ++texel) {
    TexelSums all;
    for (const TexelSink& sink : sinks) {
      all.base += sink[texel].base;
      all.excess += sink[texel].excess;
      all.solid_angle += sink[texel].solid_angle;
    }
    RIMLIGHT_CHECK(all.solid_angle > 0);
    const Vec3d radiance =
        all.base / all.solid_angle + all.excess / cube::texel_solid_angle(texel, size);
    for (int c = 0; c < 3; ++c) light.channel(c)[texel] = static_cast<float>(radiance[c]);
  }
  return light;
}

}  // namespace rimlight
