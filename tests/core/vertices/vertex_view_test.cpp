#include "core/vertices/vertex_view.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <set>

#include "core/base/parallel.h"
#include "tests/core/vertices/vertex_case.h"

namespace rimlight {
namespace {

/// Directions in floats, of unit vectors and interpolated normals.
constexpr double kDirectionBound = 2e-6;

struct Case {
  VertexScene scene = test::VertexCase().scene;
  std::shared_ptr<const TriangleTree> tree =
      std::make_shared<const TriangleTree>(scene.mesh->positions, scene.mesh->triangles, "test");

  VertexView view(std::vector<PixelPoint> points = {PixelPoint{}}) const {
    return {*scene.mesh,
            tree,
            {scene.width, scene.height, scene.transport.highlight_count, std::move(points)}};
  }
};

TEST(VertexView, NeedsTheCornersOfWhatItSeesAndNoMore) {
  const Case made;
  VertexView view = made.view();
  EXPECT_TRUE(view.look(made.scene.camera, GBufferDetail::full));
  EXPECT_FALSE(view.look(made.scene.camera, GBufferDetail::coarse));
  std::set<std::uint32_t> expected;
  for (int y = 0; y < view.height(); ++y) {
    for (int x = 0; x < view.width(); ++x) {
      const PrimaryHit& hit = view.hit(0, x, y);
      if (hit.is_miss()) continue;
      const auto& corners = made.scene.mesh->triangles[hit.triangle];
      expected.insert(corners.begin(), corners.end());
    }
  }
  EXPECT_GT(expected.size(), 100u);
  EXPECT_LT(expected.size(), made.scene.mesh->positions.size());
  EXPECT_THAT(view.vertices(), testing::ElementsAreArray(expected));
  EXPECT_LT(view.highlight_vertices().size(), view.vertices().size());
  EXPECT_LT(view.highlight_vertices().back(), made.scene.transport.highlight_count);
  EXPECT_GE(view.vertices()[view.highlight_vertices().size()],
            made.scene.transport.highlight_count);
}

TEST(VertexView, MirrorsTheEyeAtWhatHasAHighlight) {
  const Case made;
  VertexView view = made.view({{0.25, 0.75}});
  view.look(made.scene.camera, GBufferDetail::full);
  const VertexMesh& mesh = *made.scene.mesh;
  int mirrored = 0;
  for (int y = 0; y < view.height(); ++y) {
    for (int x = 0; x < view.width(); ++x) {
      const PrimaryHit& hit = view.hit(0, x, y);
      const Vec3d found(view.mirrored(0, x, y));
      const bool is_glossy = !hit.is_miss() && mesh.materials[mesh.triangles[hit.triangle][0]] != 2;
      ASSERT_EQ(found != Vec3d(), is_glossy) << x << " " << y;
      if (!is_glossy) continue;
      ++mirrored;
      const auto& [a, b, c] = mesh.triangles[hit.triangle];
      const Vec3d normal = normalized(Vec3d(mesh.normals[a]) * (1.0 - hit.u - hit.v) +
                                      Vec3d(mesh.normals[b]) * double{hit.u} +
                                      Vec3d(mesh.normals[c]) * double{hit.v});
      const Vec3d way = made.scene.camera.ray_direction(x + 0.25, y + 0.75, 100, 70);
      EXPECT_LT(length(found - (way - normal * (2 * dot(way, normal)))), kDirectionBound);
    }
  }
  EXPECT_GT(mirrored, 500);
}

TEST(VertexView, CoverageIsTheShareOfPointsThatHit) {
  const Case made;
  VertexView view = made.view({{0.1, 0.1}, {0.9, 0.1}, {0.1, 0.9}, {0.9, 0.9}});
  view.look(made.scene.camera, GBufferDetail::full);
  std::set<float> shares;
  for (int y = 0; y < view.height(); ++y) {
    for (int x = 0; x < view.width(); ++x) {
      float share = 0;
      for (std::size_t layer = 0; layer < 4; ++layer) {
        share += view.hit(layer, x, y).is_miss() ? 0 : 0.25f;
      }
      ASSERT_EQ(view.coverage()[static_cast<std::size_t>(y * 100 + x)], share);
      shares.insert(share);
    }
  }
  EXPECT_EQ(shares.size(), 5u);  // edges have some points that hit and some that miss
}

TEST(VertexView, CoarseViewsKnowEverySecondPixelBothWays) {
  const Case made;
  VertexView view = made.view();
  view.look(made.scene.camera, GBufferDetail::coarse);
  EXPECT_EQ(view.step(), 2);
  for (int y = 0; y < 70; ++y) {
    for (int x = 0; x < 100; ++x) {
      const bool hits = !view.hit(0, x - x % 2, y - y % 2).is_miss();
      ASSERT_EQ(view.coverage()[static_cast<std::size_t>(y * 100 + x)], hits ? 1 : 0);
    }
  }
  const std::size_t coarse = view.vertices().size();
  EXPECT_TRUE(view.look(made.scene.camera, GBufferDetail::full));
  EXPECT_EQ(view.step(), 1);
  EXPECT_GE(view.vertices().size(), coarse);
}

TEST(VertexView, KnowsWhatIsSeenFromBehind) {
  const Case made;
  VertexView view = made.view();
  view.look(made.scene.camera, GBufferDetail::full);
  EXPECT_EQ(view.share_from_behind(), 0);
  Camera inside;
  inside.position = {-0.6, 0, 0.1};
  inside.target = {-0.6, 0, -1};
  view.look(inside, GBufferDetail::full);
  EXPECT_EQ(view.share_from_behind(), 1);
  for (int x = 0; x < 100; ++x) EXPECT_EQ(view.mirrored(0, x, 30), Vec3f());
  Camera under;
  under.position = {0, -4, 0.5};
  view.look(under, GBufferDetail::full);
  EXPECT_GT(view.share_from_behind(), 0.9);
}

TEST(VertexView, LooksAtNothingWithoutHarm) {
  const Case made;
  VertexView view = made.view();
  Camera away = made.scene.camera;
  away.target = away.position * 2.0 - away.target;
  view.look(away, GBufferDetail::full);
  EXPECT_TRUE(view.vertices().empty());
  EXPECT_TRUE(view.highlight_vertices().empty());
  EXPECT_EQ(view.share_from_behind(), 0);
}

}  // namespace
}  // namespace rimlight
