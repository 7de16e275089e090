#include "core/material/factorization.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>
#include <vector>

#include "core/base/error.h"
#include "core/material/curve_points.h"

// Unknowns: the logarithms of 256 bins of H, 256 bins of Δ and 65 knots of P, for each channel. A
// sample is one equation: h + d + (two knots for θ_i) + (two for θ_o) = log f. All channels share
// the matrix. Bins without samples, and the constants that can move from factor to factor, are
// settled by small terms for second differences, first differences and size.

namespace rimlight {
namespace {

constexpr double kHalfPi = std::numbers::pi / 2;
constexpr std::size_t kDifferenceSteps = 48, kAzimuthSteps = 16;
constexpr double kFloor = 1e-4;
constexpr std::size_t kDifference = kCurveBins, kRest = 2 * kCurveBins;
constexpr std::size_t kUnknowns = kRest + kRestKnots;
/// Of the mean weight of a bin of H: enough to bridge gaps, too little to bend what is measured.
constexpr double kSmoothness = 1e-3, kFlatness = 1e-6, kSmallness = 1e-9;

struct Knots {
  std::size_t lower = 0;
  double share = 0;  // of lower + 1
};

Knots knots_at(double cosine) {
  const double position =
      std::acos(std::clamp(cosine, 0.0, 1.0)) / kHalfPi * static_cast<double>(kRestKnots - 1);
  const auto lower = std::min(kRestKnots - 2, static_cast<std::size_t>(position));
  return {lower, position - static_cast<double>(lower)};
}

/// One equation of the fit.
struct Sample {
  HalfDifference angles;
  Vec3d value;
  double weight = 0;  // cos θ_i cos θ_o
  std::array<std::pair<std::size_t, double>, 6> terms;
};

Sample make_sample(const HalfDifference& angles, const Vec3d& value) {
  const DirectionPair pair = direction_pair(angles);
  const Knots in = knots_at(pair.in.z), out = knots_at(pair.out.z);
  const std::size_t half = bin_of(CurveAxis::half_angle, angles.half);
  const std::size_t difference = bin_of(CurveAxis::difference_angle, angles.difference);
  return {angles,
          value,
          pair.in.z * pair.out.z,
          {{{half, 1.0},
            {kDifference + difference, 1.0},
            {kRest + in.lower, 1 - in.share},
            {kRest + in.lower + 1, in.share},
            {kRest + out.lower, 1 - out.share},
            {kRest + out.lower + 1, out.share}}}};
}

/// All samples, and how many were asked for.
struct Samples {
  std::vector<Sample> valid;
  std::size_t asked = 0;
};

Samples take_samples(const MeasuredBrdf& brdf) {
  Samples samples;
  for (std::size_t bin = 0; bin < kCurveBins; ++bin) {
    const double half = bin_begin(CurveAxis::half_angle, static_cast<double>(bin) + 0.5);
    // The steps of θ_d shift from bin to bin, so that all of its 256 bins are met.
    const double shift = std::fmod(static_cast<double>(bin) * std::numbers::phi, 1.0);
    for (std::size_t i = 0; i < kDifferenceSteps; ++i) {
      for (std::size_t j = 0; j < kAzimuthSteps; ++j) {
        const HalfDifference angles{
            half, kHalfPi * (static_cast<double>(i) + shift) / kDifferenceSteps,
            std::numbers::pi * (static_cast<double>(j) + 0.5) / kAzimuthSteps};
        const DirectionPair pair = direction_pair(angles);
        if (!(pair.in.z > 0 && pair.out.z > 0)) continue;
        ++samples.asked;
        const auto value = brdf.at(angles);
        if (value) samples.valid.push_back(make_sample(angles, *value));
      }
    }
  }
  return samples;
}

/// Adds `weight` · (Σ factors[i] x[first + i])² to the sum to be made smallest.
void add_square(Eigen::MatrixXd& matrix, std::size_t first, std::initializer_list<double> factors,
                double weight) {
  const auto begin = static_cast<Eigen::Index>(first);
  Eigen::Index row = begin;
  for (const double a : factors) {
    Eigen::Index column = begin;
    for (const double b : factors) matrix(row, column++) += weight * a * b;
    ++row;
  }
}

void add_smoothness(Eigen::MatrixXd& matrix, double weight) {
  const std::pair<std::size_t, std::size_t> blocks[] = {
      {0, kCurveBins}, {kDifference, kCurveBins}, {kRest, kRestKnots}};
  for (const auto& [first, count] : blocks) {
    for (std::size_t i = first; i < first + count; ++i) {
      add_square(matrix, i, {1}, kSmallness * weight);
      if (i + 1 < first + count) add_square(matrix, i, {1, -1}, kFlatness * weight);
      if (i + 2 < first + count) add_square(matrix, i, {1, -2, 1}, kSmoothness * weight);
    }
  }
}

using Solution = Eigen::Matrix<double, Eigen::Dynamic, 3>;

Vec3d logarithm(const Vec3d& value) {
  Vec3d result;
  for (int c = 0; c < 3; ++c) result[c] = std::log(std::max(value[c], kFloor));
  return result;
}

/// The solution, and the condition of its equations.
Solution solve(const std::vector<Sample>& samples, double& condition) {
  constexpr auto kSize = static_cast<Eigen::Index>(kUnknowns);
  Eigen::MatrixXd matrix = Eigen::MatrixXd::Zero(kSize, kSize);
  Solution right = Solution::Zero(kSize, 3);
  double weights = 0;
  for (const Sample& sample : samples) {
    const Vec3d value = logarithm(sample.value);
    for (const auto& [i, a] : sample.terms) {
      const auto row = static_cast<Eigen::Index>(i);
      for (const auto& [j, b] : sample.terms) {
        matrix(row, static_cast<Eigen::Index>(j)) += sample.weight * a * b;
      }
      for (int c = 0; c < 3; ++c) right(row, c) += sample.weight * a * value[c];
    }
    weights += sample.weight;
  }
  add_smoothness(matrix, weights / kCurveBins);
  const Eigen::LDLT<Eigen::MatrixXd> factored(matrix);
  condition = 1 / factored.rcond();
  return factored.solve(right);
}

/// Moves the constants of Δ and P to H, so that their weighted means are 0.
void balance(const std::vector<Sample>& samples, Solution& solution) {
  Eigen::RowVector3d difference = Eigen::RowVector3d::Zero(), rest = difference;
  double weights = 0;
  for (const Sample& sample : samples) {
    for (std::size_t i = 1; i < sample.terms.size(); ++i) {
      const auto& [unknown, factor] = sample.terms[i];
      (i == 1 ? difference : rest) +=
          sample.weight * factor * solution.row(static_cast<Eigen::Index>(unknown));
    }
    weights += sample.weight;
  }
  difference /= weights;
  rest /= weights;  // of two terms
  solution.topRows(kCurveBins).rowwise() += difference + rest;
  solution.middleRows(kDifference, kCurveBins).rowwise() -= difference;
  solution.bottomRows(kRestKnots).rowwise() -= rest / 2;
}

Vec3f factor_of(const Solution& solution, std::size_t unknown) {
  Vec3f result;
  for (int c = 0; c < 3; ++c) {
    const double value = std::exp(solution(static_cast<Eigen::Index>(unknown), c));
    result[c] = static_cast<float>(std::min(value, kLargestCurveValue));
  }
  return result;
}

FitError fit_error(const FactoredBrdf& brdf, const std::vector<Sample>& samples) {
  Vec3d logarithmic, relative, squares;
  double weights = 0;
  for (const Sample& sample : samples) {
    const DirectionPair pair = direction_pair(sample.angles);
    const Vec3d fit = evaluate(brdf, pair.in, pair.out);
    const Vec3d difference = logarithm(fit) - logarithm(sample.value);
    logarithmic += difference * difference * sample.weight;
    weights += sample.weight;
    // dω_i dω_o = 4 cos θ_d dω_d dω_h, and dθ_h is as wide as √θ_h in MERL's bins.
    const double area = std::sqrt(sample.angles.half) * std::sin(sample.angles.half) *
                        std::sin(2 * sample.angles.difference);
    relative += (fit - sample.value) * (fit - sample.value) * (sample.weight * area);
    squares += sample.value * sample.value * (sample.weight * area);
  }
  FitError error;
  for (int c = 0; c < 3; ++c) {
    error.logarithmic[c] = std::sqrt(logarithmic[c] / weights);
    error.relative[c] = squares[c] > 0 ? std::sqrt(relative[c] / squares[c]) : 0;
  }
  return error;
}

Vec3d knot_value(const FactoredBrdf& brdf, double cosine) {
  const Knots knots = knots_at(cosine);
  Vec3d result;
  for (int c = 0; c < 3; ++c) {
    const double low = brdf.rest[knots.lower][c], high = brdf.rest[knots.lower + 1][c];
    result[c] = std::pow(low, 1 - knots.share) * std::pow(high, knots.share);
  }
  return result;
}

}  // namespace

Vec3d rest_at(const FactoredBrdf& brdf, const Vec3d& in, const Vec3d& out) {
  if (!(in.z > 0 && out.z > 0)) return {};
  return knot_value(brdf, in.z) * knot_value(brdf, out.z);
}

Vec3d evaluate(const FactoredBrdf& brdf, const Vec3d& in, const Vec3d& out) {
  if (!(in.z > 0 && out.z > 0)) return {};
  const HalfDifference angles = half_difference(in, out);
  const std::size_t half = bin_of(CurveAxis::half_angle, angles.half);
  const std::size_t difference = bin_of(CurveAxis::difference_angle, angles.difference);
  return rest_at(brdf, in, out) * Vec3d(brdf.half_angle.values[half]) *
         Vec3d(brdf.difference_angle.values[difference]);
}

FactoredBrdf factorize(const MeasuredBrdf& brdf, const std::string& source) {
  const Samples samples = take_samples(brdf);
  if (samples.valid.empty()) throw Error(source, "no sample", "a BRDF with samples");
  FactoredBrdf result;
  Solution solution = solve(samples.valid, result.condition);
  balance(samples.valid, solution);
  for (std::size_t i = 0; i < kCurveBins; ++i) {
    result.half_angle.values[i] = factor_of(solution, i);
    result.difference_angle.values[i] = factor_of(solution, kDifference + i);
  }
  for (std::size_t i = 0; i < kRestKnots; ++i) result.rest[i] = factor_of(solution, kRest + i);
  result.error = fit_error(result, samples.valid);
  result.valid_share =
      static_cast<double>(samples.valid.size()) / static_cast<double>(samples.asked);
  return result;
}

}  // namespace rimlight
