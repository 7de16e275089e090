#include "core/light/light_sequence.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <numbers>

#include "core/base/check.h"
#include "core/light/light_rotation.h"
#include "core/light/light_sequence_player.h"
#include "core/light/light_sequence_source.h"
#include "core/light/soft_disc.h"
#include "tests/core/light/light_samples.h"
#include "tests/support/allocation_count.h"
#include "tests/support/error_of.h"

namespace rimlight {
namespace {

constexpr int kSize = 16;
constexpr double kDegree = std::numbers::pi / 180;

/// A small environment with a bright pixel, so that its rotation has an excess.
std::shared_ptr<const Environment> small_environment(std::uint64_t seed) {
  Random random(seed);
  RgbImage image(32, 16);
  for (Vec3f& pixel : image.pixels) {
    pixel = {random.uniform_float(), random.uniform_float(), random.uniform_float()};
  }
  image.at(20, 4) = {900, 800, 700};
  return std::make_shared<const Environment>("small", std::move(image));
}

/// For sequences that use no other names.
const LightEnvironments& environments() {
  static const LightEnvironments all = {{"given", small_environment(91)},
                                        {"studio", small_environment(92)},
                                        {"cathedral", small_environment(93)}};
  return all;
}

LightSequence parse(const std::string& text) { return parse_light_sequence(text, "s.json", "."); }

LightSequence with_tracks(const std::string& tracks) {
  return parse(R"({"still_frames": 3, "tracks": [)" + tracks + "]}");
}

LightSequencePlayer player_of(const LightSequence& sequence, int size = kSize) {
  return LightSequencePlayer(sequence, size, environments());
}

CubeLight light_at(const std::string& tracks, int frame) {
  return player_of(with_tracks(tracks)).at(frame).light;
}

bool same_bits(const CubeLight& a, const CubeLight& b) {
  return a.values.size() == b.values.size() &&
         std::memcmp(a.values.data(), b.values.data(), a.values.size() * sizeof(float)) == 0;
}

/// One of each kind, turned and flickering too.
const std::vector<std::string> kTracks = {
    R"({"light": "given", "rotate": {"axis": [1, 2, 3], "degrees_per_frame": 4, "frames": 9,
                                     "ease_in": 3, "ease_out": 2}})",
    R"({"blend": {"from": "given", "to": "studio", "frames": 12}, "scale": 2.5})",
    R"({"area_light": {"radiance": [3, 2, 1], "path": [[1, 0, 0], [0, 1, 0.5]],
                       "angular_radius": [5, 20], "edge": 0.4, "frames": 8},
        "rotate": {"axis": [0, 1, 0], "degrees_per_frame": 10, "frames": 11}})",
    R"({"paint": {"radiance": 7, "stroke": [[1, 0, 0], [0, 1, 0.5]], "spots": 20,
                  "angular_radius": 6, "edge": 0.4, "frames": 14}})",
    R"({"light": "given", "flicker": {"amount": 0.5, "band": [2, 20], "frames": 31}})",
    R"({"blend": {"from": "studio", "to": "given", "frames": 7},
        "rotate": {"axis": [0, 1, 0], "degrees_per_frame": 10, "frames": 11},
        "flicker": {"amount": 1, "band": [8, 20], "frames": 16}})",
    R"({"paint": {"radiance": 7, "stroke": [[1, 0, 0], [0, 1, 0.5]], "spots": 5,
                  "angular_radius": 6, "frames": 14},
        "rotate": {"axis": [0, 1, 0], "degrees_per_frame": 10, "frames": 10}})"};

std::string all_tracks() {
  std::string all;
  for (const std::string& track : kTracks) all += (all.empty() ? "" : ", ") + track;
  return all;
}

TEST(LightSequence, AFrameHasTheSameBitsWhicheverWereAskedBefore) {
  for (const std::string& tracks : {kTracks[0], kTracks[3], kTracks[6], all_tracks()}) {
    const LightSequence sequence = with_tracks(tracks);
    LightSequencePlayer player = player_of(sequence);
    std::vector<CubeLight> in_order;
    for (int frame = 0; frame < sequence.frame_count(); ++frame) {
      EXPECT_EQ(player.at(frame).index, frame);
      in_order.push_back(player.at(frame).light);
    }
    Random random(94);
    for (int i = 0; i < 100; ++i) {
      const auto frame = static_cast<std::size_t>(random.below(in_order.size()));
      ASSERT_TRUE(same_bits(player.at(static_cast<int>(frame)).light, in_order[frame])) << frame;
    }
    for (std::size_t frame = 3; frame < in_order.size(); frame += 7) {
      LightSequencePlayer fresh = player_of(sequence);
      ASSERT_TRUE(same_bits(fresh.at(static_cast<int>(frame)).light, in_order[frame])) << frame;
    }
  }
}

TEST(LightSequence, MovesExactlyWhenItSaysSo) {
  for (const std::string& track : kTracks) {
    const LightSequence sequence = with_tracks(track);
    LightSequencePlayer player = player_of(sequence);
    CubeLight before = player.at(0).light;
    EXPECT_FALSE(player.at(0).moving);
    int moving = 0;
    for (int frame = 1; frame < sequence.frame_count(); ++frame) {
      const LightFrame& now = player.at(frame);
      ASSERT_EQ(now.moving, sequence.is_moving(frame));
      ASSERT_EQ(now.moving, !same_bits(now.light, before)) << track << " " << frame;
      before = now.light;
      moving += now.moving;
    }
    EXPECT_GE(moving, 5);
    EXPECT_TRUE(sequence.is_moving(sequence.frame_count() - sequence.still_frames - 1)) << track;
    EXPECT_FALSE(sequence.is_moving(sequence.frame_count() - sequence.still_frames)) << track;
  }
}

TEST(LightSequence, WhatHasNoMotionDoesNotMove) {
  const LightSequence sequence = with_tracks(
      R"({"light": "given"}, {"light": "given", "rotate": {"axis": [0, 1, 0], "frames": 9,
                                                           "degrees_per_frame": 0}},
         {"area_light": {"radiance": 1, "path": [[1, 0, 0]], "angular_radius": 5, "frames": 8},
          "rotate": {"axis": [1, 0, 0], "degrees_per_frame": 9, "frames": 9}})");
  LightSequencePlayer player = player_of(sequence);
  const CubeLight first = player.at(0).light;
  for (int frame = 0; frame < sequence.frame_count(); ++frame) {
    EXPECT_FALSE(player.at(frame).moving);
    EXPECT_TRUE(same_bits(player.at(frame).light, first));
  }
}

TEST(LightSequence, ItsTracksAddUp) {
  LightSequencePlayer together = player_of(with_tracks(all_tracks()));
  for (const int frame : {0, 3, 10, 30}) {
    CubeLight sum(kSize);
    for (const std::string& track : kTracks) {
      LightSequencePlayer alone = player_of(with_tracks(track));
      const int last = alone.sequence().frame_count() - 1;
      const CubeLight& light = alone.at(std::min(frame, last)).light;
      for (std::size_t i = 0; i < sum.values.size(); ++i) sum.values[i] += light.values[i];
    }
    const CubeLight& light = together.at(frame).light;
    for (std::size_t i = 0; i < sum.values.size(); ++i) {
      ASSERT_NEAR(light.values[i], sum.values[i], 1e-6f * sum.values[i]) << frame;
    }
  }
}

TEST(LightSequence, ScaleAndFlickerMultiply) {
  const std::string flicker = R"("flicker": {"amount": 0.5, "band": [5, 20], "frames": 31})";
  LightSequencePlayer plain = player_of(with_tracks(R"({"light": "given"})"));
  LightSequencePlayer scaled = player_of(with_tracks(R"({"light": "given", "scale": 4, )" +  //
                                                     flicker + "}"));
  const CubeLight light = plain.at(0).light;
  for (int frame = 0; frame < scaled.sequence().frame_count(); ++frame) {
    const auto factor = static_cast<float>(pose_at(scaled.sequence().tracks[0], frame).factor);
    EXPECT_GE(factor, 2 - 1e-6);
    EXPECT_LE(factor, 6 + 1e-6);
    const CubeLight& now = scaled.at(frame).light;
    for (std::size_t i = 0; i < light.values.size(); ++i) {
      ASSERT_EQ(now.values[i], factor * light.values[i]);
    }
  }
}

TEST(LightSequence, ARotationIsWhatTheRotatorMakes) {
  const LightSequence sequence = with_tracks(kTracks[0]);
  LightSequencePlayer player = player_of(sequence);
  LightRotator rotator(environments().at("given")->project(kSize));
  CubeLight expected;
  for (int frame = 0; frame < sequence.frame_count(); ++frame) {
    rotator.rotate(sequence.rotation_at(frame).value(), expected);
    ASSERT_TRUE(same_bits(player.at(frame).light, expected)) << frame;
  }
  EXPECT_TRUE(same_bits(player.at(0).light, rotator.source()));
}

TEST(LightSequence, ABlendStartsAndEndsExactlyAtItsLights) {
  const std::string blend = R"({"blend": {"from": "given", "to": "studio", "frames": 12}})";
  const CubeLight from = environments().at("given")->project(kSize);
  const CubeLight to = environments().at("studio")->project(kSize);
  EXPECT_TRUE(same_bits(light_at(blend, 0), from));
  EXPECT_TRUE(same_bits(light_at(blend, 11), to));
  EXPECT_TRUE(same_bits(light_at(blend, 14), to));
  LightSequencePlayer player = player_of(with_tracks(blend));
  for (int frame = 0; frame < 12; ++frame) {
    const Vec3d energy = integral(player.at(frame).light);
    const double share = eased_share(frame, 12);
    const Vec3d expected = integral(from) * (1 - share) + integral(to) * share;
    EXPECT_LE(relative_difference(energy, expected), 1e-6);
  }
}

TEST(LightSequence, ATurnTakesBothEndsOfABlendWithIt) {
  const LightSequence sequence = with_tracks(kTracks[5]);
  LightSequencePlayer player = player_of(sequence);
  LightRotator rotator(environments().at("given")->project(kSize));
  CubeLight expected;
  const TrackPose end = pose_at(sequence.tracks[0], 10);
  EXPECT_EQ(end.amount, 1);
  rotator.rotate(end.rotation, expected);
  for (float& value : expected.values) value *= static_cast<float>(end.factor);
  EXPECT_TRUE(same_bits(player.at(10).light, expected));
}

TEST(LightSequence, AnAreaLightKeepsItsRadianceTimesItsSolidAngle) {
  const LightSequence sequence = with_tracks(kTracks[2]);
  LightSequencePlayer player = player_of(sequence);
  const Vec3d radiance{3, 2, 1};
  for (int frame = 0; frame < sequence.frame_count(); ++frame) {
    const TrackPose pose = pose_at(sequence.tracks[0], frame);
    const double cap = 2 * std::numbers::pi * (1 - std::cos(pose.amount));
    const CubeLight& light = player.at(frame).light;
    EXPECT_LE(relative_difference(integral(light), radiance * cap), 1e-6);
    // Its middle is where the path and the turn put it, to a part of a texel.
    EXPECT_LE(angle_between(first_moment(light, 0), pose.direction), 0.1 * 2 / kSize);
  }
  EXPECT_EQ(pose_at(sequence.tracks[0], 0).direction, (Vec3d{1, 0, 0}));
  EXPECT_NEAR(pose_at(sequence.tracks[0], 0).amount, 5 * kDegree, 1e-12);
  EXPECT_NEAR(pose_at(sequence.tracks[0], 99).amount, 20 * kDegree, 1e-12);
}

TEST(LightSequence, ATurnTakesAnAreaLightWithIt) {
  const LightSequence sequence = with_tracks(kTracks[2]);
  const auto& light = std::get<AreaLightSource>(sequence.tracks[0].source);
  // 10 steps of 10 degrees about y; the path has ended.
  const Vec3d expected = rotated(axis_angle({0, 1, 0}, 100 * kDegree), light.path.at(1));
  EXPECT_LE(angle_between(pose_at(sequence.tracks[0], 10).direction, expected), 1e-9);
}

TEST(LightSequence, SpotsComeOneByOneAndStay) {
  // 20 spots in 20 steps, over a light of its own.
  const LightSequence sequence = with_tracks(
      R"({"light": "studio"}, {"paint": {"radiance": [7, 1, 2], "stroke": [[1, 0, 0], [0, 1, 0.5]],
          "spots": 20, "angular_radius": 6, "edge": 0.4, "frames": 21}})");
  const auto& paint = std::get<PaintSource>(sequence.tracks[1].source);
  LightSequencePlayer player = player_of(sequence);
  CubeLight before = player.at(0).light;
  EXPECT_TRUE(same_bits(before, environments().at("studio")->project(kSize)));
  for (int frame = 1; frame <= 20; ++frame) {
    const SoftDisc disc{paint.stroke.at((frame - 1) / 19.0), 6 * kDegree, 0.4};
    CubeLight spot(kSize);
    add_disc(disc, paint.radiance, spot);
    const CubeLight& now = player.at(frame).light;
    int changed = 0;
    for (std::size_t i = 0; i < now.values.size(); ++i) {
      if (spot.values[i] == 0) {
        ASSERT_EQ(now.values[i], before.values[i]) << "outside the spot, frame " << frame;
      } else {
        ASSERT_NEAR(now.values[i] - before.values[i], spot.values[i], 1e-5);
        ++changed;
      }
    }
    EXPECT_GT(changed, 0);
    EXPECT_LT(changed, 100);
    before = now;
  }
}

TEST(LightSequence, SaysWhichRotationsAndLightsEditsCanPlay) {
  EXPECT_EQ(with_tracks(kTracks[0]).rotated_light(), "given");
  EXPECT_EQ(with_tracks(R"({"light": "studio"})").rotated_light(), "studio");
  EXPECT_EQ(with_tracks(R"({"light": "studio"})").rotation_at(2), Quaternion{});
  for (const std::string& other :
       {kTracks[1], kTracks[2], kTracks[3], kTracks[4], kTracks[5], kTracks[0] + "," + kTracks[0],
        std::string(R"({"light": "given", "scale": 0.5})")}) {
    EXPECT_FALSE(with_tracks(other).rotated_light()) << other;
    EXPECT_FALSE(with_tracks(other).rotation_at(0)) << other;
  }
}

TEST(LightSequence, AllocatesNothingAfterTheFirstFrame) {
  if (!test::kCountsAllocations) GTEST_SKIP() << "ThreadSanitizer has an operator new of its own";
  const LightSequence sequence = with_tracks(all_tracks());
  LightSequencePlayer player = player_of(sequence);
  player.at(1);
  const std::size_t warm = test::allocation_count();
  EXPECT_GT(warm, 0u);
  for (int frame = 0; frame < sequence.frame_count(); ++frame) player.at(frame);
  for (int frame = sequence.frame_count(); frame-- > 0;) player.at(frame);
  EXPECT_EQ(test::allocation_count(), warm);
}

TEST(LightSequence, RefusesFramesAndSizesThatAreNotThere) {
  LightSequencePlayer player = player_of(with_tracks(R"({"light": "given"})"));
  EXPECT_EQ(player.sequence().frame_count(), 4);
  EXPECT_NO_THROW(player.at(3));
  EXPECT_THROW(player.at(4), CheckFailure);
  EXPECT_THROW(player.at(-1), CheckFailure);
  EXPECT_THROW(player_of(with_tracks(R"({"light": "given"})"), 1), CheckFailure);
}

TEST(LightSequence, AnEnvironmentThatCouldOverflowIsRefused) {
  RgbImage image(8, 4);
  for (Vec3f& pixel : image.pixels) pixel = {1, 1e31f, 1};
  const LightEnvironments bright = {{"given", std::make_shared<Environment>("x", image)}};
  const std::string message = test::error_of(
      [&] { LightSequencePlayer(with_tracks(R"({"light": "given"})"), kSize, bright); });
  EXPECT_TRUE(message.starts_with("environment \"given\": found the radiance")) << message;
}

TEST(LightSequence, EnvironmentsComeFromTheCallerAndFromTheProgram) {
  const auto given = small_environment(95);
  const LightSequence sequence =
      with_tracks(R"({"blend": {"from": "given", "to": "studio", "frames": 12}})");
  EXPECT_EQ(sequence.light_names(), (std::vector<std::string>{"given", "studio"}));
  const LightEnvironments loaded = load_environments(sequence, given);
  ASSERT_EQ(loaded.size(), 2u);
  EXPECT_EQ(loaded.at("given"), given);
  EXPECT_EQ(loaded.at("studio")->name(), "studio");
  const std::string message = test::error_of([&] { load_environments(sequence, nullptr); });
  EXPECT_EQ(message, "s: found no light for \"given\", expected an environment");
}

}  // namespace
}  // namespace rimlight
