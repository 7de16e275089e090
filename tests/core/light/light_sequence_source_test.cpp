#include "core/light/light_sequence_source.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <numbers>
#include <set>
#include <sstream>
#include <string>

#include "core/base/error.h"
#include "core/base/files.h"
#include "tests/support/error_of.h"
#include "tests/support/overwrite.h"
#include "tests/support/temporary_folder.h"

namespace rimlight {
namespace {

namespace fs = std::filesystem;

const fs::path kExamples = "tests/core/light/sequences";
constexpr double kDegree = std::numbers::pi / 180;

TEST(LightSequenceSource, EveryGoodExampleIsRead) {
  int count = 0;
  for (const auto& entry : fs::directory_iterator(kExamples / "good")) {
    SCOPED_TRACE(entry.path().string());
    const LightSequence sequence = read_light_sequence(entry.path());
    EXPECT_FALSE(sequence.name.empty());
    EXPECT_GE(sequence.frame_count(), 1);
    EXPECT_FALSE(sequence.is_moving(sequence.frame_count()));
    ++count;
  }
  EXPECT_GE(count, 11);
}

TEST(LightSequenceSource, EveryBadExampleIsRefusedAtItsPointer) {
  std::ifstream list(kExamples / "expected_pointers.txt");
  std::set<std::string> listed;
  for (std::string line; std::getline(list, line);) {
    if (line.starts_with('#')) continue;
    std::istringstream words(line);
    std::string name, pointer;
    words >> name >> pointer;
    listed.insert(name);
    const std::string path = (kExamples / name).string();
    const std::string where = pointer == "-" ? path + ": found" : path + ": " + pointer + ": ";
    const std::string message = test::error_of([&] { read_light_sequence(path); });
    EXPECT_TRUE(message.starts_with(where)) << message << "\n  should begin with " << where;
  }
  std::size_t files = 0;
  for (const char* folder : {"bad", "bad_beyond_schema"}) {
    for (const auto& entry : fs::directory_iterator(kExamples / folder)) {
      files += listed.count(std::string(folder) + "/" + entry.path().filename().string());
    }
  }
  EXPECT_EQ(files, listed.size());
  EXPECT_GE(files, 60u);
}

TEST(LightSequenceSource, TheDocumentedExampleIsRead) {
  const std::string page = read_file("docs/formats/light_sequence.md", 1 << 20);
  const std::size_t begin = page.find("```json\n");
  ASSERT_NE(begin, std::string::npos);
  const std::size_t end = page.find("```", begin + 8);
  const LightSequence sequence =
      parse_light_sequence(page.substr(begin + 8, end - begin - 8), "page.md", "lights");
  EXPECT_EQ(sequence.name, "Dusk");
  EXPECT_EQ(sequence.lights.at("grace"), "lights/grace_probe.hdr");
  EXPECT_EQ(sequence.light_names(), (std::vector<std::string>{"given", "grace"}));
  ASSERT_EQ(sequence.tracks.size(), 3u);
  EXPECT_EQ(sequence.frame_count(), 150);
}

TEST(LightSequenceSource, FieldsGoWhereTheyBelong) {
  const LightSequence sequence = read_light_sequence(kExamples / "good/all.json");
  EXPECT_EQ(sequence.name, "all");
  EXPECT_EQ(sequence.frames_per_second, 60);
  EXPECT_EQ(sequence.frame_count(), 10'100);
  ASSERT_EQ(sequence.tracks.size(), 5u);
  const EasedTurn& turn = sequence.tracks[0].rotate.value();
  EXPECT_NEAR(turn.peak, 3 * kDegree, 1e-15);
  EXPECT_EQ(turn.frames, 100);
  EXPECT_EQ(turn.ease_in, 60);
  EXPECT_EQ(turn.ease_out, 30);
  const auto& blend = std::get<BlendSource>(sequence.tracks[1].source);
  EXPECT_EQ(blend.from + blend.to, "givenstudio");
  const auto& area = std::get<AreaLightSource>(sequence.tracks[2].source);
  EXPECT_EQ(area.radiance, (Vec3d{20, 18, 15}));
  EXPECT_NEAR(area.radius_from, 2 * kDegree, 1e-15);
  EXPECT_NEAR(area.radius_to, 20 * kDegree, 1e-15);
  EXPECT_EQ(area.edge, 0.5);
  EXPECT_NEAR(area.path.length(), 90 * kDegree, 1e-12);
  const auto& paint = std::get<PaintSource>(sequence.tracks[3].source);
  EXPECT_EQ(paint.radiance, (Vec3d{5, 5, 5}));
  EXPECT_EQ(paint.spots, 40);
  EXPECT_EQ(paint.frames, 50);
  EXPECT_EQ(sequence.tracks[4].flicker.value().frames(), 100);
  EXPECT_EQ(read_light_sequence(kExamples / "good/blend.json").tracks[0].scale, 0.5);
}

/// 2 … 12 Hz in 99 steps of 1/60 s are 3.3 … 19.8 cycles.
TEST(LightSequenceSource, ABandOfHertzBecomesWholeCycles) {
  const LightSequence sequence = read_light_sequence(kExamples / "good/flicker.json");
  const Flicker expected({0.4, 100, 4, 19, 7});
  for (int frame = 0; frame < 100; ++frame) {
    EXPECT_EQ(sequence.tracks[0].flicker->factor(frame), expected.factor(frame));
  }
  // 24 steps at 240 a second are a tenth of a second, in which 10 Hz go round exactly once.
  const LightSequence exact = parse_light_sequence(
      R"({"frames_per_second": 240, "tracks": [{"light": "given",
          "flicker": {"amount": 1, "band": [10, 10], "frames": 25}}]})",
      "s.json", ".");
  EXPECT_NEAR(exact.tracks[0].flicker->factor(6) + exact.tracks[0].flicker->factor(18), 2, 1e-12);
  // As doubles, 15 · (124 / 60) is more than 31 and 27 · (260 / 60) less than 117.
  for (const auto& [hertz, frames] : {std::pair{"15", "125"}, {"27", "261"}}) {
    EXPECT_NO_THROW(parse_light_sequence(
        R"({"tracks": [{"light": "given", "flicker": {"amount": 1, "band": [)" +
            std::string(hertz) + ", " + hertz + "], \"frames\": " + frames + "}}]}",
        "s.json", "."));
  }
}

TEST(LightSequenceSource, MalformedTextAndOversizedFilesAreRefused) {
  const auto parse = [](const std::string& text) {
    return test::error_of([&] { parse_light_sequence(text, "s.json", "."); });
  };
  EXPECT_EQ(parse("{"), "s.json: line 1, column 1: found malformed JSON, expected valid JSON");
  EXPECT_EQ(parse("[]"), "s.json: found an array, expected an object");
  EXPECT_TRUE(parse(R"({"tracks": [], "tracks": []})").starts_with("s.json: found the key"));
  const test::TemporaryFolder folder;
  test::overwrite(folder / "large.json", std::string((1 << 20) + 1, ' '));
  const std::string message = test::error_of([&] { read_light_sequence(folder / "large.json"); });
  EXPECT_NE(message.find("large.json"), std::string::npos) << message;
  EXPECT_NE(test::error_of([&] { read_light_sequence(folder / "none.json"); }), "no error");
}

TEST(LightSequenceSource, TheBuiltInSequencesAreTheFilesOfTheRepository) {
  std::vector<std::string> files;
  for (const auto& entry : fs::directory_iterator("configs/sequences")) {
    files.push_back(entry.path().stem().string());
    const LightSequence built_in = find_light_sequence(files.back(), "--sequence");
    const LightSequence file = find_light_sequence(entry.path().string(), "--sequence");
    EXPECT_EQ(built_in.name, files.back());
    EXPECT_EQ(built_in.name, file.name);
    EXPECT_TRUE(built_in.lights.empty()) << "a built-in sequence has no files beside it";
    ASSERT_EQ(built_in.frame_count(), file.frame_count());
    ASSERT_EQ(built_in.tracks.size(), file.tracks.size());
    for (int frame = 0; frame < file.frame_count(); ++frame) {
      for (std::size_t i = 0; i < file.tracks.size(); ++i) {
        ASSERT_EQ(pose_at(built_in.tracks[i], frame), pose_at(file.tracks[i], frame));
      }
    }
  }
  std::sort(files.begin(), files.end());
  EXPECT_EQ(files, builtin_light_sequence_names());
  EXPECT_EQ(files,
            (std::vector<std::string>{"area-light", "blend", "flicker", "paint", "rotation"}));
}

TEST(LightSequenceSource, EveryBuiltInSequenceMovesAndThenStaysFor28Frames) {
  for (const std::string& name : builtin_light_sequence_names()) {
    const LightSequence sequence = find_light_sequence(name, "--sequence");
    EXPECT_GE(sequence.still_frames, 28) << name;
    EXPECT_GE(sequence.frame_count(), 128) << name;
    int moving = 0;
    for (int frame = 0; frame < sequence.frame_count(); ++frame) {
      moving += sequence.is_moving(frame);
    }
    EXPECT_GE(moving, 50) << name;
  }
}

/// Overbeck 2006: 128 frames of which the last to turn is 99; slow at 30, faster at 75.
TEST(LightSequenceSource, TheRotationIsThePapers) {
  const LightSequence sequence = find_light_sequence("rotation", "--sequence");
  EXPECT_EQ(sequence.rotated_light(), "given");
  EXPECT_EQ(sequence.frame_count(), 128);
  for (int frame = 1; frame < 128; ++frame) EXPECT_EQ(sequence.is_moving(frame), frame <= 99);
  const EasedTurn& turn = sequence.tracks[0].rotate.value();
  const auto step = [&](int frame) {
    return (turn.angle(frame) - turn.angle(frame - 1)) / kDegree;
  };
  double fastest = 0;
  for (int frame = 1; frame < 128; ++frame) fastest = std::max(fastest, step(frame));
  EXPECT_NEAR(fastest, 3, 1e-12);
  EXPECT_LT(step(30), 1.6);
  EXPECT_GT(step(75), 2.5);
  EXPECT_NEAR(turn.angle(127) / kDegree, 162, 1e-9);
}

TEST(LightSequenceSource, AnUnknownNameListsTheKnownOnes) {
  const std::string message = test::error_of([] { find_light_sequence("spin", "--sequence"); });
  EXPECT_EQ(message,
            "--sequence: found \"spin\", expected a .json file or one of \"area-light\" \"blend\" "
            "\"flicker\" \"paint\" \"rotation\"");
}

}  // namespace
}  // namespace rimlight
