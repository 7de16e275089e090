// Compiled once for each SIMD target; the one in use is chosen at the first call.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "core/transport/column_kernel.cpp"
#include <hwy/cache_control.h>
#include <hwy/foreach_target.h>  // IWYU pragma: keep; before highway.h
#include <hwy/highway.h>

#include "core/base/check.h"
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

/// What a unit in a plane adds to each session's channels: delta · factor · step.
template <size_t kSessions>
struct PlaneDeltas {
  float value[kPlanes][kSessions][3];
};

/// One width's blocks of a run: its planes' sections one after another.
struct Blocks {
  size_t first_chroma, second_chroma, count;
  const uint8_t* values;
  const uint16_t* index;
};

/// A run's blocks by width.
struct RunBlocks {
  Blocks of_width[kWidths];

  explicit HWY_INLINE RunBlocks(const ColumnRun& run) {
    const uint16_t* count = run.counts();
    const uint8_t* values = run.values();
    for (size_t width = 0; width < kWidths; ++width, count += kPlanes) {
      const size_t luma = count[0], with_first = luma + count[1], all = with_first + count[2];
      of_width[width] = {luma, with_first, all, values, nullptr};
      values += all * kBlockBytes[width];
    }
    const auto* index = reinterpret_cast<const uint16_t*>(values);
    for (Blocks& blocks : of_width) {
      blocks.index = index;
      index += blocks.count;
    }
  }
};

HWY_INLINE bool has_layer(LayerSet layers, ValueWidth width) {
  return (layers >> layer_of(width) & 1) != 0;
}

/// to[8] += factor · value[8], from lane `i` on.
HWY_INLINE void add_product(hn::Vec<Floats> factor, hn::Vec<Floats> value, float* to) {
  const Floats floats;
  hn::Store(hn::MulAdd(factor, value, hn::Load(floats, to)), floats, to);
}

/// held[session][channel][8] += delta[session][channel] · values[8] over the luma blocks of one
/// width. No tail: 8 is a multiple of the lanes.
template <class Width, size_t kSessions>
HWY_INLINE void add_luma(const Blocks& blocks, const PlaneDeltas<kSessions>& deltas,
                         float* const* held) {
  constexpr size_t kBytes = kBlockBytes[static_cast<size_t>(Width::kWidth)];
  const Floats floats;
  hn::Vec<Floats> factor[kSessions][3];
  for (size_t session = 0; session < kSessions; ++session) {
    for (size_t channel = 0; channel < 3; ++channel) {
      factor[session][channel] = hn::Set(floats, deltas.value[0][session][channel]);
    }
  }
  const uint8_t* HWY_RESTRICT values = blocks.values;
  for (size_t block = 0; block < blocks.first_chroma; ++block, values += kBytes) {
    const size_t place = blocks.index[block] * kBlockFloats;
    for (size_t i = 0; i < kBlockReceivers; i += hn::Lanes(floats)) {
      const auto value = Width::load(values, i);
      for (size_t session = 0; session < kSessions; ++session) {
        float* const to = held[session] + place + i;
        add_product(factor[session][0], value, to);
        add_product(factor[session][1], value, to + kBlockReceivers);
        add_product(factor[session][2], value, to + 2 * kBlockReceivers);
      }
    }
  }
}

/// The same for chroma, which adds to red and green, or green and blue: both planes in one loop,
/// since sections are so short that each loop's mispredicted end counts.
template <class Width, size_t kSessions>
HWY_INLINE void add_chroma(const Blocks& blocks, const PlaneDeltas<kSessions>& deltas,
                           float* const* held) {
  constexpr size_t kBytes = kBlockBytes[static_cast<size_t>(Width::kWidth)];
  const Floats floats;
  const uint8_t* HWY_RESTRICT values = blocks.values + blocks.first_chroma * kBytes;
  for (size_t block = blocks.first_chroma; block < blocks.count; ++block, values += kBytes) {
    const size_t channel = block >= blocks.second_chroma;
    const size_t place = blocks.index[block] * kBlockFloats + channel * kBlockReceivers;
    for (size_t i = 0; i < kBlockReceivers; i += hn::Lanes(floats)) {
      const auto value = Width::load(values, i);
      for (size_t session = 0; session < kSessions; ++session) {
        const float* const delta = deltas.value[1 + channel][session] + channel;
        float* const to = held[session] + place + i;
        add_product(hn::Set(floats, delta[0]), value, to);
        add_product(hn::Set(floats, delta[1]), value, to + kBlockReceivers);
      }
    }
  }
}

template <class Width, size_t kSessions>
HWY_INLINE void add_blocks(const Blocks& blocks, const PlaneDeltas<kSessions>& deltas,
                           float* const* held) {
  add_luma<Width, kSessions>(blocks, deltas, held);
  add_chroma<Width, kSessions>(blocks, deltas, held);
}

template <size_t kSessions>
HWY_INLINE void add_run(const ColumnRun& run, LayerSet layers, const PlaneDeltas<kSessions>& deltas,
                        float* const* held) {
  const RunBlocks blocks(run);
  if (has_layer(layers, ValueWidth::word)) {
    add_blocks<Full, kSessions>(blocks.of_width[0], deltas, held);
    add_blocks<Word, kSessions>(blocks.of_width[1], deltas, held);
  }
  if (has_layer(layers, ValueWidth::byte)) {
    add_blocks<Byte, kSessions>(blocks.of_width[2], deltas, held);
  }
  if (has_layer(layers, ValueWidth::nibble)) {
    add_blocks<Nibble, kSessions>(blocks.of_width[3], deltas, held);
  }
}

/// Runs are short and lie far apart, where the hardware's prefetcher cannot follow: first the
/// offsets of a column well ahead; when those have come, the counts of a column of which only some
/// layers are wanted; and then what is wanted of a column less far ahead.
constexpr size_t kOffsetsAhead = 12;
constexpr size_t kCountsAhead = 8;
constexpr size_t kRunAhead = 4;
constexpr size_t kMostPrefetchedBytes = 16384;  // a few runs of it fit the second-level cache
constexpr size_t kCacheLine = 64;

HWY_INLINE void prefetch_offsets(const TransportView& transport, size_t tile, size_t column) {
  const TransportView::Arrays& arrays = transport.arrays();
  hwy::Prefetch(arrays.run_offset.data() + tile * (arrays.column_count + 1) + column);
}

HWY_INLINE void prefetch(const void* from, size_t size) {
  const auto* const bytes = static_cast<const char*>(from);
  size = HWY_MIN(size, kMostPrefetchedBytes);
  for (size_t at = 0; at < size; at += kCacheLine) hwy::Prefetch(bytes + at);
}

HWY_INLINE void prefetch_counts(const TransportView& transport, size_t tile, size_t column,
                                LayerSet layers) {
  if (layers != kAllLayers) hwy::Prefetch(transport.run(tile, column).words().data());
}

HWY_INLINE void prefetch_run(const TransportView& transport, size_t tile, size_t column,
                             LayerSet layers) {
  const ColumnRun run = transport.run(tile, column);
  if (layers == kAllLayers) return prefetch(run.words().data(), run.words().size_bytes());
  if (run.empty()) return;
  const RunBlocks blocks(run);
  for (size_t width = 0; width < kWidths; ++width) {
    const Blocks& of_width = blocks.of_width[width];
    if (of_width.count == 0 || !has_layer(layers, static_cast<ValueWidth>(width))) continue;
    prefetch(of_width.values, of_width.count * kBlockBytes[width]);
    prefetch(of_width.index, of_width.count * sizeof(uint16_t));
  }
}

/// Columns with a delta for each of the sessions; `Columns` says which and what.
template <size_t kSessions, class Columns>
HWY_INLINE void add_all(const TransportView& transport, size_t tile, const Columns& columns,
                        size_t count, float* const* held) {
  for (size_t i = 0; i < HWY_MIN(count, kOffsetsAhead); ++i) {
    prefetch_offsets(transport, tile, columns.column(i));
  }
  for (size_t i = 0; i < HWY_MIN(count, kCountsAhead); ++i) {
    prefetch_counts(transport, tile, columns.column(i), columns.layers(i));
  }
  for (size_t i = 0; i < HWY_MIN(count, kRunAhead); ++i) {
    prefetch_run(transport, tile, columns.column(i), columns.layers(i));
  }
  PlaneDeltas<kSessions> deltas;
  for (size_t i = 0; i < count; ++i) {
    if (i + kOffsetsAhead < count) {
      prefetch_offsets(transport, tile, columns.column(i + kOffsetsAhead));
    }
    if (const size_t k = i + kCountsAhead; k < count) {
      prefetch_counts(transport, tile, columns.column(k), columns.layers(k));
    }
    if (const size_t k = i + kRunAhead; k < count) {
      prefetch_run(transport, tile, columns.column(k), columns.layers(k));
    }
    const size_t column = columns.column(i);
    const ColumnRun run = transport.run(tile, column);
    if (run.empty()) continue;
    for (size_t plane = 0; plane < kPlanes; ++plane) {
      for (size_t session = 0; session < kSessions; ++session) {
        const Vec3f delta =
            columns.delta(i, session) * kPlaneFactors[plane] * transport.step(column);
        for (int c = 0; c < 3; ++c) deltas.value[plane][session][c] = delta[c];
      }
    }
    add_run<kSessions>(run, columns.layers(i), deltas, held);
  }
}

void add_columns_lanes(const TransportView& transport, size_t tile, const ColumnDelta* columns,
                       size_t count, float* held) {
  struct One {
    const ColumnDelta* columns;
    size_t column(size_t i) const { return columns[i].column; }
    LayerSet layers(size_t i) const { return columns[i].layers; }
    const Vec3f& delta(size_t i, size_t) const { return columns[i].delta; }
  };
  add_all<1>(transport, tile, One{columns}, count, &held);
}

/// The first kSessions of `sessions`, whose deltas are [column][session].
template <size_t kSessions>
HWY_NOINLINE void add_columns_to(const TransportView& transport, size_t tile,
                                 const uint32_t* columns, size_t count, const Vec3f* deltas,
                                 size_t sessions, float* const* held) {
  struct Many {
    const uint32_t* columns;
    const Vec3f* deltas;
    size_t sessions;
    size_t column(size_t i) const { return columns[i]; }
    LayerSet layers(size_t) const { return kAllLayers; }
    const Vec3f& delta(size_t i, size_t session) const { return deltas[i * sessions + session]; }
  };
  add_all<kSessions>(transport, tile, Many{columns, deltas, sessions}, count, held);
}

/// So many columns of a tile stay in the second-level cache, even where all blocks are stored.
constexpr size_t kColumnsAtOnce = 64;

/// Two sessions at a time: their tiles just about stay in the first-level cache. With more, they
/// have to come from the second for each block, which costs more than decoding it again.
void add_columns_to_all_lanes(const TransportView& transport, size_t tile,
                              const SessionDeltas& columns, float* const* held, size_t sessions) {
  for (size_t i = 0; i < columns.columns.size(); i += kColumnsAtOnce) {
    const size_t count = HWY_MIN(kColumnsAtOnce, columns.columns.size() - i);
    const uint32_t* const ids = columns.columns.data() + i;
    const Vec3f* const deltas = columns.deltas.data() + i * sessions;
    size_t s = 0;
    for (; s + 2 <= sessions; s += 2) {
      add_columns_to<2>(transport, tile, ids, count, deltas + s, sessions, held + s);
    }
    if (s < sessions) {
      add_columns_to<1>(transport, tile, ids, count, deltas + s, sessions, held + s);
    }
  }
}

const char* target_name() { return hwy::TargetName(HWY_TARGET); }

}  // namespace HWY_NAMESPACE
}  // namespace rimlight
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace rimlight {

HWY_EXPORT(add_columns_lanes);
HWY_EXPORT(add_columns_to_all_lanes);
HWY_EXPORT(target_name);

void add_columns(const TransportView& transport, std::size_t tile,
                 std::span<const ColumnDelta> columns, float* held) noexcept {
  HWY_DYNAMIC_DISPATCH(add_columns_lanes)
  (transport, tile, columns.data(), columns.size(), held);
}

void add_columns_to_all(const TransportView& transport, std::size_t tile,
                        const SessionDeltas& columns, std::span<float* const> held) {
  RIMLIGHT_CHECK_EQ(columns.deltas.size(), columns.columns.size() * held.size());
  HWY_DYNAMIC_DISPATCH(add_columns_to_all_lanes)
  (transport, tile, columns, held.data(), held.size());
}

const char* column_kernel_target() { return HWY_DYNAMIC_DISPATCH(target_name)(); }

}  // namespace rimlight
#endif  // HWY_ONCE
