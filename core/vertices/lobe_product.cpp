#include "core/vertices/lobe_product.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/base/check.h"
#include "core/basis/sh.h"
#include "core/basis/sh_latitudes.h"
#include "core/basis/sh_rotation.h"
#include "core/math/rotation.h"

namespace rimlight {

/// Where the axes are: azimuth φ and the angle θ from z.
struct LobeProduct::AxisAngles {
  TurnAngles azimuth, polar;
};
/// The functions in their lobes' frames, [(degree + 1)²], and two bands.
struct LobeProduct::Scratch {
  float* turned;
  float* one;
  float* other;
};

namespace {

constexpr std::size_t kRow = kLobeLanes;

std::size_t rows_of(int l) { return static_cast<std::size_t>(2 * l + 1); }

/// cos mα, sin mα for m to `degree`, by powers of cos α + i sin α.
void fill_angles(int degree, float* cosine, float* sine) {
  std::fill_n(cosine, kRow, 1.0f);
  std::fill_n(sine, kRow, 0.0f);
  for (std::size_t m = 2; m <= static_cast<std::size_t>(degree); ++m) {
    for (std::size_t lane = 0; lane < kRow; ++lane) {
      const float c = cosine[(m - 1) * kRow + lane], s = sine[(m - 1) * kRow + lane];
      const float c1 = cosine[kRow + lane], s1 = sine[kRow + lane];
      cosine[m * kRow + lane] = c * c1 - s * s1;
      sine[m * kRow + lane] = s * c1 + c * s1;
    }
  }
}

template <typename AxisAngles>
AxisAngles axis_angles(std::span<const Vec3f> axes, int degree, float* values) {
  const std::size_t size = static_cast<std::size_t>(std::max(degree, 1) + 1) * kRow;
  float *const cos_azimuth = values, *const sin_azimuth = values + size;
  float *const cos_polar = values + 2 * size, *const sin_polar = values + 3 * size;
  for (std::size_t lane = 0; lane < kRow; ++lane) {
    const Vec3d axis(axes[lane]);  // its square neither overflows nor vanishes in double
    const double square = axis.x * axis.x + axis.y * axis.y;
    const double radius = std::sqrt(square), length = std::sqrt(square + axis.z * axis.z);
    cos_azimuth[kRow + lane] = radius > 0 ? static_cast<float>(axis.x / radius) : 1;
    sin_azimuth[kRow + lane] = radius > 0 ? static_cast<float>(axis.y / radius) : 0;
    cos_polar[kRow + lane] = static_cast<float>(axis.z / length);
    sin_polar[kRow + lane] = static_cast<float>(radius / length);
  }
  fill_angles(degree, cos_azimuth, sin_azimuth);
  fill_angles(degree, cos_polar, sin_polar);
  return {{cos_azimuth, sin_azimuth}, {cos_polar, sin_polar}};
}

/// Rows of some lanes, from and to panels of kBatchVertices.
void take_rows(const float* panel, std::size_t rows, float* to) {
  for (std::size_t i = 0; i < rows; ++i) {
    std::copy_n(panel + i * kBatchVertices, kRow, to + i * kRow);
  }
}
void give_rows(const float* from, std::size_t rows, float* panel) {
  for (std::size_t i = 0; i < rows; ++i) {
    std::copy_n(from + i * kRow, kRow, panel + i * kBatchVertices);
  }
}

}  // namespace

LobeProduct::LobeProduct(int degree) : degree_(degree) {
  RIMLIGHT_CHECK(degree >= 0 && degree <= sh::kLargestDegree);
  const sh::Rotation turn(axis_angle({1, 0, 0}, std::numbers::pi / 2), 2 * degree);
  for (int l = 0; l <= 2 * degree; ++l) {
    const std::size_t size = rows_of(l);
    const std::vector<double> matrix = turn.matrix(l);
    std::vector<double> back(matrix.size());
    for (std::size_t i = 0; i < size; ++i) {
      for (std::size_t j = 0; j < size; ++j) back[i * size + j] = matrix[j * size + i];
    }
    // A product's rows |m| > n are zero in the lobe's frame, where X starts from.
    quarter_.emplace_back(matrix, size, static_cast<std::size_t>(degree));
    quarter_back_.emplace_back(back, size, size);
  }
}

/// ∫ Y_l′m Y_lm g dω = 2π ∫ P_l′m P_lm g dz by Gauss–Legendre points, where for l + l′ even only
/// the even part of g counts, and for odd ones the odd part, twice.
LobeProduct::Lobe::Lobe(int degree, std::span<const float> factors) : degree_(degree) {
  RIMLIGHT_CHECK_EQ(factors.size(), static_cast<std::size_t>(degree) + 1);
  const ShLatitudes latitudes(2 * degree, 4 * degree);
  std::vector<double> weighted[2];  // of the parts of g, by parity
  for (int parity = 0; parity < 2; ++parity) {
    weighted[parity].assign(latitudes.count(), 0.0);
    for (int l = parity; l <= degree; l += 2) {
      const double value = static_cast<double>(factors[static_cast<std::size_t>(l)]) *
                           std::sqrt((2 * l + 1) / (4 * std::numbers::pi));
      for (std::size_t i = 0; i < latitudes.count(); ++i) {
        weighted[parity][i] +=
            4 * std::numbers::pi * latitudes.weights()[i] * value * latitudes.values(l, 0)[i];
      }
    }
  }
  for (int to = 0; to <= 2 * degree; ++to) {
    first_.push_back(factors_.size());
    for (int m = 0; m <= std::min(to, degree); ++m) {
      for (int l = std::max(m, to - degree); l <= degree; ++l) {
        double sum = 0;
        for (std::size_t i = 0; i < latitudes.count(); ++i) {
          sum += weighted[(l + to) % 2][i] * latitudes.values(to, m)[i] * latitudes.values(l, m)[i];
        }
        factors_.push_back(static_cast<float>(sum));
      }
    }
  }
}

ZonalBand LobeProduct::Lobe::band(int l) const {
  return {l, degree_, degree_, factors_.data() + first_[static_cast<std::size_t>(l)]};
}

void LobeProduct::multiply(const Lobe& lobe, std::span<const Vec3f> axes,
                           std::span<const float> functions, std::span<float> products,
                           Workspace& workspace) const {
  const std::size_t count = sh::coefficient_count(degree_);
  RIMLIGHT_CHECK_EQ(axes.size(), kBatchVertices);
  RIMLIGHT_CHECK_EQ(functions.size(), count * kBatchVertices);
  RIMLIGHT_CHECK_EQ(products.size(), sh::coefficient_count(2 * degree_) * kBatchVertices);
  const std::size_t band = rows_of(2 * degree_) * kRow;
  const std::size_t angles = 4 * static_cast<std::size_t>(std::max(2 * degree_, 1) + 1) * kRow;
  const std::size_t size = count * kRow + 2 * band + angles;
  if (workspace.values.size() < size) workspace.values.resize(size);
  float* const turned = workspace.values.data();
  float* const bands = turned + count * kRow;
  for (std::size_t lane = 0; lane < kBatchVertices; lane += kRow) {
    const auto axis =
        axis_angles<AxisAngles>(axes.subspan(lane, kRow), 2 * degree_, bands + 2 * band);
    const Scratch scratch = {turned, bands, bands + band};
    turn_to_lobes(axis, functions.data() + lane, scratch);
    multiply_and_turn_back(lobe, axis, scratch, products.data() + lane);
  }
}

void LobeProduct::turn_to_lobes(const AxisAngles& axis, const float* functions,
                                const Scratch& scratch) const {
  for (int l = 0; l <= degree_; ++l) {
    const auto first = static_cast<std::size_t>(l * l), band = static_cast<std::size_t>(l);
    take_rows(functions + first * kBatchVertices, rows_of(l), scratch.one);
    turn_rows(axis.azimuth, TurnWay::back, l, scratch.one);
    multiply_rows(quarter_[band], scratch.one, scratch.other);
    turn_rows(axis.polar, TurnWay::back, l, scratch.other);
    multiply_rows(quarter_back_[band], scratch.other, scratch.turned + first * kRow);
  }
}

void LobeProduct::multiply_and_turn_back(const Lobe& lobe, const AxisAngles& axis,
                                         const Scratch& scratch, float* products) const {
  for (int l = 0; l <= 2 * degree_; ++l) {
    const auto first = static_cast<std::size_t>(l * l), band = static_cast<std::size_t>(l);
    multiply_zonal(lobe.band(l), scratch.turned, scratch.one);
    multiply_rows(quarter_[band], scratch.one, scratch.other);
    turn_rows(axis.polar, TurnWay::forth, l, scratch.other);
    multiply_rows(quarter_back_[band], scratch.other, scratch.one);
    turn_rows(axis.azimuth, TurnWay::forth, l, scratch.one);
    give_rows(scratch.one, rows_of(l), products + first * kBatchVertices);
  }
}

}  // namespace rimlight
