#include "server/protocol/view_edits.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "server/protocol/frame_message.h"
#include "server/protocol/messages.h"
#include "server/session/baked_scene.h"
#include "tests/core/vertices/vertex_case.h"
#include "tests/support/error_of.h"

namespace rimlight::server {
namespace {

using rimlight::test::error_of;
using testing::HasSubstr;

const std::vector<std::string> kEnvironments{"day"};
const KnownMaterials kMaterials{{"brass", "clay"}};

Edit parsed(const std::string& members, const KnownMaterials& materials = kMaterials) {
  return std::get<Edit>(
      parse_client_message(R"({"type":"edit",)" + members + "}", kEnvironments, materials));
}

const std::string kView =
    R"("view":{"camera":{"position":[1,2,3],"target":[0,1,0],"up":[0,2,0],"fov":50}})";

TEST(ViewEdits, AViewComesBackAsItWasSent) {
  const Camera expected{{1, 2, 3}, {0, 1, 0}, {0, 2, 0}, 50};
  const Edit edit = parsed(kView);
  ASSERT_TRUE(edit.view && *edit.view);
  EXPECT_EQ(**edit.view, expected);
  DesignState state;
  apply_edit(edit, state);
  EXPECT_EQ(state.view, expected);
  EXPECT_EQ(parsed("\"view\":" + state_to_json(state)["view"].dump()), edit);
  apply_edit(parsed(R"("view":{"camera":null})"), state);
  EXPECT_EQ(state, DesignState());
}

TEST(ViewEdits, MaterialsAreSetPieceByPieceAndTakenBackWhole) {
  DesignState state;
  apply_edit(parsed(R"("material":{"parameter":{"brass":{"albedo":[0.5,0.25,0]},
                                               "clay":{"exponent":7}}})"),
             state);
  apply_edit(parsed(R"("material":{"parameter":{"brass":{"highlight":[0,0,1],"exponent":30}}})"),
             state);
  EXPECT_EQ(state.materials["brass"], (MaterialEdit{Vec3f{0.5f, 0.25f, 0}, Vec3f{0, 0, 1}, 30.0}));
  EXPECT_EQ(state.materials["clay"], (MaterialEdit{std::nullopt, std::nullopt, 7.0}));
  DesignState again;
  apply_edit(parsed("\"material\":" + state_to_json(state)["material"].dump()), again);
  EXPECT_EQ(again, state);
  state.environment = "day";
  state.view = Camera{{1, 2, 3}, {0, 1, 0}, {0, 2, 0}, 50};
  state.rotation = {0, 1, 0, 0};
  const nlohmann::json text = state_to_json(state);
  EXPECT_EQ(read_state(JsonReader(text, "state")), state);
  apply_edit(parsed(R"("material":{"parameter":{"brass":null}})"), state);
  EXPECT_EQ(state.materials.size(), 1u);
}

TEST(ViewEdits, ALobeAndAnExponentTakeEachOthersPlace) {
  DesignState state;
  const auto apply = [&](const std::string& of_clay) {
    apply_edit(parsed(R"("material":{"parameter":{"clay":)" + of_clay + "}}"), state);
    return state.materials["clay"];
  };
  const std::vector<double> ring{0, 0.1, 1e6, 0};
  EXPECT_EQ(apply(R"({"exponent":7})"), (MaterialEdit{{}, {}, 7.0}));
  EXPECT_EQ(apply(R"({"lobe":[0,0.1,1e6,0]})"), (MaterialEdit{{}, {}, 7.0, ring}));
  DesignState again;
  apply_edit(parsed("\"material\":" + state_to_json(state)["material"].dump()), again);
  EXPECT_EQ(again, state);
  state.environment = "day";
  const nlohmann::json text = state_to_json(state);
  EXPECT_EQ(read_state(JsonReader(text, "state")), state);
  EXPECT_EQ(apply(R"({"lobe":null})"), (MaterialEdit{{}, {}, 7.0})) << "back to the exponent";
  apply(R"({"lobe":[0,1]})");
  EXPECT_EQ(apply(R"({"exponent":8})"), (MaterialEdit{{}, {}, 8.0}));
  EXPECT_EQ(apply(R"({"exponent":9,"lobe":[0,1]})"),
            (MaterialEdit{{}, {}, 9.0, std::vector<double>{0, 1}}));
  apply("null");
  apply(R"({"lobe":[0,1]})");
  apply_edit(parsed(R"("material":{"parameter":{"clay":{"lobe":null}}})"), state);
  EXPECT_TRUE(state.materials.empty()) << "an edit of nothing is none";
}

struct BadEdit {
  const char* members;
  const char* error;  // part of what() must be this
};

class BadViewEdits : public testing::TestWithParam<BadEdit> {};

TEST_P(BadViewEdits, GetAnErrorThatNamesTheField) {
  EXPECT_THAT(error_of([] { parsed(GetParam().members); }), HasSubstr(GetParam().error));
}

INSTANTIATE_TEST_SUITE_P(
    Table, BadViewEdits,
    testing::Values(
        BadEdit{R"("view":7)", "/view"}, BadEdit{R"("view":{})", "no \"camera\""},
        BadEdit{R"("view":{"camera":{"position":[0,0,1],"target":[0,0,0],"up":[0,1,0]}})",
                "\"fov\""},
        BadEdit{R"("view":{"camera":{"position":[0,0,1],"target":[0,0,1],"up":[0,1,0],"fov":40}})",
                "/view/camera/target: found the position itself"},
        BadEdit{R"("view":{"camera":{"position":[0,0,1],"target":[0,0,0],"up":[0,0,2],"fov":40}})",
                "/view/camera/up"},
        BadEdit{
            R"("view":{"camera":{"position":[0,0,1e10],"target":[0,0,0],"up":[0,1,0],"fov":40}})",
            "/view/camera/position/2"},
        BadEdit{R"("view":{"camera":{"position":[0,0,1],"target":[0,0,0],"up":[0,1,0],"fov":180}})",
                "/view/camera/fov"},
        BadEdit{R"("material":{})", "parameter, curve or load"},
        BadEdit{R"("material":{"parameter":{}})", "of 1 to 256 materials"},
        BadEdit{R"("material":{"parameter":{"gold":null}})", "one of \"brass\" \"clay\""},
        BadEdit{R"("material":{"parameter":{"clay":{}}})", "one or more of albedo"},
        BadEdit{R"("material":{"parameter":{"clay":{"shine":1}}})", "unknown field \"shine\""},
        BadEdit{R"("material":{"parameter":{"clay":{"albedo":[0,0,1.01]}}})",
                "/material/parameter/clay/albedo/2"},
        BadEdit{R"("material":{"parameter":{"clay":{"highlight":[0,-1,0]}}})",
                "/material/parameter/clay/highlight/1"},
        BadEdit{R"("material":{"parameter":{"clay":{"exponent":1e5}}})",
                "/material/parameter/clay/exponent"},
        BadEdit{R"("material":{"parameter":{"clay":{"lobe":7}}})", "/material/parameter/clay/lobe"},
        BadEdit{R"("material":{"parameter":{"clay":{"lobe":[]}}})",
                "/material/parameter/clay/lobe"},
        BadEdit{R"("material":{"parameter":{"clay":{"lobe":[1]}}})",
                "/material/parameter/clay/lobe"},
        BadEdit{R"("material":{"parameter":{"clay":{"lobe":[0,0,0]}}})",
                "/material/parameter/clay/lobe: found nothing but zeros"},
        BadEdit{R"("material":{"parameter":{"clay":{"lobe":[0,-1]}}})",
                "/material/parameter/clay/lobe/1"},
        BadEdit{R"("material":{"parameter":{"clay":{"lobe":[1,1,1.1e6]}}})",
                "/material/parameter/clay/lobe/2"},
        BadEdit{R"("material":{"parameter":{"clay":{"lobe":[1,"a"]}}})",
                "/material/parameter/clay/lobe/1"},
        BadEdit{R"("material":{"parameter":{"clay":{"lobe":[0,0,0,0,0,0,0,0,0,0,0,0,0,0,0,0,0,0,0,
          0,0,0,0,0,0,0,0,0,0,0,0,0,0,0,0,0,0,0,0,0,0,0,0,0,0,0,0,0,0,0,0,0,0,0,0,0,0,0,0,0,0,0,0,
          0,0,1]}}})",
                "/material/parameter/clay/lobe"}));

TEST(ViewEdits, ABakeWithoutMaterialsKeepsEditsOfAnyButNotOfTooMany) {
  DesignState state;
  for (std::size_t i = 0; i < kMostMaterials; ++i) {
    const std::string name = "m" + std::to_string(i);
    apply_edit(parsed("\"material\":{\"parameter\":{\"" + name + "\":{\"exponent\":3}}}", {}),
               state);
  }
  EXPECT_EQ(state.materials.size(), kMostMaterials);
  DesignState before = state;
  const Edit one_more =
      parsed(R"("exposure":3,"material":{"parameter":{"other":{"exponent":3}}})", {});
  EXPECT_THAT(error_of([&] { apply_edit(one_more, state); }), HasSubstr("at most 256"));
  EXPECT_EQ(state, before);
  EXPECT_THAT(error_of([&] {
                parsed("\"material\":{\"parameter\":{\"" + std::string(201, 'x') + "\":null}}", {});
              }),
              HasSubstr("201 bytes"));
}

TEST(FrameMessages, SayWhatTheyDoNotShowWithinBounds) {
  FrameHeader header;
  header.width = header.height = 1;
  header.unshown = {"the moved camera", std::string(1000, 'x'), "\xff is not UTF-8"};
  const auto payload = std::make_shared<const std::vector<std::uint8_t>>();
  const FramePtr few = write_frame_message(header, payload);
  const auto read = parse_frame_message(few->bytes(), "frame").header.unshown;
  ASSERT_EQ(read.size(), 3u);
  EXPECT_EQ(read[0], "the moved camera");
  EXPECT_EQ(read[1].size(), kLongestUnshown);
  header.unshown.assign(300, std::string(1000, 'y'));
  const FramePtr many = write_frame_message(header, payload);
  const auto cut = parse_frame_message(many->bytes(), "frame").header.unshown;
  ASSERT_EQ(cut.size(), kMostUnshown);
  EXPECT_EQ(cut.back(), "285 things more");
}

TEST(ServedVertices, TheirSourceDrawsWhatAVertexRendererDoes) {
  const auto vertices = rimlight::test::scene_of();
  const ServedScene scene = serve_vertices("case", vertices, rimlight::test::kVertexSettings);
  EXPECT_EQ(scene.name, "case");
  EXPECT_TRUE(scene.any_view);
  EXPECT_EQ(known_materials(scene).names, (std::vector<std::string>{"brass", "enamel", "floor"}));
  EXPECT_EQ(scene.environments, (std::vector<std::string>{"sky", "dim"}));
  DesignState state;
  state.environment = "dim";
  state.view = Camera{{-2, 1, 3}, {0, 0, 0}, {0, 1, 0}, 50};
  VertexRenderer renderer(vertices, rimlight::test::kVertexSettings);
  const auto source = scene.make_source();
  Rgb8Image expected, frame;
  FrameReport report;
  ASSERT_TRUE(renderer.render_exact(state, expected, report));
  ASSERT_TRUE(source->render_exact(state, frame, report, {}));
  EXPECT_EQ(frame.bytes, expected.bytes);
  renderer.render_moving(state, expected);
  source->render_moving(state, frame);
  EXPECT_EQ(frame.bytes, expected.bytes);
}

TEST(ServedVertices, ANameThatFitsNoUrlIsRefused) {
  const VertexScene vertices = rimlight::test::VertexCase().scene;
  EXPECT_THAT(error_of([&] {
                serve_vertices("a b", std::make_shared<const VertexScene>(vertices),
                               rimlight::test::kVertexSettings);
              }),
              HasSubstr("to stand in a URL"));
}

}  // namespace
}  // namespace rimlight::server
