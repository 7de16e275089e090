// Moving frames under a deadline: what they show, and what they say of their error.
#include <gtest/gtest.h>

#include <cstdio>

#include "core/base/parallel.h"
#include "tests/core/vertices/baked_case.h"
#include "tests/support/allocation_count.h"
#include "tests/support/temporary_folder.h"

namespace rimlight {
namespace {

using test::kVertexSettings;

VertexSettings within_ms(double ms) {
  VertexSettings settings = kVertexSettings;
  settings.budget = {FrameBudget::Unit::milliseconds, ms};
  return settings;
}

DesignState turned(int step) {
  DesignState state;
  state.environment = step % 2 == 0 ? "sky" : "dim";
  state.rotation = axis_angle({0.3, 1, 0.2}, 0.4 * step);
  return state;
}

std::shared_ptr<const VertexScene> fine_spheres() {
  return test::scene_of({.rings = 60, .width = 300, .height = 220});
}

struct Moving {
  RgbImage image;
  FrameReport report;

  Moving(VertexRenderer& renderer, const DesignState& state)
      : report(renderer.render_moving(state, image)) {}
};

/// Frames without time against those at full rate: mean of estimate over truth.
void calibrate(const std::shared_ptr<const VertexScene>& scene) {
  VertexRenderer hasty(scene, within_ms(0)), full(scene, kVertexSettings);
  Moving(hasty, turned(0));  // the first shows a coarse view
  double mean = 0;
  int near = 0;
  constexpr int kFrames = 24;
  for (int step = 0; step < kFrames; ++step) {
    const Moving frame(hasty, turned(step)), whole(full, turned(step));
    const double truth = test::distance(frame.image, whole.image);
    ASSERT_GT(truth, 0);
    EXPECT_EQ(whole.report.estimate_of_time.value(), 0);
    const double norm = test::size_of(frame.image);
    const double ratio = frame.report.estimate_of_time.value() * norm / truth;
    mean += ratio / kFrames;
    near += std::abs(ratio - 1) <= 0.15 ? 1 : 0;
  }
  std::printf("estimate / truth: mean %.3f, within 15 %%: %d of %d\n", mean, near, kFrames);
  EXPECT_NEAR(mean, 1, 0.25);
  EXPECT_GE(near, kFrames / 2);
}

TEST(RatedFrame, TheEstimateOfInterpolatedHighlightsIsTheTruth) {
  const test::TemporaryFolder folder;
  const auto scene = test::balls_scene();
  scene->bake.width = 400;
  scene->bake.height = 300;
  scene->bake.vertex.longest_edge = 0.02;
  calibrate(test::baked(scene, folder / "balls.bake"));
}

TEST(RatedFrame, MuchTimeGivesTheFrameAtFullRate) {
  VertexRenderer patient(fine_spheres(), within_ms(1e9)), full(fine_spheres(), kVertexSettings);
  for (int step = 0; step < 3; ++step) {
    const Moving frame(patient, turned(step)), whole(full, turned(step));
    EXPECT_EQ(frame.image.pixels, whole.image.pixels);
    EXPECT_EQ(frame.report.estimate_of_time.value(), 0);
  }
}

TEST(RatedFrame, ExactFramesDoNotKnowOfDeadlines) {
  VertexRenderer hasty(fine_spheres(), within_ms(0)), full(fine_spheres(), kVertexSettings);
  for (int step = 0; step < 3; ++step) {
    Moving(hasty, turned(step));
    Rgb8Image frame, whole;
    FrameReport report;
    ASSERT_TRUE(hasty.render_exact(turned(step), frame, report));
    ASSERT_TRUE(full.render_exact(turned(step), whole, report));
    EXPECT_EQ(frame.bytes, whole.bytes);
  }
}

TEST(RatedFrame, MattLightAndOnePixelInSixteenAreExact) {
  VertexRenderer hasty(fine_spheres(), within_ms(0)), full(fine_spheres(), kVertexSettings);
  Moving(hasty, turned(0));
  const Moving frame(hasty, turned(1)), whole(full, turned(1));
  std::size_t different = 0;
  for (int y = 0; y < whole.image.height; ++y) {
    for (int x = 0; x < whole.image.width; ++x) {
      const bool is_same = frame.image.at(x, y) == whole.image.at(x, y);
      different += is_same ? 0 : 1;
      const bool is_on_grid = x % 4 == 0 && y % 4 == 0;
      ASSERT_TRUE(is_same || !is_on_grid) << x << " " << y;
    }
  }
  EXPECT_GT(different, 3000u);
  DesignState matt = turned(1);
  matt.materials["brass"].highlight = matt.materials["enamel"].highlight = Vec3f();
  const Moving frame_of_matt(hasty, matt), all_of_matt(full, matt);
  EXPECT_EQ(frame_of_matt.image.pixels, all_of_matt.image.pixels);
  EXPECT_EQ(frame_of_matt.report.estimate_of_time.value(), 0);
}

TEST(RatedFrame, ACoarseViewSaysHowCoarseItIs) {
  const test::TemporaryFolder folder;
  const auto scene = test::balls_scene();
  scene->bake.width = 400;
  scene->bake.height = 300;
  const auto shown = test::baked(scene, folder / "balls.bake");
  VertexSettings coarse = kVertexSettings;
  coarse.view_ms = 0;
  double mean = 0;
  constexpr int kViews = 8;
  VertexRenderer first(shown, coarse), full(shown, kVertexSettings);
  for (int step = 0; step < kViews; ++step) {
    DesignState state = turned(step);
    state.view = shown->camera;
    state.view->position = rotated(axis_angle({0, 1, 0}, 0.3 * step), state.view->position);
    const Moving rough(first, state), whole(full, state);
    const double truth = test::distance(rough.image, whole.image) / test::size_of(whole.image);
    const double ratio = rough.report.estimate_of_time.value() / truth;
    std::printf("coarse view: estimate / truth %.2f\n", ratio);
    EXPECT_GT(ratio, 0.6);
    EXPECT_LT(ratio, 1.6);
    mean += ratio / kViews;
    EXPECT_EQ(Moving(first, state).report.estimate_of_time.value(), 0) << "the rest was traced";
  }
  EXPECT_NEAR(mean, 1, 0.3);
}

TEST(RatedFrame, ADeadlineAllocatesNoMoreThanNone) {
  if (!test::kCountsAllocations) GTEST_SKIP();
  const auto allocations = [](const VertexSettings& settings) {
    VertexRenderer renderer(fine_spheres(), settings);
    Rgb8Image frame;
    std::size_t count = 0;
    run_alone([&] {
      for (int step = 0; step < 8; ++step) {
        const std::size_t before = test::allocation_count();
        renderer.render_moving(turned(step), frame);
        count = test::allocation_count() - before;
      }
    });
    return count;
  };
  EXPECT_LE(allocations(within_ms(0)), allocations(kVertexSettings));
  EXPECT_LE(allocations(within_ms(1e9)), allocations(kVertexSettings));
}

}  // namespace
}  // namespace rimlight
