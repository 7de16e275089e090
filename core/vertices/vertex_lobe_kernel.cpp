// Compiled once for each SIMD target; the one in use is chosen at the first call.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "core/vertices/vertex_lobe_kernel.cpp"
#include "core/vertices/vertex_lobe_kernel.h"

#include <hwy/foreach_target.h>  // IWYU pragma: keep; before highway.h
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace rimlight {
namespace HWY_NAMESPACE {
namespace {
namespace hn = hwy::HWY_NAMESPACE;

using Floats = hn::CappedTag<float, 16>;
using Vector = hn::Vec<Floats>;
constexpr size_t kChannels = 3, kCorners = 3;

/// Nine sums at once, one for each corner and channel: that many additions do not wait for each
/// other, and the weights are applied once, not to each coefficient.
HWY_INLINE void gather_one(const MirroringPoint& point, const float* HWY_RESTRICT harmonics,
                           size_t stride, float* HWY_RESTRICT radiance) {
  const Floats floats;
  Vector sums[kCorners][kChannels];
  for (auto& of_corner : sums) {
    for (Vector& sum : of_corner) sum = hn::Zero(floats);
  }
  for (size_t k = 0; k < stride; k += hn::Lanes(floats)) {
    const Vector lobe = hn::Mul(hn::Load(floats, harmonics + k), hn::Load(floats, point.lobe + k));
    for (size_t corner = 0; corner < kCorners; ++corner) {
      for (size_t c = 0; c < kChannels; ++c) {
        const Vector light = hn::Load(floats, point.corners[corner] + c * stride + k);
        sums[corner][c] = hn::MulAdd(lobe, light, sums[corner][c]);
      }
    }
  }
  for (size_t c = 0; c < kChannels; ++c) {
    Vector sum = hn::Mul(hn::Set(floats, point.weights[0]), sums[0][c]);
    for (size_t corner = 1; corner < kCorners; ++corner) {
      sum = hn::MulAdd(hn::Set(floats, point.weights[corner]), sums[corner][c], sum);
    }
    radiance[c] = hn::GetLane(hn::SumOfLanes(floats, sum));
  }
}

void gather_lanes(std::span<const MirroringPoint> points, const float* harmonics, size_t stride,
                  float* radiance) {
  for (const MirroringPoint& point : points) {
    gather_one(point, harmonics, stride, radiance);
    harmonics += stride;
    radiance += kChannels;
  }
}

const char* lobe_target() { return hwy::TargetName(HWY_TARGET); }

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace rimlight
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace rimlight {

HWY_EXPORT(gather_lanes);
HWY_EXPORT(lobe_target);

void gather_lobes(std::span<const MirroringPoint> points, const float* harmonics,
                  std::size_t stride, float* radiance) noexcept {
  HWY_DYNAMIC_DISPATCH(gather_lanes)(points, harmonics, stride, radiance);
}

const char* vertex_lobe_target() { return HWY_DYNAMIC_DISPATCH(lobe_target)(); }

}  // namespace rimlight
#endif  // HWY_ONCE
