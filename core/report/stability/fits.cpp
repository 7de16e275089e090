// Least squares near and below full rank: harmonics from directions, BRDFs from few samples.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <functional>
#include <numbers>
#include <string>
#include <utility>

#include "core/base/error.h"
#include "core/basis/sh.h"
#include "core/basis/sh_projection.h"
#include "core/material/factorization.h"
#include "core/math/random.h"
#include "core/math/sampling.h"
#include "core/report/stability/cases.h"

namespace rimlight::stability {
namespace {

std::string rounded(double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%.2g", value);
  return text;
}

/// Directions evenly over a cap about +z.
std::vector<Vec3d> cap_directions(double angle, int count) {
  std::vector<Vec3d> directions;
  for (int i = 0; i < count; ++i) {
    const Sample2 at = r2_point({}, i);
    const double z = 1 - at.u * (1 - std::cos(angle)), r = std::sqrt(std::max(0.0, 1 - z * z));
    const double azimuth = 2 * std::numbers::pi * at.v;
    directions.push_back({r * std::cos(azimuth), r * std::sin(azimuth), z});
  }
  return directions;
}

/// The error of coefficients fitted to values on a cap, over what rounding of the values to floats
/// may do to them: condition · 2⁻²⁴ of their norm, and as much of their own rounding.
StabilityMeasure nearly_singular(const StabilityTrial& trial) {
  constexpr int kDegree = 4;
  Random random(1);
  std::vector<double> truth(sh::coefficient_count(kDegree));
  for (double& value : truth) value = random.uniform(-1, 1);
  double worst = 0;
  std::string note = "condition numbers:";
  for (const double degrees : {180.0, 90.0, 45.0, 20.0, 10.0}) {
    const auto directions = cap_directions(degrees * std::numbers::pi / 180, 500);
    std::vector<float> values;
    for (const Vec3d& direction : directions) {
      const auto basis = sh::evaluate(direction, kDegree);
      double value = trial.either(0.0, 1e-4 * random.uniform(-1, 1));
      for (std::size_t i = 0; i < basis.size(); ++i) value += basis[i] * truth[i];
      values.push_back(static_cast<float>(value));
    }
    const sh::Fit fit = sh::fit(directions, values, kDegree);
    double difference = 0, size = 0;
    for (std::size_t i = 0; i < truth.size(); ++i) {
      difference += std::pow(double{fit.coefficients[i]} - truth[i], 2);
      size += truth[i] * truth[i];
    }
    worst = std::max(worst, std::sqrt(difference / size) / ((fit.condition + 1) * 0x1p-24));
    note += " " + rounded(fit.condition);
  }
  return {worst, note};
}

/// How many sets of directions that do not tell all coefficients apart were fitted.
StabilityMeasure below_full_rank(const StabilityTrial& trial) {
  constexpr int kDegree = 3;
  std::vector<std::vector<Vec3d>> sets(4);
  for (int i = 0; i < 100; ++i) {
    const double angle = 0.1 * i;
    sets[0].push_back({std::cos(angle), std::sin(angle), 0});                  // a great circle
    sets[1].push_back({0, 0, 1});                                              // one direction
    sets[2].push_back(i % 2 == 0 ? Vec3d(1, 2, 3) : Vec3d(-1, -2, -3) * 1e5);  // two
  }
  sets[3] = cap_directions(std::numbers::pi, 15);  // one less than coefficients
  if (trial.broken) sets.push_back(cap_directions(std::numbers::pi, 100));
  int taken = 0;
  for (const auto& directions : sets) {
    try {
      static_cast<void>(sh::fit(directions, std::vector<float>(directions.size(), 1), kDegree));
      ++taken;
    } catch (const Error&) {
    }
  }
  return {static_cast<double>(taken)};
}

/// A BRDF from a formula, with samples where it has any.
class FormulaBrdf final : public MeasuredBrdf {
 public:
  using Formula = std::function<std::optional<Vec3d>(const HalfDifference&, const DirectionPair&)>;
  explicit FormulaBrdf(Formula formula) : formula_(std::move(formula)) {}

 private:
  std::optional<Vec3d> value(const HalfDifference& angles,
                             const DirectionPair& pair) const override {
    return formula_(angles, pair);
  }

  Formula formula_;
};

/// A product of factors, which the fit has the form of.
Vec3d product_value(const HalfDifference& angles, const DirectionPair& pair) {
  const double lobe = std::exp(-20 * angles.half * angles.half);
  const double edge = 0.1 + std::pow(1 - std::cos(angles.difference), 5);
  return Vec3d(1, 0.5, 0.25) * (lobe * edge * pair.in.z * pair.out.z + 1e-3);
}

std::string describe(const FactoredBrdf& fit) {
  return "condition " + rounded(fit.condition) + ", samples at " + rounded(fit.valid_share) +
         " of the angles";
}

/// The error of logarithms, the largest of the channels.
double logarithmic_error(const FactoredBrdf& fit) { return max_component(fit.error.logarithmic); }

/// Clusters of samples that say nothing of most bins: near the mirror direction alone.
StabilityMeasure few_samples(const StabilityTrial& trial) {
  Random random(2);
  const FormulaBrdf brdf(
      [&](const HalfDifference& angles, const DirectionPair& pair) -> std::optional<Vec3d> {
        if (angles.half > 0.1 || angles.difference > 0.3) return std::nullopt;
        return product_value(angles, pair) * trial.either(1.0, random.uniform(0.5, 2));
      });
  const FactoredBrdf fit = factorize(brdf, "few samples");
  return {logarithmic_error(fit), describe(fit)};
}

/// One cell of angles has samples.
StabilityMeasure one_cluster(const StabilityTrial& trial) {
  Random random(3);
  const FormulaBrdf brdf(
      [&](const HalfDifference& angles, const DirectionPair&) -> std::optional<Vec3d> {
        if (angles.half < 0.2 || angles.half > 0.205) return std::nullopt;
        return Vec3d(2, 3, 4) * trial.either(1.0, random.uniform(0.5, 2));
      });
  const FactoredBrdf fit = factorize(brdf, "one cluster");
  return {logarithmic_error(fit), describe(fit)};
}

/// Factors of black, of constant and of enormous BRDFs: the largest error of a value, relative, or
/// to the floor that values have.
StabilityMeasure flat_brdfs(const StabilityTrial& trial) {
  double worst = 0;
  std::string note;
  for (const double level : {0.0, 1e-8, 1.0, 1e5}) {
    const FormulaBrdf brdf([level](const HalfDifference&, const DirectionPair&) {
      return std::optional(Vec3d::filled(level));
    });
    const FactoredBrdf fit = factorize(brdf, "flat");
    const double expected = std::max(level, 1e-4) * trial.either(1.0, 1.1);
    for (const double z : {1.0, 0.7, 0.01}) {
      const Vec3d in(std::sqrt(1 - z * z), 0, z), out(-in.x, 0, z);
      for (const Vec3d& other : {in, out, Vec3d(0, 0, 1)}) {
        worst = std::max(worst, std::abs(evaluate(fit, in, other).x / expected - 1));
      }
    }
    note = describe(fit);
  }
  return {worst, note};
}

}  // namespace

std::vector<StabilityCase> fits_cases() {
  using enum BoundKind;
  const std::string part = "fits";
  return {
      {"nearly-singular-fit", part,
       "error of harmonics fitted on caps of 180° … 10°, over condition · 2⁻²⁴", at_most, 1.01,
       "values are floats, and a fit makes their error larger by the condition number",
       nearly_singular},
      {"fit-below-full-rank", part, "sets of directions of too low a rank that were fitted",
       at_most, 0, "coefficients that directions do not tell apart are refused", below_full_rank},
      {"factors-of-few-samples", part, "rms error of logarithms where the samples are", at_most,
       0.02, "the BRDF is such a product, but for steps of bins and 1e-3 of light everywhere",
       few_samples},
      {"factors-of-one-cluster", part, "rms error of logarithms where the samples are", at_most,
       0.01, "one value, which any of the factors can hold", one_cluster},
      {"factors-of-flat-brdfs", part, "relative error of values of 0, 1e-8, 1 and 1e5", at_most,
       1e-3,
       "a constant is a product of constants; below 1e-4 values count as 1e-4; the pull "
       "of the smallness term is 1e-9 of a bin's weight",
       flat_brdfs},
  };
}

}  // namespace rimlight::stability
