#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "core/bake/lane_kernel.cpp"
#include "core/bake/lane_kernel.h"

#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include <algorithm>

HWY_BEFORE_NAMESPACE();
namespace rimlight::HWY_NAMESPACE {
namespace {

namespace hn = hwy::HWY_NAMESPACE;

// 64 lanes are a whole number of vectors on every target up to 2,048 bits.
void add_weighted_lanes_impl(const float* HWY_RESTRICT weights, const Vec3f& value,
                             float* HWY_RESTRICT sum) {
  const hn::ScalableTag<float> f32;
  for (int c = 0; c < 3; ++c, weights += kGroupLanes, sum += kGroupLanes) {
    const auto factor = hn::Set(f32, value[c]);
    for (std::size_t i = 0; i < kGroupLanes; i += hn::Lanes(f32)) {
      hn::Store(hn::MulAdd(factor, hn::Load(f32, weights + i), hn::Load(f32, sum + i)), f32,
                sum + i);
    }
  }
}

/// One channel of one light over some rows: the 64 sums stay in registers where there are enough.
void add_row_products(const float* HWY_RESTRICT rows, const float* HWY_RESTRICT light,
                      std::size_t count, float* HWY_RESTRICT sum) {
  const hn::CappedTag<float, 16> f32;
  const std::size_t lanes = hn::Lanes(f32);
  for (std::size_t i = 0; i < kGroupLanes; i += 4 * lanes) {
    auto a = hn::Load(f32, sum + i);
    auto b = hn::Load(f32, sum + i + lanes);
    auto c = hn::Load(f32, sum + i + 2 * lanes);
    auto d = hn::Load(f32, sum + i + 3 * lanes);
    for (std::size_t j = 0; j < count; ++j) {
      const auto factor = hn::Set(f32, light[j]);
      const float* const row = rows + j * kRowLanes + i;
      a = hn::MulAdd(factor, hn::Load(f32, row), a);
      b = hn::MulAdd(factor, hn::Load(f32, row + lanes), b);
      c = hn::MulAdd(factor, hn::Load(f32, row + 2 * lanes), c);
      d = hn::MulAdd(factor, hn::Load(f32, row + 3 * lanes), d);
    }
    hn::Store(a, f32, sum + i);
    hn::Store(b, f32, sum + i + lanes);
    hn::Store(c, f32, sum + i + 2 * lanes);
    hn::Store(d, f32, sum + i + 3 * lanes);
  }
}

void multiply_rows_impl(const GroupRows& rows, std::span<const CubeLight> lights, float* images) {
  constexpr std::size_t kRowsAtOnce =
      64;  // 48 KiB of rows serve all lights while they are in cache
  const std::size_t count = rows.values.size() / kRowLanes;
  std::fill_n(images, lights.size() * kRowLanes, 0.0f);
  for (std::size_t first = 0; first < count; first += kRowsAtOnce) {
    const std::size_t block = std::min(kRowsAtOnce, count - first);
    for (std::size_t light = 0; light < lights.size(); ++light) {
      for (int c = 0; c < 3; ++c) {
        const std::size_t channel = static_cast<std::size_t>(c) * kGroupLanes;
        add_row_products(rows.row(first) + channel, lights[light].channel(c).data() + first, block,
                         images + light * kRowLanes + channel);
      }
    }
  }
}

}  // namespace
}  // namespace rimlight::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace rimlight {

HWY_EXPORT(add_weighted_lanes_impl);
HWY_EXPORT(multiply_rows_impl);

void add_weighted_lanes(const float* weights, const Vec3f& value, float* sum) {
  HWY_DYNAMIC_DISPATCH(add_weighted_lanes_impl)(weights, value, sum);
}

void multiply_rows(const GroupRows& rows, std::span<const CubeLight> lights, float* images) {
  HWY_DYNAMIC_DISPATCH(multiply_rows_impl)(rows, lights, images);
}

}  // namespace rimlight
#endif
