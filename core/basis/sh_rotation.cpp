#include "core/basis/sh_rotation.h"

#include <cmath>
#include <complex>

#include "core/base/check.h"

namespace rimlight::sh {
namespace {

using Complex = std::complex<double>;

/// Powers of the unit number e^iθ. Each product rounds once or twice, so the last is within
/// 64 · 3e-16.
AxialTurn axial_turn(const Complex& angle, int degree) {
  AxialTurn turn;
  double cosine = 1, sine = 0;
  for (int m = 0; m <= degree; ++m) {
    turn.cosine[m & 1][AxialTurn::slot(m)] = cosine;
    turn.sine[m & 1][AxialTurn::slot(m)] = sine;
    const double turned = cosine * angle.real() - sine * angle.imag();
    sine = cosine * angle.imag() + sine * angle.real();
    cosine = turned;
  }
  return turn;
}

/// e^iα, e^iβ, e^iγ of R = Z(α) Y(β) Z(γ), without any trigonometry: for the quaternion,
///   w + iz = cos β/2 · e^i(α + γ)/2,   y − ix = sin β/2 · e^i(α − γ)/2.
struct EulerAngles {
  Complex alpha, beta, gamma;
};

EulerAngles euler_angles(const Quaternion& q) {
  const double along = std::hypot(q.w, q.z), across = std::hypot(q.y, q.x);
  // Where β is 0 or π only the sum or the difference of α and γ is told: γ is 0.
  const Complex sum = along > 0 ? Complex(q.w, q.z) / along : Complex(q.y, -q.x) / across;
  const Complex difference = across > 0 ? Complex(q.y, -q.x) / across : sum;
  return {sum * difference,
          {(along - across) * (along + across), 2 * along * across},
          sum * std::conj(difference)};
}

}  // namespace

Rotation::Rotation(const Quaternion& rotation, int degree) {
  check_degree(degree);
  const double length = norm(rotation);
  RIMLIGHT_CHECK(std::isfinite(length));
  RIMLIGHT_CHECK(length > 0);
  const Quaternion unit = normalized(rotation);
  const EulerAngles angles = euler_angles(unit);
  turns_.degree = degree;
  turns_.only_last = unit.x == 0 && unit.y == 0;
  turns_.last = axial_turn(angles.alpha, degree);
  if (turns_.only_last) return;
  turns_.middle = axial_turn(std::conj(angles.beta), degree);
  turns_.first = axial_turn(angles.gamma, degree);
}

void Rotation::apply(std::span<const float> signals, std::span<float> rotated) const {
  RIMLIGHT_CHECK_EQ(rotated.size(), signals.size());
  RIMLIGHT_CHECK_EQ(signals.size() % coefficient_count(degree()), std::size_t{0});
  rotate(turns_, signals.data(), rotated.data(), signals.size() / coefficient_count(degree()));
}

void Rotation::apply(std::span<const double> signals, std::span<double> rotated) const {
  RIMLIGHT_CHECK_EQ(rotated.size(), signals.size());
  RIMLIGHT_CHECK_EQ(signals.size() % coefficient_count(degree()), std::size_t{0});
  rotate(turns_, signals.data(), rotated.data(), signals.size() / coefficient_count(degree()));
}

std::vector<double> Rotation::matrix(int l) const {
  RIMLIGHT_CHECK(l >= 0);
  RIMLIGHT_CHECK(l <= degree());
  const auto side = static_cast<std::size_t>(2 * l + 1);
  std::vector<double> result(side * side), signal(coefficient_count(degree()));
  for (std::size_t column = 0; column < side; ++column) {
    signal.assign(signal.size(), 0.0);
    signal[index(l, -l) + column] = 1;
    apply(signal, signal);
    for (std::size_t row = 0; row < side; ++row) {
      result[row * side + column] = signal[index(l, -l) + row];
    }
  }
  return result;
}

}  // namespace rimlight::sh
