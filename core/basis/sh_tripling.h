#pragma once

#include <cstddef>
#include <cstdint>

#include "core/base/aligned_vector.h"
#include "core/basis/sh.h"

namespace rimlight {

/// Tripling coefficients C(i, j, k) = ∫ Y_i Y_j Y_k dω of real spherical harmonics: the first two
/// to one degree, the third to twice that, where the products of the first two end.
///
/// C vanishes unless l₁ + l₂ + l₃ is even, |l₁ − l₂| ≤ l₃ ≤ l₁ + l₂, one of |m| is the sum of the
/// other two, and the number of sines (m < 0) is even. What is left is, but for its sign, the same
/// for all choices of cosine and sine: so only m ≥ 0 is stored, as *runs* over l₃ = first, first +
/// 2, … without indices. The sign is − where the two smaller of |m| are sines and the largest is a
/// cosine (Green 2003 and Sloan 2008 list the first few).
class ShTripling {
 public:
  /// The table to a degree, made at the first call for that degree and kept. Any thread; degrees
  /// 0 … sh::kLargestDegree, else CheckFailure. (Degree 10: 70 KB, under 1 ms; 32: 16 MB.)
  static const ShTripling& to_degree(int degree);

  int degree() const { return degree_; }

  /// The l₃ of a run: first, first + 2, …, last; none when first > last.
  struct Run {
    int first, last;
    std::size_t count() const {
      return first > last ? 0 : static_cast<std::size_t>((last - first) / 2 + 1);
    }
  };
  /// All l₃ that |m₃| and the triangle allow.
  static constexpr Run run(int l1, int l2, int m3) {
    const int least = l1 > l2 ? l1 - l2 : l2 - l1;
    const int first = least >= m3 ? least : m3 + ((l1 + l2 + m3) & 1);
    return {first, l1 + l2};
  }

  /// All runs one after another, for l₁, m₁ in 0 … l₁, l₂ ≤ l₁, m₂ in 0 … (l₂ < l₁ ? l₂ : m₁), in
  /// this order, m₂ innermost: first the run of m₃ = m₁ + m₂, then, where neither is 0, that of
  /// m₃ = |m₁ − m₂|. A table to a lower degree is a prefix. Rounded to float; what is below 1e-13
  /// is exactly 0, as are those that vanish by accident.
  const AlignedVector<float>& values() const { return values_; }

  /// Calls visit(i, j, k, C) for all non-zero C with i ≥ j to this degree, k to twice; the places
  /// are those of the real harmonics, signs included.
  template <typename Visit>
  void for_each(const Visit& visit) const;

  /// Those of i ≤ j ≤ k, all to this degree, that are not 0: 7,042 to degree 9, 26,450 to 12.
  std::size_t unique_count() const;

  explicit ShTripling(int degree);

 private:
  template <typename Visit>
  static void visit_run(int l1, int m1, int l2, int m2, int m3, const float* values,
                        const Visit& visit);

  int degree_;
  AlignedVector<float> values_;
};

template <typename Visit>
void ShTripling::visit_run(int l1, int m1, int l2, int m2, int m3, const float* values,
                           const Visit& visit) {
  const Run l3 = run(l1, l2, m3);
  for (int signs = 0; signs < 8; ++signs) {
    const bool sine[3] = {(signs & 1) != 0, (signs & 2) != 0, (signs & 4) != 0};
    if ((sine[0] && m1 == 0) || (sine[1] && m2 == 0) || (sine[2] && m3 == 0)) continue;
    if (sine[0] != (sine[1] != sine[2])) continue;  // an odd number of sines
    const int first = sine[0] ? -m1 : m1, second = sine[1] ? -m2 : m2, third = sine[2] ? -m3 : m3;
    if (l1 == l2 && m1 == m2 && first < second) continue;  // the same pair the other way round
    const std::size_t i = sh::index(l1, first), j = sh::index(l2, second);
    const bool largest_sine = m1 == m2 + m3 ? sine[0] : m2 == m1 + m3 ? sine[1] : sine[2];
    const bool negative = (sine[0] || sine[1] || sine[2]) && !largest_sine;
    const float* value = values;
    for (int l = l3.first; l <= l3.last; l += 2, ++value) {
      if (*value == 0) continue;
      visit(i > j ? i : j, i > j ? j : i, sh::index(l, third), negative ? -*value : *value);
    }
  }
}

template <typename Visit>
void ShTripling::for_each(const Visit& visit) const {
  const float* at = values_.data();
  for (int l1 = 0; l1 <= degree_; ++l1) {
    for (int m1 = 0; m1 <= l1; ++m1) {
      for (int l2 = 0; l2 <= l1; ++l2) {
        for (int m2 = 0; m2 <= (l2 < l1 ? l2 : m1); ++m2) {
          const int less = m1 > m2 ? m1 - m2 : m2 - m1;
          visit_run(l1, m1, l2, m2, m1 + m2, at, visit);
          at += run(l1, l2, m1 + m2).count();
          if (less == m1 + m2) continue;
          visit_run(l1, m1, l2, m2, less, at, visit);
          at += run(l1, l2, less).count();
        }
      }
    }
  }
}

}  // namespace rimlight
