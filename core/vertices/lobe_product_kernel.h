#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "core/base/aligned_vector.h"

namespace rimlight {

// The steps of LobeProduct on rows of kLobeLanes vertices, [row][kLobeLanes], 64-byte aligned; lane
// by lane. So few lanes, because all rows that a product needs then fit in the first-level cache.
inline constexpr std::size_t kLobeLanes = 32;

/// A constant matrix between the rows of one band, as dense blocks of few outputs: outputs of a
/// block have the same inputs.
struct SparseRows {
  static constexpr std::size_t kMostOutputs = 12;

  struct Block {
    std::uint32_t outputs = 0, inputs = 0;
    std::uint32_t rows = 0;    // in `rows`: the outputs, then the inputs
    std::uint32_t values = 0;  // in `values`: [input][output]
  };
  std::vector<Block> blocks;
  std::vector<std::uint16_t> rows;
  AlignedVector<float> values;

  /// matrix [size][size], row-major; entries below 1e-12 are zero, as are the columns that are
  /// further than `reach` from the middle one.
  SparseRows(const std::vector<double>& matrix, std::size_t size, std::size_t reach);
};

/// to = matrix · from, all rows of the band; `to` is another array.
void multiply_rows(const SparseRows& matrix, const float* from, float* to) noexcept;

/// cos mα and sin mα of each lane, [m][kLobeLanes].
struct TurnAngles {
  const float* cosine;
  const float* sine;
};
enum class TurnWay { forth, back };
/// Turns a band, 2l + 1 rows, about z by α, or by −α, in place.
void turn_rows(const TurnAngles& angles, TurnWay way, int l, float* rows) noexcept;

/// One band l′ of the product of a function and a zonal lobe about z: row m is Σ_l factor · row (l,
/// m) of the function, with the same factors for m and −m.
struct ZonalBand {
  int l = 0;                       // l′
  int degree = 0;                  // of the function
  int least_difference = 0;        // l ≥ l′ − this
  const float* factors = nullptr;  // of m = 0, 1, … min(l′, degree); each of l = first(m) … degree
  int first(int m) const { return m > l - least_difference ? m : l - least_difference; }
};
/// Rows |m| > degree of `to`, [2l′ + 1] rows, are set to zero.
void multiply_zonal(const ZonalBand& band, const float* function, float* to) noexcept;

}  // namespace rimlight
