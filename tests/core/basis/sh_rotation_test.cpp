#include "core/basis/sh_rotation.h"

#include <gtest/gtest.h>

#include <cmath>
#include <iostream>
#include <limits>
#include <numbers>

#include "core/base/check.h"
#include "tests/core/basis/sh_cases.h"
#include "tests/support/allocation_count.h"
#include "tests/support/every_target.h"

namespace rimlight {
namespace {

constexpr double kPi = std::numbers::pi;

// Phases are within 32 · 3e-16, and J within some 1e-15 (the quadrature's weights), used twice:
// what sh_rotation.h promises.
constexpr double kDoubleBound = 1e-13;

/// Rotations by 180°, tiny angles, about the axes, at and near the polar axis, and random ones.
std::vector<Quaternion> telling_rotations() {
  std::vector<Quaternion> rotations = {{}, {0, 0, 0, -1}, {1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, 0}};
  for (const Vec3d& axis : {Vec3d(1, 0, 0), Vec3d(0, 1, 0), Vec3d(0, 0, 1), Vec3d(1, 1, 1),
                            Vec3d(1e-9, 0, 1), Vec3d(1, -1, 1e-9)}) {
    for (const double angle : {1e-300, 1e-17, 1e-9, 1e-4, 0.5, kPi / 2, kPi - 1e-9, kPi, 6.0}) {
      rotations.push_back(axis_angle(axis, angle));
    }
  }
  Random random(81);
  for (int i = 0; i < 30; ++i) rotations.push_back(random_rotation(random));
  return rotations;
}

std::vector<double> random_double_signal(int degree, Random& random) {
  std::vector<double> signal(sh::coefficient_count(degree));
  for (double& value : signal) value = random.uniform(-1, 1);
  return signal;
}

template <typename T>
std::vector<T> rotated_signal(const Quaternion& rotation, const std::vector<T>& signal) {
  std::vector<T> result(signal.size());
  sh::Rotation(rotation, sh::degree_of_count(signal.size())).apply(signal, result);
  return result;
}

template <typename T>
double largest_difference(const std::vector<T>& a, const std::vector<T>& b) {
  double worst = a.size() == b.size() ? 0 : std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < a.size(); ++i) {
    const double difference = std::abs(static_cast<double>(a[i]) - static_cast<double>(b[i]));
    if (!(difference <= worst)) worst = difference;
  }
  return worst;
}

TEST(ShRotation, ReconstructionOfTheRotatedIsTheRotatedReconstruction) {
  Random random(82);
  const auto directions = telling_directions(20);
  // The direction's own rounding moves a signal of 1,089 terms by 32 · √1089 · 2.3 · 2⁻⁵² = 5e-13,
  // and one of 4,225 by six times as much.
  for (const auto& [degree, bound] :
       {std::pair{sh::kLargestDegree, 2e-12}, {sh::kLargestLightDegree, 1.2e-11}}) {
    double worst = 0;
    const auto signal = random_double_signal(degree, random);
    for (const Quaternion& rotation : telling_rotations()) {
      const auto turned = rotated_signal(rotation, signal);
      for (const Vec3d& direction : directions) {
        const double truth = value_at(signal, rotated(conjugate(rotation), direction));
        const double error = std::abs(value_at(turned, direction) - truth);
        ASSERT_TRUE(std::isfinite(error));
        worst = std::max(worst, error);
      }
    }
    std::cout << "degree " << degree << ": worst error " << worst << "\n";
    EXPECT_LE(worst, bound);
  }
}

TEST(ShRotation, BandOneTurnsLikeAVector) {
  for (const Quaternion& rotation : telling_rotations()) {
    const Vec3d vector(0.3, -0.4, 0.9);
    const Vec3d truth = rotated(rotation, vector);
    const auto turned =
        rotated_signal(rotation, std::vector<double>{0.7, vector.y, vector.z, vector.x});
    EXPECT_NEAR(turned[0], 0.7, kDoubleBound);
    EXPECT_NEAR(turned[1], truth.y, kDoubleBound);
    EXPECT_NEAR(turned[2], truth.z, kDoubleBound);
    EXPECT_NEAR(turned[3], truth.x, kDoubleBound);
  }
}

TEST(ShRotation, TurningTwiceEqualsTurningByTheProduct) {
  Random random(83);
  const auto rotations = telling_rotations();
  double worst = 0;
  for (std::size_t i = 0; i < rotations.size(); ++i) {
    const Quaternion& a = rotations[i];
    const Quaternion& b = rotations[(7 * i + 3) % rotations.size()];
    const auto signal = random_double_signal(sh::kLargestDegree, random);
    worst = std::max(worst, largest_difference(rotated_signal(a, rotated_signal(b, signal)),
                                               rotated_signal(a * b, signal)));
  }
  std::cout << "worst difference " << worst << "\n";
  EXPECT_LE(worst, 3 * kDoubleBound);
}

TEST(ShRotation, MatricesAreOrthogonalAndTheInversesAreTheirTransposes) {
  double worst = 0, worst_inverse = 0;
  for (const Quaternion& rotation : telling_rotations()) {
    const sh::Rotation there(rotation, 20), back(conjugate(rotation), 20);
    for (const int l : {0, 1, 2, 7, 20}) {
      const auto side = static_cast<std::size_t>(2 * l + 1);
      const auto matrix = there.matrix(l), inverse = back.matrix(l);
      ASSERT_EQ(matrix.size(), side * side);
      for (std::size_t i = 0; i < side; ++i) {
        for (std::size_t j = 0; j < side; ++j) {
          double sum = i == j ? -1 : 0;
          for (std::size_t k = 0; k < side; ++k) sum += matrix[i * side + k] * matrix[j * side + k];
          worst = std::max(worst, std::abs(sum));
          worst_inverse =
              std::max(worst_inverse, std::abs(matrix[i * side + j] - inverse[j * side + i]));
        }
      }
    }
  }
  std::cout << "worst of M·Mᵀ − 1 " << worst << ", of M⁻¹ − Mᵀ " << worst_inverse << "\n";
  EXPECT_LE(worst, kDoubleBound);
  EXPECT_LE(worst_inverse, kDoubleBound);
}

TEST(ShRotation, TheIdentityChangesNoBit) {
  Random random(84);
  auto signal = random_signal(sh::kLargestDegree, random);
  for (std::size_t i = 0; i < signal.size(); i += 3) signal[i] *= 1e-25f;  // beside large ones
  EXPECT_EQ(rotated_signal({}, signal), signal);
  EXPECT_EQ(rotated_signal({0, 0, 0, -3}, signal), signal) << "of any length and sign";
}

TEST(ShRotation, AboutThePolarAxisZonalCoefficientsKeepTheirBits) {
  Random random(85);
  const auto signal = random_signal(sh::kLargestDegree, random);
  const auto turned = rotated_signal(axis_angle({0, 0, 1}, 1.234), signal);
  for (int l = 0; l <= sh::kLargestDegree; ++l) {
    EXPECT_EQ(turned[sh::index(l, 0)], signal[sh::index(l, 0)]);
  }
  // Half a turn changes the sign of odd m and nothing else.
  const auto half = rotated_signal({0, 0, 1, 0}, signal);
  for (int l = 0; l <= sh::kLargestDegree; ++l) {
    for (int m = -l; m <= l; ++m) {
      const float value = signal[sh::index(l, m)];
      EXPECT_EQ(half[sh::index(l, m)], m % 2 == 0 ? value : -value);
    }
  }
}

TEST(ShRotation, HalfTurnsAboutTheOtherAxesFlipSigns) {
  // About x: (y, z) → (−y, −z). m ≥ 0 is even in y, and the sign of z is (−1)^(l + m).
  Random random(86);
  const auto signal = random_signal(sh::kLargestDegree, random);
  const auto turned = rotated_signal({1, 0, 0, 0}, signal);
  for (int l = 0; l <= sh::kLargestDegree; ++l) {
    for (int m = -l; m <= l; ++m) {
      const double sign = ((l + m) % 2 == 0) == (m >= 0) ? 1 : -1;
      EXPECT_NEAR(turned[sh::index(l, m)], sign * static_cast<double>(signal[sh::index(l, m)]),
                  1e-7);
    }
  }
}

TEST(ShRotation, EveryBandKeepsItsEnergyToARounding) {
  Random random(87);
  const auto signal = random_signal(sh::kLargestDegree, random);
  const auto energies = sh::band_energies(signal);
  for (const Quaternion& rotation : telling_rotations()) {
    const auto kept = sh::band_energies(rotated_signal(rotation, signal));
    for (std::size_t l = 0; l < energies.size(); ++l) {
      EXPECT_NEAR(kept[l], energies[l], 2 * 6e-8 * energies[l]) << l;
    }
  }
}

TEST(ShRotation, TinyAnglesMoveByTheirSize) {
  Random random(88);
  const auto signal = random_double_signal(10, random);
  for (const double angle : {1e-300, 1e-17, 1e-12, 1e-6}) {
    for (const Vec3d& axis : {Vec3d(1, 0, 0), Vec3d(0, 1, 0), Vec3d(0, 0, 1)}) {
      // Of a band's vector of norm < √(2l + 1): at most l times the angle.
      const double moved =
          largest_difference(rotated_signal(axis_angle(axis, angle), signal), signal);
      EXPECT_LE(moved, 10 * std::sqrt(21) * angle + kDoubleBound);
    }
  }
}

TEST(ShRotation, FloatsAreTheRoundedDoublesOnEveryTargetAlsoInPlace) {
  Random random(89);
  for (const int degree : {0, 1, 2, 3, 7, 8, 14, 15, 16, 17, 20, 31, 32, 33, 63, 64}) {
    for (const std::size_t signals : {0u, 1u, 3u, 5u}) {
      const std::size_t count = sh::coefficient_count(degree);
      std::vector<float> all;
      while (all.size() < signals * count) {
        const auto one = random_signal(degree, random);
        all.insert(all.end(), one.begin(), one.end());
      }
      const sh::Rotation rotation(random_rotation(random), degree);
      const std::vector<double> wide(all.begin(), all.end());
      std::vector<double> truth(all.size());
      for (std::size_t s = 0; s < signals; ++s) {
        rotation.apply(std::span(wide).subspan(s * count, count),
                       std::span(truth).subspan(s * count, count));
      }
      test::for_every_target([&] {
        std::vector<float> turned(all.size()), in_place = all;
        rotation.apply(all, turned);
        rotation.apply(in_place, in_place);
        EXPECT_EQ(in_place, turned);
        for (std::size_t i = 0; i < all.size(); ++i) {
          ASSERT_NEAR(turned[i], truth[i], 6e-8 * std::abs(truth[i]) + kDoubleBound);
        }
      });
    }
  }
}

TEST(ShRotation, AllocatesNothingOnceWarm) {
  if (!test::kCountsAllocations) GTEST_SKIP() << "ThreadSanitizer has an operator new of its own";
  Random random(90);
  std::vector<float> light = random_signal(20, random);
  const std::size_t cold = test::allocation_count();
  std::vector<float> turned(light.size());
  EXPECT_GT(test::allocation_count(), cold) << "the count is alive";
  sh::Rotation(random_rotation(random), 20).apply(light, turned);
  const std::size_t warm = test::allocation_count();
  for (int i = 0; i < 20; ++i) sh::Rotation(random_rotation(random), 20).apply(light, turned);
  EXPECT_EQ(test::allocation_count(), warm);
}

TEST(ShRotation, RefusesWhatIsNoRotationOrHasAnotherShape) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THROW(sh::Rotation({0, 0, 0, 0}, 3), CheckFailure);
  EXPECT_THROW(sh::Rotation({0, nan, 0, 1}, 3), CheckFailure);
  EXPECT_THROW(sh::Rotation({}, -1), CheckFailure);
  EXPECT_THROW(sh::Rotation({}, sh::kLargestLightDegree + 1), CheckFailure);
  const sh::Rotation rotation({}, 2);
  std::vector<float> nine(9), ten(10);
  EXPECT_THROW(rotation.apply(ten, ten), CheckFailure);
  EXPECT_THROW(rotation.apply(nine, ten), CheckFailure);
  EXPECT_THROW(static_cast<void>(rotation.matrix(3)), CheckFailure);
}

}  // namespace
}  // namespace rimlight
