// Turns of light: composed very often, by half a turn, by almost nothing, by quaternions that are
// not unit.
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <string>

#include "core/base/error.h"
#include "core/basis/sh.h"
#include "core/basis/sh_rotation.h"
#include "core/light/light_rotation.h"
#include "core/relight/design_state.h"
#include "core/report/stability/cases.h"

namespace rimlight::stability {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr int kSize = 16;

std::size_t turn_count(const StabilityTrial& trial) {
  return trial.fast ? std::max<std::size_t>(1, trial.turns / 100) : trial.turns;
}

/// A light that nowhere exceeds 16 times its mean, so that every texel is turned by overlap alone.
CubeLight soft_light(std::uint64_t seed) {
  CubeLight light(kSize);
  Random random(seed);
  for (float& value : light.values) value = random.uniform_float();
  return light;
}

/// Σ |a − b| over Σ |b|.
double relative_l1(const CubeLight& a, const CubeLight& b) {
  double difference = 0, size = 0;
  for (std::size_t i = 0; i < a.values.size(); ++i) {
    difference += std::abs(double{a.values[i]} - double{b.values[i]});
    size += std::abs(double{b.values[i]});
  }
  return difference / size;
}

/// Many small turns one after another, as a drag makes them, and the one that they add up to.
struct ComposedTurn {
  Quaternion composed, direct;
};

ComposedTurn compose(std::size_t count, const StabilityTrial& trial) {
  const Vec3d axis = normalized(Vec3d(1, -2, 0.5));
  constexpr double kStep = 0.0123;
  const Quaternion step = axis_angle(axis, kStep);
  ComposedTurn turn;
  for (std::size_t i = 0; i < count; ++i) turn.composed = normalized(step * turn.composed);
  const double steps = static_cast<double>(count) + trial.either(0.0, 1e-3);
  turn.direct = axis_angle(axis, std::fmod(kStep * steps, 4 * kPi));
  return turn;
}

/// The angle between two rotations.
double angle_between(const Quaternion& a, const Quaternion& b) {
  const Quaternion q = a * conjugate(b);
  return 2 * std::atan2(std::hypot(q.x, q.y, q.z), std::abs(q.w));
}

StabilityMeasure composed_turns(const StabilityTrial& trial) {
  const std::size_t count = turn_count(trial);
  const ComposedTurn turn = compose(count, trial);
  const double error = angle_between(turn.composed, turn.direct);
  return {std::max(error, std::abs(norm(turn.composed) - 1)), std::to_string(count) + " turns"};
}

StabilityMeasure composed_turns_of_texels(const StabilityTrial& trial) {
  const std::size_t count = turn_count(trial);
  const ComposedTurn turn = compose(count, trial);
  LightRotator rotator(soft_light(1));
  CubeLight composed, direct;
  rotator.rotate(turn.composed, composed);
  rotator.rotate(turn.direct, direct);
  return {relative_l1(composed, direct), std::to_string(count) + " turns"};
}

std::vector<double> random_coefficients(int degree, std::uint64_t seed) {
  std::vector<double> values(sh::coefficient_count(degree));
  Random random(seed);
  for (double& value : values) value = random.uniform(-1, 1);
  return values;
}

/// ‖a − b‖ over ‖b‖.
double relative_norm(const std::vector<double>& a, const std::vector<double>& b) {
  double difference = 0, size = 0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    difference += (a[i] - b[i]) * (a[i] - b[i]);
    size += b[i] * b[i];
  }
  return std::sqrt(difference / size);
}

StabilityMeasure composed_turns_of_harmonics(const StabilityTrial& trial) {
  constexpr int kDegree = 6;
  const std::size_t count = turn_count(trial);
  const Vec3d axis = normalized(Vec3d(1, -2, 0.5));
  constexpr double kStep = 0.0123;
  const sh::Rotation step(axis_angle(axis, kStep), kDegree);
  const std::vector<double> source = random_coefficients(kDegree, 2);
  std::vector<double> turned = source, direct(source.size());
  for (std::size_t i = 0; i < count; ++i) step.apply(turned, turned);
  const double angle =
      std::fmod(kStep * (static_cast<double>(count) + trial.either(0.0, 0.01)), 4 * kPi);
  sh::Rotation(axis_angle(axis, angle), kDegree).apply(source, direct);
  return {relative_norm(turned, direct), std::to_string(count) + " turns"};
}

/// Half a turn about an axis of the cube takes texels to texels.
StabilityMeasure half_turn_of_texels(const StabilityTrial& trial) {
  LightRotator rotator(soft_light(3));
  double worst = 0;
  for (const Vec3d& axis : {Vec3d(1, 0, 0), Vec3d(0, 1, 0), Vec3d(0, 0, 1)}) {
    CubeLight turned, expected(kSize);
    rotator.rotate(axis_angle(axis, kPi * trial.either(1.0, 1.01)), turned);
    for (std::size_t t = 0; t < turned.count(); ++t) {
      const Vec3d d = cube::texel_direction(t, kSize);
      const std::size_t from = cube::texel_of(axis * (2 * dot(axis, d)) - d, kSize);
      for (int c = 0; c < 3; ++c) expected.channel(c)[t] = rotator.source().channel(c)[from];
    }
    worst = std::max(worst, relative_l1(turned, expected));
  }
  return {worst};
}

/// Y_lm(−x, −y, z) = (−1)^m Y_lm; about y, (−1)^l for cosines and (−1)^(l+1) for sines; about x,
/// (−1)^(l+m) and (−1)^(l+m+1).
StabilityMeasure half_turn_of_harmonics(const StabilityTrial& trial) {
  constexpr int kDegree = sh::kLargestLightDegree;
  const std::vector<double> source = random_coefficients(kDegree, 4);
  std::vector<double> turned(source.size()), expected(source.size());
  double worst = 0;
  for (int axis = 0; axis < 3; ++axis) {
    Vec3d about;
    about[axis] = 1;
    sh::Rotation(axis_angle(about, kPi * trial.either(1.0, 1 + 1e-9)), kDegree)
        .apply(source, turned);
    for (int l = 0; l <= kDegree; ++l) {
      for (int m = -l; m <= l; ++m) {
        const int sine = m < 0 ? 1 : 0;
        const int flips = axis == 2 ? m : axis == 1 ? l + sine : l + m + sine;
        expected[sh::index(l, m)] = (flips % 2 == 0 ? 1 : -1) * source[sh::index(l, m)];
      }
    }
    worst = std::max(worst, relative_norm(turned, expected));
  }
  return {worst};
}

/// What a turn by a tiny angle moves, over the most that it may: each texel's border sweeps over at
/// most angle · border / area of its light, which goes and comes; and rounding to floats.
StabilityMeasure tiny_turn_of_texels(const StabilityTrial& trial) {
  LightRotator rotator(soft_light(5));
  double worst = 0;
  for (const double angle : {1e-12, 1e-9, 1e-7, 1e-5, 1e-3}) {
    CubeLight turned;
    rotator.rotate(axis_angle({1, 2, 3}, angle + trial.either(0.0, 0.01)), turned);
    constexpr double kBorderOverArea = 4.6 * kSize;  // of the texels at a face's corner
    constexpr double kRounding = 1e-5;  // corners in floats: 2⁻²⁴ of a face's side
    const double most = 2 * kBorderOverArea * angle + kRounding;
    worst = std::max(worst, relative_l1(turned, rotator.source()) / most);
  }
  return {worst};
}

/// A turn by a tiny angle moves a band by no more than the angle times its degree, and back again.
StabilityMeasure tiny_turn_of_harmonics(const StabilityTrial& trial) {
  constexpr int kDegree = sh::kLargestDegree;
  const std::vector<double> source = random_coefficients(kDegree, 6);
  double worst = 0;
  for (const Vec3d& axis : {Vec3d(0, 0, 1), Vec3d(1, 2, 3)}) {
    for (const double angle : {1e-15, 1e-12, 1e-9}) {
      std::vector<double> turned(source.size()), back(source.size());
      sh::Rotation(axis_angle(axis, angle), kDegree).apply(source, turned);
      sh::Rotation(axis_angle(axis, -angle * trial.either(1.0, -1e3)), kDegree).apply(turned, back);
      worst = std::max(
          {worst, relative_norm(back, source), relative_norm(turned, source) - kDegree * angle});
    }
  }
  return {worst};
}

/// How many turns that are none are taken for one.
StabilityMeasure refused_quaternions(const StabilityTrial& trial) {
  constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  std::vector<Quaternion> wrong = {{0, 0, 0, 0},         {0, 0, 0, 1.01},  {0, 0, 0, 0.99},
                                   {1, 1, 1, 1},         {kNaN, 0, 0, 1},  {0, kInfinity, 0, 1},
                                   {0, 0, 1e308, 1e308}, {1e-200, 0, 0, 0}};
  if (trial.broken) wrong.push_back({0, 0, 0, 1});
  int taken = 0;
  for (const Quaternion& q : wrong) {
    try {
      static_cast<void>(checked_rotation({.environment = "sky", .rotation = q}));
      ++taken;
    } catch (const Error&) {
    }
  }
  return {static_cast<double>(taken)};
}

/// Quaternions that are unit but for rounding on their way through JSON: made unit, and the light
/// turned by them keeps its energy.
StabilityMeasure nearly_unit_quaternions(const StabilityTrial& trial) {
  LightRotator rotator(soft_light(7));
  const double energy = integral(rotator.source()).x;
  Random random(8);
  double worst = 0;
  for (int i = 0; i < (trial.fast ? 5 : 50); ++i) {
    Quaternion q = random_rotation(random);
    const double scale = 1 + random.uniform(-9e-4, 9e-4);
    q = {q.x * scale, q.y * scale, q.z * scale, q.w * scale};
    const Quaternion unit = checked_rotation({.environment = "sky", .rotation = q});
    CubeLight turned;
    rotator.rotate(unit, turned);
    const double kept = integral(turned).x * trial.either(1.0, scale * scale * 1.01);
    worst = std::max({worst, std::abs(norm(unit) - 1), std::abs(kept / energy - 1)});
  }
  return {worst};
}

/// Rotations of harmonics take quaternions of any length.
StabilityMeasure long_and_short_quaternions(const StabilityTrial& trial) {
  constexpr int kDegree = 20;
  const std::vector<double> source = random_coefficients(kDegree, 9);
  std::vector<double> turned(source.size()), expected(source.size());
  const Quaternion q = axis_angle({3, 1, 2}, 2);
  sh::Rotation(q, kDegree).apply(source, expected);
  double worst = 0;
  for (const double scale : {1e-150, 1e-20, 0.5, 3.0, 1e20, 1e150}) {
    const double off = trial.either(1.0, 1 + 1e-9);
    sh::Rotation({q.x * scale * off, q.y * scale, q.z * scale, q.w * scale}, kDegree)
        .apply(source, turned);
    worst = std::max(worst, relative_norm(turned, expected));
  }
  return {worst};
}

}  // namespace

std::vector<StabilityCase> rotation_cases() {
  using enum BoundKind;
  const std::string part = "rotation";
  const std::string promise = "what sh::Rotation promises: 1e-13 of a band's norm a turn";
  return {
      {"composed-turns", part, "radians between 10⁶ composed turns and the one they add up to",
       at_most, 1e6 * 4 * 0x1p-53, "each product rounds by at most 4 · 2⁻⁵³", composed_turns},
      {"composed-turns-of-texels", part, "relative L1 between the light under both", at_most, 1e-5,
       "corners of texels in floats: the turn comes from the source, so nothing adds up",
       composed_turns_of_texels},
      {"composed-turns-of-harmonics", part,
       "relative L2 of coefficients that were turned 10⁶ times", at_most, 1e6 * 1e-13, promise,
       composed_turns_of_harmonics},
      {"half-turn-of-texels", part, "relative L1 against the texels that half a turn exchanges",
       at_most, 1e-5, "corners of texels in floats: 2⁻²⁴ of a face's side, over texels of 1/16",
       half_turn_of_texels},
      {"half-turn-of-harmonics", part, "relative L2 against signs of coefficients, degree 64",
       at_most, 2e-13, promise + "; the angle itself is rounded", half_turn_of_harmonics},
      {"tiny-turn-of-texels", part, "share of the L1 change that angles from 1e-12 to 1e-3 allow",
       at_most, 1, "the border of a texel sweeps over angle · border / area of it",
       tiny_turn_of_texels},
      {"tiny-turn-of-harmonics", part, "relative L2 after a turn by 1e-15 … 1e-9 and back", at_most,
       2e-13, promise, tiny_turn_of_harmonics},
      {"quaternions-refused", part, "quaternions that are no rotation and were taken for one",
       at_most, 0, "a session's rotation is unit to 10⁻³, or refused", refused_quaternions},
      {"quaternions-nearly-unit", part, "relative error of ∫L dω, and of the norm", at_most, 1e-3,
       "what rotation promises of a quaternion that was made unit", nearly_unit_quaternions},
      {"quaternions-of-any-length", part,
       "relative L2 between turns by quaternions of lengths 1e-150 … 1e150", at_most, 1e-13,
       promise, long_and_short_quaternions},
  };
}

}  // namespace rimlight::stability
