// The Gram matrices of CurveTransport.
#include <gtest/gtest.h>

#include <cmath>

#include "core/base/check.h"
#include "core/base/parallel.h"
#include "core/math/random.h"
#include "tests/core/curves/curve_cases.h"

namespace rimlight {
namespace {

CurveMaterial glaze() {
  return {"glaze", {.model = BrdfModel::cook_torrance, .specular = {1, 0.9f, 0.8f}}};
}

/// ‖T̂ d‖² by the definition.
double reference_norm(const PanelCase& test, CurveAxis axis, const CurveCoefficients& d) {
  double sum = 0;
  test.for_each_row([&](std::size_t p, std::size_t row) {
    const Vec3d value =
        stored_row(test.transport, p, row, axis, d) - row_of(test.transport.fixed(p), row);
    sum += dot(value, value);
  });
  return sum;
}

/// Of sums of products in floats, which may cancel.
constexpr double kRounding = 1e-7;

/// Σ_k ‖d_k T̂_k‖
double size_of_terms(const PanelCase& test, CurveAxis axis, const CurveCoefficients& d) {
  double sum = 0;
  for (std::size_t k = 0; k < kCurveBins; ++k) {
    const Vec3d squared = Vec3d(d[k]) * Vec3d(d[k]);
    sum += std::sqrt(dot(squared, test.transport.column_norm_squared(0, axis, k)));
  }
  return sum;
}

TEST(CurveNorms, TheErrorOfAnEditIsWhatTheImageLacks) {
  PanelCase test(glaze());
  const CurveMaterialState state = baked_state(glaze());
  Random random(1);
  for (const CurveAxis axis : {CurveAxis::half_angle, CurveAxis::difference_angle}) {
    EXPECT_EQ(test.transport.squared_norm(0, axis, {}), 0);
    test.rebuild(state, axis);
    test.transport.find_norms(0, axis);
    int told_by_rounding = 0;
    for (int edit = 0; edit < 40; ++edit) {
      // A bump somewhere, narrow or wide, and then the largest of its coefficients are held.
      BrdfCurve bump{axis, {}};
      const double middle = random.uniform(0, 256), width = std::exp(random.uniform(-1, 4));
      for (std::size_t i = 0; i < kCurveBins; ++i) {
        const double x = (static_cast<double>(i) - middle) / width;
        bump.values[i] = Vec3f{1, 2, 0.1f} * static_cast<float>(std::exp(-x * x));
      }
      CurveCoefficients d = test.transport.basis(axis).coefficients(bump);
      if (edit % 2 == 0) {
        for (Vec3f& value : d) value = max_component(value) > 0.1f ? Vec3f{} : value;
      }
      const double expected = reference_norm(test, axis, d);
      const double terms = size_of_terms(test, axis, d);
      EXPECT_NEAR(test.transport.squared_norm(0, axis, d), expected,
                  1e-3 * expected + kRounding * terms * terms);
      told_by_rounding += expected < kRounding * terms * terms;
    }
    EXPECT_LT(told_by_rounding, 10);
  }
}

TEST(CurveNorms, OfColumnsAreTheirOwn) {
  PanelCase test(glaze());
  test.rebuild(baked_state(glaze()), CurveAxis::half_angle);
  EXPECT_EQ(test.transport.column_norm_squared(0, CurveAxis::half_angle, 3).x, 0);
  test.transport.find_norms(0, CurveAxis::half_angle);
  for (std::size_t k = 0; k < kCurveBins; k += 5) {
    for (int c = 0; c < 3; ++c) {
      CurveCoefficients d{};
      d[k][c] = 1;
      const double expected = reference_norm(test, CurveAxis::half_angle, d);
      EXPECT_NEAR(test.transport.column_norm_squared(0, CurveAxis::half_angle, k)[c], expected,
                  1e-5 * expected);
    }
  }
}

TEST(CurveNorms, AreOfEachMaterialAlone) {
  const CurveScene scene = random_scene({glaze(), glaze()}, 20, 8, 5);
  CurveTransport transport(scene.receivers());
  const CurveSky sky(8);
  const CurveLight light(sky, random_light(8, 1), 0);
  const CurveMaterialState state = baked_state(glaze());
  for (std::size_t p = 0; p < transport.panels().size(); ++p) {
    transport.rebuild(p, light, state, CurveAxis::half_angle, 1);
  }
  transport.find_norms(1, CurveAxis::half_angle);
  EXPECT_EQ(transport.column_norm_squared(0, CurveAxis::half_angle, 0).x, 0);
  EXPECT_GT(transport.column_norm_squared(1, CurveAxis::half_angle, 0).x, 0);
}

}  // namespace
}  // namespace rimlight
