// Every SIMD target against sums in double.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "core/base/aligned_vector.h"
#include "core/curves/curve_column_kernel.h"
#include "core/curves/gram_kernel.h"
#include "core/curves/quick_image.h"
#include "core/math/random.h"
#include "tests/core/curves/curve_cases.h"
#include "tests/support/every_target.h"

namespace rimlight {
namespace {

TEST(CurveColumnKernel, EveryTargetAddsColumnsToRounding) {
  Random random(1);
  AlignedVector<std::int16_t> numbers(kCurveBins * kPanelFloats);
  for (auto& number : numbers) {
    number = static_cast<std::int16_t>(static_cast<int>(random.below(65535)) - 32767);
  }
  AlignedVector<float> steps(kCurveBins * 3);
  for (float& step : steps) step = random.uniform_float();
  std::vector<CurveColumn> columns;
  for (const std::uint32_t k : {0u, 1u, 7u, 100u, 255u}) {
    columns.push_back({k, {random.uniform_float(), -random.uniform_float(), 1}});
  }
  const int targets = test::for_every_target([&] {
    AlignedVector<float> image(kPanelFloats, 5);
    add_curve_columns(numbers.data(), steps.data(), columns, image.data());
    for (std::size_t i = 0; i < kPanelFloats; ++i) {
      const std::size_t c = i / kPanelRows;
      double expected = 5, size = 5;
      for (const CurveColumn& column : columns) {
        const double factor =
            double{column.delta[static_cast<int>(c)]} * steps[column.coefficient * 3 + c];
        const double term = factor * numbers[column.coefficient * kPanelFloats + i];
        expected += term;
        size += std::abs(term);
      }
      EXPECT_NEAR(image[i], expected, 8 * 0x1p-23 * size);
    }
  });
  EXPECT_GE(targets, 1);
}

TEST(GramKernel, EveryTargetSumsProductsToRounding) {
  Random random(2);
  AlignedVector<float> a(kPanelRows * kCurveBins);
  for (float& value : a) value = static_cast<float>(random.uniform(-1, 1));
  test::for_every_target([&] {
    AlignedVector<float> gram(kCurveBins * kCurveBins, 3);
    add_gram(a.data(), gram.data());
    for (std::size_t k = 0; k < kCurveBins; k += 7) {
      for (std::size_t j = k; j < kCurveBins; ++j) {
        double expected = 3;
        for (std::size_t row = 0; row < kPanelRows; ++row) {
          expected += double{a[row * kCurveBins + k]} * a[row * kCurveBins + j];
        }
        EXPECT_NEAR(gram[k * kCurveBins + j], expected, 64 * 64 * 0x1p-24);
      }
    }
  });
}

/// Bins and sums alike: T′ · c + fixed, and the row shaded.
TEST(SurfaceKernel, EveryTargetSumsOverTheSky) {
  for (const CurveCase& item : curve_cases()) {
    const Brdf& brdf = item.material.brdf;
    const bool is_chosen = item.name == "measured" || item.name == "Ward" ||
                           item.name == "glaze of roughness 0.200000" ||
                           (brdf.model == BrdfModel::blinn_phong && brdf.exponent == 60) ||
                           (brdf.model == BrdfModel::ashikhmin_shirley && brdf.exponent == 60);
    if (!is_chosen) continue;
    const CurveMaterialState state = baked_state(item.material);
    test::for_every_target([&] {
      PanelCase test(item.material);
      RelativeError shaded, stored;
      const auto axis =
          state.difference_angle ? CurveAxis::difference_angle : CurveAxis::half_angle;
      if (state.has(axis)) test.transport.rebuild(1, test.curve_light, state, axis, 1);
      const CurvePanel& panel = test.transport.panels()[1];
      for (std::size_t row = 0; row < panel.row_count; ++row) {
        const Vec3d expected =
            reference_row(test.transport.receivers(), panel, row, test.light, state);
        shaded.add(
            Vec3d(shade_exactly(test.transport.receivers(), panel, row, test.curve_light, state)),
            expected);
        if (!state.has(axis)) continue;
        stored.add(stored_row(test.transport, 1, row, axis,
                              test.transport.basis(axis).coefficients(*state.curve(axis))),
                   expected);
      }
      EXPECT_LT(shaded.value(), 2e-4) << item.name;
      if (state.has(axis)) {
        EXPECT_LT(stored.value(), 1e-3) << item.name;
      }
    });
  }
}

}  // namespace
}  // namespace rimlight
