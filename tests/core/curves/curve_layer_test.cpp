// What frames show of editable materials: the quick image after a change of the light, T′ made in
// the background panel by panel, columns of it after an edit of a curve.

#include "core/curves/curve_layer.h"

#include <gtest/gtest.h>

#include <atomic>
#include <cmath>
#include <map>

#include "core/base/error.h"
#include "core/base/parallel.h"
#include "core/curves/quick_image.h"
#include "tests/core/curves/curve_cases.h"
#include "tests/support/allocation_count.h"
#include "tests/support/small_bake.h"
#include "tests/support/temporary_folder.h"

namespace rimlight {
namespace {

constexpr int kSize = 8;
constexpr std::size_t kRows = 70;  // of each material: two panels
const FrameBudget kEnough{FrameBudget::Unit::coefficients, 1e6};

CurveMaterial gold() {
  CurveMaterial material{"gold", {}};
  material.brdf.model = BrdfModel::cook_torrance;
  material.brdf.albedo = {};
  material.brdf.specular = {1, 1, 1};
  material.brdf.roughness = 0.3f;
  material.brdf.eta = {0.2f, 0.5f, 1.4f};
  material.brdf.k = {3.3f, 2.2f, 1.9f};
  return material;
}

CurveMaterial pearl() {
  CurveMaterial material{"pearl", {}};
  material.brdf.model = BrdfModel::blinn_phong;
  material.brdf.albedo = {0.4f, 0.3f, 0.2f};
  material.brdf.specular = {0.3f, 0.3f, 0.3f};
  material.brdf.exponent = 20;
  return material;
}

CurveMaterial varnish() {
  CurveMaterial material = pearl();
  material.name = "varnish";
  material.brdf.model = BrdfModel::phong;
  return material;
}

class CurveLayerTest : public testing::Test {
 protected:
  CurveLayerTest() {
    test::SmallBake settings;
    settings.cube_size = kSize;
    BakeManifest manifest = small_manifest(settings);
    manifest.materials = scene.materials;
    manifest.measured_brdfs = {{"cloth", {}, some_measured()}};
    CurveReceivers receivers = scene.receivers();
    receivers.measured = manifest.measured_brdfs;
    BakeWriter writer(folder / "curves.bake");
    fill(writer, settings);
    writer.add_curves(receivers);
    writer.commit(manifest);
    bake = std::make_shared<const Bake>(folder / "curves.bake");
    state.environment = "sky";
  }

  ImageLayer::Request request() const { return {state, light}; }

  /// Pixels of all tiles, by receiver.
  std::vector<Vec3f> image(const CurveLayer& layer) const {
    const PixelLayout& pixels = bake->manifest().pixels;
    std::vector<Vec3f> result(pixels.receiver_count());
    for (std::size_t tile = 0; tile < pixels.tile_count(); ++tile) {
      TileImage square;
      for (auto& channel : square.channel) channel.fill(0);
      layer.add(tile, square);
      const auto [left, top] = pixels.pixel(tile * kTileReceivers);
      for (std::size_t i = 0; i < kTileReceivers; ++i) {
        const auto [x, y] = pixels.pixel(tile * kTileReceivers + i);
        const auto at = static_cast<std::size_t>(y - top) * TileImage::kSide +
                        static_cast<std::size_t>(x - left);
        result[tile * kTileReceivers + i] = {square.channel[0][at], square.channel[1][at],
                                             square.channel[2][at]};
      }
    }
    return result;
  }

  /// What all receivers show, summed in double under the state and the light.
  std::vector<Vec3d> truth() const {
    const CurveReceivers receivers = bake->curve_receivers();
    const MeasuredLibrary library = {{"cloth", some_measured()}};
    std::vector<Vec3d> result(bake->manifest().pixels.receiver_count());
    for (const CurvePanel& panel : make_panels(receivers)) {
      const CurveMaterial& baked = receivers.materials[panel.material];
      const auto edit = state.materials.find(baked.name);
      const CurveMaterialState material =
          resolve(baked, edit == state.materials.end() ? MaterialEdit{} : edit->second, library,
                  baked.name);
      for (std::size_t row = 0; row < panel.row_count; ++row) {
        result[panel.receivers[row]] += reference_row(receivers, panel, row, light, material);
      }
    }
    return result;
  }

  double absolute_error(const CurveLayer& layer) const {
    const auto found = image(layer);
    const auto expected = truth();
    double sum = 0;
    for (std::size_t i = 0; i < found.size(); ++i) {
      const Vec3d difference = Vec3d(found[i]) - expected[i];
      sum += dot(difference, difference);
    }
    return std::sqrt(sum);
  }
  double relative_error(const CurveLayer& layer) const {
    double sum = 0;
    for (const Vec3d& value : truth()) sum += dot(value, value);
    return absolute_error(layer) / std::sqrt(sum);
  }

  static void improve_until_done(CurveLayer& layer) {
    while (layer.improve({}) != Unfinished::nothing) {
    }
  }

  void draw(const std::string& material, CurveAxis axis, double scale) {
    CurveEdit curve;
    curve.points = {{0.1, Vec3d(2, 1, 1) * scale}, {0.4, Vec3d(1, 2, 0.5) * scale}, {0.9, {}}};
    MaterialEdit& edit = state.materials[material];
    (axis == CurveAxis::half_angle ? edit.half_angle : edit.difference_angle) = curve;
  }

  test::TemporaryFolder folder;
  CurveScene scene = random_scene({gold(), pearl(), varnish()}, kRows, kSize, 5);
  std::shared_ptr<const Bake> bake;
  CubeLight light = random_light(kSize, 7);
  DesignState state;
};

TEST_F(CurveLayerTest, SettledItIsTheSumOverAllTexels) {
  CurveLayer layer(bake, {});
  LayerReport report;
  ASSERT_TRUE(layer.settle(request(), {}, report));
  EXPECT_LT(relative_error(layer), 1e-3);
  EXPECT_EQ(report.squared_error, 0);
  EXPECT_NE(report.unfinished, Unfinished::exact_frame);
}

TEST_F(CurveLayerTest, AChangedLightIsShownAtOnceAndExactlyOnceTheRestWasMade) {
  CurveLayer layer(bake, {.strongest_texels = 16, .sampled_rows = 400});
  const LayerReport quick = layer.move(request(), kEnough);
  EXPECT_EQ(quick.unfinished, Unfinished::exact_frame);
  const double error = absolute_error(layer);
  EXPECT_GT(error, 0);
  EXPECT_LT(relative_error(layer), 0.3);
  // All rows are in the sample.
  EXPECT_NEAR(std::sqrt(quick.squared_error), error, 0.02 * error);
  improve_until_done(layer);
  const LayerReport better = layer.move(request(), kEnough);
  EXPECT_EQ(better.unfinished, Unfinished::nothing);
  EXPECT_EQ(better.squared_error, 0);
  EXPECT_LT(relative_error(layer), 1e-3);

  light = random_light(kSize, 8);
  EXPECT_EQ(layer.move(request(), kEnough).unfinished, Unfinished::exact_frame);
  EXPECT_LT(relative_error(layer), 0.3);
}

TEST_F(CurveLayerTest, AnEditOfAFreshCurveIsExactWithinOneFrame) {
  CurveLayer layer(bake, {});
  layer.move(request(), kEnough);
  improve_until_done(layer);
  draw("gold", CurveAxis::half_angle, 3);
  draw("pearl", CurveAxis::half_angle, 1);
  const LayerReport report = layer.move(request(), kEnough);
  EXPECT_NE(report.unfinished, Unfinished::exact_frame);
  EXPECT_GT(report.terms, 10u);
  EXPECT_LT(relative_error(layer), 1e-3);
}

TEST_F(CurveLayerTest, WhatABudgetLeavesIsTheErrorThatItSays) {
  CurveLayer layer(bake, {});
  layer.move(request(), kEnough);
  improve_until_done(layer);
  draw("gold", CurveAxis::half_angle, 3);
  const LayerReport report = layer.move(request(), {FrameBudget::Unit::coefficients, 8});
  EXPECT_EQ(report.terms, 8u);
  const double error = absolute_error(layer);
  EXPECT_NEAR(std::sqrt(report.squared_error_of_time), error, 0.02 * error);
  for (int frame = 0; frame < 60; ++frame) {
    layer.move(request(), {FrameBudget::Unit::coefficients, 8});
  }
  EXPECT_LT(relative_error(layer), 1e-3);
}

TEST_F(CurveLayerTest, TransportIsMadeWhileEditsGoOnWithoutAPause) {
  CurveLayer layer(bake, {.rebuild_ms = 1});
  layer.move(request(), kEnough);
  LayerReport report;
  int frames = 0;
  do {
    draw("gold", CurveAxis::half_angle, 1 + 0.01 * frames);
    report = layer.move(request(), kEnough);
    ASSERT_LT(++frames, 10'000);
  } while (report.unfinished == Unfinished::exact_frame);
  EXPECT_LT(relative_error(layer), 1e-3);
}

TEST_F(CurveLayerTest, TheOtherCurveMakesTheFirstOnesTransportStaleAndItIsMadeAgain) {
  CurveLayer layer(bake, {.rebuild_ms = 0});
  layer.move(request(), kEnough);
  improve_until_done(layer);
  // T′ of θ_d was made beside that of θ_h: the first edit of it is exact at once.
  draw("gold", CurveAxis::difference_angle, 0.4);
  LayerReport report = layer.move(request(), kEnough);
  EXPECT_EQ(report.unfinished, Unfinished::next_edits);
  EXPECT_LT(relative_error(layer), 1e-3);
  // That of θ_h has the old Fresnel curve in it.
  draw("gold", CurveAxis::half_angle, 1);
  report = layer.move(request(), kEnough);
  EXPECT_EQ(report.unfinished, Unfinished::exact_frame);
  EXPECT_LT(relative_error(layer), 0.3);
  improve_until_done(layer);
  layer.move(request(), kEnough);
  EXPECT_LT(relative_error(layer), 1e-3);
}

TEST_F(CurveLayerTest, ParametersThatAreInNoCurveAndMeasuredBrdfsAreFollowed) {
  CurveLayer layer(bake, {});
  LayerReport report;
  ASSERT_TRUE(layer.settle(request(), {}, report));
  state.materials["pearl"].albedo = Vec3f(0.1f, 0.2f, 0.3f);
  state.materials["varnish"].exponent = 5;
  state.materials["gold"].measured = "cloth";
  ASSERT_TRUE(layer.settle(request(), {}, report));
  EXPECT_LT(relative_error(layer), 1e-3);
  state.materials.clear();
  ASSERT_TRUE(layer.settle(request(), {}, report));
  EXPECT_LT(relative_error(layer), 1e-3);
}

TEST_F(CurveLayerTest, WhateverCameBeforeTheSettledImageIsThatOfTheState) {
  CurveLayer layer(bake, {});
  for (int step = 0; step < 12; ++step) {
    const auto axis = step % 3 == 0 ? CurveAxis::difference_angle : CurveAxis::half_angle;
    draw(step % 2 == 0 ? "gold" : "pearl", step % 2 == 0 ? axis : CurveAxis::half_angle,
         0.3 + 0.1 * step);
    if (step % 4 == 1) light = random_light(kSize, static_cast<std::uint64_t>(20 + step));
    if (step == 7) state.materials["gold"].roughness = 0.7;
    if (step == 9) state.materials.erase("gold");
    layer.move(request(), {FrameBudget::Unit::coefficients, 5});
    std::atomic<int> asked{0};
    layer.improve([&asked] { return ++asked > 3; });
  }
  LayerReport report;
  ASSERT_TRUE(layer.settle(request(), {}, report));
  EXPECT_LT(relative_error(layer), 1e-3);
}

TEST_F(CurveLayerTest, AbandonedWorkKeepsWhatItMade) {
  CurveLayer layer(bake, {.strongest_texels = 0});
  layer.move(request(), kEnough);
  const double before = absolute_error(layer);
  const std::size_t panels = make_panels(bake->curve_receivers()).size();
  std::atomic<std::size_t> asked{0};
  LayerReport report;
  EXPECT_FALSE(layer.settle(
      request(), [&] { return ++asked > panels / 2; }, report));
  const double half = absolute_error(layer);
  EXPECT_LT(half, before);
  EXPECT_GT(half, 0.01 * before);
  asked = 0;
  EXPECT_TRUE(layer.settle(
      request(), [&] { return ++asked > 10 * panels; }, report));
  EXPECT_LT(relative_error(layer), 1e-3);
}

TEST_F(CurveLayerTest, ABadStateIsRefusedAndChangesNothing) {
  CurveLayer layer(bake, {});
  LayerReport report;
  ASSERT_TRUE(layer.settle(request(), {}, report));
  const auto before = image(layer);
  const DesignState good = state;
  state.materials["gold"].roughness = 7;
  EXPECT_THROW(layer.check(state), Error);
  state = good;
  state.materials["gold"].measured = "velvet";
  EXPECT_THROW(layer.check(state), Error);
  state = good;
  state.materials["gold"].half_angle = CurveEdit{CurveScale::linear, {{0.5, {-1, 0, 0}}}, {}};
  EXPECT_THROW(layer.check(state), Error);
  state = good;
  EXPECT_NO_THROW(layer.check(state));
  layer.move(request(), kEnough);
  EXPECT_EQ(image(layer), before);
}

TEST_F(CurveLayerTest, WhatAnEditCannotDoIsSaid) {
  CurveLayer layer(bake, {});
  EXPECT_TRUE(layer.move(request(), kEnough).unshown.empty());
  state.materials["floor"].albedo = Vec3f(1, 1, 1);
  draw("varnish", CurveAxis::half_angle, 1);
  const auto unshown = layer.move(request(), kEnough).unshown;
  const auto says = [&](const std::string& text) {
    return std::ranges::any_of(
        unshown, [&](const std::string& each) { return each.find(text) != std::string::npos; });
  };
  EXPECT_TRUE(says("floor"));
  EXPECT_TRUE(says("phong"));
  EXPECT_TRUE(says("other surfaces"));
}

TEST_F(CurveLayerTest, WhatTheTexelsCannotResolveIsSaid) {
  CurveLayer layer(bake, {});
  state.materials["gold"].roughness = 1e-3;
  const auto unshown = layer.move(request(), kEnough).unshown;
  ASSERT_FALSE(unshown.empty());
  EXPECT_EQ(unshown[0], "the sharpness of gold (the light's texels are 14.3° wide)");
}

TEST_F(CurveLayerTest, UnderABlackLightAllIsBlack) {
  light = CubeLight(kSize);
  CurveLayer layer(bake, {});
  layer.move(request(), kEnough);
  for (const Vec3f& value : image(layer)) EXPECT_EQ(value, Vec3f());
  LayerReport report;
  ASSERT_TRUE(layer.settle(request(), {}, report));
  for (const Vec3f& value : image(layer)) EXPECT_EQ(value, Vec3f());
}

TEST_F(CurveLayerTest, AllocatesNothingUnderATurningLight) {
  if (!test::kCountsAllocations) GTEST_SKIP() << "no operator new of its own here";
  set_thread_count(1);  // so that the calling thread's allocations are all there are
  const CubeLight lights[] = {random_light(kSize, 1), random_light(kSize, 2)};
  CurveLayer layer(bake, {});
  const auto run = [&] {
    for (const CubeLight& each : lights) {
      light = each;
      layer.move(request(), kEnough);
    }
  };
  run();
  run();
  const auto before = test::allocation_count();
  run();
  EXPECT_EQ(test::allocation_count() - before, 0u);
  set_thread_count(0);
}

TEST(CurveLayerOf, IsNothingForABakeWithoutCurves) {
  const test::TemporaryFolder folder;
  test::write_small_bake(folder / "small.bake", {});
  EXPECT_EQ(curve_layer_of(std::make_shared<const Bake>(folder / "small.bake")), nullptr);
}

}  // namespace
}  // namespace rimlight
