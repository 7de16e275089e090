#pragma once

#include <span>
#include <vector>

#include "core/basis/sh_rotation_kernel.h"
#include "core/math/rotation.h"

namespace rimlight::sh {

/// A rotation R of functions on the sphere, (R f)(ω) = f(R⁻¹ ω), on their coefficients: exact, as
/// each band turns into itself. R = Z(α) Y(β) Z(γ) in Euler angles about z and y, and Y(β) = J
/// Z(−β) J with J the exchange of the axes y and z, whose matrices are fixed (the factors of
/// Pinchon and Hoggan 2007; the matrices are ours, by quadrature). Z mixes m with −m only, and J is
/// three quarters zeros, so a signal costs (n + 1)³/3 products twice, and no matrix is built. All
/// of it in double:
///
///   a rotation of doubles is within 1e-13 of the truth, relative to the band's norm; one of floats
///   is rounded once more, to float
///   about z (the identity too) only Z(α) is applied: then zonal bands stay as they are bit for
///   bit, and the identity changes nothing
///
/// Made in a fraction of a microsecond; the first one computes the matrices J (some milliseconds).
/// Any thread; allocates nothing after the first.
class Rotation {
 public:
  /// Rotates bands up to `degree`. CheckFailure for a degree out of range, or a quaternion (of any
  /// length) that is zero or not finite.
  Rotation(const Quaternion& rotation, int degree);

  int degree() const { return turns_.degree; }

  /// signals, rotated: [signal][(degree + 1)²], of one size, a multiple of the coefficients' count,
  /// else CheckFailure. They may be the same memory, but not overlap otherwise.
  void apply(std::span<const float> signals, std::span<float> rotated) const;
  void apply(std::span<const double> signals, std::span<double> rotated) const;

  /// The orthogonal matrix of one band, l ≤ degree(): rotated = matrix · coefficients, [2l + 1][2l
  /// + 1] row-major, row and column m = −l … l.
  std::vector<double> matrix(int l) const;

 private:
  RotationTurns turns_;
};

}  // namespace rimlight::sh
