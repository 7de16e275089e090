#include "core/basis/daubechies_filters.h"

#include <cmath>

// One level, from n values to n/2 low and n/2 high ones. The rows inside are Daubechies' filters h
// and g, g_t = (−1)^t h_(3−t), at values 2k − 1 … 2k + 2 for k = 2 … n/2 − 3. Of the n dimensions
// they leave four at each end: at the left e₀, e₁, e₂ and u ∝ h₂ e₃ + h₃ e₄ (orthogonal to the
// first row's h and g because h₀h₂ + h₁h₃ = 0), at the right its mirror with h₀ and h₁.
//
// g annihilates sequences that are linear where it reaches. So constant and linear samples lie in
// the span of the inner low rows and of their own parts in the two ends' four dimensions; taking
// those parts as low filters, and what is orthogonal to them as high ones, leaves no details
// anywhere. The low values of both sequences are what the next level starts with: linear inside,
// and whatever the end filters make of them at the ends.
//
// Within the two dimensions of each kind a rotation takes the one filter's part of u away, so that
// it has 3 taps and the other 5. The last level, of 4 values, has the two sequences themselves as
// low filters.

namespace rimlight::daubechies {
namespace {

using EndFilters = DaubechiesInterval::EndFilters;
using Taps = std::array<double, DaubechiesInterval::kBoundaryTaps>;

double dot_product(const Taps& a, const Taps& b) {
  double sum = 0;
  for (std::size_t i = 0; i < a.size(); ++i) sum += a[i] * b[i];
  return sum;
}

/// What is left of `v` off the orthonormal `axes`, twice for accuracy, and scaled to length 1.
Taps orthonormalized(Taps v, std::span<const Taps> axes) {
  for (int pass = 0; pass < 2; ++pass) {
    for (const Taps& axis : axes) {
      const double along = dot_product(v, axis);
      for (std::size_t i = 0; i < v.size(); ++i) v[i] -= along * axis[i];
    }
  }
  const double scale = 1 / std::sqrt(dot_product(v, v));
  for (double& x : v) x *= scale;
  return v;
}

/// Turns two orthonormal filters so that the first one's tap at `innermost` vanishes.
void shorten(Taps& first, Taps& second, std::size_t innermost) {
  const double a = first[innermost], b = second[innermost];
  const double length = std::hypot(a, b);
  if (length == 0) return;
  const double cosine = b / length, sine = a / length;
  for (std::size_t i = 0; i < first.size(); ++i) {
    const double x = first[i], y = second[i];
    first[i] = cosine * x - sine * y;
    second[i] = sine * x + cosine * y;
  }
}

/// The four filters of one end: `space` spans its dimensions (orthonormal), constant and linear are
/// the two sequences there, `innermost` the tap farthest from the end.
EndFilters end_filters(std::span<const Taps> space, const Taps& constant, const Taps& linear,
                       std::size_t innermost) {
  const auto inside = [&](const Taps& v) {
    Taps result{};
    for (const Taps& axis : space) {
      const double along = dot_product(v, axis);
      for (std::size_t i = 0; i < v.size(); ++i) result[i] += along * axis[i];
    }
    return result;
  };
  EndFilters filters{};
  filters[0] = orthonormalized(inside(constant), {});
  filters[1] = orthonormalized(inside(linear), std::span(filters).first(1));
  // Of four axes, the two that stand out most from what is there already.
  for (std::size_t found = 2; found < 4; ++found) {
    double best = 0;
    for (const Taps& axis : space) {
      double rest = 1;
      for (std::size_t i = 0; i < found; ++i) rest -= std::pow(dot_product(axis, filters[i]), 2);
      if (!(rest > best + 1e-9)) continue;
      best = rest;
      filters[found] = orthonormalized(axis, std::span(filters).first(found));
    }
  }
  shorten(filters[0], filters[1], innermost);
  shorten(filters[2], filters[3], innermost);
  return filters;
}

using Axes = std::array<Taps, 4>;

Axes left_space(std::size_t length) {
  Axes axes{};
  for (std::size_t i = 0; i < 4; ++i) axes[i][i] = 1;
  if (length < 16) return axes;
  const double norm = std::hypot(kLow[2], kLow[3]);
  axes[3] = {0, 0, 0, kLow[2] / norm, kLow[3] / norm};
  return axes;
}

Axes right_space(std::size_t length) {
  Axes axes{};
  for (std::size_t i = 0; i < 4; ++i) axes[i][i + 1] = 1;
  if (length < 16) return axes;
  const double norm = std::hypot(kLow[0], kLow[1]);
  axes[0] = {kLow[0] / norm, kLow[1] / norm, 0, 0, 0};
  return axes;
}

Taps taps_at(std::span<const double> values, std::size_t first) {
  Taps taps{};
  for (std::size_t i = 0; i < taps.size() && first + i < values.size(); ++i) {
    taps[i] = values[first + i];
  }
  return taps;
}

}  // namespace

/// The level's filters, from what constant and linear samples have become there.
DaubechiesInterval::Level make_level(std::span<const double> constant,
                                     std::span<const double> linear) {
  DaubechiesInterval::Level level{constant.size(), {}, {}};
  const std::size_t last = level.length >= 5 ? level.length - 5 : 0;
  const Axes left = left_space(level.length);
  // The innermost tap of an end that has all of its filters' room; a coarse one keeps the sequences
  // themselves, constant first.
  const std::size_t innermost = level.length >= 16 ? 4 : level.length == 8 ? 3 : 4;
  level.left = end_filters(left, taps_at(constant, 0), taps_at(linear, 0), innermost);
  if (level.length == 4) return level;
  level.right = end_filters(right_space(level.length), taps_at(constant, last),
                            taps_at(linear, last), level.length >= 16 ? 0 : 1);
  return level;
}

}  // namespace rimlight::daubechies
