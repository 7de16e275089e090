// A sun apart from the harmonics: its shadows, and frames with it.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/base/parallel.h"
#include "core/vertices/sun_shadows.h"
#include "core/vertices/vertex_renderer.h"
#include "tests/core/vertices/vertex_case.h"
#include "tests/core/vertices/vertex_reference.h"

namespace rimlight {
namespace {

using test::kVertexSettings;

const Quaternion kTurned = normalized(Quaternion{0.1, -0.2, 0.15, 0.9});

/// A gradient with one small pixel, in the middle of a texel, that outshines the rest; `sun`: its
/// radiance.
std::shared_ptr<const Environment> sunny_sky(const std::string& name, float sun) {
  RgbImage image(256, 128);
  for (int y = 0; y < 128; ++y) {
    for (int x = 0; x < 256; ++x) {
      image.at(x, y) = Vec3f(0.6f, 0.7f + 0.002f * static_cast<float>(y), 1.0f);
    }
  }
  const Vec3d way =
      cube::texel_direction(cube::texel_of({0.6, 0.7, 0.4}, test::kLightSize), test::kLightSize);
  const double azimuth = std::atan2(way.x, -way.z), height = std::asin(way.y);
  image.at(static_cast<int>((azimuth / (2 * std::numbers::pi) + 0.5) * 256),
           static_cast<int>((0.5 - height / std::numbers::pi) * 128)) = Vec3f(1, 0.9f, 0.7f) * sun;
  return std::make_shared<const Environment>(name, std::move(image));
}

std::shared_ptr<const VertexScene> sunny_scene(SunLight sun) {
  VertexScene scene = test::VertexCase().scene;
  scene.environments = {{sunny_sky("day", 8000), 0.4}, {test::sky("overcast"), 0.7}};
  scene.sun = sun;
  return std::make_shared<const VertexScene>(scene);
}

DesignState day(const Quaternion& rotation = {}) {
  DesignState state;
  state.environment = "day";
  state.rotation = rotation;
  return state;
}

RgbImage radiance_of(const std::shared_ptr<const VertexScene>& scene, const DesignState& state,
                     const VertexSettings& settings = kVertexSettings) {
  VertexRenderer renderer(scene, settings);
  RgbImage image;
  FrameReport report;
  renderer.render_radiance(state, image, report);
  return image;
}

AlignedVector<std::uint8_t> exact_bytes(VertexRenderer& renderer, const DesignState& state) {
  Rgb8Image frame;
  FrameReport report;
  EXPECT_TRUE(renderer.render_exact(state, frame, report));
  return frame.bytes;
}

AlignedVector<std::uint8_t> moving_bytes(VertexRenderer& renderer, const DesignState& state) {
  Rgb8Image frame;
  renderer.render_moving(state, frame);
  return frame.bytes;
}

TEST(VertexSun, PixelsMatchBruteForceInDouble) {
  const auto scene = sunny_scene(SunLight::directional);
  for (const Quaternion& rotation : {Quaternion{}, kTurned}) {
    const RgbImage image = radiance_of(scene, day(rotation));
    const reference::VertexImage truth(*scene, day(rotation), test::kLightSize);
    int lit = 0, shaded = 0;
    for (int y = 3; y < scene->height; y += 7) {
      for (int x = 2; x < scene->width; x += 9) {
        const reference::VertexPixel expected = truth.pixel(x, y);
        if (!expected.is_safe || expected.coverage < 1) continue;
        for (int c = 0; c < 3; ++c) {
          EXPECT_NEAR(image.at(x, y)[c], expected.radiance[c], 3e-5 * expected.magnitude)
              << x << " " << y;
        }
        ++(expected.sun > 0 ? lit : shaded);
      }
    }
    EXPECT_GT(lit, 15);
    EXPECT_GT(shaded, 4);
  }
}

TEST(VertexSun, AnEnvironmentWithoutASunLooksTheSame) {
  DesignState state;
  state.environment = "overcast";
  EXPECT_EQ(radiance_of(sunny_scene(SunLight::directional), state).pixels,
            radiance_of(sunny_scene(SunLight::harmonics), state).pixels);
}

TEST(VertexSun, SettingsOverruleTheScene) {
  VertexSettings apart = kVertexSettings, together = kVertexSettings;
  apart.sun = SunLight::directional;
  together.sun = SunLight::harmonics;
  const auto image = radiance_of(sunny_scene(SunLight::harmonics), day());
  EXPECT_EQ(radiance_of(sunny_scene(SunLight::directional), day(), together).pixels, image.pixels);
  EXPECT_NE(radiance_of(sunny_scene(SunLight::harmonics), day(), apart).pixels, image.pixels);
}

TEST(VertexSun, ViewAndLightChangeWithoutATraceOfWhatWasBefore) {
  DesignState state = day(kTurned);
  const auto scene = sunny_scene(SunLight::directional);
  VertexRenderer used(scene, kVertexSettings);
  const auto agrees = [&] {
    VertexRenderer fresh(scene, kVertexSettings);
    const auto expected = moving_bytes(fresh, state);
    return moving_bytes(used, state) == expected &&
           exact_bytes(used, state) == exact_bytes(fresh, state);
  };
  EXPECT_TRUE(agrees());
  const auto first = moving_bytes(used, state);
  state.rotation = {};
  EXPECT_TRUE(agrees());
  EXPECT_NE(moving_bytes(used, state), first);
  state.view = Camera{.position = {-3, 1.5, 1}, .target = {0.2, -0.1, 0}};
  EXPECT_TRUE(agrees());
  state.environment = "overcast";
  EXPECT_TRUE(agrees());
  state = day(kTurned);
  EXPECT_TRUE(agrees());
}

TEST(VertexSun, ExactFramesAreTheSameAtAnyNumberOfThreads) {
  const auto scene = sunny_scene(SunLight::directional);
  VertexRenderer parallel(scene, kVertexSettings), alone(scene, kVertexSettings);
  AlignedVector<std::uint8_t> bytes;
  run_alone([&] { bytes = exact_bytes(alone, day()); });
  EXPECT_EQ(exact_bytes(parallel, day()), bytes);
}

/// A small plate over a floor, seen from above and aside.
struct Plate {
  VertexMesh mesh;
  std::shared_ptr<const TriangleTree> tree;
  Camera camera;

  Plate() {
    add_square(4, 0);
    add_square(0.5f, 1);
    tree = std::make_shared<const TriangleTree>(mesh.positions, mesh.triangles, "plate");
    camera.position = {3, 2, 3};
    camera.target = {0, 0, 0};
  }
  void add_square(float half, float y) {
    const auto first = static_cast<std::uint32_t>(mesh.positions.size());
    for (const auto& [x, z] : {std::pair{-1, -1}, {-1, 1}, {1, 1}, {1, -1}}) {
      mesh.positions.push_back({half * static_cast<float>(x), y, half * static_cast<float>(z)});
      mesh.normals.push_back({0, 1, 0});
    }
    mesh.triangles.push_back({first, first + 1, first + 2});
    mesh.triangles.push_back({first, first + 2, first + 3});
  }
  VertexView view() const {
    VertexView view(mesh, tree, {160, 120, 0, {PixelPoint{}}});
    view.look(camera, GBufferDetail::full);
    return view;
  }
};

/// The share of a disc of radius 1 on the side x > edge.
double share_beyond(double edge) {
  const double x = std::clamp(edge, -1.0, 1.0);
  return (std::acos(x) - x * std::sqrt(1 - x * x)) / std::numbers::pi;
}

TEST(SunShadows, AreSharpWithOneRayAndAPenumbraWithMany) {
  const Plate plate;
  const VertexView view = plate.view();
  const Sun sun{{0, 1, 0}, {1, 1, 1}, 0.1};
  SunShadows sharp(plate.mesh, plate.tree, 1), soft(plate.mesh, plate.tree, 256);
  sharp.find(view, sun, true);
  soft.find(view, sun, true);
  int lit = 0, dark = 0, between = 0;
  for (int y = 0; y < 120; ++y) {
    for (int x = 0; x < 160; ++x) {
      const PrimaryHit& hit = view.hit(0, x, y);
      if (hit.is_miss()) continue;
      const auto& [a, b, c] = plate.mesh.triangles[hit.triangle];
      const Vec3f at = plate.mesh.positions[a] * (1 - hit.u - hit.v) +
                       plate.mesh.positions[b] * hit.u + plate.mesh.positions[c] * hit.v;
      const auto pixel = static_cast<std::size_t>(y * 160 + x);
      EXPECT_EQ(sharp.at(0, pixel).cosine, 1);
      const bool on_floor = at.y < 0.5;
      const double beside = std::max(std::abs(at.x), std::abs(at.z)) - 0.5;
      if (std::abs(beside) > 1e-4) {
        const bool visible = !on_floor || beside > 0;
        EXPECT_EQ(sharp.at(0, pixel).visible, visible ? 1 : 0) << at.x << " " << at.z;
        ++(visible ? lit : dark);
      }
      // Beside the middle of a side the plate hides a half plane, seen from 1 below.
      if (!on_floor || std::min(std::abs(at.x), std::abs(at.z)) > 0.35) continue;
      const double expected = 1 - share_beyond(beside / std::tan(sun.angular_radius));
      EXPECT_NEAR(soft.at(0, pixel).visible, expected, 0.03);
      between += expected > 0.1 && expected < 0.9 ? 1 : 0;
    }
  }
  EXPECT_GT(lit, 1000);
  EXPECT_GT(dark, 50);
  EXPECT_GT(between, 30);
}

TEST(SunShadows, BehindASurfaceThereIsNoSun) {
  const Plate plate;
  const VertexView view = plate.view();
  SunShadows shadows(plate.mesh, plate.tree, 1);
  shadows.find(view, {{0, -1, 0}, {1, 1, 1}, 0}, true);
  for (std::size_t pixel = 0; pixel < 160 * 120; ++pixel) {
    ASSERT_EQ(shadows.at(0, pixel).cosine, 0);
    ASSERT_EQ(shadows.at(0, pixel).visible, 0);
  }
}

TEST(SunShadows, ACoarseViewHasTheBitsOfAFullOne) {
  const auto scene = sunny_scene(SunLight::directional);
  const auto tree =
      std::make_shared<const TriangleTree>(scene->mesh->positions, scene->mesh->triangles, "scene");
  const Sun sun{normalized(Vec3d{1, 1, 0.4}), {1, 1, 1}, 0.02};
  VertexView full(*scene->mesh, tree, {101, 67, 0, {PixelPoint{}}});
  VertexView coarse(*scene->mesh, tree, {101, 67, 0, {PixelPoint{}}});
  full.look(scene->camera, GBufferDetail::full);
  coarse.look(scene->camera, GBufferDetail::coarse);
  SunShadows of_full(*scene->mesh, tree, 3), of_coarse(*scene->mesh, tree, 3);
  of_full.find(full, sun, true);
  of_coarse.find(coarse, sun, true);
  int partly = 0;
  for (int y = 0; y < 67; y += 2) {
    for (int x = 0; x < 101; x += 2) {
      const auto pixel = static_cast<std::size_t>(y * 101 + x);
      ASSERT_EQ(of_full.at(0, pixel).cosine, of_coarse.at(0, pixel).cosine);
      ASSERT_EQ(of_full.at(0, pixel).visible, of_coarse.at(0, pixel).visible);
      partly += of_full.at(0, pixel).visible > 0 ? 1 : 0;
    }
  }
  EXPECT_GT(partly, 200);
}

}  // namespace
}  // namespace rimlight
