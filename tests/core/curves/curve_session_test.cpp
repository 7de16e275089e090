#include "core/curves/curve_session.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

#include "core/base/files.h"
#include "core/curves/curve_session_source.h"
#include "tests/support/error_of.h"

namespace rimlight {
namespace {

using ::testing::HasSubstr;
using ::testing::StartsWith;

CurveSession parse(const std::string& edits) {
  return parse_curve_session(R"({"edits": [)" + edits + "]}", "session");
}

const char* const kPoints =
    R"({"material": "m", "axis": "half_angle", "scale": "logarithmic", "rest": 2,
        "points": [[0, 8], [0.5, [1, 2, 4]], [1, 0]]})";
const char* const kDrag =
    R"({"material": "m", "axis": "half_angle", "drag": [[1, 0.25, [4, 2, 1]]], "frames": 9,
        "rest": 3, "title": "dragged"})";

TEST(CurveSession, PlacesEachFrameInItsStroke) {
  const CurveSession session = parse(std::string(kPoints) + "," + kDrag);
  EXPECT_EQ(session.name, "session");
  ASSERT_EQ(session.frame_count(), 1 + 2 + 9 + 3);
  for (int frame = 0; frame < session.frame_count(); ++frame) {
    const auto place = session.place(frame);
    EXPECT_EQ(place.stroke, frame < 3 ? 0u : 1u) << frame;
    EXPECT_EQ(place.step, frame < 3 ? frame : frame - 3) << frame;
    EXPECT_EQ(place.is_moving, frame == 0 || (frame >= 3 && frame < 12)) << frame;
  }
  EXPECT_EQ(session.strokes[1].title, "dragged");
  EXPECT_EQ(session.strokes[0].title, "m");
  EXPECT_EQ(session.materials(), std::vector<std::string>{"m"});
}

TEST(CurveSession, DragsGoEasedFromCurveToCurveAndStay) {
  const CurveStroke stroke = parse(std::string(kPoints) + "," + kDrag).strokes[1];
  double before = 0.5;
  for (int step = 0; step < stroke.frames; ++step) {
    const CurveEdit curve = stroke.at(step);
    ASSERT_EQ(curve.points.size(), 3u);
    EXPECT_EQ(curve.points[0], stroke.from.points[0]);
    EXPECT_EQ(curve.points[2], stroke.from.points[2]);
    const CurvePoint& dragged = curve.points[1];
    EXPECT_LT(dragged.position, before) << step;  // every frame is an edit
    before = dragged.position;
    // On the logarithmic scale red and blue, which change places, keep their product.
    EXPECT_NEAR(dragged.value.x * dragged.value.z, 4, 1e-12) << step;
    EXPECT_DOUBLE_EQ(dragged.value.y, 2);
    check_curve_points(curve.points, "step");
  }
  // Eased: 3x² − 2x³ at a third of the way.
  EXPECT_NEAR(stroke.at(2).points[1].position, 0.5 - 0.25 * (7.0 / 27), 1e-12);
  EXPECT_EQ(stroke.at(stroke.frames - 1), stroke.to);
  EXPECT_EQ(stroke.at(stroke.frames + 2), stroke.to);
}

TEST(CurveSession, LinearDragsToZeroAndLogarithmicOnesStayFinite) {
  for (const char* const scale : {"linear", "logarithmic"}) {
    const CurveStroke stroke =
        parse(R"({"material": "m", "axis": "difference_angle", "scale": ")" + std::string(scale) +
              R"(", "points": [[0, 1000000], [1, 0]]},
                {"material": "m", "axis": "difference_angle", "frames": 50,
                 "drag": [[0, 0, 0], [1, 1, 1000000]]})")
            .strokes[1];
    for (int step = 0; step < stroke.frames; ++step) {
      const CurveEdit curve = stroke.at(step);
      check_curve_points(curve.points, "step");
      for (const Vec3f& value : curve_of(stroke.axis, curve).values) {
        EXPECT_TRUE(is_finite(value)) << scale << step;
      }
    }
  }
}

TEST(CurveSession, EachCurveIsDraggedFromItsOwnPoints) {
  const CurveSession session = parse(
      R"({"material": "a", "axis": "half_angle", "points": [[0, 1], [1, 2]]},
         {"material": "b", "axis": "half_angle", "points": [[0, 3], [1, 4]]},
         {"material": "a", "axis": "difference_angle", "points": [[0.5, 5]]},
         {"material": "a", "axis": "half_angle", "drag": [[0, 0, 7]]},
         {"material": "a", "axis": "half_angle", "drag": [[1, 0.9, 8]]})");
  const CurveEdit& last = session.strokes[4].to;
  ASSERT_EQ(last.points.size(), 2u);
  EXPECT_EQ(last.points[0], (CurvePoint{0, {7, 7, 7}}));
  EXPECT_EQ(last.points[1], (CurvePoint{0.9, {8, 8, 8}}));
  EXPECT_EQ(session.materials(), (std::vector<std::string>{"a", "b"}));
}

struct BadEdit {
  std::string edits, pointer;
};

TEST(CurveSession, BadOnesAreRefusedAtTheirPointer) {
  const std::string points = kPoints;
  const std::string half = R"("material": "m", "axis": "half_angle", )";
  const std::vector<BadEdit> cases = {
      {"", "/edits"},
      {"3", "/edits/0"},
      {R"({"axis": "half_angle", "points": [[0, 1]]})", "/edits/0"},
      {R"({"material": "", "axis": "half_angle", "points": [[0, 1]]})", "/edits/0/material"},
      {R"({"material": "m", "axis": "theta", "points": [[0, 1]]})", "/edits/0/axis"},
      {"{" + half + R"("points": []})", "/edits/0/points"},
      {"{" + half + R"("points": [[0, 1], [0, 2]]})", "/edits/0/points/1"},
      {"{" + half + R"("points": [[0.5, 1], [0.2, 2]]})", "/edits/0/points/1"},
      {"{" + half + R"("points": [[1.5, 1]]})", "/edits/0/points/0/0"},
      {"{" + half + R"("points": [[0, -1]]})", "/edits/0/points/0/1"},
      {"{" + half + R"("points": [[0, 1e7]]})", "/edits/0/points/0/1"},
      {"{" + half + R"("points": [[0, [1, 2]]]})", "/edits/0/points/0/1"},
      {"{" + half + R"("points": [[0, 1, 2]]})", "/edits/0/points/0"},
      {"{" + half + R"("points": [[0, 1]], "frames": 2})", "/edits/0/frames"},
      {"{" + half + R"("points": [[0, 1]], "rest": -1})", "/edits/0/rest"},
      {"{" + half + R"("points": [[0, 1]], "scale": "square"})", "/edits/0/scale"},
      {"{" + half + R"("points": [[0, 1]], "colour": 1})", "/edits/0"},
      {"{" + half + R"("points": [[0, 1]], "drag": [[0, 0, 1]]})", "/edits/0"},
      {"{" + half + R"("rest": 1})", "/edits/0"},
      {"{" + half + R"("drag": [[0, 0, 1]]})", "/edits/0/drag"},
      {points + ",{" + half + R"("drag": [[3, 0, 1]]})", "/edits/1/drag/0/0"},
      {points + ",{" + half + R"("drag": [[1, 1, 1]]})", "/edits/1/drag"},
      {points + ",{" + half + R"("drag": [[1, 0.5]]})", "/edits/1/drag/0"},
      {points + ",{" + half + R"("drag": [[1, 0.5, 1]], "frames": 0})", "/edits/1/frames"},
      {points + ",{" + half + R"("drag": [[1, 0.5, 1]], "scale": "linear"})", "/edits/1/scale"},
  };
  for (const BadEdit& bad : cases) {
    EXPECT_THAT(test::error_of([&] { parse(bad.edits); }),
                StartsWith("session: " + bad.pointer + ": found"))
        << bad.edits;
  }
}

TEST(CurveSession, TooManyFramesAreRefused) {
  std::string edits = kPoints;
  for (int i = 0; i < 6; ++i) {
    edits += R"(,{"material": "m", "axis": "half_angle", "drag": [[1, 0.5, 1]], "frames": 1000,
                  "rest": 1000})";
  }
  EXPECT_THAT(test::error_of([&] { parse(edits); }), HasSubstr("at most 10000 frames"));
}

TEST(CurveSession, BuiltInOnesAreReadAndOthersNamed) {
  const auto& names = builtin_curve_session_names();
  ASSERT_THAT(names, testing::Contains("pearl"));
  for (const std::string& name : names) {
    EXPECT_EQ(find_curve_session(name, "--session").name, name);
    EXPECT_EQ(read_curve_session("configs/edits/" + name + ".json").frame_count(),
              find_curve_session(name, "--session").frame_count());
  }
  EXPECT_THAT(test::error_of([] { find_curve_session("opal", "--session"); }),
              testing::AllOf(HasSubstr("--session: found \"opal\""), HasSubstr("\"pearl\"")));
}

TEST(CurveSession, TheDocumentedExampleIsRead) {
  const std::string page = read_file("docs/formats/curve_session.md", 1 << 20);
  const std::size_t begin = page.find("```json\n");
  ASSERT_NE(begin, std::string::npos);
  const std::size_t end = page.find("```", begin + 8);
  const CurveSession session =
      parse_curve_session(page.substr(begin + 8, end - begin - 8), "page.md");
  EXPECT_EQ(session.name, "Two strokes");
  ASSERT_EQ(session.strokes.size(), 2u);
  EXPECT_EQ(session.frame_count(), 1 + 12 + 30 + 12);
}

}  // namespace
}  // namespace rimlight
