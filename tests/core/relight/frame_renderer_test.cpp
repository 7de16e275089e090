#include "core/relight/frame_renderer.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <memory>
#include <vector>

#include "core/base/error.h"
#include "core/base/parallel.h"
#include "core/basis/cube_haar.h"
#include "core/image/metrics.h"
#include "core/image/tone_map.h"
#include "core/light/light_rotation.h"
#include "core/relight/prepared_environment.h"
#include "tests/support/allocation_count.h"
#include "tests/support/reference/columns.h"
#include "tests/support/reference/pixel_haar.h"
#include "tests/support/small_bake.h"
#include "tests/support/temporary_folder.h"

namespace rimlight {
namespace {

const test::SmallBake kSettings{.cube_size = 8, .lowest = -0.2};
constexpr int kBackgroundSize = 32;  // small, since projecting costs by its texels
const Quaternion kTurned = normalized(Quaternion{0.1, -0.5, 0.3, 0.8});

RelightSettings settings(const char* policy = "pbi", std::size_t budget = 30) {
  return {parse_policy(policy, "test"),
          {FrameBudget::Unit::coefficients, static_cast<double>(budget)},
          kBackgroundSize};
}

std::shared_ptr<const Bake> small_bake() {
  static const test::TemporaryFolder folder;
  static const std::shared_ptr<const Bake> bake = [] {
    test::write_small_bake(folder / "a.bake", kSettings);
    return std::make_shared<const Bake>(folder / "a.bake");
  }();
  return bake;
}

/// What a pixel should show, in double, and the magnitudes that rounding scales with.
struct Reference {
  std::vector<Vec3d> geometry;  // [height][width]: B alone
  std::vector<Vec3d> radiance;  // with the environment behind it
  std::vector<double> magnitude;
};

Reference reference_image(const Bake& bake, const DesignState& state) {
  const PixelLayout& pixels = bake.manifest().pixels;
  const CubeHaar haar(bake.manifest().cube_size);
  const auto& environments = bake.environments();
  const auto baked = std::ranges::find_if(environments, [&](const BakedEnvironment& one) {
    return one.environment->name() == state.environment;
  });
  const auto prepared = prepare_environment(baked->environment, {haar.size(), kBackgroundSize});
  LightRotator rotator(prepared->texels);
  CubeLight texels, light(haar.size());
  rotator.rotate(state.rotation, texels);
  for (int c = 0; c < 3; ++c) haar.forward(texels.channel(c), light.channel(c));
  std::vector<ColumnDelta> columns;
  for (std::uint32_t i = 0; i < light.count(); ++i) columns.push_back({i, light.at(i)});

  Reference image;
  image.radiance.resize(static_cast<std::size_t>(pixels.width * pixels.height));
  image.geometry.resize(image.radiance.size());
  image.magnitude.resize(image.radiance.size());
  const std::vector<float> zero(kTileFloats);
  for (std::size_t tile = 0; tile < pixels.tile_count(); ++tile) {
    const auto held = reference::add_columns(bake.transport(), tile, columns, zero);
    const auto reflectance = bake.reflectance().tile_span(tile);
    const auto product = reference::restore_radiance(held.value, reflectance, false);
    const auto magnitude = reference::restore_radiance(held.magnitude, reflectance, true);
    for (std::size_t i = 0; i < kTileReceivers; ++i) {
      const auto [x, y] = pixels.pixel(tile * kTileReceivers + i);
      if (x >= pixels.width || y >= pixels.height) continue;
      const auto at = static_cast<std::size_t>(y * pixels.width + x);
      const Vec3d ray = rotated(
          conjugate(state.rotation),
          bake.manifest().camera.ray_direction(x + 0.5, y + 0.5, pixels.width, pixels.height));
      const Vec3f behind = prepared->background.at(Vec3f(ray));
      for (int c = 0; c < 3; ++c) {
        const std::size_t lane = i / 8 * kBlockFloats + static_cast<std::size_t>(c) * 8 + i % 8;
        image.geometry[at][c] = product[lane];
        image.radiance[at][c] = product[lane] + (1 - double{bake.coverage()[at]}) * behind[c];
        image.magnitude[at] = std::max(image.magnitude[at], magnitude[lane] + behind[c]);
      }
    }
  }
  return image;
}

TEST(FrameRenderer, TheExactImageIsTheProductWithTheEnvironmentBehindIt) {
  const auto bake = small_bake();
  FrameRenderer renderer(bake, settings());
  for (const DesignState& state : {DesignState{"sky", {}, 0}, DesignState{"sky", kTurned, 0},
                                   DesignState{"room", kTurned, 0}}) {
    RgbImage image;
    FrameReport report;
    renderer.render_radiance(state, image, report);
    const Reference expected = reference_image(*bake, state);
    double size = 0;
    for (std::size_t i = 0; i < expected.radiance.size(); ++i) {
      // 384 columns of three roundings; the ray turned in float moves by 2⁻²⁴ · 4 or so, which in a
      // map of 256 texels a face is 10⁻⁴ of the step between neighbours.
      const double bound = (3 * 0x1p-24 * 384 + 1e-3) * expected.magnitude[i];
      for (int c = 0; c < 3; ++c) {
        ASSERT_TRUE(std::abs(image.pixels[i][c] - expected.radiance[i][c]) <= bound)
            << i << " " << image.pixels[i][c] << " " << expected.radiance[i][c];
        size += std::abs(expected.radiance[i][c]);
      }
    }
    EXPECT_GT(size, 0);
    EXPECT_TRUE(report.exact);
    EXPECT_EQ(report.residual, 0);
    EXPECT_GT(report.terms, 100u);
  }
}

TEST(PreparedEnvironment, IsSharedAsLongAsItsEnvironmentLives) {
  const auto make = [] { return test::small_environments()[0].environment; };
  auto environment = make();
  const auto first = prepare_environment(environment, {4, 8});
  EXPECT_EQ(prepare_environment(environment, {4, 8}), first);
  EXPECT_NE(prepare_environment(environment, {8, 8}), first);
  EXPECT_EQ(first->texels.values, environment->project(4).values);
  environment = make();
  EXPECT_NE(prepare_environment(environment, {4, 8}), first);
}

TEST(FrameRenderer, PixelsAreTheRadianceToneMapped) {
  FrameRenderer renderer(small_bake(), settings());
  for (const double stops : {-3.0, 0.0, 1.5}) {
    const DesignState state{"sky", kTurned, stops};
    RgbImage radiance;
    Rgb8Image frame;
    FrameReport report;
    renderer.render_radiance(state, radiance, report);
    ASSERT_TRUE(renderer.render_exact(state, frame, report));
    ASSERT_EQ(frame.width, radiance.width);
    ASSERT_EQ(frame.height, radiance.height);
    int middle = 0;
    for (std::size_t i = 0; i < frame.bytes.size(); ++i) {
      // The small bake's sky has the exposure 0.5.
      const double linear =
          radiance.pixels[i / 3][static_cast<int>(i % 3)] * 0.5 * std::exp2(stops);
      const double expected = 255 * srgb_from_linear(std::clamp(linear, 0.0, 1.0));
      ASSERT_NEAR(frame.bytes[i], expected, 1.01) << i;
      middle += frame.bytes[i] > 10 && frame.bytes[i] < 245;
    }
    EXPECT_GT(middle, 1000);
  }
}

TEST(FrameRenderer, TheExactFrameHasTheSameBytesWhateverCameBefore) {
  const auto bake = small_bake();
  const DesignState last{"room", kTurned, 0.5};
  Rgb8Image fresh, moved;
  FrameReport report;
  FrameRenderer first(bake, settings());
  ASSERT_TRUE(first.render_exact(last, fresh, report));
  for (const char* const policy : {"linear", "nwa", "bi", "pbi", "benefit"}) {
    FrameRenderer renderer(bake, settings(policy, 20));
    for (int i = 0; i < 10; ++i) {
      renderer.render_moving({i % 4 == 0 ? "room" : "sky", axis_angle({0, 1, 0}, 0.2 * i), 0},
                             moved);
    }
    ASSERT_NE(moved.bytes, fresh.bytes);
    ASSERT_TRUE(renderer.render_exact(last, moved, report));
    EXPECT_EQ(moved.bytes, fresh.bytes);
  }
}

TEST(FrameRenderer, TheSameFramesHaveTheSameBytesAtAnyThreadCount) {
  std::vector<AlignedVector<std::uint8_t>> found;
  for (const int threads : {1, 2, 3}) {
    set_thread_count(threads);
    FrameRenderer renderer(small_bake(), settings("pbi", 20));
    Rgb8Image frame;
    AlignedVector<std::uint8_t> all;
    for (int i = 0; i < 6; ++i) {
      renderer.render_moving({"sky", axis_angle({1, 1, 0}, 0.1 * i), 0}, frame);
      all.insert(all.end(), frame.bytes.begin(), frame.bytes.end());
    }
    found.push_back(std::move(all));
  }
  set_thread_count(0);
  EXPECT_EQ(found[0], found[1]);
  EXPECT_EQ(found[0], found[2]);
}

void expect_budget_and_convergence(const RelightSettings& settings) {
  FrameRenderer renderer(small_bake(), settings);
  Rgb8Image frame, exact;
  FrameReport report = renderer.render_moving({"sky", {}, 0}, frame);
  EXPECT_EQ(report.bands_reset, 3u);
  EXPECT_EQ(report.terms, 30u);
  EXPECT_FALSE(report.exact);
  EXPECT_GT(report.residual, 0);
  EXPECT_LT(report.residual, 1);
  for (int i = 0; i < 13; ++i) report = renderer.render_moving({"sky", kTurned, 0}, frame);
  EXPECT_EQ(report.residual, 0) << "384 coefficients are 13 times 30";
  report = renderer.render_moving({"sky", kTurned, 0}, frame);
  EXPECT_EQ(report.terms, 0u);
  ASSERT_TRUE(renderer.render_exact({"sky", kTurned, 0}, exact, report));
  int different = 0;
  for (std::size_t i = 0; i < frame.bytes.size(); ++i) {
    ASSERT_NEAR(frame.bytes[i], exact.bytes[i], 1);
    different += frame.bytes[i] != exact.bytes[i];
  }
  EXPECT_LT(different, 20);
}

TEST(FrameRenderer, StaysWithinItsBudgetAndConvergesWhenTheLightIsStill) {
  for (const char* const policy : {"bi", "pbi", "pbi:dealer:transport", "benefit"}) {
    SCOPED_TRACE(policy);
    expect_budget_and_convergence(settings(policy, 30));
  }
}

TEST(FrameRenderer, AnAbandonedFrameIsNotTouched) {
  FrameRenderer renderer(small_bake(), settings());
  Rgb8Image frame;
  renderer.render_moving({"sky", {}, 0}, frame);
  const auto before = frame.bytes;
  FrameReport report;
  report.terms = 77;
  std::atomic<int> asked = 0;
  EXPECT_FALSE(
      renderer.render_exact({"sky", kTurned, 0}, frame, report, [&] { return ++asked == 2; }));
  EXPECT_EQ(frame.bytes, before);
  EXPECT_EQ(report.terms, 77u);
  Rgb8Image again, expected;
  ASSERT_TRUE(renderer.render_exact({"sky", kTurned, 0}, again, report));
  FrameRenderer fresh(small_bake(), settings());
  ASSERT_TRUE(fresh.render_exact({"sky", kTurned, 0}, expected, report));
  EXPECT_EQ(again.bytes, expected.bytes);
}

TEST(FrameRenderer, AllocatesNothingAfterTheFirstFrames) {
  if (!test::kCountsAllocations) GTEST_SKIP() << "no operator new of its own here";
  set_thread_count(1);  // so that the calling thread's allocations are all there are
  FrameRenderer renderer(small_bake(), settings("pbi", 30));
  Rgb8Image frame;
  FrameReport report;
  const std::function<bool()> never = [] { return false; };
  const DesignState states[] = {{"sky", {}, 0}, {"sky", kTurned, 1}, {"room", kTurned, 0}};
  const auto run = [&] {
    for (const DesignState& state : states) {
      renderer.render_moving(state, frame);
      ASSERT_TRUE(renderer.render_exact(state, frame, report, never));
    }
  };
  run();
  run();
  const auto before = test::allocation_count();
  run();
  EXPECT_EQ(test::allocation_count() - before, 0u);
  set_thread_count(0);
}

TEST(FrameRenderer, RefusesStatesThatCannotBeShown) {
  FrameRenderer renderer(small_bake(), settings());
  Rgb8Image frame;
  const double nan = std::nan("");
  for (const DesignState& state :
       {DesignState{"moon", {}, 0}, DesignState{"", {}, 0}, DesignState{"sky", {0, 0, 0, 0}, 0},
        DesignState{"sky", {0, 0, 0, 1.1}, 0}, DesignState{"sky", {nan, 0, 0, 1}, 0},
        DesignState{"sky", {}, nan}, DesignState{"sky", {}, 1e4}}) {
    EXPECT_THROW(renderer.render_moving(state, frame), Error);
  }
  EXPECT_TRUE(frame.bytes.empty());
  // Digits of a client's JSON: nearly unit is turned into unit.
  EXPECT_NO_THROW(renderer.render_moving({"sky", {0, 0.6001, 0, 0.8}, 0}, frame));
}

TEST(FrameRenderer, AnAddedEnvironmentGetsTheExposureOfABake) {
  const auto bake = small_bake();
  FrameRenderer renderer(bake, settings());
  const Environment& room = *bake->environments()[1].environment;
  renderer.add_environment(std::make_shared<Environment>("mine", room.image(), room.layout()));
  RgbImage radiance;
  Rgb8Image frame;
  FrameReport report;
  renderer.render_radiance({"mine", {}, 0}, radiance, report);
  ASSERT_TRUE(renderer.render_exact({"mine", {}, 0}, frame, report));
  const Reference expected = reference_image(*bake, {"room", {}, 0});
  std::vector<Vec3f> covered;
  for (std::size_t i = 0; i < expected.geometry.size(); ++i) {
    if (bake->coverage()[i] > 0) covered.emplace_back(expected.geometry[i]);
  }
  ASSERT_LT(covered.size(), expected.geometry.size());
  const double scale = auto_exposure_scale(covered);
  ASSERT_NE(scale, 1);
  for (std::size_t i = 0; i < frame.bytes.size(); ++i) {
    const double linear = radiance.pixels[i / 3][static_cast<int>(i % 3)] * scale;
    ASSERT_NEAR(frame.bytes[i], 255 * srgb_from_linear(std::clamp(linear, 0.0, 1.0)), 1.1);
  }
}

TEST(FrameRenderer, SaysThatItShowsNoOtherViewAndNoEditedMaterial) {
  FrameRenderer renderer(small_bake(), settings());
  DesignState state{"sky", kTurned, 0};
  Rgb8Image plain, frame;
  FrameReport report;
  ASSERT_TRUE(renderer.render_exact(state, plain, report));
  EXPECT_THAT(report.unshown, testing::IsEmpty());
  state.view = renderer.bake().manifest().camera;
  EXPECT_THAT(renderer.render_moving(state, frame).unshown, testing::IsEmpty());
  state.view->position.x += 1;
  state.materials["brass"].exponent = 3;
  ASSERT_TRUE(renderer.render_exact(state, frame, report));
  EXPECT_THAT(report.unshown, testing::ElementsAre(testing::HasSubstr("the moved camera"),
                                                   testing::HasSubstr("edits of materials")));
  EXPECT_EQ(frame.bytes, plain.bytes);
  EXPECT_EQ(renderer.render_moving(state, frame).unshown, report.unshown);
}

}  // namespace
}  // namespace rimlight
