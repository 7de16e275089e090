// Which of a scene's materials sessions may edit.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "core/bake/curve_surfaces.h"
#include "tests/core/bake/curve_scenes.h"
#include "tests/support/error_of.h"

namespace rimlight {
namespace {

using test::error_of;
using ::testing::HasSubstr;

TEST(EditableMaterials, AreThoseNamedOrAllWithAGloss) {
  auto scene = test::curve_scene();
  const auto names = [&] {
    std::vector<std::string> result;
    for (const CurveMaterial& one : find_editable_materials(*scene).materials) {
      result.push_back(one.name);
    }
    return result;
  };
  EXPECT_EQ(names(), (std::vector<std::string>{"pearl", "gold", "cloth"}));
  scene->bake.editable = {"floor", "pearl", "floor"};
  EXPECT_EQ(names(), (std::vector<std::string>{"pearl", "floor"}));
  const MaterialSet set = find_editable_materials(*scene).set();
  EXPECT_TRUE(set.has(test::kPearl) && set.has(test::kFloor) && !set.has(test::kGold));
}

TEST(EditableMaterials, ThatAreMeasuredAreKeptInFactorsAlone) {
  const auto scene = test::curve_scene();
  scene->bake.editable = {"cloth"};
  const CurveMaterial found = find_editable_materials(*scene).materials.front();
  ASSERT_TRUE(found.measured.has_value());
  EXPECT_EQ(found.measured->rest, scene->materials[test::kCloth].measured->factors().rest);
  EXPECT_EQ(found.measured_name, "linen");
  EXPECT_EQ(found.brdf.model, BrdfModel::lambert);  // nothing that points into the scene
  EXPECT_EQ(found.brdf.measured, nullptr);
}

TEST(EditableMaterials, ThatThereAreNoneOfIsAnError) {
  auto scene = test::curve_scene();
  const auto error = [&] { return error_of([&] { find_editable_materials(*scene); }); };
  scene->bake.editable = {"pearl", "brass"};
  EXPECT_THAT(error(), HasSubstr("ball: editable: found \"brass\""));
  scene->bake.editable = {};
  scene->bake.cube_size = 4;
  EXPECT_THAT(error(), HasSubstr("cube_size: found 4, expected at least 8"));
  scene->bake.cube_size = 8;
  for (Material& material : scene->materials) material.brdf.model = BrdfModel::lambert;
  EXPECT_THAT(error(), HasSubstr("no material with a gloss"));
}

}  // namespace
}  // namespace rimlight
