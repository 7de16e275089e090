#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "core/base/half.h"
#include "core/transport/vertex_transport.h"

namespace rimlight {

// What is done to *panels*: values of kPanelLanes vertices side by side, [coefficient][kPanelLanes]
// in fp32, 64-byte aligned. Everything is lane by lane: a vertex gets the same bits in any lane of
// any panel. Nothing is allocated.
inline constexpr std::size_t kPanelLanes = kBatchVertices;
inline constexpr std::size_t kLightChannels = 3;

/// Indices from `begin` up to and without `end`.
struct CoefficientRange {
  std::size_t begin = 0;
  std::size_t end = 0;
  friend bool operator==(const CoefficientRange&, const CoefficientRange&) = default;
};

/// Some lanes of a batch of transport, on their way to the lanes of a panel from `to` on.
struct LanePiece {
  const Half* transport;  // [coefficients][kBatchVertices]
  std::uint64_t lanes;    // a bit for each lane of the batch
  std::size_t to;
};
/// Writes `coefficients` rows, from the transport's first, to those of the panel; the lanes after
/// the last one may be overwritten too, so that pieces go from left to right.
void load_lanes(const LanePiece& piece, std::size_t coefficients, float* panel) noexcept;

/// Some lanes of a panel, to the lanes from `to` on of another (or of the same, when the kept lanes
/// move down). Lanes from to + their number on may be overwritten up to where the lanes of the
/// source end; the kept ones must fit in, or go on in `next`, a panel of the same rows.
struct LaneMove {
  const float* from;
  std::uint64_t lanes;
  float* panel;
  float* next;
  std::size_t to;
};
void move_lanes(const LaneMove& move, std::size_t coefficients) noexcept;

/// The product matrices of the channels, symmetric: row i of channel c is at matrix[c] + i·stride.
struct ChannelMatrices {
  std::array<const float*, kLightChannels> matrix;
  std::size_t stride;
};
/// One bilinear form for all lanes:
///     sums[c] += Σ_i left_i · (Σ_j M^c_ij right_j)     over i of rows, j of columns
///   left, right  panels                sums  [kLightChannels][kPanelLanes]
/// `lanes`, the first so many, is rounded up to 16. M is applied to `right` as a matrix product: 2
/// · 3 · rows · columns operations a lane, and little else.
struct BilinearForm {
  CoefficientRange rows, columns;
  const float* left;
  const float* right;
  std::size_t lanes = kPanelLanes;
};
void add_bilinear_form(const ChannelMatrices& matrices, const BilinearForm& form,
                       float* sums) noexcept;

/// What of a light goes into a sum over transport: the first `count` coefficients of each channel.
struct BatchSum {
  const Half* transport;  // [channels][transport_stride][kBatchVertices]
  std::size_t channels;   // 1 or kLightChannels
  std::size_t transport_stride;
  const float* light;  // [kLightChannels][light_stride]
  std::size_t light_stride;
  std::size_t count;
};
/// sums[c] = Σ_i light^c_i · transport^c_i, [kLightChannels][kBatchVertices].
void sum_batch(const BatchSum& sum, float* sums) noexcept;

/// Rounds to nearest; a multiple of 16 values.
void store_halves(std::span<const float> values, Half* to) noexcept;
/// A multiple of 16 values, in float.
float sum_of_squares(std::span<const float> values) noexcept;

/// The product of one matrix and a panel as rows of coefficients, one a lane:
///     rows[lane][i] = Σ_j M_ij panel_j      for i of the matrix' stride, a multiple of 16
/// added up in the order of its columns; the matrix is padded with zeros, and so are the rows.
struct RowProduct {
  const float* matrix;  // [size][stride]
  std::size_t size, stride;
  const float* panel;
};
void multiply_to_rows(const RowProduct& product, std::span<float* const> rows) noexcept;

/// rows[lane][coefficient] = panel[coefficient][lane], rows `stride` floats apart; from
/// `coefficients` up to the stride zeros.
void transpose_panel(const float* panel, std::size_t coefficients, float* rows,
                     std::size_t stride) noexcept;

/// The SIMD target in use ("AVX3", …).
const char* vertex_product_target();

}  // namespace rimlight
