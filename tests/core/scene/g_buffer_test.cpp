#include "core/scene/g_buffer.h"

#include <gtest/gtest.h>

#include <cstring>
#include <limits>
#include <memory>

#include "core/base/error.h"
#include "core/base/parallel.h"
#include "tests/core/scene/scene_cases.h"
#include "tests/support/error_of.h"
#include "tests/support/reference/triangles.h"

namespace rimlight {
namespace {

/// Of a triangle's size, as in the tests of RayScene.
constexpr double kEdge = 1e-4;
/// Barycentrics in floats: coordinates of about 3 against sides of 0.4.
constexpr double kWeightBound = 2e-5;

std::shared_ptr<const TriangleTree> tree_of(const Mesh& mesh) {
  return std::make_shared<const TriangleTree>(mesh.positions, mesh.triangles, "test");
}

Camera camera_from(const Vec3d& position) {
  Camera camera;
  camera.position = position;
  return camera;
}

bool same_bits(const GBuffer& a, const GBuffer& b) {
  for (int y = 0; y < a.height(); ++y) {
    for (int x = 0; x < a.width(); ++x) {
      if (std::memcmp(&a.at(x, y), &b.at(x, y), sizeof(PrimaryHit)) != 0) return false;
    }
  }
  return true;
}

TEST(GBuffer, HitsMatchBruteForceInDouble) {
  const Mesh mesh = triangle_soup(300, 5);
  const auto scene = scene_of({mesh});
  const Camera camera = camera_from({1.5, 0.7, 2.5});
  const PixelPoint point{0.25, 0.625};
  GBuffer buffer(tree_of(mesh), 61, 43, point);
  ASSERT_TRUE(buffer.trace(camera, GBufferDetail::full));
  int hits = 0, skipped = 0;
  for (int y = 0; y < 43; ++y) {
    for (int x = 0; x < 61; ++x) {
      const Vec3d way(Vec3f(camera.ray_direction(x + point.x, y + point.y, 61, 43)));
      const Vec3d origin{Vec3f(camera.position)};
      const auto grown = reference::nearest_hit(*scene, origin, way, kEdge);
      const auto shrunk = reference::nearest_hit(*scene, origin, way, -kEdge);
      if (grown.has_value() != shrunk.has_value() ||
          (grown && grown->triangle != shrunk->triangle)) {
        ++skipped;
        continue;
      }
      const PrimaryHit& hit = buffer.at(x, y);
      ASSERT_EQ(hit.is_miss(), !grown.has_value()) << x << " " << y;
      if (!grown) continue;
      ++hits;
      ASSERT_EQ(hit.triangle, grown->triangle) << x << " " << y;
      EXPECT_NEAR(hit.u, grown->u, kWeightBound);
      EXPECT_NEAR(hit.v, grown->v, kWeightBound);
    }
  }
  EXPECT_GT(hits, 500);
  EXPECT_LT(skipped, 60);
}

TEST(GBuffer, CoarseThenFullIsFullBitForBit) {
  const auto tree = tree_of(triangle_soup(300, 6));
  const Camera camera = camera_from({2, 1, 2});
  GBuffer at_once(tree, 150, 77), in_steps(tree, 150, 77);
  at_once.trace(camera, GBufferDetail::full);
  ASSERT_TRUE(in_steps.trace(camera, GBufferDetail::coarse));
  EXPECT_EQ(in_steps.detail(), GBufferDetail::coarse);
  int hits = 0;
  for (int y = 0; y < 77; y += 2) {
    for (int x = 0; x < 150; x += 2) {
      ASSERT_EQ(std::memcmp(&in_steps.at(x, y), &at_once.at(x, y), sizeof(PrimaryHit)), 0);
      hits += in_steps.at(x, y).is_miss() ? 0 : 1;
    }
  }
  EXPECT_GT(hits, 300);
  ASSERT_TRUE(in_steps.trace(camera, GBufferDetail::full));
  EXPECT_TRUE(same_bits(at_once, in_steps));
}

TEST(GBuffer, ThreadsAndWhatCameBeforeChangeNoBit) {
  const auto tree = tree_of(test_sphere({0, 0, 0}, 1, 40));
  const Camera first = camera_from({0, 0, 3}), second = camera_from({2, 1, 2});
  GBuffer fresh(tree, 200, 130), used(tree, 200, 130), alone(tree, 200, 130);
  fresh.trace(second, GBufferDetail::full);
  used.trace(first, GBufferDetail::full);
  used.trace(second, GBufferDetail::full);
  run_alone([&] { alone.trace(second, GBufferDetail::full); });
  EXPECT_TRUE(same_bits(fresh, used));
  EXPECT_TRUE(same_bits(fresh, alone));
  used.trace(first, GBufferDetail::full);
  EXPECT_FALSE(same_bits(fresh, used));
}

TEST(GBuffer, AStillViewIsNotTracedAgain) {
  GBuffer buffer(tree_of(test_sphere({0, 0, 0}, 1, 8)), 32, 32);
  const Camera camera = camera_from({0, 0, 3});
  EXPECT_EQ(buffer.detail(), GBufferDetail::none);
  EXPECT_TRUE(buffer.trace(camera, GBufferDetail::full));
  EXPECT_FALSE(buffer.trace(camera, GBufferDetail::full));
  EXPECT_FALSE(buffer.trace(camera, GBufferDetail::coarse));
  EXPECT_TRUE(buffer.trace(camera_from({0, 0, 4}), GBufferDetail::coarse));
  EXPECT_EQ(buffer.detail(), GBufferDetail::coarse);
}

TEST(GBuffer, ACameraInsideAMeshSeesItEverywhere) {
  GBuffer buffer(tree_of(test_sphere({0, 0, 0}, 1, 20)), 40, 30);
  Camera camera = camera_from({0.1, 0, 0});
  camera.target = {5, 2, 1};
  buffer.trace(camera, GBufferDetail::full);
  for (int y = 0; y < 30; ++y) {
    for (int x = 0; x < 40; ++x) EXPECT_FALSE(buffer.at(x, y).is_miss()) << x << " " << y;
  }
}

TEST(GBuffer, NothingAndTrianglesWithoutAreaAreNeverHit) {
  Mesh flat;
  add_triangle(flat, {-1, 0, 0}, {1, 0, 0}, {0.5f, 0, 0});
  for (const Mesh& mesh : {Mesh{}, flat}) {
    GBuffer buffer(tree_of(mesh), 33, 33);
    buffer.trace(camera_from({0, 0, 3}), GBufferDetail::full);
    for (int i = 0; i < 33; ++i) EXPECT_TRUE(buffer.at(i, 16).is_miss());
  }
}

TEST(TriangleTree, RefusesMeshesThatCannotBe) {
  Mesh mesh = test_sphere({0, 0, 0}, 1, 4);
  mesh.triangles[3][1] = static_cast<std::uint32_t>(mesh.positions.size());
  EXPECT_EQ(test::error_of([&] { tree_of(mesh); }),
            "test: triangle 3: found corner 40, expected less than 40");
  mesh = test_sphere({0, 0, 0}, 1, 4);
  mesh.positions[2].y = std::numeric_limits<float>::quiet_NaN();
  EXPECT_EQ(test::error_of([&] { tree_of(mesh); }),
            "test: position 2: found a number that is not finite, expected finite numbers");
}

}  // namespace
}  // namespace rimlight
