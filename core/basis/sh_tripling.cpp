#include "core/basis/sh_tripling.h"

#include <array>
#include <cmath>
#include <memory>
#include <mutex>
#include <numbers>
#include <vector>

#include "core/base/check.h"
#include "core/basis/sh_latitudes.h"

namespace rimlight {
namespace {

/// What vanishes by accident comes out at some 1e-16, and the least of the others is 8e-8 to degree
/// 12. At degree 32 some fall below this too, where no sum in float could tell.
constexpr double kVanishing = 1e-13;

/// ∫ P(l₁, m₁) P(l₂, m₂) P(l₃, m₃) dz, azimuth and normalization included, along runs.
/// Gauss–Legendre points to degree l₁ + l₂ + l₃ make it exact but for rounding.
class RunIntegrals {
 public:
  explicit RunIntegrals(int degree) : latitudes_(2 * degree, 4 * degree) {
    pair_.resize(latitudes_.count());
  }

  void set_pair(int l1, int m1, int l2, int m2) {
    const double* const first = latitudes_.values(l1, m1);
    const double* const second = latitudes_.values(l2, m2);
    // The integrand is even in z: twice the northern half.
    for (std::size_t i = 0; i < pair_.size(); ++i) {
      pair_[i] = 2 * latitudes_.weights()[i] * first[i] * second[i];
    }
    neither_zonal_ = m1 != 0 && m2 != 0;
  }

  float value(int l3, int m3) const {
    const double* const third = latitudes_.values(l3, m3);
    double sum = 0;
    for (std::size_t i = 0; i < pair_.size(); ++i) sum += pair_[i] * third[i];
    // Over φ, cos² with its two factors √2 gives 2π; three cosines with three give 2π / √2.
    sum *= 2 * std::numbers::pi / (neither_zonal_ && m3 != 0 ? std::numbers::sqrt2 : 1);
    return std::abs(sum) < kVanishing ? 0.0f : static_cast<float>(sum);
  }

 private:
  ShLatitudes latitudes_;
  std::vector<double> pair_;
  bool neither_zonal_ = false;
};

}  // namespace

ShTripling::ShTripling(int degree) : degree_(degree) {
  RunIntegrals integrals(degree);
  const auto add_run = [&](const Run& l3, int m3) {
    for (int l = l3.first; l <= l3.last; l += 2) values_.push_back(integrals.value(l, m3));
  };
  for (int l1 = 0; l1 <= degree; ++l1) {
    for (int m1 = 0; m1 <= l1; ++m1) {
      for (int l2 = 0; l2 <= l1; ++l2) {
        for (int m2 = 0; m2 <= (l2 < l1 ? l2 : m1); ++m2) {
          integrals.set_pair(l1, m1, l2, m2);
          add_run(run(l1, l2, m1 + m2), m1 + m2);
          const int less = std::abs(m1 - m2);
          if (less != m1 + m2) add_run(run(l1, l2, less), less);
        }
      }
    }
  }
}

const ShTripling& ShTripling::to_degree(int degree) {
  RIMLIGHT_CHECK(degree >= 0 && degree <= sh::kLargestDegree);
  static std::array<std::once_flag, sh::kLargestDegree + 1> made;
  static std::array<std::unique_ptr<const ShTripling>, sh::kLargestDegree + 1> tables;
  const auto i = static_cast<std::size_t>(degree);
  std::call_once(made[i], [&] { tables[i] = std::make_unique<const ShTripling>(degree); });
  return *tables[i];
}

std::size_t ShTripling::unique_count() const {
  std::size_t count = 0;
  const std::size_t end = sh::coefficient_count(degree_);
  for_each([&](std::size_t, std::size_t j, std::size_t k, float) {
    count += k <= j && k < end;  // i ≥ j ≥ k: each multiset once
  });
  return count;
}

}  // namespace rimlight
