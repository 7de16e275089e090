#include "core/basis/daubechies_interval.h"

#include <algorithm>
#include <bit>
#include <cmath>

#include "core/base/check.h"
#include "core/basis/daubechies_filters.h"

namespace rimlight {
namespace {

using EndFilters = DaubechiesInterval::EndFilters;
constexpr auto kLow = daubechies::kLow, kHigh = daubechies::kHigh;

/// outputs[o] = Σ_i matrix[o][i] · inputs[i], for each lane; an output may be in an input's place.
template <typename T, std::size_t kOutputs, std::size_t kInputs>
void apply(const std::array<std::array<double, kInputs>, kOutputs>& matrix,
           const std::array<const T*, kInputs>& inputs, const std::array<T*, kOutputs>& outputs,
           std::size_t lanes) {
  constexpr std::size_t kChunk = 8;  // locals of a fixed size: the loops become vectors
  for (std::size_t lane = 0; lane < lanes; lane += kChunk) {
    const std::size_t count = std::min(kChunk, lanes - lane);
    T in[kInputs][kChunk] = {};
    T out[kOutputs][kChunk] = {};
    for (std::size_t i = 0; i < kInputs; ++i) std::copy_n(inputs[i] + lane, count, in[i]);
    for (std::size_t o = 0; o < kOutputs; ++o) {
      for (std::size_t i = 0; i < kInputs; ++i) {
        const T factor = static_cast<T>(matrix[o][i]);
        for (std::size_t at = 0; at < kChunk; ++at) out[o][at] += factor * in[i][at];
      }
    }
    for (std::size_t o = 0; o < kOutputs; ++o) std::copy_n(out[o], count, outputs[o] + lane);
  }
}

/// What forward and inverse steps work on: `low` holds length values (before) or length / 2 (after)
/// at its front, `high` the length / 2 details.
template <typename T, typename High>
struct Step {
  T* low;
  High* high;
  std::size_t lanes;

  T* at(std::size_t i) const { return low + i * lanes; }
  High* detail(std::size_t i) const { return high + i * lanes; }
};

/// The lows of row 0, 1 and the details of row 0, 1 from `first` on.
template <typename T, typename High>
std::array<const T*, 4> end_values(const Step<T, High>& step, std::size_t first) {
  return {step.at(first), step.at(first + 1), step.detail(first), step.detail(first + 1)};
}

template <typename T>
void split_end(const Step<T, T>& step, const EndFilters& filters, std::size_t first_value,
               std::size_t first_row) {
  std::array<const T*, 5> inputs{};
  for (std::size_t i = 0; i < inputs.size(); ++i) inputs[i] = step.at(first_value + i);
  apply<T, 4, 5>(filters, inputs,
                 {step.at(first_row), step.at(first_row + 1), step.detail(first_row),
                  step.detail(first_row + 1)},
                 step.lanes);
}

std::array<std::array<double, 4>, 4> shortest(const EndFilters& filters) {
  std::array<std::array<double, 4>, 4> matrix{};
  for (std::size_t i = 0; i < 4; ++i) std::copy_n(filters[i].begin(), 4, matrix[i].begin());
  return matrix;
}

template <typename T>
void split(const DaubechiesInterval::Level& level, const Step<T, T>& step) {
  if (level.length == 4) {
    apply<T, 4, 4>(shortest(level.left), {step.at(0), step.at(1), step.at(2), step.at(3)},
                   {step.at(0), step.at(1), step.detail(0), step.detail(1)}, step.lanes);
    return;
  }
  const std::size_t half = level.length / 2;
  // Each row reads values that no row before it has put its low value over.
  split_end(step, level.left, 0, 0);
  for (std::size_t k = 2; k + 2 < half; ++k) {
    apply<T, 2, 4>({kLow, kHigh},
                   {step.at(2 * k - 1), step.at(2 * k), step.at(2 * k + 1), step.at(2 * k + 2)},
                   {step.at(k), step.detail(k)}, step.lanes);
  }
  split_end(step, level.right, level.length - 5, half - 2);
}

/// kCount samples that one end makes alone: its taps from `first` on.
template <std::size_t kCount, typename T>
void join_end(const Step<T, const T>& step, const EndFilters& filters, std::size_t first,
              std::size_t first_row, std::size_t first_value) {
  std::array<std::array<double, 4>, kCount> matrix{};
  std::array<T*, kCount> outputs{};
  for (std::size_t o = 0; o < kCount; ++o) {
    for (std::size_t i = 0; i < 4; ++i) matrix[o][i] = filters[i][first + o];
    outputs[o] = step.at(first_value + o);
  }
  apply<T, kCount, 4>(matrix, end_values(step, first_row), outputs, step.lanes);
}

/// Two samples to which two neighbours contribute, each an end (4 values) or an inner row (2).
template <std::size_t kBefore, std::size_t kAfter, typename T>
void join_pair(const Step<T, const T>& step, const std::array<std::array<double, 2>, kBefore>& low,
               const std::array<const T*, kBefore>& before,
               const std::array<std::array<double, 2>, kAfter>& high,
               const std::array<const T*, kAfter>& after, std::size_t first_value) {
  std::array<std::array<double, kBefore + kAfter>, 2> matrix{};
  std::array<const T*, kBefore + kAfter> inputs{};
  for (std::size_t i = 0; i < kBefore + kAfter; ++i) {
    const bool is_before = i < kBefore;
    const std::array<double, 2>& taps = is_before ? low[i] : high[i - kBefore];
    matrix[0][i] = taps[0];
    matrix[1][i] = taps[1];
    inputs[i] = is_before ? before[i] : after[i - kBefore];
  }
  apply<T, 2, kBefore + kAfter>(matrix, inputs, {step.at(first_value), step.at(first_value + 1)},
                                step.lanes);
}

std::array<std::array<double, 2>, 4> two_taps(const EndFilters& filters, std::size_t first) {
  std::array<std::array<double, 2>, 4> taps{};
  for (std::size_t i = 0; i < 4; ++i) taps[i] = {filters[i][first], filters[i][first + 1]};
  return taps;
}

template <typename T>
void join(const DaubechiesInterval::Level& level, const Step<T, const T>& step) {
  if (level.length == 4) {
    join_end<4>(step, level.left, 0, 0, 0);
    return;
  }
  using InnerPair = std::array<std::array<double, 2>, 2>;
  constexpr InnerPair kFront = {{{kLow[0], kLow[1]}, {kHigh[0], kHigh[1]}}};
  constexpr InnerPair kBack = {{{kLow[2], kLow[3]}, {kHigh[2], kHigh[3]}}};
  const std::size_t half = level.length / 2, last = half - 2;
  const auto row = [&](std::size_t k) {
    return std::array<const T*, 2>{step.at(k), step.detail(k)};
  };
  // From the end: samples never cover a low value still to be read.
  join_end<3>(step, level.right, 2, last, level.length - 3);
  if (level.length == 8) {
    join_pair<4, 4>(step, two_taps(level.left, 3), end_values(step, 0), two_taps(level.right, 0),
                    end_values(step, last), 3);
  } else {
    join_pair<2, 4>(step, kBack, row(last - 1), two_taps(level.right, 0), end_values(step, last),
                    2 * last - 1);
    for (std::size_t k = last - 1; k > 2; --k) {
      join_pair<2, 2>(step, kBack, row(k - 1), kFront, row(k), 2 * k - 1);
    }
    join_pair<4, 2>(step, two_taps(level.left, 3), end_values(step, 0), kFront, row(2), 3);
  }
  join_end<3>(step, level.left, 0, 0, 0);
}

template <typename T>
void run_forward(const DaubechiesInterval& basis, std::span<const DaubechiesInterval::Level> levels,
                 std::span<T> samples, std::span<T> coefficients, std::size_t lanes) {
  RIMLIGHT_CHECK_EQ(samples.size(), basis.size() * lanes);
  RIMLIGHT_CHECK_EQ(coefficients.size(), samples.size());
  for (const DaubechiesInterval::Level& level : levels) {
    split<T>(level, {samples.data(), coefficients.data() + level.length / 2 * lanes, lanes});
  }
  std::copy_n(samples.begin(), 2 * lanes, coefficients.begin());
}

template <typename T>
void run_inverse(const DaubechiesInterval& basis, std::span<const DaubechiesInterval::Level> levels,
                 std::span<const T> coefficients, std::span<T> samples, std::size_t lanes) {
  RIMLIGHT_CHECK_EQ(samples.size(), basis.size() * lanes);
  RIMLIGHT_CHECK_EQ(coefficients.size(), samples.size());
  std::copy_n(coefficients.begin(), 2 * lanes, samples.begin());
  for (std::size_t i = levels.size(); i-- > 0;) {
    const T* const high = coefficients.data() + levels[i].length / 2 * lanes;
    join<T>(levels[i], {samples.data(), high, lanes});
  }
}

}  // namespace

DaubechiesInterval::DaubechiesInterval(std::size_t size) : size_(size) {
  RIMLIGHT_CHECK(size >= kSmallest && size <= kLargest);
  RIMLIGHT_CHECK(std::has_single_bit(size));
  band_count_ = std::countr_zero(size) - 1;
  std::vector<double> constant(size, 1 / std::sqrt(static_cast<double>(size))), linear(size);
  const double middle = 0.5 * static_cast<double>(size - 1);
  double squares = 0;
  for (std::size_t i = 0; i < size; ++i) {
    linear[i] = static_cast<double>(i) - middle;
    squares += linear[i] * linear[i];
  }
  for (double& x : linear) x /= std::sqrt(squares);
  std::vector<double> details(size);
  for (std::size_t length = size; length >= 4; length /= 2) {
    levels_.push_back(daubechies::make_level(constant, linear));
    for (std::vector<double>* sequence : {&constant, &linear}) {
      split<double>(levels_.back(), {sequence->data(), details.data(), 1});
      sequence->resize(length / 2);
    }
  }
}

int DaubechiesInterval::band_of(std::size_t coefficient) const {
  RIMLIGHT_CHECK(coefficient < size_);
  return coefficient < 4 ? 0 : static_cast<int>(std::bit_width(coefficient)) - 2;
}

void DaubechiesInterval::forward(std::span<float> samples, std::span<float> coefficients,
                                 std::size_t lanes) const {
  run_forward<float>(*this, levels_, samples, coefficients, lanes);
}

void DaubechiesInterval::forward(std::span<double> samples, std::span<double> coefficients,
                                 std::size_t lanes) const {
  run_forward<double>(*this, levels_, samples, coefficients, lanes);
}

void DaubechiesInterval::inverse(std::span<const float> coefficients, std::span<float> samples,
                                 std::size_t lanes) const {
  run_inverse<float>(*this, levels_, coefficients, samples, lanes);
}

void DaubechiesInterval::inverse(std::span<const double> coefficients, std::span<double> samples,
                                 std::size_t lanes) const {
  run_inverse<double>(*this, levels_, coefficients, samples, lanes);
}

}  // namespace rimlight
