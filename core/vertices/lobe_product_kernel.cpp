// Compiled once for each SIMD target; the one in use is chosen at the first call.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "core/vertices/lobe_product_kernel.cpp"
#include "core/vertices/lobe_product_kernel.h"

#include <hwy/foreach_target.h>  // IWYU pragma: keep; before highway.h
#include <hwy/highway.h>

#include <algorithm>
#include <cmath>
#include <map>

HWY_BEFORE_NAMESPACE();
namespace rimlight {
namespace HWY_NAMESPACE {
namespace {
namespace hn = hwy::HWY_NAMESPACE;

using Floats = hn::CappedTag<float, 16>;
constexpr size_t kRow = kLobeLanes;
/// Vectors of a row at once: with kMostOutputs outputs, 24 of 32 registers, or 12 of 16.
constexpr size_t kVectors = hn::MaxLanes(Floats()) == 16 ? 2 : 1;

template <size_t kOutputs>
void multiply_block(const SparseRows& matrix, const SparseRows::Block& block,
                    const float* HWY_RESTRICT from, float* HWY_RESTRICT to, size_t lane) {
  const Floats floats;
  const size_t width = hn::Lanes(floats);
  const uint16_t* const outputs = matrix.rows.data() + block.rows;
  const uint16_t* const inputs = outputs + kOutputs;
  const float* factor = matrix.values.data() + block.values;
  hn::Vec<Floats> sum[kOutputs][kVectors];
  for (auto& output : sum) {
    for (auto& vector : output) vector = hn::Zero(floats);
  }
  for (size_t i = 0; i < block.inputs; ++i, factor += kOutputs) {
    const float* const row = from + inputs[i] * kRow + lane;
    hn::Vec<Floats> value[kVectors];
    for (size_t v = 0; v < kVectors; ++v) value[v] = hn::LoadU(floats, row + v * width);
    for (size_t o = 0; o < kOutputs; ++o) {
      const auto all = hn::Set(floats, factor[o]);
      for (size_t v = 0; v < kVectors; ++v) sum[o][v] = hn::MulAdd(all, value[v], sum[o][v]);
    }
  }
  for (size_t o = 0; o < kOutputs; ++o) {
    for (size_t v = 0; v < kVectors; ++v) {
      hn::StoreU(sum[o][v], floats, to + outputs[o] * kRow + lane + v * width);
    }
  }
}

void multiply_all(const SparseRows& matrix, const float* from, float* to) {
  using Multiply =
      void (*)(const SparseRows&, const SparseRows::Block&, const float*, float*, size_t);
  static constexpr Multiply kMultiply[SparseRows::kMostOutputs] = {
      multiply_block<1>, multiply_block<2>,  multiply_block<3>,  multiply_block<4>,
      multiply_block<5>, multiply_block<6>,  multiply_block<7>,  multiply_block<8>,
      multiply_block<9>, multiply_block<10>, multiply_block<11>, multiply_block<12>};
  const size_t step = kVectors * hn::Lanes(Floats());
  for (size_t lane = 0; lane < kRow; lane += step) {
    for (const SparseRows::Block& block : matrix.blocks) {
      kMultiply[block.outputs - 1](matrix, block, from, to, lane);
    }
  }
}

void turn_all(const TurnAngles& angles, TurnWay way, int l, float* rows) {
  const Floats floats;
  const auto sign = hn::Set(floats, way == TurnWay::forth ? 1.0f : -1.0f);
  for (int m = 1; m <= l; ++m) {
    float* const even = rows + static_cast<size_t>(l + m) * kRow;
    float* const odd = rows + static_cast<size_t>(l - m) * kRow;
    const size_t angle = static_cast<size_t>(m) * kRow;
    for (size_t lane = 0; lane < kRow; lane += hn::Lanes(floats)) {
      const auto cosine = hn::LoadU(floats, angles.cosine + angle + lane);
      const auto sine = hn::Mul(sign, hn::LoadU(floats, angles.sine + angle + lane));
      const auto a = hn::LoadU(floats, even + lane), b = hn::LoadU(floats, odd + lane);
      hn::StoreU(hn::NegMulAdd(b, sine, hn::Mul(a, cosine)), floats, even + lane);
      hn::StoreU(hn::MulAdd(a, sine, hn::Mul(b, cosine)), floats, odd + lane);
    }
  }
}

/// Rows m and −m at once, which have the same factors.
HWY_INLINE void multiply_pair(const ZonalBand& band, int m, const float* factor,
                              const float* HWY_RESTRICT function, float* HWY_RESTRICT to,
                              size_t lane) {
  const Floats floats;
  const size_t width = hn::Lanes(floats);
  hn::Vec<Floats> sum[2][kVectors];
  for (auto& row : sum) {
    for (auto& vector : row) vector = hn::Zero(floats);
  }
  for (int l = band.first(m); l <= band.degree; ++l, ++factor) {
    const auto all = hn::Set(floats, *factor);
    const int zonal = l * l + l;
    const float* const plus = function + static_cast<size_t>(zonal + m) * kRow + lane;
    const float* const minus = function + static_cast<size_t>(zonal - m) * kRow + lane;
    for (size_t v = 0; v < kVectors; ++v) {
      sum[0][v] = hn::MulAdd(all, hn::LoadU(floats, plus + v * width), sum[0][v]);
      sum[1][v] = hn::MulAdd(all, hn::LoadU(floats, minus + v * width), sum[1][v]);
    }
  }
  for (size_t v = 0; v < kVectors; ++v) {
    const size_t at = lane + v * width;
    hn::StoreU(sum[1][v], floats, to + static_cast<size_t>(band.l - m) * kRow + at);
    hn::StoreU(sum[0][v], floats, to + static_cast<size_t>(band.l + m) * kRow + at);
  }
}

void multiply_band(const ZonalBand& band, const float* function, float* to) {
  const size_t step = kVectors * hn::Lanes(Floats());
  const float* factor = band.factors;
  for (int m = 0; m <= HWY_MIN(band.l, band.degree); ++m) {
    for (size_t lane = 0; lane < kRow; lane += step) {
      multiply_pair(band, m, factor, function, to, lane);
    }
    factor += HWY_MAX(0, band.degree - band.first(m) + 1);
  }
  for (int m = band.degree + 1; m <= band.l; ++m) {
    for (size_t lane = 0; lane < kRow; ++lane) {
      to[static_cast<size_t>(band.l - m) * kRow + lane] = 0;
      to[static_cast<size_t>(band.l + m) * kRow + lane] = 0;
    }
  }
}

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace rimlight
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace rimlight {

HWY_EXPORT(multiply_all);
HWY_EXPORT(turn_all);
HWY_EXPORT(multiply_band);

SparseRows::SparseRows(const std::vector<double>& matrix, std::size_t size, std::size_t reach) {
  constexpr double kZero = 1e-12;
  const std::size_t middle = size / 2;
  std::map<std::vector<std::uint16_t>, std::vector<std::uint16_t>> outputs_of;  // by inputs
  for (std::size_t i = 0; i < size; ++i) {
    std::vector<std::uint16_t> inputs;
    for (std::size_t j = 0; j < size; ++j) {
      const std::size_t distance = j > middle ? j - middle : middle - j;
      if (distance > reach || std::abs(matrix[i * size + j]) < kZero) continue;
      inputs.push_back(static_cast<std::uint16_t>(j));
    }
    outputs_of[inputs].push_back(static_cast<std::uint16_t>(i));
  }
  for (const auto& [inputs, outputs] : outputs_of) {
    for (std::size_t first = 0; first < outputs.size(); first += kMostOutputs) {
      const std::size_t count = std::min(kMostOutputs, outputs.size() - first);
      blocks.push_back(
          {static_cast<std::uint32_t>(count), static_cast<std::uint32_t>(inputs.size()),
           static_cast<std::uint32_t>(rows.size()), static_cast<std::uint32_t>(values.size())});
      const auto begin = outputs.begin() + static_cast<std::ptrdiff_t>(first);
      rows.insert(rows.end(), begin, begin + static_cast<std::ptrdiff_t>(count));
      rows.insert(rows.end(), inputs.begin(), inputs.end());
      for (const std::uint16_t input : inputs) {
        for (std::size_t o = 0; o < count; ++o) {
          values.push_back(static_cast<float>(matrix[outputs[first + o] * size + input]));
        }
      }
    }
  }
}

void multiply_rows(const SparseRows& matrix, const float* from, float* to) noexcept {
  HWY_DYNAMIC_DISPATCH(multiply_all)(matrix, from, to);
}

void turn_rows(const TurnAngles& angles, TurnWay way, int l, float* rows) noexcept {
  HWY_DYNAMIC_DISPATCH(turn_all)(angles, way, l, rows);
}

void multiply_zonal(const ZonalBand& band, const float* function, float* to) noexcept {
  HWY_DYNAMIC_DISPATCH(multiply_band)(band, function, to);
}

}  // namespace rimlight
#endif  // HWY_ONCE
