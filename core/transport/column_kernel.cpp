// Compiled once for each SIMD target; the one in use is chosen at the first call.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "core/transport/column_kernel.cpp"
#include <hwy/cache_control.h>
#include <hwy/foreach_target.h>  // IWYU pragma: keep; before highway.h
#include <hwy/highway.h>

#include "core/transport/column_kernel.h"

HWY_BEFORE_NAMESPACE();
namespace rimlight {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

// One channel of a block is at most one vector of 8; narrower targets take 2 of 4, or 8 of 1.
using Floats = hn::CappedTag<float, kBlockReceivers>;
using Halves = hn::Rebind<hwy::float16_t, Floats>;

/// radiance[8] += delta · values[8]. No tail: 8 is a multiple of the lanes.
HWY_INLINE void add_channel(hn::Vec<Floats> delta, const hwy::float16_t* HWY_RESTRICT values,
                            float* HWY_RESTRICT radiance) {
  const Floats floats;
  const Halves halves;
  for (size_t i = 0; i < kBlockReceivers; i += hn::Lanes(floats)) {
    const auto value = hn::PromoteTo(floats, hn::Load(halves, values + i));
    hn::Store(hn::MulAdd(delta, value, hn::Load(floats, radiance + i)), floats, radiance + i);
  }
}

HWY_INLINE void add_run(const ColumnRun& run, const Vec3f& delta, float* tile_radiance) {
  const Floats floats;
  // The scale goes into the delta: one rounding a column, none a value.
  const auto red = hn::Set(floats, delta.x * run.scale);
  const auto green = hn::Set(floats, delta.y * run.scale);
  const auto blue = hn::Set(floats, delta.z * run.scale);
  const auto* values = reinterpret_cast<const hwy::float16_t*>(run.values);
  for (const uint16_t block : run.block_index) {
    float* const radiance = tile_radiance + block * kBlockFloats;
    add_channel(red, values, radiance);
    add_channel(green, values + kBlockReceivers, radiance + kBlockReceivers);
    add_channel(blue, values + 2 * kBlockReceivers, radiance + 2 * kBlockReceivers);
    values += kBlockFloats;
  }
}

/// Runs are short and lie far apart, where the hardware's prefetcher cannot follow: first the
/// offsets of a column well ahead, then, when those have come, the run of a column less far ahead.
constexpr size_t kOffsetsAhead = 8;
constexpr size_t kRunAhead = 4;
constexpr size_t kMostPrefetchedBytes = 1024;  // a longer run starts the hardware's prefetcher
constexpr size_t kCacheLine = 64;

HWY_INLINE void prefetch_offsets(const TransportView& transport, size_t tile, size_t column) {
  const TransportView::Arrays& arrays = transport.arrays();
  hwy::Prefetch(arrays.column_offset.data() + tile * (arrays.column_count + 1) + column);
  hwy::Prefetch(arrays.column_scale.data() + tile * arrays.column_count + column);
}

HWY_INLINE void prefetch_run(const TransportView& transport, size_t tile, size_t column) {
  const ColumnRun run = transport.run(tile, column);
  const auto* const bytes = reinterpret_cast<const char*>(run.values);
  const size_t size =
      HWY_MIN(run.block_index.size() * kBlockFloats * sizeof(Half), kMostPrefetchedBytes);
  hwy::Prefetch(run.block_index.data());
  for (size_t at = 0; at < size; at += kCacheLine) hwy::Prefetch(bytes + at);
}

void add_columns_lanes(const TransportView& transport, size_t tile, const ColumnDelta* columns,
                       size_t count, float* HWY_RESTRICT tile_radiance) {
  for (size_t i = 0; i < HWY_MIN(count, kOffsetsAhead); ++i) {
    prefetch_offsets(transport, tile, columns[i].column);
  }
  for (size_t i = 0; i < HWY_MIN(count, kRunAhead); ++i) {
    prefetch_run(transport, tile, columns[i].column);
  }
  for (size_t i = 0; i < count; ++i) {
    if (i + kOffsetsAhead < count) {
      prefetch_offsets(transport, tile, columns[i + kOffsetsAhead].column);
    }
    if (i + kRunAhead < count) prefetch_run(transport, tile, columns[i + kRunAhead].column);
    add_run(transport.run(tile, columns[i].column), columns[i].delta, tile_radiance);
  }
}

const char* target_name() { return hwy::TargetName(HWY_TARGET); }

}  // namespace HWY_NAMESPACE
}  // namespace rimlight
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace rimlight {

HWY_EXPORT(add_columns_lanes);
HWY_EXPORT(target_name);

void add_columns(const TransportView& transport, std::size_t tile,
                 std::span<const ColumnDelta> columns, float* tile_radiance) noexcept {
  HWY_DYNAMIC_DISPATCH(add_columns_lanes)
  (transport, tile, columns.data(), columns.size(), tile_radiance);
}

const char* column_kernel_target() { return HWY_DYNAMIC_DISPATCH(target_name)(); }

}  // namespace rimlight
#endif  // HWY_ONCE
