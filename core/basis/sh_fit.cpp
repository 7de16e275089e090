#include <Eigen/QR>
#include <Eigen/SVD>
#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

#include "core/base/check.h"
#include "core/base/checked.h"
#include "core/base/error.h"
#include "core/basis/sh.h"
#include "core/basis/sh_projection.h"

namespace rimlight::sh {
namespace {

constexpr const char* kWhere = "fit of spherical harmonics";

using Rows = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic>;

Eigen::Index to_index(std::size_t value) { return static_cast<Eigen::Index>(value); }

void check_input(std::span<const Vec3d> directions, std::span<const float> values,
                 std::size_t coefficients) {
  const std::string counted = std::to_string(directions.size()) + " directions";
  if (directions.size() < coefficients) {
    throw Error(kWhere, counted,
                "at least one for each of " + std::to_string(coefficients) + " coefficients");
  }
  const auto size = checked_product(directions.size(), coefficients);
  if (!size || *size > kLargestFit) {
    throw Error(kWhere, counted + " for " + std::to_string(coefficients) + " coefficients",
                "a product of at most " + std::to_string(kLargestFit));
  }
  for (std::size_t i = 0; i < directions.size(); ++i) {
    const Vec3d& d = directions[i];
    // Its square must be a number too, for its length.
    if (!(std::isfinite(dot(d, d)) && dot(d, d) > 0)) {
      throw Error(kWhere, "direction " + std::to_string(i) + " zero, too long or not finite",
                  "directions of any other length");
    }
  }
  for (std::size_t i = 0; i < values.size(); ++i) {
    if (!std::isfinite(values[i])) {
      throw Error(kWhere, "value " + std::to_string(i) + " not finite", "finite values");
    }
  }
}

/// [directions][coefficients].
Rows basis_rows(std::span<const Vec3d> directions, int degree) {
  Rows rows(to_index(directions.size()), to_index(coefficient_count(degree)));
  std::vector<double> values(coefficient_count(degree));
  for (std::size_t i = 0; i < directions.size(); ++i) {
    evaluate(directions[i], degree, values);
    rows.row(to_index(i)) = Eigen::Map<const Eigen::RowVectorXd>(values.data(), rows.cols());
  }
  return rows;
}

/// The condition of a triangle R, which has the singular values of all rows. Error below full rank.
double checked_condition(const Rows& triangle, std::size_t directions) {
  const Eigen::VectorXd singular = Eigen::BDCSVD<Rows>(triangle).singularValues();
  const double largest = singular(0), smallest = singular(singular.size() - 1);
  // Singular values this small are roundings of zero (Golub and Van Loan 2013, section 5.5.8).
  const double zero =
      largest * static_cast<double>(directions) * std::numeric_limits<double>::epsilon();
  if (!(smallest > zero)) {
    const auto rank = std::ranges::count_if(singular, [&](double s) { return s > zero; });
    throw Error(
        kWhere,
        "rank " + std::to_string(rank) + " from " + std::to_string(directions) + " directions",
        "rank " + std::to_string(singular.size()) +
            ": directions that tell all coefficients apart");
  }
  return largest / smallest;
}

}  // namespace

Fit fit(std::span<const Vec3d> directions, std::span<const float> values, int degree) {
  check_degree(degree);
  RIMLIGHT_CHECK(degree <= kLargestDegree);
  const std::size_t coefficients = coefficient_count(degree);
  check_input(directions, values, coefficients);
  RIMLIGHT_CHECK_EQ(values.size() % directions.size(), std::size_t{0});
  const std::size_t signals = values.size() / directions.size();
  Rows rows = basis_rows(directions, degree);
  const Eigen::HouseholderQR<Eigen::Ref<Rows>> factored(rows);
  const Eigen::Index count = rows.cols();
  const Rows triangle = rows.topRows(count).template triangularView<Eigen::Upper>();
  Fit result;
  result.condition = checked_condition(triangle, directions.size());
  for (std::size_t s = 0; s < signals; ++s) {
    Eigen::VectorXd right(rows.rows());
    for (Eigen::Index i = 0; i < rows.rows(); ++i) {
      right(i) = static_cast<double>(values[s * directions.size() + static_cast<std::size_t>(i)]);
    }
    right.applyOnTheLeft(factored.householderQ().adjoint());
    const Eigen::VectorXd solved = triangle.triangularView<Eigen::Upper>().solve(right.head(count));
    for (const double value : solved) result.coefficients.push_back(static_cast<float>(value));
  }
  return result;
}

}  // namespace rimlight::sh
