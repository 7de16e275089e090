#include "core/basis/sh_projection.h"

#include <algorithm>

#include "core/base/check.h"
#include "core/basis/cube_map.h"
#include "core/basis/sh.h"
#include "core/basis/sh_kernel.h"
#include "core/basis/sh_sum_kernel.h"

namespace rimlight::sh {
namespace {

// 400 coefficients of so many directions stay in the second-level cache.
constexpr std::size_t kBlock = 64;

/// Calls body(first, count, block) for blocks of directions, with the basis evaluated there.
template <typename Body>
void for_each_block(const Directions& directions, int degree, const Body& body) {
  const std::size_t coefficients = coefficient_count(degree);
  AlignedVector<float> values(coefficients * kBlock);
  for (std::size_t first = 0; first < directions.count(); first += kBlock) {
    const std::size_t count = std::min(kBlock, directions.count() - first);
    evaluate(directions.part(first, count), degree, values, kBlock);
    body(first, count, BasisBlock{values.data(), coefficients, padded(count), kBlock});
  }
}

/// How many signals there are in `size` numbers, `each` for a signal.
std::size_t signal_count(std::size_t size, std::size_t each) {
  if (each == 0) return 0;
  RIMLIGHT_CHECK_EQ(size % each, std::size_t{0});
  return size / each;
}

}  // namespace

SphereQuadrature cube_quadrature(int size, const Quaternion& rotation) {
  RIMLIGHT_CHECK(size >= cube::kSmallestSize);
  RIMLIGHT_CHECK(size <= cube::kLargestSize);
  const Matrix3 turn = matrix(normalized(rotation));
  std::vector<Vec3d> directions(cube::texel_count(size));
  for (std::size_t texel = 0; texel < directions.size(); ++texel) {
    directions[texel] = turn * cube::texel_direction(texel, size);
  }
  SphereQuadrature quadrature{Directions(directions), cube::texel_solid_angles(size)};
  quadrature.weights.resize(padded(directions.size()), 0.0f);
  return quadrature;
}

std::vector<float> project(const SphereQuadrature& quadrature, std::span<const float> values,
                           int degree) {
  check_degree(degree);
  const Directions& directions = quadrature.directions;
  RIMLIGHT_CHECK_EQ(quadrature.weights.size(), padded(directions.count()));
  const std::size_t signals = signal_count(values.size(), directions.count());
  std::vector<double> sums(signals * coefficient_count(degree), 0.0);
  AlignedVector<float> samples(signals * kBlock, 0.0f);
  for_each_block(directions, degree,
                 [&](std::size_t first, std::size_t count, const BasisBlock& block) {
                   for (std::size_t s = 0; s < signals; ++s) {
                     const float* const from = values.data() + s * directions.count() + first;
                     float* const to = samples.data() + s * kBlock;
                     for (std::size_t i = 0; i < count; ++i) {
                       to[i] = from[i] * quadrature.weights[first + i];
                     }
                     std::fill(to + count, to + kBlock, 0.0f);
                   }
                   add_projection(block, samples.data(), signals, sums.data());
                 });
  std::vector<float> coefficients(sums.size());
  std::ranges::transform(sums, coefficients.begin(),
                         [](double sum) { return static_cast<float>(sum); });
  return coefficients;
}

std::vector<float> reconstruct(std::span<const float> coefficients, int degree,
                               const Directions& directions) {
  check_degree(degree);
  const std::size_t signals = signal_count(coefficients.size(), coefficient_count(degree));
  std::vector<float> values(signals * directions.count());
  AlignedVector<float> samples(signals * kBlock);
  for_each_block(directions, degree,
                 [&](std::size_t first, std::size_t count, const BasisBlock& block) {
                   sum_basis(block, coefficients.data(), signals, samples.data());
                   for (std::size_t s = 0; s < signals; ++s) {
                     std::copy_n(samples.data() + s * kBlock, count,
                                 values.data() + s * directions.count() + first);
                   }
                 });
  return values;
}

std::vector<float> reconstruct_bands(std::span<const float> coefficients,
                                     const Directions& directions) {
  const int degree = degree_of_count(coefficients.size());
  std::vector<float> values(static_cast<std::size_t>(degree + 1) * directions.count());
  AlignedVector<float> samples(kBlock);
  for_each_block(
      directions, degree, [&](std::size_t first, std::size_t count, const BasisBlock& block) {
        for (int l = 0; l <= degree; ++l) {
          BasisBlock band = block;
          band.values += index(l, -l) * block.stride;
          band.coefficients = static_cast<std::size_t>(2 * l + 1);
          sum_basis(band, coefficients.data() + index(l, -l), 1, samples.data());
          std::copy_n(samples.data(), count,
                      values.data() + static_cast<std::size_t>(l) * directions.count() + first);
        }
      });
  return values;
}

}  // namespace rimlight::sh
