#pragma once

#include <cstddef>
#include <vector>

namespace rimlight {

/// The latitude part of spherical harmonics at the northern half of Gauss–Legendre points, in
/// double: what products and their integrals are exact on.
///
///     P(l, m) with Y(l, ±m) = P(l, m)(z) · {cos mφ, sin mφ} · (m = 0 ? 1 : √2), all P(m, m) ≥ 0
///
/// P(l, m)(−z) = (−1)^(l−m) P(l, m)(z), so the southern half needs no numbers of its own.
class ShLatitudes {
 public:
  /// Degrees to `degree`; integrals over z are exact for polynomials to `exact_degree`. Both ≥ 0,
  /// else CheckFailure.
  ShLatitudes(int degree, int exact_degree);

  /// Latitudes with z > 0; as many again lie in the south.
  std::size_t count() const { return weights_.size(); }
  /// ∫ f dz = Σ weight · (f(z) + f(−z)); they sum to 1.
  const std::vector<double>& weights() const { return weights_; }
  /// P(l, m) at all latitudes, [count()]; 0 ≤ m ≤ l ≤ degree.
  const double* values(int l, int m) const {
    return values_.data() + static_cast<std::size_t>(l * (l + 1) / 2 + m) * count();
  }

 private:
  void fill(int degree, const std::vector<double>& z);
  double* row(int l, int m) {
    return values_.data() + static_cast<std::size_t>(l * (l + 1) / 2 + m) * count();
  }

  std::vector<double> weights_;
  std::vector<double> values_;  // [l (l + 1) / 2 + m][count]
};

}  // namespace rimlight
