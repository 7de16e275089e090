#include "core/vertices/frame_deadline.h"

#include <gtest/gtest.h>

#include <chrono>
#include <thread>

#include "tests/core/vertices/vertex_case.h"

namespace rimlight {
namespace {

constexpr FrameBudget kNoTime{FrameBudget::Unit::milliseconds, 0};
constexpr FrameBudget kLong{FrameBudget::Unit::milliseconds, 1e6};

void wait_ms(int ms) { std::this_thread::sleep_for(std::chrono::milliseconds(ms)); }

/// A plan with highlights.
struct Planned {
  test::VertexCase made{{.rings = 40, .width = 260, .height = 200}};
  VertexView view{*made.scene.mesh,
                  std::make_shared<const TriangleTree>(made.scene.mesh->positions,
                                                       made.scene.mesh->triangles, "case"),
                  {260, 200, made.scene.transport.highlight_count, {PixelPoint{}}}};
  HighlightPlan plan{*made.scene.mesh, 5};

  Planned() {
    view.look(made.scene.camera, GBufferDetail::full);
    plan.find(view);
  }
};

TEST(FrameDeadline, CountsKeepNoneAndViewsFollowTheirOwnLimit) {
  const Planned planned;
  FrameDeadline counts({FrameBudget::Unit::coefficients, 0}, 5);
  counts.start();
  EXPECT_FALSE(counts.is_kept());
  EXPECT_EQ(counts.choose_rate(planned.plan, {1'000'000, 1, 1}), HighlightRate::every);
  EXPECT_EQ(counts.detail(GBufferDetail::none), GBufferDetail::full);
  counts.looked(GBufferDetail::none, GBufferDetail::full, 6);
  EXPECT_EQ(counts.detail(GBufferDetail::none), GBufferDetail::coarse);
  EXPECT_EQ(counts.detail(GBufferDetail::coarse), GBufferDetail::full);
  FrameDeadline hasty({FrameBudget::Unit::bytes, 1e9}, 0);
  EXPECT_EQ(hasty.detail(GBufferDetail::none), GBufferDetail::coarse);
}

TEST(FrameDeadline, TheRateFollowsWhatVerticesTook) {
  const Planned planned;
  FrameDeadline deadline({FrameBudget::Unit::milliseconds, 1000}, 25);
  const auto rate = [&] {
    deadline.start();
    return deadline.choose_rate(planned.plan, {10'000, 5'000, 2'000});
  };
  EXPECT_EQ(rate(), HighlightRate::every) << "nothing is known yet";
  deadline.lit(10, 1e9);
  EXPECT_EQ(rate(), HighlightRate::every) << "so few vertices tell nothing";
  for (int i = 0; i < 5; ++i) deadline.lit(10'000, 1500);
  EXPECT_EQ(rate(), HighlightRate::quarter);
  for (int i = 0; i < 5; ++i) deadline.lit(10'000, 4000);
  EXPECT_EQ(rate(), HighlightRate::sixteenth);
  deadline.lit(10'000, 1);
  EXPECT_EQ(rate(), HighlightRate::sixteenth) << "one frame is no evidence";
  for (int i = 0; i < 5; ++i) deadline.lit(10'000, 1);
  EXPECT_EQ(rate(), HighlightRate::every);
}

TEST(FrameDeadline, LateTilesGoToCoarserRates) {
  const Planned planned;
  FrameDeadline deadline({FrameBudget::Unit::milliseconds, 60}, 25);
  deadline.start();
  deadline.start_tiles(planned.plan, HighlightRate::every);
  const std::size_t tiles = planned.plan.tile_count();
  ASSERT_GT(tiles, 10u);
  EXPECT_EQ(deadline.rate_of_tile(), HighlightRate::every);
  HighlightRate before = HighlightRate::every;
  for (std::size_t tile = 0; tile < tiles; ++tile) {
    const HighlightRate rate = deadline.rate_of_tile();
    EXPECT_GE(rate, before);
    before = rate;
    wait_ms(12);
    deadline.finish_tile(tile, rate);
  }
  EXPECT_EQ(before, HighlightRate::sixteenth);
  deadline.finish();
  // What it took is remembered: 20 tiles of 12 ms are no 60.
  deadline.start();
  EXPECT_EQ(deadline.choose_rate(planned.plan, {}), HighlightRate::sixteenth);
}

TEST(FrameDeadline, ViewsAreCoarseWhereFullOnesTakeTooLong) {
  const Planned planned;
  FrameDeadline deadline({FrameBudget::Unit::milliseconds, 100}, 1e9);
  deadline.start();
  EXPECT_EQ(deadline.detail(GBufferDetail::none), GBufferDetail::full);
  deadline.looked(GBufferDetail::none, GBufferDetail::full, 130);
  deadline.start();
  EXPECT_EQ(deadline.detail(GBufferDetail::none), GBufferDetail::coarse);
  EXPECT_EQ(deadline.detail(GBufferDetail::coarse), GBufferDetail::full) << "the rest of a view";
  int coarse = 0;
  while (deadline.detail(GBufferDetail::none) == GBufferDetail::coarse && coarse < 1000) {
    deadline.looked(GBufferDetail::none, GBufferDetail::coarse, 30);
    deadline.start();
    ++coarse;
  }
  EXPECT_GT(coarse, 10);
  EXPECT_LT(coarse, 20) << "130 · 0.98^14 is below 100: it is tried again";
}

TEST(FrameDeadline, NoTimeIsTheCoarsestAndMuchTimeTheFinest) {
  const Planned planned;
  FrameDeadline none(kNoTime, 25), much(kLong, 25);
  none.start();
  much.start();
  EXPECT_EQ(none.choose_rate(planned.plan, {}), HighlightRate::sixteenth);
  EXPECT_EQ(much.choose_rate(planned.plan, {}), HighlightRate::every);
  EXPECT_EQ(none.detail(GBufferDetail::none), GBufferDetail::coarse);
  EXPECT_EQ(much.detail(GBufferDetail::none), GBufferDetail::full);
}

}  // namespace
}  // namespace rimlight
