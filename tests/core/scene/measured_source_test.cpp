// Measured BRDFs in scene sources.
#include "core/scene/measured_source.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>
#include <utility>
#include <vector>

#include "core/scene/scene_source.h"
#include "tests/core/scene/scene_files.h"
#include "tests/support/brdf_files.h"
#include "tests/support/error_of.h"

namespace rimlight {
namespace {

using ::testing::HasSubstr;

class MeasuredSource : public testing::Test {
 protected:
  MeasuredSource() {
    write(folder_, "cloth.bsdf",
          test::rgl_file(test::small_rgl_fields(0.5f, 1, {0.6f, 0.4f, 0.2f})));
    write(folder_, "silk.bsdf",
          test::rgl_file(test::small_rgl_fields(0.7f, 1, {0.2f, 0.4f, 0.6f})));
    write(folder_, "short.binary", "no BRDF");
    write(folder_, "paper.txt", "");
  }

  /// A disc of the material "m".
  Scene parse(const std::string& material, const std::string& measured = "") const {
    return parse_scene(R"({"camera": {"position": [0, 0, 3], "target": [0, 0, 0]},)" +
                           (measured.empty() ? "" : "\"measured\": " + measured + ",") +
                           R"("materials": {"m": )" + material +
                           R"(}, "objects": [{"shape": "disc", "material": "m"}],
                           "environments": ["studio"]})",
                       "scene.json", folder_.path());
  }

  test::TemporaryFolder folder_;
};

constexpr const char* kGrey = R"({"model": "lambert"})";

TEST_F(MeasuredSource, ListsFilesByTheirNamesOrByOthers) {
  const Scene scene = parse(kGrey, R"(["cloth.bsdf", {"file": "silk.bsdf", "name": "blue silk"}])");
  ASSERT_EQ(scene.measured.size(), 2u);
  EXPECT_EQ(scene.measured[0].name, "cloth");
  EXPECT_EQ(scene.measured[1].name, "blue silk");
  for (const MeasuredReflection& one : scene.measured) {
    EXPECT_GT(one.lobe->factors().valid_share, 0.9);
    EXPECT_GT(one.lobe->factors().error.relative.x, 0);
  }
  const Vec3f red = scene.measured[0].lobe->evaluate({0, 0, 1}, {0, 0, 1});
  EXPECT_NEAR(red.x / red.z, 3, 0.01);
  EXPECT_TRUE(parse(kGrey).measured.empty());
}

TEST_F(MeasuredSource, MaterialsNameOneOrBringTheirOwn) {
  const Scene named = parse(R"({"model": "measured", "measured": "cloth"})", R"(["cloth.bsdf"])");
  EXPECT_EQ(named.materials[0].brdf.model, BrdfModel::measured);
  EXPECT_EQ(named.materials[0].brdf.measured, named.measured[0].lobe.get());
  EXPECT_EQ(named.materials[0].measured, named.measured[0].lobe);
  EXPECT_EQ(named.materials[0].measured_name, "cloth");
  const Scene own = parse(R"({"model": "measured", "file": "silk.bsdf"})", R"(["cloth.bsdf"])");
  ASSERT_EQ(own.measured.size(), 2u);
  EXPECT_EQ(own.measured[1].name, "silk");
  EXPECT_EQ(own.materials[0].brdf.measured, own.measured[1].lobe.get());
  const Scene same = parse(R"({"model": "measured", "file": "cloth.bsdf"})",
                           R"([{"file": "cloth.bsdf", "name": "shared"}])");
  EXPECT_EQ(same.measured.size(), 1u);
  EXPECT_EQ(same.materials[0].measured_name, "shared");
}

TEST_F(MeasuredSource, ErrorsNameTheFieldAndTheFile) {
  using Case = std::pair<std::string, std::vector<std::string>>;
  for (const auto& [list, expected] : std::vector<Case>{
           {R"(["none.bsdf"])", {"/measured/0", "none.bsdf"}},
           {R"(["cloth.bsdf", "short.binary"])", {"/measured/1", "short.binary", "34992012"}},
           {R"(["paper.txt"])", {"/measured/0", "paper.txt", ".binary, .brdf or .bsdf"}},
           {R"([])", {"/measured"}},
           {R"([3])", {"/measured/0"}},
           {R"("cloth.bsdf")", {"/measured"}},
           {R"([{"file": "cloth.bsdf", "name": ""}])", {"/measured/0/name"}},
           {R"([{"name": "cloth"}])", {"/measured/0", "\"file\""}},
           {R"([{"file": "cloth.bsdf", "layout": 1}])", {"/measured/0", "layout"}},
           {R"(["cloth.bsdf", {"file": "silk.bsdf", "name": "cloth"}])",
            {"/measured/1", "\"cloth\" twice"}}}) {
    const std::string error = test::error_of([&, text = list] { parse(kGrey, text); });
    for (const std::string& part : expected) EXPECT_THAT(error, HasSubstr(part)) << list;
  }
  for (const auto& [fields, expected] : std::vector<Case>{
           {"", {"/materials/m", "one of \"measured\" and \"file\""}},
           {R"(, "measured": "silk")", {"/materials/m/measured", "found \"silk\""}},
           {R"(, "measured": "cloth", "file": "cloth.bsdf")", {"/materials/m", "one of"}},
           {R"(, "file": "none.bsdf")", {"/materials/m/file", "none.bsdf"}},
           {R"(, "file": "cloth.bsdf", "albedo": 0.5)", {"/materials/m", "albedo"}},
           {R"(, "file": "cloth.bsdf", "texture": "a.png")", {"/materials/m", "texture"}}}) {
    const std::string error = test::error_of(
        [&, text = fields] { parse(R"({"model": "measured")" + text + "}", R"(["cloth.bsdf"])"); });
    for (const std::string& part : expected) EXPECT_THAT(error, HasSubstr(part)) << fields;
  }
}

}  // namespace
}  // namespace rimlight
