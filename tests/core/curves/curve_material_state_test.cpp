#include "core/curves/curve_material_state.h"

#include <gtest/gtest.h>

#include "core/base/error.h"
#include "tests/core/curves/curve_cases.h"

namespace rimlight {
namespace {

CurveMaterial glaze() {
  return {"glaze", {.model = BrdfModel::cook_torrance, .specular = {1, 1, 1}}};
}

TEST(CurveMaterialState, BakedMaterialsHaveTheirModelsOwnCurves) {
  const CurveMaterialState state = resolve(glaze(), {}, {}, "glaze");
  EXPECT_EQ(state.half_angle, factor_curve(glaze().brdf, CurveAxis::half_angle));
  EXPECT_EQ(state.difference_angle, factor_curve(glaze().brdf, CurveAxis::difference_angle));
}

}  // namespace
}  // namespace rimlight
