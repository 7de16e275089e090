#include "core/curves/curve_material_state.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <functional>
#include <limits>

#include "core/base/error.h"
#include "tests/core/curves/curve_cases.h"

namespace rimlight {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

CurveMaterial of_model(BrdfModel model) {
  Brdf brdf{.model = model, .albedo = {0.5f, 0.2f, 0}, .specular = {0.3f, 0.3f, 0.3f}};
  return {"thing", brdf};
}
CurveMaterial glaze() { return of_model(BrdfModel::cook_torrance); }

MaterialEdit edited(const std::function<void(MaterialEdit&)>& change) {
  MaterialEdit edit;
  change(edit);
  return edit;
}

CurveEdit drawn(std::vector<CurvePoint> points, std::vector<Vec3f> values) {
  CurveEdit edit;
  edit.points = std::move(points);
  edit.values = std::move(values);
  return edit;
}
CurveEdit constant(float value) {
  return drawn({}, std::vector<Vec3f>(kCurveBins, {value, value, value}));
}

std::string refusal(const CurveMaterial& material, const MaterialEdit& edit) {
  try {
    resolve(material, edit, {}, "materials/thing");
  } catch (const Error& error) {
    return error.what();
  }
  return "none";
}

TEST(CurveMaterialState, UneditedMaterialsHaveTheirModelsOwnCurves) {
  const CurveMaterialState state = resolve(glaze(), {}, {}, "");
  EXPECT_EQ(state.half_angle, factor_curve(glaze().brdf, CurveAxis::half_angle));
  EXPECT_EQ(state.difference_angle, factor_curve(glaze().brdf, CurveAxis::difference_angle));
  const CurveMaterialState phong = resolve(of_model(BrdfModel::phong), {}, {}, "");
  EXPECT_FALSE(phong.has(CurveAxis::half_angle) || phong.has(CurveAxis::difference_angle));
  const CurveMaterialState mixed = resolve(of_model(BrdfModel::ashikhmin_shirley), {}, {}, "");
  EXPECT_FALSE(mixed.has(CurveAxis::half_angle));
  EXPECT_TRUE(mixed.has(CurveAxis::difference_angle));
}

TEST(CurveMaterialState, ParametersChangeTheModelAndItsCurves) {
  const MaterialEdit edit = edited([](MaterialEdit& e) {
    e.roughness = 0.4;
    e.eta = Vec3f{1.2f, 1.3f, 1.4f};
    e.specular = Vec3f{0.1f, 0.2f, 0.3f};
  });
  const CurveMaterialState state = resolve(glaze(), edit, {}, "");
  EXPECT_EQ(state.brdf.roughness, 0.4f);
  EXPECT_EQ(state.brdf.eta, Vec3f(1.2f, 1.3f, 1.4f));
  EXPECT_EQ(state.half_angle, factor_curve(state.brdf, CurveAxis::half_angle));
  EXPECT_NE(state.half_angle, factor_curve(glaze().brdf, CurveAxis::half_angle));
  EXPECT_NE(state.difference_angle, factor_curve(glaze().brdf, CurveAxis::difference_angle));
}

TEST(CurveMaterialState, DrawnCurvesTakeTheModelsPlace) {
  MaterialEdit edit;
  edit.half_angle = constant(2);
  const CurveMaterialState state = resolve(glaze(), edit, {}, "");
  EXPECT_EQ(state.half_angle->values[200], Vec3f(2, 2, 2));
  EXPECT_EQ(state.difference_angle, factor_curve(glaze().brdf, CurveAxis::difference_angle));
  EXPECT_FALSE(resolve(of_model(BrdfModel::phong), edit, {}, "").half_angle);
}

TEST(CurveMaterialState, MeasuredOnesComeByName) {
  const MeasuredLibrary library{{"pearl", some_measured()}};
  MaterialEdit edit;
  edit.measured = "pearl";
  edit.difference_angle = constant(0.5f);
  const CurveMaterialState state = resolve(glaze(), edit, library, "");
  ASSERT_TRUE(state.measured);
  EXPECT_EQ(state.half_angle, some_measured().half_angle);
  EXPECT_EQ(state.difference_angle->values[3].x, 0.5f);
  edit.measured = "gold";
  EXPECT_THAT(refusal(glaze(), edit), HasSubstr("thing/measured: found \"gold\""));
}

TEST(CurveMaterialState, EachFieldOutsideItsDomainIsNamed) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  struct Bad {
    const char* field;
    std::function<void(MaterialEdit&)> change;
  };
  const Bad cases[] = {
      {"albedo",
       [](MaterialEdit& e) {
         e.albedo = Vec3f{0, 1.1f, 0};
       }},
      {"specular",
       [](MaterialEdit& e) {
         e.specular = Vec3f{0, 0, -1};
       }},
      {"exponent", [](MaterialEdit& e) { e.exponent = 0.5; }},
      {"exponent_across", [](MaterialEdit& e) { e.exponent_across = 2e5; }},
      {"roughness", [](MaterialEdit& e) { e.roughness = 1e-5; }},
      {"roughness", [&](MaterialEdit& e) { e.roughness = nan; }},
      {"roughness_across", [](MaterialEdit& e) { e.roughness_across = 1.5; }},
      {"eta",
       [](MaterialEdit& e) {
         e.eta = Vec3f{1, 0.01f, 1};
       }},
      {"k",
       [](MaterialEdit& e) {
         e.k = Vec3f{0, 0, 101};
       }},
      {"half_angle", [](MaterialEdit& e) { e.half_angle = CurveEdit{}; }},
      {"half_angle", [](MaterialEdit& e) { e.half_angle = constant(-1); }},
      {"half_angle", [](MaterialEdit& e) { e.half_angle = constant(2e6f); }},
      {"difference_angle", [](MaterialEdit& e) { e.difference_angle = drawn({}, {Vec3f{}}); }},
      {"difference_angle", [](MaterialEdit& e) {
         e.difference_angle = drawn({{2, {1, 1, 1}}}, {});
       }}};
  for (const Bad& bad : cases) {
    EXPECT_THAT(refusal(glaze(), edited(bad.change)),
                HasSubstr(std::string("materials/thing/") + bad.field))
        << bad.field;
  }
}

TEST(CurveMaterialState, LobesMayNotReflectMoreThanTheyGet) {
  MaterialEdit edit;
  edit.specular = Vec3f{0.6f, 0.6f, 0.6f};
  for (const BrdfModel model : {BrdfModel::phong, BrdfModel::blinn_phong, BrdfModel::ward}) {
    EXPECT_THAT(refusal(of_model(model), edit), HasSubstr("albedo + specular"));
  }
  EXPECT_EQ(refusal(glaze(), edit), "none");
  edit.specular = Vec3f{0.5f, 0.6f, 1};
  EXPECT_EQ(refusal(of_model(BrdfModel::ward), edit), "none");
}

TEST(CurveMaterialState, OneExponentIsBothAndAnAxisIsItsOwn) {
  const CurveMaterial ward = of_model(BrdfModel::ward);
  MaterialEdit edit;
  edit.roughness = 0.7;
  EXPECT_EQ(resolve(ward, edit, {}, "").brdf.roughness_across, 0.7f);
  edit.roughness_across = 0.1;
  EXPECT_EQ(resolve(ward, edit, {}, "").brdf.roughness, 0.7f);
  EXPECT_EQ(resolve(ward, edit, {}, "").brdf.roughness_across, 0.1f);
}

TEST(CurveMaterialState, TellsInWordsWhatAModelDoesNotHave) {
  MaterialEdit edit;
  edit.half_angle = edit.difference_angle = constant(1);
  edit.k = Vec3f{1, 1, 1};
  EXPECT_THAT(unavailable(glaze(), edit), IsEmpty());
  EXPECT_THAT(unavailable(of_model(BrdfModel::phong), edit),
              ElementsAre("phong has no extinction k", "phong has no curve over θ_h",
                          "phong has no curve over θ_d"));
  EXPECT_THAT(unavailable(of_model(BrdfModel::ashikhmin_shirley), edit),
              ElementsAre("ashikhmin_shirley has no extinction k",
                          "ashikhmin_shirley has no curve over θ_h"));
  edit.measured = "pearl";
  EXPECT_THAT(unavailable(of_model(BrdfModel::phong), edit),
              ElementsAre("a measured BRDF has no extinction k"));
  MaterialEdit lobe;
  lobe.lobe = std::vector<double>{1, 0};
  EXPECT_THAT(unavailable(of_model(BrdfModel::phong), lobe),
              ElementsAre("phong has no lobe to draw"));
}

/// What an edit of one field makes stale: T′ over θ_h, over θ_d, `fixed`.
struct Stale {
  BrdfModel model;
  std::function<void(MaterialEdit&)> change;
  bool half_angle, difference_angle, fixed;
};

TEST(CurveMaterialState, TellsWhatAnEditMakesStale) {
  const auto half = [](MaterialEdit& e) { e.half_angle = constant(1); };
  const auto difference = [](MaterialEdit& e) { e.difference_angle = constant(1); };
  const auto albedo = [](MaterialEdit& e) { e.albedo = Vec3f{0.1f, 0.1f, 0.1f}; };
  const auto roughness = [](MaterialEdit& e) { e.roughness = 0.9; };
  const auto specular = [](MaterialEdit& e) { e.specular = Vec3f{0.1f, 0.1f, 0.1f}; };
  const auto exponent = [](MaterialEdit& e) { e.exponent = 9; };
  const auto eta = [](MaterialEdit& e) { e.eta = Vec3f{2, 2, 2}; };
  const Stale cases[] = {{BrdfModel::cook_torrance, [](MaterialEdit&) {}, false, false, false},
                         {BrdfModel::cook_torrance, half, false, true, false},
                         {BrdfModel::cook_torrance, difference, true, false, false},
                         {BrdfModel::cook_torrance, roughness, false, true, false},
                         {BrdfModel::cook_torrance, eta, true, false, true},
                         {BrdfModel::cook_torrance, albedo, false, false, true},
                         {BrdfModel::cook_torrance, specular, true, true, true},
                         {BrdfModel::blinn_phong, exponent, false, false, false},
                         {BrdfModel::blinn_phong, specular, true, false, false},
                         {BrdfModel::blinn_phong, half, false, false, false},
                         {BrdfModel::ashikhmin_shirley, exponent, false, true, false},
                         {BrdfModel::ashikhmin_shirley, specular, false, false, true},
                         {BrdfModel::ashikhmin_shirley, difference, false, false, false},
                         {BrdfModel::phong, exponent, false, false, true},
                         {BrdfModel::ward, roughness, false, false, true},
                         {BrdfModel::lambert, albedo, false, false, true},
                         {BrdfModel::lambert, roughness, false, false, false}};
  int index = 0;
  for (const Stale& item : cases) {
    const CurveMaterial material = of_model(item.model);
    const CurveMaterialState from = resolve(material, {}, {}, "");
    const CurveStateChange found = change(from, resolve(material, edited(item.change), {}, ""));
    EXPECT_EQ(found.transport_half_angle, item.half_angle) << index;
    EXPECT_EQ(found.transport_difference_angle, item.difference_angle) << index;
    EXPECT_EQ(found.fixed, item.fixed) << index;
    ++index;
  }
}

TEST(CurveMaterialState, AMeasuredOneInAModelsPlaceMakesAllStale) {
  const MeasuredLibrary library{{"pearl", some_measured()}};
  MaterialEdit edit;
  edit.measured = "pearl";
  const CurveStateChange found =
      change(resolve(glaze(), {}, {}, ""), resolve(glaze(), edit, library, ""));
  EXPECT_TRUE(found.transport_half_angle && found.transport_difference_angle && found.fixed);
  EXPECT_TRUE(found.half_angle && found.difference_angle);
}

}  // namespace
}  // namespace rimlight
