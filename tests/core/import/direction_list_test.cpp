// Lists of light directions in every form, and what is wrong with the others.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>

#include "core/base/files.h"
#include "core/import/direction_list.h"
#include "tests/core/import/npy_bytes.h"
#include "tests/support/error_of.h"
#include "tests/support/overwrite.h"
#include "tests/support/temporary_folder.h"

namespace rimlight {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

void expect_near(const Vec3d& a, const Vec3d& b) { EXPECT_LT(length(a - b), 1e-12); }

DirectionList of_text(const std::string& text, DirectionAxes axes = DirectionAxes::y_up) {
  return parse_direction_text(text, "lights.txt", axes);
}
std::string error_of_text(const std::string& text) {
  return test::error_of([&] { of_text(text); });
}
std::string error_of_json(const std::string& text) {
  return test::error_of([&] { parse_direction_json(text, "lights.json"); });
}

TEST(DirectionList, ReadsLinesOfText) {
  const DirectionList list = of_text("# the dome\n0 0 2\n\n  3,0,4   # any length\r\n-1e0;+0;0\n");
  ASSERT_EQ(list.size(), 3u);
  expect_near(list.directions[0], {0, 0, 1});
  expect_near(list.directions[1], {0.6, 0, 0.8});
  expect_near(list.directions[2], {-1, 0, 0});
  EXPECT_THAT(list.weights, IsEmpty());
  EXPECT_THAT(list.images, IsEmpty());
}

TEST(DirectionList, ReadsWeightsAndImages) {
  const DirectionList list = of_text("a.exr 0 1 0 0.5\nsub/B.PNG,1,0,0,1.5");
  EXPECT_THAT(list.weights, ElementsAre(0.5, 1.5));
  EXPECT_THAT(list.images, ElementsAre("a.exr", "sub/B.PNG"));
  expect_near(list.directions[1], {1, 0, 0});
}

TEST(DirectionList, TurnsZUpIntoTheWorldsAxes) {
  const DirectionList list = of_text("1 0 0\n0 1 0\n0 0 1", DirectionAxes::z_up);
  expect_near(list.directions[0], {1, 0, 0});
  expect_near(list.directions[1], {0, 0, -1});
  expect_near(list.directions[2], {0, 1, 0});
  // A rotation, no reflection.
  expect_near(cross(list.directions[0], list.directions[1]), list.directions[2]);
}

TEST(DirectionList, BadLinesAreNamed) {
  struct Case {
    const char *text, *expected;
  };
  for (const Case& one :
       {Case{"", "lights.txt: found no direction"},
        Case{"# nothing\n", "found no direction"},
        Case{"0 1 0\n1 2\n", "line 2: found 2 numbers"},
        Case{"0 1 0 1 1\n", "line 1: found 5 numbers"},
        Case{"a.exr 0 1\n", "line 1: found 2 numbers"},
        Case{"a.gif 0 1 0\n", "line 1: found \"a.gif\""},
        Case{"x y z\n", "line 1: found \"x\""},
        Case{"0 1 0x1\n", "\"0x1\""},
        Case{"0 nan 0\n", "\"nan\""},
        Case{"0 1e999 0\n", "\"1e999\""},
        Case{"1 0 0\n0 0 0\n", "line 2: found a direction of length 0"},
        Case{"1e-9 0 0\n", "length"},
        Case{"1e7 0 0\n", "length"},
        Case{"0 1 0 0\n", "line 1: found the weight 0"},
        Case{"0 1 0 -1\n", "weight -1"},
        Case{"0 1 0 1e7\n", "weight"},
        Case{"0 1 0 1\n1 0 0\n", "line 2: found a direction without a weight"},
        Case{"0 1 0\n1 0 0 1\n", "line 2: found a weight"},
        Case{"a.exr 0 1 0\n1 0 0\n", "line 2: found a direction without an image"},
        Case{"0 1 0\na.exr 1 0 0\n", "line 2: found an image"}}) {
    EXPECT_THAT(error_of_text(one.text), HasSubstr(one.expected)) << one.text;
  }
}

TEST(DirectionList, ThereIsAMostOfThem) {
  std::string text;
  for (std::size_t i = 0; i < kMostDirections; ++i) text += "0 1 0\n";
  EXPECT_EQ(of_text(text).size(), kMostDirections);
  EXPECT_THAT(error_of_text(text + "0 1 0\n"), HasSubstr("line 131073"));
}

TEST(DirectionList, ReadsJson) {
  const DirectionList list = parse_direction_json(R"({ // axes must be said
    "axes": "z_up",
    "directions": [ { "direction": [0, 0, 3], "weight": 0.25, "image": "top.exr" },
                    { "direction": [0, 2, 0], "weight": 0.75, "image": "back.exr" } ] })",
                                                  "lights.json");
  expect_near(list.directions[0], {0, 1, 0});
  expect_near(list.directions[1], {0, 0, -1});
  EXPECT_THAT(list.weights, ElementsAre(0.25, 0.75));
  EXPECT_THAT(list.images, ElementsAre("top.exr", "back.exr"));
}

TEST(DirectionList, BadJsonNamesTheField) {
  struct Case {
    const char *text, *expected;
  };
  for (const Case& one :
       {Case{R"({ "directions": [ { "direction": [0, 1, 0] } ] })", "\"axes\""},
        Case{R"({ "axes": "x_up", "directions": [ { "direction": [0, 1, 0] } ] })", "/axes"},
        Case{R"({ "axes": "y_up", "directions": [] })", "/directions"},
        Case{R"({ "axes": "y_up", "directions": [ {} ] })", "/directions/0"},
        Case{R"({ "axes": "y_up", "directions": [ { "direction": [0, 1] } ] })",
             "/directions/0/direction"},
        Case{R"({ "axes": "y_up", "directions": [ { "direction": [0, 0, 0] } ] })",
             "/directions/0: found a direction of length 0"},
        Case{R"({ "axes": "y_up", "directions": [ { "direction": [0, 1, 0], "weight": 0 } ] })",
             "/directions/0: found the weight 0"},
        Case{R"({ "axes": "y_up", "directions": [ { "direction": [0, 1, 0], "image": "" } ] })",
             "/directions/0/image"},
        Case{R"({ "axes": "y_up", "directions": [ { "direction": [0, 1, 0], "wieght": 1 } ] })",
             "\"wieght\""},
        Case{R"({ "axes": "y_up", "lights": [] })", "\"lights\""}}) {
    EXPECT_THAT(error_of_json(one.text), HasSubstr(one.expected)) << one.text;
  }
}

TEST(DirectionList, FilesAreReadByTheirEnding) {
  const test::TemporaryFolder folder;
  test::overwrite(folder / "a.csv", "0,1,0\n");
  test::overwrite(folder / "a.json", R"({"axes":"y_up","directions":[{"direction":[0,1,0]}]})");
  test::overwrite(folder / "three.npy", npy_floats({2, 3}, {0, 1, 0, 0, 0, 2}));
  test::overwrite(folder / "four.npy", npy_floats({1, 4}, {0, 1, 0, 0.5f}));
  test::overwrite(folder / "five.npy", npy_floats({1, 5}, {0, 1, 0, 0.5f, 1}));
  test::overwrite(folder / "zero.npy", npy_floats({2, 3}, {0, 1, 0, 0, 0, 0}));
  expect_near(read_directions(folder / "a.csv").directions[0], {0, 1, 0});
  expect_near(read_directions(folder / "a.csv", DirectionAxes::z_up).directions[0], {0, 0, -1});
  expect_near(read_directions(folder / "a.json", DirectionAxes::y_up).directions[0], {0, 1, 0});
  expect_near(read_directions(folder / "three.npy").directions[1], {0, 0, 1});
  EXPECT_THAT(read_directions(folder / "four.npy").weights, ElementsAre(0.5));
  const auto error_of_file = [&](const char* name, std::optional<DirectionAxes> axes = {}) {
    return test::error_of([&] { read_directions(folder / name, axes); });
  };
  EXPECT_THAT(error_of_file("a.json", DirectionAxes::z_up), HasSubstr("/axes"));
  EXPECT_THAT(error_of_file("five.npy"), HasSubstr("five.npy: \"shape\": found 1 × 5"));
  EXPECT_THAT(error_of_file("zero.npy"), HasSubstr("zero.npy: [1]: found a direction of length 0"));
  EXPECT_THAT(error_of_file("missing.txt"), HasSubstr("missing.txt"));
  EXPECT_THAT(error_of_file("a.obj"), HasSubstr("\".obj\""));
}

/// docs/formats/directions.schema.json is held to the same files.
TEST(DirectionList, TakesTheGoodExamplesAndNamesEachBadOne) {
  const std::filesystem::path examples = "tests/core/import/examples";
  std::size_t good = 0, bad = 0;
  for (const auto& entry : std::filesystem::directory_iterator(examples / "good")) {
    EXPECT_GT(read_directions(entry.path()).size(), 1u) << entry.path();
    ++good;
  }
  for (const char* const kind : {"bad", "bad_beyond_schema"}) {
    for (const auto& entry : std::filesystem::directory_iterator(examples / kind)) {
      const std::string error = test::error_of([&] { read_directions(entry.path()); });
      EXPECT_THAT(error, HasSubstr(entry.path().filename().string() + ": "));
      ++bad;
    }
  }
  EXPECT_EQ(good, 2u);
  EXPECT_EQ(bad, 12u);
}

/// The first block of a language in a page of documentation.
std::string block_of(const std::string& page, const std::string& language) {
  const std::string fence = "```" + language + "\n";
  const std::size_t begin = page.find(fence) + fence.size();
  return page.substr(begin, page.find("```", begin) - begin);
}

TEST(DirectionList, ThePagesExamplesAreRead) {
  const std::string page = read_file("docs/formats/import.md", std::size_t{1} << 20);
  const DirectionList text = of_text(block_of(page, "text"));
  EXPECT_THAT(text.images, ElementsAre("lamp_000.exr", "lamp_001.exr", "lamp_002.exr"));
  const DirectionList json = parse_direction_json(block_of(page, "json"), "import.md");
  EXPECT_EQ(json.axes, DirectionAxes::z_up);
  EXPECT_THAT(json.weights, ElementsAre(0.21, 0.34));
  expect_near(json.directions[0], {0, 1, 0});
}

}  // namespace
}  // namespace rimlight
