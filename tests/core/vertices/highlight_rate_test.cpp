#include "core/vertices/highlight_rate.h"

#include <gtest/gtest.h>

#include <set>

#include "core/base/parallel.h"
#include "core/transport/receivers.h"
#include "tests/core/vertices/vertex_case.h"

namespace rimlight {
namespace {

constexpr int kDegree = 5;
constexpr std::array kCoarse{HighlightRate::quarter, HighlightRate::sixteenth};

/// A view of the case, and its plan.
struct Planned {
  test::VertexCase made;
  VertexView view;
  HighlightPlan plan;

  explicit Planned(GBufferDetail detail = GBufferDetail::full)
      : made({.rings = 40, .width = 150, .height = 110}),
        view(painted(),
             std::make_shared<const TriangleTree>(made.scene.mesh->positions,
                                                  made.scene.mesh->triangles, "case"),
             {150, 110, made.scene.transport.highlight_count, {PixelPoint{}}}),
        plan(*made.scene.mesh, kDegree) {
    view.look(made.scene.camera, detail);
    plan.find(view);
  }
  /// Upper halves of the spheres are of another material than lower ones: an edge that nothing but
  /// the material shows.
  const VertexMesh& painted() {
    auto mesh = std::make_shared<VertexMesh>(*made.scene.mesh);
    for (std::size_t v = 0; v < made.scene.transport.highlight_count; ++v) {
      mesh->materials[v] = mesh->positions[v].y > 0.05f ? 1 : 0;
    }
    made.scene.mesh = mesh;
    return *made.scene.mesh;
  }
  const VertexMesh& mesh() const { return *made.scene.mesh; }
  std::uint32_t material(int x, int y) const {
    return mesh().materials[mesh().triangles[view.hit(0, x, y).triangle][0]];
  }
  bool shines(int x, int y) const {
    return !view.hit(0, x, y).is_miss() && view.has_highlight(0, x, y);
  }
  template <typename Visit>
  void for_each_shining(const Visit& visit) const {
    for (int y = 0; y < view.height(); y += view.step()) {
      for (int x = 0; x < view.width(); x += view.step()) {
        if (shines(x, y)) visit(x, y);
      }
    }
  }
};

TEST(HighlightPlan, WeightsOfCornersAreBilinearAndReproduceAPlane) {
  for (const int side : {2, 4}) {
    for (int y = 8; y < 16; ++y) {
      for (int x = 8; x < 16; ++x) {
        float sum = 0, at_x = 0, at_y = 0;
        for (const GridWeight& one : grid_weights(x, y, side, 15)) {
          EXPECT_EQ(one.x % side + one.y % side, 0);
          sum += one.weight;
          at_x += one.weight * static_cast<float>(one.x);
          at_y += one.weight * static_cast<float>(one.y);
        }
        EXPECT_NEAR(sum, 1, 1e-6);
        EXPECT_NEAR(at_x, x, 1e-5);
        EXPECT_NEAR(at_y, y, 1e-5);
      }
    }
  }
  const auto alone = grid_weights(9, 9, 4, 2);
  EXPECT_EQ(alone[1].weight, 1);
  EXPECT_EQ(alone[0].weight + alone[2].weight + alone[3].weight, 0);
}

TEST(HighlightPlan, NeverReachesAcrossAnEdge) {
  const Planned planned;
  const float least = std::cos(6.0f / (kDegree + 1));
  std::size_t corners = 0, evaluated = 0;
  planned.for_each_shining([&](int x, int y) {
    for (const HighlightRate rate : kCoarse) {
      const GridCorners fitting = planned.plan.corners(rate, x, y);
      evaluated += fitting == 0 ? 1 : 0;
      if (fitting == 0) continue;
      for (const GridWeight& one : grid_weights(x, y, spacing(rate), fitting)) {
        ASSERT_TRUE(one.weight >= 0 && one.weight <= 1.0001f);
        if (!(one.weight > 0)) continue;
        ++corners;
        ASSERT_LT(one.x, planned.view.width());
        ASSERT_LT(one.y, planned.view.height());
        ASSERT_TRUE(planned.shines(one.x, one.y));
        EXPECT_EQ(planned.material(one.x, one.y), planned.material(x, y));
        EXPECT_GE(dot(planned.view.mirrored(0, x, y), planned.view.mirrored(0, one.x, one.y)),
                  least - 1e-6f);
        EXPECT_NEAR(planned.view.distance(0, one.x, one.y), planned.view.distance(0, x, y), 0.3);
        // What is evaluated is on the grid itself.
        EXPECT_EQ(planned.plan.corners(rate, one.x, one.y), 0);
      }
    }
  });
  EXPECT_GT(corners, 5000u);
  EXPECT_GT(evaluated, 1000u);
}

TEST(HighlightPlan, SpheresInteriorIsInterpolated) {
  const Planned planned;
  const std::size_t every = planned.plan.evaluated(HighlightRate::every);
  ASSERT_GT(every, 2000u);
  EXPECT_LT(planned.plan.evaluated(HighlightRate::quarter), 2 * every / 5);
  EXPECT_LT(planned.plan.evaluated(HighlightRate::sixteenth), every / 4);
}

TEST(HighlightPlan, VerticesAreThoseOfWhatIsEvaluatedAtThisRateOrCoarser) {
  const Planned planned;
  std::set<std::uint32_t> needed;
  for (const HighlightRate rate : {HighlightRate::sixteenth, HighlightRate::quarter}) {
    std::size_t evaluated = 0;
    planned.for_each_shining([&](int x, int y) {
      if (planned.plan.corners(rate, x, y) != 0 && !HighlightPlan::is_sample(x, y)) return;
      ++evaluated;
      const auto& corners = planned.mesh().triangles[planned.view.hit(0, x, y).triangle];
      needed.insert(corners.begin(), corners.end());
    });
    const auto found = planned.plan.vertices(rate);
    EXPECT_EQ(std::vector(found.begin(), found.end()), std::vector(needed.begin(), needed.end()));
    EXPECT_EQ(planned.plan.evaluated(rate), evaluated);
  }
  const auto all = planned.plan.vertices(HighlightRate::every);
  const auto seen = planned.view.highlight_vertices();
  EXPECT_TRUE(std::ranges::equal(all, seen));
  EXPECT_LT(planned.plan.vertices(HighlightRate::sixteenth).size(), all.size());
}

TEST(HighlightPlan, SamplesAreOneInSixtyFour) {
  std::size_t samples = 0;
  for (int y = 0; y < 512; ++y) {
    for (int x = 0; x < 512; ++x) samples += HighlightPlan::is_sample(x, y) ? 1 : 0;
  }
  EXPECT_NEAR(static_cast<double>(samples), 4096, 6 * 64);
}

TEST(HighlightPlan, ACoarseViewHasNothingBetweenItsPixelsAtTheQuarter) {
  const Planned planned(GBufferDetail::coarse);
  EXPECT_EQ(planned.plan.evaluated(HighlightRate::quarter),
            planned.plan.evaluated(HighlightRate::every));
  EXPECT_LT(planned.plan.evaluated(HighlightRate::sixteenth),
            planned.plan.evaluated(HighlightRate::every) / 2);
}

TEST(HighlightPlan, IsTheSameAtAnyNumberOfThreads) {
  Planned planned;
  HighlightPlan alone(planned.mesh(), kDegree);
  run_alone([&] { alone.find(planned.view); });
  planned.for_each_shining([&](int x, int y) {
    for (const HighlightRate rate : kCoarse) {
      ASSERT_EQ(alone.corners(rate, x, y), planned.plan.corners(rate, x, y));
    }
  });
  for (const HighlightRate rate : kCoarse) {
    EXPECT_TRUE(std::ranges::equal(alone.vertices(rate), planned.plan.vertices(rate)));
  }
}

}  // namespace
}  // namespace rimlight
