#include "core/vertices/vertex_renderer.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <atomic>
#include <cmath>
#include <limits>
#include <numbers>

#include "core/base/parallel.h"
#include "core/relight/prepared_environment.h"
#include "tests/core/vertices/vertex_case.h"
#include "tests/core/vertices/vertex_reference.h"
#include "tests/support/error_of.h"

namespace rimlight {
namespace {

using test::kVertexSettings;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

const Quaternion kTurned = normalized(Quaternion{0.2, -0.5, 0.3, 0.8});

DesignState state_of(const std::string& environment, const Quaternion& rotation = {}) {
  DesignState state;
  state.environment = environment;
  state.rotation = rotation;
  return state;
}

Camera side_view() {
  Camera camera;
  camera.position = {-3, 1.5, 1};
  camera.target = {0.2, -0.1, 0};
  camera.vertical_field_of_view_degrees = 35;
  return camera;
}

AlignedVector<std::uint8_t> exact_bytes(VertexRenderer& renderer, const DesignState& state) {
  Rgb8Image frame;
  FrameReport report;
  EXPECT_TRUE(renderer.render_exact(state, frame, report));
  EXPECT_TRUE(report.exact);
  return frame.bytes;
}

AlignedVector<std::uint8_t> moving_bytes(VertexRenderer& renderer, const DesignState& state) {
  Rgb8Image frame;
  EXPECT_FALSE(renderer.render_moving(state, frame).exact);
  return frame.bytes;
}

RgbImage radiance_of(VertexRenderer& renderer, const DesignState& state) {
  RgbImage image;
  FrameReport report;
  renderer.render_radiance(state, image, report);
  return image;
}

/// Pixels of a coarse grid against brute force; answers how many had surfaces.
int compare(const VertexScene& scene, const DesignState& state) {
  // Products of 36 by 36 coefficients, rotation, and directions in float; relative to Σ |summand|,
  // which is several times the radiance.
  constexpr double kBound = 2e-5;
  VertexRenderer renderer(std::make_shared<const VertexScene>(scene), kVertexSettings);
  const RgbImage image = radiance_of(renderer, state);
  const reference::VertexImage truth(scene, state, test::kLightSize);
  const auto sky =
      prepare_environment(scene.environments[state.environment == "sky" ? 0 : 1].environment,
                          {kVertexSettings.light_size, kVertexSettings.background_size});
  const Camera camera = state.view.value_or(scene.camera);
  int hits = 0;
  for (int y = 3; y < scene.height; y += 11) {
    for (int x = 2; x < scene.width; x += 13) {
      const reference::VertexPixel expected = truth.pixel(x, y);
      if (!expected.is_safe) continue;
      hits += expected.coverage > 0 ? 1 : 0;
      const Vec3d way = camera.ray_direction(x + 0.5, y + 0.5, scene.width, scene.height);
      const Vec3f behind = sky->background.at(Vec3f(rotated(conjugate(state.rotation), way)));
      for (int c = 0; c < 3; ++c) {
        const double value = expected.radiance[c] + (1 - expected.coverage) * behind[c];
        const double size = expected.magnitude + (1 - expected.coverage) * behind[c];
        EXPECT_NEAR(image.at(x, y)[c], value, kBound * size) << x << " " << y;
      }
    }
  }
  return hits;
}

TEST(VertexRenderer, PixelsMatchBruteForceInDouble) {
  EXPECT_GT(compare(*test::scene_of(), state_of("sky", kTurned)), 20);
}

TEST(VertexRenderer, SoDoColouredTransportAndOtherViews) {
  DesignState state = state_of("dim", kTurned);
  state.view = side_view();
  EXPECT_GT(compare(*test::scene_of({.channels = 3}), state), 20);
}

TEST(VertexRenderer, SoDoEditedMaterials) {
  DesignState state = state_of("sky");
  state.materials["brass"] = {Vec3f{0.1f, 0.9f, 0.3f}, std::nullopt, 70.0};
  state.materials["enamel"].highlight = Vec3f{1, 0.2f, 0};
  state.materials["floor"].albedo = Vec3f{0.05f, 0.1f, 1};
  EXPECT_GT(compare(*test::scene_of(), state), 20);
}

TEST(VertexRenderer, TheImageIsLinearInTheLight) {
  VertexRenderer renderer(test::scene_of(), kVertexSettings);
  const RgbImage bright = radiance_of(renderer, state_of("sky", kTurned));
  const RgbImage dim = radiance_of(renderer, state_of("dim", kTurned));
  double size = 0;
  for (std::size_t i = 0; i < bright.pixels.size(); ++i) {
    for (int c = 0; c < 3; ++c) {
      // A quarter is exact in floats, but the environment's average is a sum of other roundings.
      ASSERT_NEAR(dim.pixels[i][c], 0.25 * bright.pixels[i][c], 1e-4);
      size += std::abs(bright.pixels[i][c]);
    }
  }
  EXPECT_GT(size, 1000);
}

TEST(VertexRenderer, ViewLightAndMaterialsChangeWithoutATraceOfWhatWasBefore) {
  DesignState state = state_of("sky", kTurned);
  VertexRenderer used(test::scene_of(), kVertexSettings);
  const auto agrees = [&] {
    VertexRenderer fresh(test::scene_of(), kVertexSettings);
    const auto expected = moving_bytes(fresh, state);
    return moving_bytes(used, state) == expected &&
           exact_bytes(used, state) == exact_bytes(fresh, state);
  };
  const auto first = moving_bytes(used, state);
  EXPECT_TRUE(agrees());
  state.view = side_view();
  EXPECT_TRUE(agrees());
  EXPECT_NE(moving_bytes(used, state), first);
  state.rotation = {};
  EXPECT_TRUE(agrees());
  state.materials["enamel"].exponent = 5;
  EXPECT_TRUE(agrees());
  state.environment = "dim";
  EXPECT_TRUE(agrees());
  state = state_of("sky", kTurned);
  EXPECT_EQ(moving_bytes(used, state), first);
}

TEST(VertexRenderer, ExactFramesAreTheSameAtAnyNumberOfThreads) {
  const DesignState state = state_of("sky", kTurned);
  VertexRenderer parallel(test::scene_of(), kVertexSettings);
  VertexRenderer alone(test::scene_of(), kVertexSettings);
  AlignedVector<std::uint8_t> bytes;
  run_alone([&] { bytes = exact_bytes(alone, state); });
  EXPECT_EQ(exact_bytes(parallel, state), bytes);
}

TEST(VertexRenderer, CoarseFramesShowEveryFourthPixelOfTheFullOne) {
  VertexSettings hasty = kVertexSettings;
  hasty.view_ms = 0;
  VertexRenderer coarse(test::scene_of(), hasty), full(test::scene_of(), kVertexSettings);
  DesignState state = state_of("sky", kTurned);
  const auto whole = moving_bytes(full, state);
  const auto first = moving_bytes(coarse, state);
  const auto at = [](int x, int y) { return 3 * static_cast<std::size_t>(y * 100 + x); };
  for (int y = 0; y < 70; y += 2) {
    for (int x = 0; x < 100; x += 2) {
      for (std::size_t c = 0; c < 3; ++c) ASSERT_EQ(first[at(x, y) + c], whole[at(x, y) + c]);
    }
  }
  EXPECT_NE(first, whole);
  EXPECT_EQ(moving_bytes(coarse, state), whole);  // the same view once more: what was missing
  EXPECT_EQ(exact_bytes(coarse, state), exact_bytes(full, state));
}

TEST(VertexRenderer, AnAbandonedFrameIsNotTouched) {
  VertexRenderer renderer(test::scene_of(), kVertexSettings);
  const DesignState state = state_of("sky");
  std::atomic<int> asked{0};
  Rgb8Image whole;
  FrameReport report;
  const auto count = [&] {
    ++asked;
    return false;
  };
  ASSERT_TRUE(renderer.render_exact(state, whole, report, count));
  const int questions = asked.load();
  ASSERT_GT(questions, 3);
  for (const int patience : {0, 1, 2, questions - 1}) {
    asked = 0;
    Rgb8Image frame(3, 2);
    std::ranges::fill(frame.bytes, std::uint8_t{77});
    EXPECT_FALSE(renderer.render_exact(state, frame, report, [&] { return asked++ >= patience; }));
    EXPECT_EQ(frame.width, 3);
    EXPECT_THAT(frame.bytes, testing::Each(77));
  }
  Rgb8Image again;
  ASSERT_TRUE(renderer.render_exact(state, again, report));
  EXPECT_EQ(again.bytes, whole.bytes);
}

TEST(VertexRenderer, AnAddedEnvironmentIsExposedWhateverItsScale) {
  VertexRenderer renderer(test::scene_of(), kVertexSettings);
  renderer.add_environment(test::sky("added"));
  const auto bytes = exact_bytes(renderer, state_of("added", kTurned));
  renderer.add_environment(test::sky("added", 4));  // a power of two: the same bits
  EXPECT_EQ(exact_bytes(renderer, state_of("added", kTurned)), bytes);
  EXPECT_GT(*std::ranges::max_element(bytes), 100);
}

TEST(VertexRenderer, StatesThatCannotBeShownAreRefusedAndLeaveItWhole) {
  VertexRenderer renderer(test::scene_of(), kVertexSettings);
  const DesignState good = state_of("sky", kTurned);
  const auto before = exact_bytes(renderer, good);
  const auto error = [&](const auto& change) {
    DesignState state = good;
    change(state);
    Rgb8Image frame;
    FrameReport report;
    const std::string moving = test::error_of([&] { renderer.render_moving(state, frame); });
    EXPECT_EQ(moving, test::error_of([&] { renderer.render_exact(state, frame, report); }));
    EXPECT_EQ(moving, test::error_of([&] {
                RgbImage image;
                renderer.render_radiance(state, image, report);
              }));
    return moving;
  };
  constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
  EXPECT_THAT(error([](auto& s) { s.environment = "moon"; }), HasSubstr("one of \"dim\" \"sky\""));
  EXPECT_THAT(error([](auto& s) { s.rotation = {0, 0, 0, 2}; }), HasSubstr("rotation"));
  EXPECT_THAT(error([](auto& s) {
                s.view = Camera{.position = {1, 1, 1}, .target = {1, 1, 1}};
              }),
              HasSubstr("view/target"));
  EXPECT_THAT(error([](auto& s) { s.view = Camera{.up = {0, 0, 1}}; }), HasSubstr("view/up"));
  EXPECT_THAT(error([](auto& s) { s.materials["gold"].albedo = Vec3f(); }),
              HasSubstr("one of \"brass\" \"enamel\" \"floor\""));
  EXPECT_THAT(error([](auto& s) { s.materials["brass"].albedo = Vec3f(0, kNan, 0); }),
              HasSubstr("materials/brass/albedo"));
  EXPECT_THAT(error([](auto& s) { s.materials["brass"].highlight = Vec3f(0, 0, 1.5f); }),
              HasSubstr("materials/brass/highlight"));
  EXPECT_THAT(error([](auto& s) { s.materials["brass"].exponent = -1; }),
              HasSubstr("materials/brass/exponent"));
  EXPECT_THAT(error([](auto& s) {
                s.materials["brass"].lobe = std::vector<double>{0, 0};
              }),
              HasSubstr("materials/brass/lobe"));
  EXPECT_EQ(exact_bytes(renderer, good), before);
}

TEST(VertexRenderer, ALobeSampledFromPhongsGivesNearlyItsPicture) {
  VertexRenderer renderer(test::scene_of(), kVertexSettings);
  DesignState state = state_of("sky", kTurned);
  state.materials["brass"].highlight = Vec3f{1, 1, 1};
  const auto difference = [&](double exponent) {
    state.materials["brass"].exponent = exponent;
    state.materials["brass"].lobe.reset();
    const auto phong = exact_bytes(renderer, state);
    std::vector<double> lobe;
    for (int i = 0; i < 64; ++i)
      lobe.push_back(std::pow(std::cos(i * std::numbers::pi / 2 / 63), 12));
    state.materials["brass"].lobe = lobe;
    const auto sampled = exact_bytes(renderer, state);
    int most = 0;
    for (std::size_t i = 0; i < phong.size(); ++i) {
      most = std::max(most, std::abs(int{phong[i]} - int{sampled[i]}));
    }
    return most;
  };
  EXPECT_LE(difference(12), 1);
  EXPECT_GT(difference(3), 5) << "another exponent's looks otherwise";
}

TEST(VertexRenderer, SaysWhatOfEditsAndViewsItDoesNotShow) {
  VertexScene scene = test::VertexCase().scene;
  scene.has_interreflection = true;
  VertexRenderer renderer(std::make_shared<const VertexScene>(scene), kVertexSettings);
  DesignState state = state_of("sky");
  Rgb8Image frame;
  EXPECT_THAT(renderer.render_moving(state, frame).unshown, IsEmpty());
  state.view = side_view();
  state.materials["enamel"].highlight = Vec3f{1, 1, 1};
  EXPECT_THAT(renderer.render_moving(state, frame).unshown, IsEmpty());
  state.materials["brass"] = {Vec3f{1, 1, 1}, std::nullopt, 5000.0};
  state.materials["floor"].highlight = Vec3f{1, 1, 1};
  EXPECT_THAT(renderer.render_moving(state, frame).unshown,
              ElementsAre(HasSubstr("light from brass"), HasSubstr("sharpness of brass"),
                          HasSubstr("highlight of floor")));
  state.materials.clear();
  state.view = Camera{.position = {-0.6, 0, 0.1}, .target = {-0.6, 0, -1}};  // inside a sphere
  EXPECT_THAT(renderer.render_moving(state, frame).unshown, ElementsAre(HasSubstr("backs")));
}

}  // namespace
}  // namespace rimlight
