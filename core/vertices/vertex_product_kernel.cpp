// Compiled once for each SIMD target; the one in use is chosen at the first call.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "core/vertices/vertex_product_kernel.cpp"
#include "core/vertices/vertex_product_kernel.h"

#include <hwy/foreach_target.h>  // IWYU pragma: keep; before highway.h
#include <hwy/highway.h>

#include <algorithm>

HWY_BEFORE_NAMESPACE();
namespace rimlight {
namespace HWY_NAMESPACE {
namespace {
namespace hn = hwy::HWY_NAMESPACE;

using Floats = hn::CappedTag<float, 16>;
using Halves = hn::Rebind<hwy::float16_t, Floats>;

HWY_INLINE hn::Vec<Floats> load_half(const Half* from) {
  return hn::PromoteTo(Floats(),
                       hn::LoadU(Halves(), reinterpret_cast<const hwy::float16_t*>(from)));
}

/// The kept lanes of one vector, and where they go.
struct VectorMove {
  std::size_t from;
  std::uint64_t bits;
  std::size_t count;
};

/// Splits a mask of a panel into vectors that keep something; returns how many.
HWY_INLINE std::size_t split(std::uint64_t lanes, VectorMove* moves) {
  const std::size_t width = hn::Lanes(Floats());
  const std::uint64_t all = width == 64 ? ~std::uint64_t{0} : (std::uint64_t{1} << width) - 1;
  std::size_t count = 0;
  for (std::size_t lane = 0; lane < kPanelLanes; lane += width) {
    const std::uint64_t bits = (lanes >> lane) & all;
    if (bits != 0) moves[count++] = {lane, bits, hwy::PopCount(bits)};
  }
  return count;
}

HWY_INLINE hn::Mask<Floats> mask_of(std::uint64_t bits) {
  std::uint8_t bytes[8];
  hwy::CopyBytes<8>(&bits, bytes);
  return hn::LoadMaskBits(Floats(), bytes);
}

/// The first `count` values to lanes from `lane` on of a panel's row: as a whole vector, whose rest
/// is written again or padding, unless it would leave the row.
HWY_INLINE void store_kept(hn::Vec<Floats> values, std::size_t count, float* row,
                           std::size_t lane) {
  const Floats floats;
  if (lane + hn::Lanes(floats) <= kPanelLanes) {
    hn::StoreU(values, floats, row + lane);
    return;
  }
  alignas(64) float part[kPanelLanes];
  hn::Store(values, floats, part);
  for (std::size_t k = 0; k < count; ++k) row[lane + k] = part[k];
}

void load_pieces(const LanePiece& piece, std::size_t coefficients, float* panel) {
  VectorMove moves[kPanelLanes];
  const std::size_t count = split(piece.lanes, moves);
  for (std::size_t i = 0; i < coefficients; ++i) {
    const Half* const from = piece.transport + i * kPanelLanes;
    std::size_t to = piece.to;
    for (std::size_t v = 0; v < count; ++v) {
      const auto values = load_half(from + moves[v].from);
      store_kept(hn::Compress(values, mask_of(moves[v].bits)), moves[v].count,
                 panel + i * kPanelLanes, to);
      to += moves[v].count;
    }
  }
}

void move_pieces(const LaneMove& move, std::size_t coefficients) {
  const Floats floats;
  VectorMove moves[kPanelLanes];
  const std::size_t count = split(move.lanes, moves);
  const std::size_t width = hn::Lanes(floats);
  alignas(64) float part[kPanelLanes];
  for (std::size_t i = 0; i < coefficients; ++i) {
    const std::size_t row = i * kPanelLanes;
    std::size_t to = move.to;
    for (std::size_t v = 0; v < count; ++v) {
      const auto kept =
          hn::Compress(hn::LoadU(floats, move.from + row + moves[v].from), mask_of(moves[v].bits));
      if (to + width <= kPanelLanes) {
        hn::StoreU(kept, floats, move.panel + row + to);
      } else {
        hn::StoreU(kept, floats, part);
        for (std::size_t k = 0; k < moves[v].count; ++k) {
          const std::size_t lane = to + k;
          float* const panel = lane < kPanelLanes ? move.panel : move.next - kPanelLanes;
          panel[row + lane] = part[k];
        }
      }
      to += moves[v].count;
    }
  }
}

/// Σ_i left_i (Σ_j M_ij right_j) over kRows rows, for all channels and kVectors vectors: so that
/// 32 registers hold 3 · 4 · 2 sums, 16 hold 3 · 4 · 1, with room for the factors.
template <size_t kRows, size_t kVectors>
HWY_INLINE void add_rows(const ChannelMatrices& matrices, const BilinearForm& form, size_t row,
                         size_t lane, float* HWY_RESTRICT sums) {
  const Floats floats;
  const size_t width = hn::Lanes(floats);
  hn::Vec<Floats> sum[kLightChannels][kRows][kVectors];
  for (auto& channel : sum) {
    for (auto& of_row : channel) {
      for (auto& vector : of_row) vector = hn::Zero(floats);
    }
  }
  const float* right = form.right + form.columns.begin * kPanelLanes + lane;
  // By symmetry the factors of neighbouring rows lie side by side, in row j.
  size_t factor = form.columns.begin * matrices.stride + row;
  for (size_t j = form.columns.begin; j < form.columns.end; ++j) {
    hn::Vec<Floats> value[kVectors];
    for (size_t v = 0; v < kVectors; ++v) value[v] = hn::LoadU(floats, right + v * width);
    for (size_t c = 0; c < kLightChannels; ++c) {
      const float* const factors = matrices.matrix[c] + factor;
      for (size_t r = 0; r < kRows; ++r) {
        const auto all = hn::Set(floats, factors[r]);
        for (size_t v = 0; v < kVectors; ++v)
          sum[c][r][v] = hn::MulAdd(all, value[v], sum[c][r][v]);
      }
    }
    factor += matrices.stride;
    right += kPanelLanes;
  }
  for (size_t v = 0; v < kVectors; ++v) {
    const size_t at = lane + v * width;
    for (size_t c = 0; c < kLightChannels; ++c) {
      auto total = hn::LoadU(floats, sums + c * kPanelLanes + at);
      for (size_t r = 0; r < kRows; ++r) {
        const auto left = hn::LoadU(floats, form.left + (row + r) * kPanelLanes + at);
        total = hn::MulAdd(left, sum[c][r][v], total);
      }
      hn::StoreU(total, floats, sums + c * kPanelLanes + at);
    }
  }
}

template <size_t kVectors>
HWY_INLINE void add_all_rows(const ChannelMatrices& matrices, const BilinearForm& form, size_t lane,
                             float* HWY_RESTRICT sums) {
  // Blocks of one row leave the multipliers waiting for each other: threes take up what fours
  // leave.
  constexpr size_t kThrees[4] = {0, 3, 2, 1};
  const size_t count = form.rows.end - form.rows.begin;
  const size_t in_threes = HWY_MIN(3 * kThrees[count % 4], count / 3 * 3);
  size_t row = form.rows.begin;
  for (; row + 4 <= form.rows.end - in_threes; row += 4) {
    add_rows<4, kVectors>(matrices, form, row, lane, sums);
  }
  for (; row + 3 <= form.rows.end; row += 3) {
    add_rows<3, kVectors>(matrices, form, row, lane, sums);
  }
  for (; row < form.rows.end; ++row) add_rows<1, kVectors>(matrices, form, row, lane, sums);
}

void add_form(const ChannelMatrices& matrices, const BilinearForm& form, float* sums) {
  const size_t width = hn::Lanes(Floats());
  constexpr size_t kVectors = hn::MaxLanes(Floats()) == 16 ? 2 : 1;
  const size_t lanes = hwy::RoundUpTo(form.lanes, 16);
  size_t lane = 0;
  for (; lane + kVectors * width <= lanes; lane += kVectors * width) {
    add_all_rows<kVectors>(matrices, form, lane, sums);
  }
  for (; lane < lanes; lane += width) add_all_rows<1>(matrices, form, lane, sums);
}

/// 16 lanes of a batch in all channels.
template <size_t kVectors>
HWY_INLINE void sum_lanes(const BatchSum& sum, size_t lane, float* HWY_RESTRICT sums) {
  const Floats floats;
  const size_t width = hn::Lanes(floats);
  hn::Vec<Floats> total[kLightChannels][kVectors];
  for (auto& channel : total) {
    for (auto& vector : channel) vector = hn::Zero(floats);
  }
  for (size_t i = 0; i < sum.count; ++i) {
    for (size_t v = 0; v < kVectors; ++v) {
      const Half* const from = sum.transport + i * kPanelLanes + lane + v * width;
      auto value = load_half(from);
      for (size_t c = 0; c < kLightChannels; ++c) {
        if (sum.channels > 1 && c > 0)
          value = load_half(from + c * sum.transport_stride * kPanelLanes);
        total[c][v] =
            hn::MulAdd(hn::Set(floats, sum.light[c * sum.light_stride + i]), value, total[c][v]);
      }
    }
  }
  for (size_t c = 0; c < kLightChannels; ++c) {
    for (size_t v = 0; v < kVectors; ++v) {
      hn::StoreU(total[c][v], floats, sums + c * kPanelLanes + lane + v * width);
    }
  }
}

void sum_batches(const BatchSum& sum, float* sums) {
  const size_t width = hn::Lanes(Floats());
  constexpr size_t kVectors = hn::MaxLanes(Floats()) == 16 ? 4 : 2;
  const size_t step = HWY_MIN(kVectors * width, kPanelLanes);
  for (size_t lane = 0; lane < kPanelLanes; lane += step) sum_lanes<kVectors>(sum, lane, sums);
}

void to_halves(const float* values, std::size_t count, Half* to) {
  const Floats floats;
  for (std::size_t i = 0; i < count; i += hn::Lanes(floats)) {
    hn::StoreU(hn::DemoteTo(Halves(), hn::LoadU(floats, values + i)), Halves(),
               reinterpret_cast<hwy::float16_t*>(to + i));
  }
}

float add_squares(const float* values, std::size_t count) {
  const Floats floats;
  auto sum = hn::Zero(floats);
  for (std::size_t i = 0; i < count; i += hn::Lanes(floats)) {
    const auto value = hn::LoadU(floats, values + i);
    sum = hn::MulAdd(value, value, sum);
  }
  return hn::GetLane(hn::SumOfLanes(floats, sum));
}

/// kLanes rows by kColumns vectors of each, from column `first` on: by symmetry those of the
/// factors lie side by side.
template <size_t kLanes, size_t kColumns>
HWY_INLINE void multiply_lanes(const RowProduct& product, size_t first, size_t lane,
                               float* const* rows) {
  const Floats floats;
  const size_t width = hn::Lanes(floats);
  hn::Vec<Floats> sum[kLanes][kColumns];
  for (auto& row : sum) {
    for (auto& vector : row) vector = hn::Zero(floats);
  }
  const float* factor = product.matrix + first;
  const float* value = product.panel + lane;
  for (size_t j = 0; j < product.size; ++j, factor += product.stride, value += kPanelLanes) {
    hn::Vec<Floats> factors[kColumns];
    for (size_t k = 0; k < kColumns; ++k) factors[k] = hn::LoadU(floats, factor + k * width);
    for (size_t v = 0; v < kLanes; ++v) {
      const auto all = hn::Set(floats, value[v]);
      for (size_t k = 0; k < kColumns; ++k) sum[v][k] = hn::MulAdd(factors[k], all, sum[v][k]);
    }
  }
  for (size_t v = 0; v < kLanes; ++v) {
    for (size_t k = 0; k < kColumns; ++k) {
      hn::StoreU(sum[v][k], floats, rows[lane + v] + first + k * width);
    }
  }
}

template <size_t kColumns>
HWY_INLINE void multiply_columns(const RowProduct& product, size_t first, size_t count,
                                 float* const* rows) {
  constexpr size_t kLanes = hn::MaxLanes(Floats()) == 16 ? 6 : 3;
  size_t lane = 0;
  for (; lane + kLanes <= count; lane += kLanes) {
    multiply_lanes<kLanes, kColumns>(product, first, lane, rows);
  }
  for (; lane < count; ++lane) multiply_lanes<1, kColumns>(product, first, lane, rows);
}

void multiply_rows_of(const RowProduct& product, float* const* rows, size_t count) {
  const size_t width = hn::Lanes(Floats());
  size_t first = 0;
  for (; first + 4 * width <= product.stride; first += 4 * width) {
    multiply_columns<4>(product, first, count, rows);
  }
  for (; first < product.stride; first += width) multiply_columns<1>(product, first, count, rows);
}

const char* target_name() { return hwy::TargetName(HWY_TARGET); }

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace rimlight
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace rimlight {

HWY_EXPORT(load_pieces);
HWY_EXPORT(move_pieces);
HWY_EXPORT(add_form);
HWY_EXPORT(sum_batches);
HWY_EXPORT(to_halves);
HWY_EXPORT(add_squares);
HWY_EXPORT(multiply_rows_of);
HWY_EXPORT(target_name);

void load_lanes(const LanePiece& piece, std::size_t coefficients, float* panel) noexcept {
  HWY_DYNAMIC_DISPATCH(load_pieces)(piece, coefficients, panel);
}

void move_lanes(const LaneMove& move, std::size_t coefficients) noexcept {
  HWY_DYNAMIC_DISPATCH(move_pieces)(move, coefficients);
}

void add_bilinear_form(const ChannelMatrices& matrices, const BilinearForm& form,
                       float* sums) noexcept {
  HWY_DYNAMIC_DISPATCH(add_form)(matrices, form, sums);
}

void sum_batch(const BatchSum& sum, float* sums) noexcept {
  HWY_DYNAMIC_DISPATCH(sum_batches)(sum, sums);
}

void store_halves(std::span<const float> values, Half* to) noexcept {
  HWY_DYNAMIC_DISPATCH(to_halves)(values.data(), values.size(), to);
}

float sum_of_squares(std::span<const float> values) noexcept {
  return HWY_DYNAMIC_DISPATCH(add_squares)(values.data(), values.size());
}

void multiply_to_rows(const RowProduct& product, std::span<float* const> rows) noexcept {
  HWY_DYNAMIC_DISPATCH(multiply_rows_of)(product, rows.data(), rows.size());
}

// By squares that stay in one cache line a row: scalar stores, but each line is read once.
void transpose_panel(const float* panel, std::size_t coefficients, float* rows,
                     std::size_t stride) noexcept {
  constexpr std::size_t kSquare = 16;
  for (std::size_t first = 0; first < stride; first += kSquare) {
    const std::size_t last = std::min(first + kSquare, stride);
    for (std::size_t lane = 0; lane < kPanelLanes; ++lane) {
      for (std::size_t i = first; i < last; ++i) {
        rows[lane * stride + i] = i < coefficients ? panel[i * kPanelLanes + lane] : 0;
      }
    }
  }
}

const char* vertex_product_target() { return HWY_DYNAMIC_DISPATCH(target_name)(); }

}  // namespace rimlight
#endif  // HWY_ONCE
