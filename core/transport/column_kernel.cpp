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

// Eight numbers are at most one vector of 8; narrower targets take 2 of 4, or 8 of 1.
using Floats = hn::CappedTag<float, kBlockReceivers>;
using Integers = hn::RebindToSigned<Floats>;
using Unsigned = hn::RebindToUnsigned<Floats>;

// How each width is read: Lanes(Floats) numbers of a block from its `first` on.
struct Full {
  static constexpr ValueWidth kWidth = ValueWidth::full;
  static HWY_INLINE hn::Vec<Floats> load(const uint8_t* block, size_t first) {
    return hn::LoadU(Floats(), reinterpret_cast<const float*>(block) + first);
  }
};
struct Word {
  static constexpr ValueWidth kWidth = ValueWidth::word;
  static HWY_INLINE hn::Vec<Floats> load(const uint8_t* block, size_t first) {
    const hn::Rebind<int16_t, Floats> words;
    const auto* const from = reinterpret_cast<const int16_t*>(block) + first;
    return hn::ConvertTo(Floats(), hn::PromoteTo(Integers(), hn::LoadU(words, from)));
  }
};
struct Byte {
  static constexpr ValueWidth kWidth = ValueWidth::byte;
  static HWY_INLINE hn::Vec<Floats> load(const uint8_t* block, size_t first) {
    const hn::Rebind<int8_t, Floats> bytes;
    const auto* const from = reinterpret_cast<const int8_t*>(block) + first;
    return hn::ConvertTo(Floats(), hn::PromoteTo(Integers(), hn::LoadU(bytes, from)));
  }
};
struct Nibble {
  static constexpr ValueWidth kWidth = ValueWidth::nibble;
  static HWY_INLINE hn::Vec<Floats> load(const uint8_t* block, size_t first) {
    uint32_t all;
    hwy::CopyBytes<sizeof all>(block, &all);
    // Lane i's four bits to the top, then down again with their sign.
    const Unsigned lanes;
    const auto up = hn::Sub(hn::Set(lanes, 28),
                            hn::ShiftLeft<2>(hn::Iota(lanes, static_cast<uint32_t>(first))));
    const auto top = hn::Shl(hn::Set(lanes, all), up);
    return hn::ConvertTo(Floats(), hn::ShiftRight<28>(hn::BitCast(Integers(), top)));
  }
};

/// Where the kernel stands in a run.
struct Place {
  const uint16_t* count;
  const uint8_t* values;
  const uint16_t* index;
};

/// held[channel][8] += delta[channel] · values[8] over one section's blocks, for the channels that
/// a plane adds to. No tail: 8 is a multiple of the lanes.
template <class Width, size_t kFirstChannel, size_t kChannels>
HWY_INLINE void add_section(const Vec3f& delta, float* HWY_RESTRICT held, Place& at) {
  constexpr size_t kBytes = kBlockBytes[static_cast<size_t>(Width::kWidth)];
  const Floats floats;
  const auto first = hn::Set(floats, delta[kFirstChannel]);
  const auto second = hn::Set(floats, delta[kFirstChannel + 1]);
  const auto third = hn::Set(floats, delta[2]);
  const uint8_t* HWY_RESTRICT values = at.values;
  const uint16_t* HWY_RESTRICT index = at.index;
  const uint16_t* const end = index + *at.count;
  for (; index != end; ++index, values += kBytes) {
    float* const block = held + *index * kBlockFloats + kFirstChannel * kBlockReceivers;
    for (size_t i = 0; i < kBlockReceivers; i += hn::Lanes(floats)) {
      const auto value = Width::load(values, i);
      const auto add = [&](hn::Vec<Floats> factor, float* to) HWY_ATTR {
        hn::Store(hn::MulAdd(factor, value, hn::Load(floats, to)), floats, to);
      };
      add(first, block + i);
      add(second, block + kBlockReceivers + i);
      if (kChannels == 3) add(third, block + 2 * kBlockReceivers + i);
    }
  }
  at = {at.count + 1, values, index};
}

/// The planes' deltas: per channel, delta · factor · step.
struct PlaneDeltas {
  Vec3f plane[kPlanes];
};

/// One width's three sections. Luma adds to all channels, chroma to red and green, or green and
/// blue.
template <class Width>
HWY_INLINE void add_width(const PlaneDeltas& delta, float* HWY_RESTRICT held, Place& at) {
  add_section<Width, 0, 3>(delta.plane[0], held, at);
  add_section<Width, 0, 2>(delta.plane[1], held, at);
  add_section<Width, 1, 2>(delta.plane[2], held, at);
}

HWY_INLINE void add_run(const ColumnRun& run, const Vec3f& delta, float step, float* held) {
  if (run.empty()) return;
  PlaneDeltas planes;
  for (size_t plane = 0; plane < kPlanes; ++plane) {
    planes.plane[plane] = delta * kPlaneFactors[plane] * step;
  }
  Place at = {run.counts(), run.values(), run.indices()};
  add_width<Full>(planes, held, at);
  add_width<Word>(planes, held, at);
  add_width<Byte>(planes, held, at);
  add_width<Nibble>(planes, held, at);
}

/// Runs are short and lie far apart, where the hardware's prefetcher cannot follow: first the
/// offsets of a column well ahead, then, when those have come, the run of a column less far ahead.
constexpr size_t kOffsetsAhead = 8;
constexpr size_t kRunAhead = 4;
constexpr size_t kMostPrefetchedBytes = 1024;  // a longer run starts the hardware's prefetcher
constexpr size_t kCacheLine = 64;

HWY_INLINE void prefetch_offsets(const TransportView& transport, size_t tile, size_t column) {
  const TransportView::Arrays& arrays = transport.arrays();
  hwy::Prefetch(arrays.run_offset.data() + tile * (arrays.column_count + 1) + column);
}

HWY_INLINE void prefetch_run(const TransportView& transport, size_t tile, size_t column) {
  const auto words = transport.run(tile, column).words();
  const auto* const bytes = reinterpret_cast<const char*>(words.data());
  const size_t size = HWY_MIN(words.size_bytes(), kMostPrefetchedBytes);
  for (size_t at = 0; at < size; at += kCacheLine) hwy::Prefetch(bytes + at);
}

void add_columns_lanes(const TransportView& transport, size_t tile, const ColumnDelta* columns,
                       size_t count, float* HWY_RESTRICT held) {
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
    const ColumnDelta& column = columns[i];
    add_run(transport.run(tile, column.column), column.delta, transport.step(column.column), held);
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
                 std::span<const ColumnDelta> columns, float* held) noexcept {
  HWY_DYNAMIC_DISPATCH(add_columns_lanes)
  (transport, tile, columns.data(), columns.size(), held);
}

const char* column_kernel_target() { return HWY_DYNAMIC_DISPATCH(target_name)(); }

}  // namespace rimlight
#endif  // HWY_ONCE
