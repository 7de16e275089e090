// The estimate of a bake's own error against bakes that do not have it.
#include "core/vertices/vertex_estimate.h"

#include <gtest/gtest.h>

#include <cstdio>

#include "core/math/random.h"
#include "tests/core/vertices/baked_case.h"
#include "tests/support/temporary_folder.h"

namespace rimlight {
namespace {

using test::kVertexSettings;

/// One of all turns, evenly: four normal numbers make a quaternion (Marsaglia).
DesignState turned(const std::string& environment, int step) {
  Random random(static_cast<std::uint64_t>(step) + 11);
  const auto normal = [&random] {
    double sum = -6;
    for (int i = 0; i < 12; ++i) sum += random.uniform(0, 1);
    return sum;
  };
  DesignState state;
  state.environment = environment;
  state.rotation = normalized(Quaternion{normal(), normal(), normal(), normal()});
  return state;
}

struct Compared {
  double least = 1e9, most = 0;  // of estimate over truth, in one frame
  double of_all = 0;             // root mean squares over the frames: what is estimated
};

/// Exact frames of a bake against those of a better one of the same scene, over lights and turns.
Compared compare(const std::shared_ptr<const VertexScene>& rough,
                 const std::shared_ptr<const VertexScene>& fine, const DesignState& edits = {}) {
  VertexRenderer renderer(rough, kVertexSettings), better(fine, kVertexSettings);
  Compared compared;
  double squares = 0, true_squares = 0;
  for (const char* const environment : {"sky", "dim"}) {
    for (int step = 0; step < 8; ++step) {
      DesignState state = turned(environment, step + (environment[0] == 'd' ? 8 : 0));
      state.materials = edits.materials;
      RgbImage image, truth;
      FrameReport report, ignored;
      renderer.render_radiance(state, image, report);
      better.render_radiance(state, truth, ignored);
      EXPECT_EQ(report.estimate_of_time, 0);
      // The dimmer light's errors count as much.
      const double bright = environment[0] == 'd' ? 4 : 1;
      const double estimate = bright * report.estimate.value() * test::size_of(image);
      const double error = bright * test::distance(image, truth);
      compared.least = std::min(compared.least, estimate / error);
      compared.most = std::max(compared.most, estimate / error);
      squares += estimate * estimate;
      true_squares += error * error;
    }
  }
  compared.of_all = std::sqrt(squares / true_squares);
  std::printf("bake: estimate / truth %.2f to %.2f in single frames, of all %.2f\n", compared.least,
              compared.most, compared.of_all);
  return compared;
}

TEST(VertexEstimate, ThreeJSymbolsAreCompleteAndThoseOfTables) {
  constexpr int kDegree = 12;
  for (int a = 0; a <= kDegree; ++a) {
    for (int b = 0; b <= kDegree; ++b) {
      double over_c = 0;
      for (int c = 0; c <= a + b; ++c) over_c += (2 * c + 1) * three_j_squared(a, b, c);
      EXPECT_NEAR(over_c, 1, 1e-12);
    }
  }
  EXPECT_NEAR(three_j_squared(1, 1, 2), 2.0 / 15, 1e-14);
  EXPECT_NEAR(three_j_squared(2, 2, 2), 2.0 / 35, 1e-14);
  EXPECT_EQ(three_j_squared(1, 1, 1), 0);
  EXPECT_EQ(three_j_squared(1, 1, 3), 0);
}

class Calibration : public testing::Test {
 protected:
  std::shared_ptr<const VertexScene> bake(double error, VertexTransfer transfer,
                                          bool keep_bands = true) {
    const auto scene = test::balls_scene();
    scene->bake.vertex.error = error;
    scene->bake.vertex.transfer = transfer;
    scene->bake.vertex.keep_bands = keep_bands;
    scene->bake.vertex.most_rays = 40000;
    // Else the finer bake's first rays would be the other's.
    scene->bake.seed = error < 0.02 ? 7 : 1;
    return test::baked(scene, folder_ / ("bake" + std::to_string(++count_)));
  }

 private:
  test::TemporaryFolder folder_;
  int count_ = 0;
};

/// Over all turns within the factor; a single one may hide errors, or show where they are.
void expect_calibrated(const Compared& compared) {
  EXPECT_GT(compared.of_all, 0.7);
  EXPECT_LT(compared.of_all, 1.4);
  EXPECT_GT(compared.least, 0.35);
  EXPECT_LT(compared.most, 2.2);
}

TEST_F(Calibration, SamplingOfMattLight) {
  DesignState matt;
  matt.materials["ball"].highlight = Vec3f();
  expect_calibrated(
      compare(bake(0.05, VertexTransfer::shadowed), bake(0.008, VertexTransfer::shadowed), matt));
}

TEST_F(Calibration, SamplingOfHighlights) {
  DesignState glossy;
  glossy.materials["ball"] = {Vec3f(), Vec3f{1, 1, 1}, 30.0};
  glossy.materials["floor"].albedo = Vec3f(0.02f, 0.02f, 0.02f);
  expect_calibrated(
      compare(bake(0.05, VertexTransfer::shadowed), bake(0.008, VertexTransfer::shadowed), glossy));
}

TEST_F(Calibration, SamplingWithLightBetweenSurfaces) {
  expect_calibrated(compare(bake(0.05, VertexTransfer::interreflected),
                            bake(0.008, VertexTransfer::interreflected)));
}

TEST_F(Calibration, WhatWasLeftOut) {
  // The same rays, but the bands that the error does not need: no more than an order of magnitude.
  const auto cut = bake(0.2, VertexTransfer::shadowed, false);
  const auto whole = bake(0.2, VertexTransfer::shadowed, true);
  ASSERT_LT(cut->transport.irradiance_degree + cut->transport.visibility_degree,
            whole->transport.irradiance_degree + whole->transport.visibility_degree);
  auto known = std::make_shared<VertexScene>(*cut);
  known->error.sampling = {};
  const Compared compared = compare(known, whole);
  EXPECT_GT(compared.of_all, 0.4);
  EXPECT_LT(compared.of_all, 2.5);
}

TEST_F(Calibration, ABakeThatSaysNothingHasNoEstimate) {
  auto scene = std::make_shared<VertexScene>(*test::scene_of());
  VertexRenderer renderer(scene, kVertexSettings);
  RgbImage image;
  FrameReport report;
  renderer.render_radiance(turned("sky", 1), image, report);
  EXPECT_FALSE(report.estimate.has_value());
}

}  // namespace
}  // namespace rimlight
