#include "core/relight/frame_update.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <memory>
#include <numeric>
#include <string>
#include <vector>

#include "core/base/parallel.h"
#include "core/math/random.h"
#include "tests/support/allocation_count.h"
#include "tests/support/error_of.h"
#include "tests/support/small_bake.h"
#include "tests/support/temporary_folder.h"

namespace rimlight {
namespace {

using Unit = FrameBudget::Unit;
constexpr int kSize = 8;
const CubeHaar kHaar(kSize);
const char* const kPolicies[] = {"linear", "nwa", "bi", "pbi", "pbi:exhaustive", "benefit"};
/// Those that come to the target frame by frame under a budget that does not hold all of it.
const char* const kIncrementalPolicies[] = {"bi", "pbi", "pbi:dealer", "pbi:exhaustive", "benefit"};

const Bake& bake() {
  static const test::TemporaryFolder folder;
  static const std::unique_ptr<const Bake> made = [] {
    test::write_small_bake(folder / "a.bake", {.cube_size = kSize});
    return std::make_unique<const Bake>(folder / "a.bake");
  }();
  return *made;
}

/// Every column's, rarely equal.
CubeLight light_of(int frame) {
  CubeLight light(kSize);
  for (std::size_t i = 0; i < light.count(); ++i) {
    Random random(7, i);
    for (int c = 0; c < 3; ++c) {
      const double phase = random.uniform(0, 6.3) + random.uniform(0, 0.2) * frame;
      light.channel(c)[i] = static_cast<float>(std::sin(phase));
    }
  }
  return light;
}

std::size_t bytes_of_all_columns() {
  const auto& bytes = bake().column_bytes();
  return std::accumulate(bytes.begin(), bytes.end(), std::size_t{0});
}

/// One session's image, and what moves it.
struct Session {
  Relighter relighter{bake().transport(), bake().reflectance(), kHaar};
  FrameUpdater updater;

  explicit Session(const char* policy)
      : updater(bake(), kHaar, parse_policy(policy, "test"), relighter) {}

  double distance(const CubeLight& target) const {
    double sum = 0;
    for (std::size_t layer = 0; layer < kLayers; ++layer) {
      sum += weighted_distance(kHaar, target, relighter.held().layer(layer));
    }
    return sum;
  }
  std::vector<float> image() const {
    std::vector<float> image(relighter.tile_count() * kTileFloats);
    for (std::size_t tile = 0; tile < relighter.tile_count(); ++tile) {
      relighter.find_radiance(
          tile, std::span<float, kTileFloats>(image.data() + tile * kTileFloats, kTileFloats));
    }
    return image;
  }
};

TEST(FrameBudget, TextsAreReadAndWritten) {
  const auto expect = [](const char* text, Unit unit, double amount, const char* name) {
    const FrameBudget budget = parse_budget(text, "budget");
    EXPECT_EQ(budget.unit, unit) << text;
    EXPECT_EQ(budget.amount, amount) << text;
    EXPECT_EQ(budget_name(budget), name);
  };
  expect("30", Unit::coefficients, 30, "30");
  expect("0", Unit::coefficients, 0, "0");
  expect("2MB", Unit::bytes, 2e6, "2MB");
  expect("0.25MB", Unit::bytes, 250'000, "0.25MB");
  expect("16ms", Unit::milliseconds, 16, "16ms");
  expect("16.6ms", Unit::milliseconds, 16.6, "16.6ms");
  EXPECT_EQ(budget_name({}), "30");
}

TEST(FrameBudget, WhatIsWrittenIsReadBack) {
  Random random(3);
  for (int i = 0; i < 1000; ++i) {
    const double amount = std::pow(10.0, random.uniform(-3, 9));
    for (const FrameBudget& budget :
         {FrameBudget{Unit::coefficients, std::floor(amount)}, FrameBudget{Unit::bytes, amount},
          FrameBudget{Unit::milliseconds, amount}}) {
      const FrameBudget read = parse_budget(budget_name(budget), "test");
      ASSERT_EQ(read.unit, budget.unit);
      // Bytes are written as millions.
      ASSERT_NEAR(read.amount, budget.amount, budget.unit == Unit::bytes ? 1e-15 * amount : 0);
    }
  }
}

TEST(FrameBudget, OtherTextsAreErrorsThatNameTheirPlace) {
  for (const char* const text :
       {"",    "MB",    "ms",   "-1",  "-2MB",  "1.5", "30 ",   " 30",  "2mb",     "2 MB",
        "16s", "16msx", "0x10", "nan", "nanms", "inf", "infms", "1e13", "1e999ms", "twelve"}) {
    EXPECT_EQ(test::error_of([&] { parse_budget(text, "config: budget"); }),
              "config: budget: found \"" + std::string(text) +
                  "\", expected a budget such as 30 (coefficients), 2MB or 16ms");
  }
}

TEST(FrameUpdate, BudgetsOfCoefficientsAndBytesAreNeverExceeded) {
  const std::size_t all = bytes_of_all_columns();
  for (const char* const policy : kPolicies) {
    Session counted(policy), weighed(policy);
    std::size_t columns = 0, bytes = 0;
    for (int frame = 0; frame < 30; ++frame) {
      const std::size_t most = static_cast<std::size_t>(frame * frame);
      const auto of_count =
          counted.updater.update(light_of(frame), {Unit::coefficients, static_cast<double>(most)});
      ASSERT_LE(of_count.columns, most) << policy;
      const std::size_t most_bytes = all * static_cast<std::size_t>(frame) / 40;
      const auto of_bytes =
          weighed.updater.update(light_of(frame), {Unit::bytes, static_cast<double>(most_bytes)});
      ASSERT_LE(of_bytes.bytes, most_bytes) << policy;
      columns += of_count.columns;
      bytes += of_bytes.bytes;
    }
    EXPECT_GT(columns, 1000u) << policy;
    EXPECT_GT(bytes, all) << policy;
  }
}

TEST(FrameUpdate, BudgetsOfCoefficientsAndBytesGiveTheSameBitsAtAnyThreadCount) {
  const double bytes = static_cast<double>(bytes_of_all_columns()) / 10;
  for (const char* const policy : kPolicies) {
    for (const FrameBudget& budget :
         {FrameBudget{Unit::coefficients, 40}, FrameBudget{Unit::bytes, bytes}}) {
      std::vector<std::vector<float>> images;
      for (const int threads : {1, 2, 3}) {
        set_thread_count(threads);
        Session session(policy);
        for (int frame = 0; frame < 10; ++frame) session.updater.update(light_of(frame), budget);
        images.push_back(session.image());
      }
      set_thread_count(0);
      EXPECT_EQ(images[0], images[1]) << policy << " " << budget_name(budget);
      EXPECT_EQ(images[0], images[2]) << policy << " " << budget_name(budget);
      EXPECT_TRUE(std::ranges::any_of(images[0], [](float value) { return value != 0; }));
    }
  }
}

TEST(FrameUpdate, ReportsTellWhatWasDone) {
  Session session("bi");
  const CubeLight target = light_of(0);
  std::size_t columns = 0, bytes = 0;
  for (int frame = 0; session.distance(target) > 0; ++frame) {
    ASSERT_LT(frame, 100);
    const UpdateReport report = session.updater.update(target, {Unit::coefficients, 25});
    EXPECT_EQ(report.columns, session.relighter.last_terms());
    EXPECT_EQ(report.bands_reset, frame == 0 ? 3u : 0u) << "the light that holds nothing";
    EXPECT_GE(report.plan_ms, 0);
    EXPECT_GT(report.apply_ms, 0);
    columns += report.columns;
    bytes += report.bytes;
  }
  EXPECT_EQ(columns, kHaar.coefficient_count()) << "each column once";
  EXPECT_EQ(bytes, bytes_of_all_columns());
  const UpdateReport nothing = session.updater.update(target, {Unit::coefficients, 25});
  EXPECT_EQ(nothing.columns, 0u);
  EXPECT_EQ(nothing.bytes, 0u);
  EXPECT_EQ(nothing.bands_reset, 0u);
  EXPECT_EQ(nothing.tiles_rebuilt, 0u);
}

TEST(FrameUpdate, RebuiltTilesAreCounted) {
  Session session("bi");
  const std::size_t tiles = bake().transport().tile_count();
  std::size_t columns = 0, rebuilt = 0;
  for (int frame = 0; columns < 3 * Relighter::kMostAdditions; ++frame) {
    const UpdateReport report = session.updater.update(light_of(frame), {Unit::coefficients, 300});
    columns += report.columns;
    rebuilt += report.tiles_rebuilt;
    ASSERT_EQ(rebuilt, columns * tiles / Relighter::kMostAdditions);
    if (frame % 10 != 0) continue;
    // A frame that does nothing rebuilds nothing, whatever the one before it did.
    ASSERT_EQ(session.updater.update(light_of(frame), {Unit::coefficients, 0}).tiles_rebuilt, 0u);
  }
  EXPECT_GE(rebuilt, 3 * tiles);
}

TEST(FrameUpdate, ADeadlineFarTooShortStillMovesTowardsTheTarget) {
  const CubeLight target = light_of(0);
  for (const char* const policy : kIncrementalPolicies) {
    for (const double deadline : {0.0, 1e-9, 0.01}) {
      Session session(policy);
      double previous = session.distance(target);
      std::size_t frames = 0;
      for (; previous > 0; ++frames) {
        ASSERT_LT(frames, kHaar.coefficient_count()) << policy;
        session.updater.update(target, {Unit::milliseconds, deadline});
        const double distance = session.distance(target);
        ASSERT_LT(distance, previous) << policy << " stands still";
        previous = distance;
      }
      EXPECT_GT(frames, 10u) << "the deadline was not short";
    }
  }
  // What starts anew each time shows something.
  Session session("nwa");
  EXPECT_GT(session.updater.update(target, {Unit::milliseconds, 0}).columns, 0u);
}

TEST(FrameUpdate, ADeadlineFarTooLongReachesTheTargetAtOnce) {
  const CubeLight targets[] = {light_of(0), light_of(9), CubeLight(kSize)};
  for (const char* const policy : kPolicies) {
    for (const double deadline : {1e4, 1e12}) {
      Session session(policy);
      for (const CubeLight& target : targets) {
        const auto start = std::chrono::steady_clock::now();
        session.updater.update(target, {Unit::milliseconds, deadline});
        EXPECT_EQ(session.distance(target), 0) << policy;
        EXPECT_LT(std::chrono::steady_clock::now() - start, std::chrono::seconds(9))
            << "time that is left is not waited out";
      }
    }
  }
}

/// Batches that each start from zero would leave what the last, smallest one holds.
TEST(FrameUpdate, ADeadlineOfAPolicyThatKeepsNothingIsOneBatch) {
  for (const char* const policy : {"nwa", "linear"}) {
    Session session(policy);
    for (int frame = 0; frame < 20; ++frame) {
      const UpdateReport report = session.updater.update(light_of(frame), {Unit::milliseconds, 5});
      EXPECT_EQ(report.columns, session.relighter.last_terms());
      EXPECT_EQ(report.bands_reset, 3u);
    }
  }
}

TEST(FrameUpdate, AllocatesNothingAfterTheFirstFrames) {
  if (!test::kCountsAllocations) GTEST_SKIP() << "no operator new of its own here";
  set_thread_count(1);  // so that the calling thread's allocations are all there are
  std::vector<CubeLight> lights;
  for (int frame = 0; frame < 4; ++frame) lights.push_back(light_of(frame));
  for (const char* const policy : kPolicies) {
    for (const FrameBudget& budget :
         {FrameBudget{Unit::coefficients, 300}, FrameBudget{Unit::bytes, 1e6},
          FrameBudget{Unit::milliseconds, 1}}) {
      Session session(policy);
      // Enough for a plan of every size; too few for a tile to be rebuilt.
      for (const CubeLight& light : lights) session.updater.update(light, {Unit::bytes, 1e12});
      for (const CubeLight& light : lights) session.updater.update(light, budget);
      const auto before = test::allocation_count();
      std::size_t rebuilt = 0;
      for (std::size_t frame = 0; frame < 60; ++frame) {
        rebuilt += session.updater.update(lights[frame % 4], budget).tiles_rebuilt;
      }
      EXPECT_EQ(test::allocation_count() - before, 0u) << policy << " " << budget_name(budget);
      if (budget.unit == Unit::coefficients && std::string(policy) != "linear") {
        EXPECT_GT(rebuilt, 0u) << policy;
      }
    }
  }
  set_thread_count(0);
}

}  // namespace
}  // namespace rimlight
