#include "server/protocol/curve_edits.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/math/random.h"
#include "server/protocol/messages.h"
#include "tests/server/curve_sphere.h"
#include "tests/support/error_of.h"

namespace rimlight::server {
namespace {

using nlohmann::json;
using rimlight::test::error_of;
using testing::HasSubstr;

const std::vector<std::string> kEnvironments{"day"};

const KnownMaterials& known() {
  static const KnownMaterials kKnown = known_materials(test::curve_sphere_scene("curves", 8));
  return kKnown;
}

Edit parsed(const std::string& material, const KnownMaterials& materials = known()) {
  return std::get<Edit>(parse_client_message(R"({"type":"edit","material":)" + material + "}",
                                             kEnvironments, materials));
}

/// The state comes back from its own text, as an edit and as a state.
void expect_round_trip(DesignState state, const KnownMaterials& materials = known()) {
  state.environment = "day";
  const json text = state_to_json(state);
  EXPECT_EQ(read_state(JsonReader(text, "state")), state) << text;
  DesignState again;
  again.environment = "day";
  apply_edit(parsed(text["material"].dump(), materials), again);
  EXPECT_EQ(again, state) << text;
}

json random_values(Random& random, std::size_t count) {
  json values = json::array();
  for (std::size_t i = 0; i < count; ++i) {
    values.push_back({random.uniform(0, 1e6), random.uniform(0, 1), 0});
  }
  return values;
}

TEST(CurveEdits, PointsAndValuesComeBackAsTheyWereSent) {
  Random random(3);
  json points = json::array();
  for (int i = 0; i < 256; ++i) {
    points.push_back({i / 255.0, random.uniform(0, 1e6), random.uniform(0, 1), 0});
  }
  const json edit{
      {"curve",
       {{"pearl",
         {{"half_angle", {{"scale", "logarithmic"}, {"points", points}}},
          {"difference_angle", {{"values", random_values(random, 256)}}}}},
        {"red & blue", {{"half_angle", {{"scale", "linear"}, {"points", {{0.5, 1, 2, 3}}}}}}}}}};
  DesignState state;
  apply_edit(parsed(edit.dump()), state);
  const MaterialEdit& pearl = state.materials["pearl"];
  ASSERT_TRUE(pearl.half_angle && pearl.difference_angle);
  EXPECT_EQ(pearl.half_angle->scale, CurveScale::logarithmic);
  ASSERT_EQ(pearl.half_angle->points.size(), 256u);
  EXPECT_EQ(pearl.half_angle->points[9].value.x, points[9][1]);
  EXPECT_TRUE(pearl.half_angle->values.empty());
  EXPECT_EQ(pearl.difference_angle->values.size(), 256u);
  EXPECT_EQ(state.materials["red & blue"].half_angle->points,
            (std::vector<CurvePoint>{{0.5, {1, 2, 3}}}));
  EXPECT_EQ(state_to_json(state)["material"]["curve"]["pearl"]["half_angle"],
            edit["curve"]["pearl"]["half_angle"]);
  expect_round_trip(state);
}

TEST(CurveEdits, ACurveIsTakenBackByNullAndTheOtherAxisStays) {
  DesignState state;
  const std::string flat = R"({"scale":"linear","points":[[0,1,1,1]]})";
  apply_edit(parsed(R"({"curve":{"pearl":{"half_angle":)" + flat + R"(,"difference_angle":)" +
                    flat + "}}}"),
             state);
  apply_edit(parsed(R"({"curve":{"pearl":{"half_angle":null}}})"), state);
  EXPECT_FALSE(state.materials["pearl"].half_angle);
  EXPECT_TRUE(state.materials["pearl"].difference_angle);
  apply_edit(parsed(R"({"curve":{"pearl":{"difference_angle":null}}})"), state);
  EXPECT_TRUE(state.materials.empty()) << "an edit of nothing is none";
}

TEST(CurveEdits, ParametersOfBrdfsComeBackAndAnIndexMayBeOneNumber) {
  DesignState state;
  apply_edit(parsed(R"({"parameter":{
      "pearl":{"specular":[1,0.5,0],"roughness":0.0001,"eta":1.7,"k":[0,50,100]},
      "brushed":{"roughness":1,"roughness_across":0.2,"exponent":100000,"exponent_across":1}}})"),
             state);
  const MaterialEdit& pearl = state.materials["pearl"];
  EXPECT_EQ(pearl.specular, Vec3f(Vec3d{1, 0.5, 0}));
  EXPECT_EQ(pearl.roughness, 0.0001);
  EXPECT_EQ(pearl.eta, Vec3f::filled(1.7f));
  EXPECT_EQ(pearl.k, Vec3f(Vec3d{0, 50, 100}));
  const MaterialEdit& brushed = state.materials["brushed"];
  EXPECT_EQ(brushed.roughness_across, 0.2);
  EXPECT_EQ(brushed.exponent_across, 1);
  EXPECT_EQ(brushed.exponent, 100000);
  expect_round_trip(state);
}

TEST(CurveEdits, EveryRangeHoldsItsOwnEnds) {
  for (const char* const eta : {"0.05", "100"}) {
    DesignState state;
    apply_edit(parsed(std::string(R"({"parameter":{"pearl":{"k":100,"eta":)") + eta + "}}}"),
               state);
    expect_round_trip(state);
  }
}

TEST(CurveEdits, TakingAllBackComesBeforeWhatIsSetInTheSameEdit) {
  DesignState state;
  apply_edit(parsed(R"({"parameter":{"pearl":{"roughness":0.5}},"load":{"pearl":"gold"},
                        "curve":{"pearl":{"half_angle":{"scale":"linear","points":[[0,1,1,1]]}}}})"),
             state);
  EXPECT_EQ(state.materials["pearl"].measured, "gold");
  expect_round_trip(state);
  apply_edit(parsed(R"({"parameter":{"pearl":null},"load":{"pearl":"gold"}})"), state);
  MaterialEdit only;
  only.measured = "gold";
  EXPECT_EQ(state.materials["pearl"], only);
  apply_edit(parsed(R"({"load":{"pearl":null}})"), state);
  EXPECT_TRUE(state.materials.empty());
}

struct BadEdit {
  std::string material;
  const char* error;  // part of what() must be this
};

std::string curve(const std::string& text, const std::string& name = "pearl") {
  return R"({"curve":{")" + name + R"(":{"half_angle":)" + text + "}}}";
}
std::string parameter(const std::string& text) {
  return R"({"parameter":{"pearl":{)" + text + "}}}";
}
std::string many(const std::string& first, const std::string& each, int count) {
  std::string text = "[" + first;
  for (int i = 1; i < count; ++i) text += "," + each;
  return text + "]";
}

class BadCurveEdits : public testing::TestWithParam<BadEdit> {};

TEST_P(BadCurveEdits, GetAnErrorThatNamesTheField) {
  EXPECT_THAT(error_of([] { parsed(GetParam().material); }), HasSubstr(GetParam().error));
}

INSTANTIATE_TEST_SUITE_P(
    Curves, BadCurveEdits,
    testing::Values(
        BadEdit{curve(R"({"values":)" + many("[1,1,1]", "[1,1,1]", 257) + "}"),
                "/material/curve/pearl/half_angle/values: found 257 bins"},
        BadEdit{curve(R"({"values":)" + many("[1,1,1]", "[1,1,1]", 255) + "}"), "255 bins"},
        BadEdit{curve(R"({"values":)" + many("[1,-1,1]", "[1,1,1]", 256) + "}"), "/values/0"},
        BadEdit{curve(R"({"values":)" + many("[1,1]", "[1,1,1]", 256) + "}"), "/values/0"},
        BadEdit{curve(R"({"values":)" + many("[1,1,1e999]", "[1,1,1]", 256) + "}"), "message"},
        BadEdit{curve(R"({"values":)" + many("[1,1,1000001]", "[1,1,1]", 256) + "}"), "/values/0"},
        BadEdit{curve(R"({"values":[],"scale":"linear"})"), "unknown field \"scale\""},
        BadEdit{curve(R"({"scale":"linear","points":[]})"), "/points: found 0 points"},
        BadEdit{curve(R"({"scale":"linear","points":)" + many("[0,1,1,1]", "[1,1,1,1]", 257) + "}"),
                "found 257 points"},
        BadEdit{curve(R"({"scale":"linear","points":[[0.5,1,1,1],[0.5,1,1,1]]})"), "/points/1"},
        BadEdit{curve(R"({"scale":"linear","points":[[0.5,1,1,1],[0.4,1,1,1]]})"), "/points/1"},
        BadEdit{curve(R"({"scale":"linear","points":[[1.01,1,1,1]]})"), "/points/0"},
        BadEdit{curve(R"({"scale":"linear","points":[[0,1,1]]})"), "/points/0"},
        BadEdit{curve(R"({"scale":"linear","points":[[0,1,1,null]]})"), "/points/0/3"},
        BadEdit{curve(R"({"scale":"linear","points":[[0,1,1,-1e-9]]})"), "/points/0"},
        BadEdit{curve(R"({"scale":"square","points":[[0,1,1,1]]})"), "/half_angle/scale"},
        BadEdit{curve(R"({"points":[[0,1,1,1]]})"), "no \"scale\""},
        BadEdit{curve("7"), "/material/curve/pearl/half_angle"},
        BadEdit{curve("null", "iron"), "one of \"pearl\""},
        BadEdit{R"({"curve":{"pearl":{}}})", "one or both of half_angle"},
        BadEdit{R"({"curve":{"pearl":null}})", "/material/curve/pearl"},
        BadEdit{R"({"curve":{"pearl":{"theta":null}}})", "unknown field \"theta\""},
        BadEdit{R"({"curve":{}})", "of 1 to 256 materials"},
        BadEdit{R"({"load":{"pearl":"iron"}})", "null or one of \"gold\""},
        BadEdit{R"({"load":{"pearl":7}})", "/material/load/pearl"},
        BadEdit{R"({"load":{"iron":"gold"}})", "one of \"pearl\""},
        BadEdit{R"({"look":{"iron":"gold"}})", "unknown field \"look\""}));

INSTANTIATE_TEST_SUITE_P(
    Parameters, BadCurveEdits,
    testing::Values(BadEdit{parameter(R"("roughness":0)"), "/material/parameter/pearl/roughness"},
                    BadEdit{parameter(R"("roughness":1.1)"), "/roughness"},
                    BadEdit{parameter(R"("roughness_across":0.00009)"), "/roughness_across"},
                    BadEdit{parameter(R"("eta":0.04)"), "/eta"},
                    BadEdit{parameter(R"("eta":[1,1,101])"), "/eta/2"},
                    BadEdit{parameter(R"("eta":[1,1])"), "/eta"},
                    BadEdit{parameter(R"("eta":1e999)"), "message"},
                    BadEdit{parameter(R"("k":-1)"), "/k"}, BadEdit{parameter(R"("k":"a")"), "/k"},
                    BadEdit{parameter(R"("specular":[0,0,1.1])"), "/specular/2"},
                    BadEdit{parameter(R"("specular":1)"), "/specular"},
                    BadEdit{parameter(R"("exponent":0.9)"), "/exponent"},
                    BadEdit{parameter(R"("exponent":100001)"), "/exponent"},
                    BadEdit{parameter(R"("exponent_across":0)"), "/exponent_across"}));

TEST(CurveEdits, OnlyFactorsThatAMaterialHasCanBeDrawnWhereNothingIsMeasured) {
  ServedScene scene = test::curve_sphere_scene("curves", 8);
  scene.measured.clear();
  const KnownMaterials bare = known_materials(scene);
  const auto error = [&](const char* axis, const char* name) {
    return error_of([&] {
      parsed(std::string(R"({"curve":{")") + name + "\":{\"" + axis + "\":null}}}", bare);
    });
  };
  EXPECT_EQ(error("half_angle", "pearl"), "no error");
  EXPECT_EQ(error("half_angle", "red & blue"), "no error");
  EXPECT_THAT(error("difference_angle", "red & blue"), HasSubstr("a factor over difference_angle"));
  EXPECT_THAT(error("half_angle", "brushed"), HasSubstr("/material/curve/brushed/half_angle"));
  EXPECT_THAT(error_of([&] { parsed(R"({"load":{"pearl":"gold"}})", bare); }),
              HasSubstr("this scene has none"));
}

TEST(CurveEdits, ScenesThatShowNoneKeepThemButNotTooMany) {
  DesignState state;
  const std::string axes = R"(":{"half_angle":{"scale":"linear","points":[[0,1,1,1]]},)"
                           R"("difference_angle":{"scale":"linear","points":[[0,1,1,1]]}}}})";
  for (std::size_t i = 0; i < kMostDrawnCurves / 2; ++i) {
    apply_edit(parsed("{\"curve\":{\"m" + std::to_string(i) + axes, {}), state);
  }
  apply_edit(parsed(R"({"load":{"m0":"anything"},"parameter":{"m0":{"exponent":100000}}})", {}),
             state);
  expect_round_trip(state, {});
  const DesignState before = state;
  const Edit one_more = parsed("{\"curve\":{\"more" + axes, {});
  EXPECT_THAT(error_of([&] { apply_edit(one_more, state); }), HasSubstr("at most 64"));
  EXPECT_EQ(state, before);
  const KnownMaterials others{{"brass"}};
  EXPECT_EQ(error_of([&] { parsed("{\"curve\":{\"brass" + axes, others); }), "no error");
  EXPECT_NE(error_of([&] { parsed("{\"curve\":{\"clay" + axes, others); }), "no error");
  EXPECT_NE(error_of([&] { parsed(R"({"parameter":{"brass":{"exponent":20000}}})", others); }),
            "no error");
}

TEST(CurveEdits, TheWelcomeSaysWhatCanBeEdited) {
  ServedScene scene = test::curve_sphere_scene("curves", 8);
  scene.editable[1].measured = test::made_up_measured();
  Welcome welcome;
  welcome.editable = scene.editable;
  welcome.measured = {"gold"};
  const json text = json::parse(write_welcome(welcome));
  EXPECT_EQ(text["measured"], json({"gold"}));
  const json& editable = text["editable"];
  ASSERT_EQ(editable.size(), 3u);
  EXPECT_EQ(editable[0]["name"], "pearl");
  EXPECT_EQ(editable[0]["model"], "cook_torrance");
  EXPECT_EQ(editable[0]["eta"][2], 1.6f);
  EXPECT_EQ(editable[0]["roughness"], 0.3f);
  EXPECT_EQ(editable[0]["axes"], json({"half_angle", "difference_angle"}));
  EXPECT_EQ(editable[1]["model"], "measured");
  EXPECT_EQ(editable[1]["axes"], json({"half_angle", "difference_angle"}));
  EXPECT_EQ(editable[2]["model"], "ward");
  EXPECT_EQ(editable[2]["axes"], json::array());
}

}  // namespace
}  // namespace rimlight::server
