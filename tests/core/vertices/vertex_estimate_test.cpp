// The estimate of a bake's own error against bakes that do not have it.
#include "core/vertices/vertex_estimate.h"

#include <gtest/gtest.h>

#include <cstdio>

#include "core/basis/sh_tripling.h"
#include "tests/core/vertices/baked_case.h"
#include "tests/support/temporary_folder.h"

namespace rimlight {
namespace {

using test::kVertexSettings;

DesignState turned(const std::string& environment, int step) {
  DesignState state;
  state.environment = environment;
  state.rotation = axis_angle({0.3, 1, 0.2}, 0.9 * step);
  return state;
}

struct Compared {
  double least = 1e9, most = 0, mean = 0;  // of estimate over truth
};

/// Exact frames of a bake against those of a better one of the same scene, over lights and turns.
Compared compare(const std::shared_ptr<const VertexScene>& rough,
                 const std::shared_ptr<const VertexScene>& fine, const DesignState& edits = {}) {
  VertexRenderer renderer(rough, kVertexSettings), better(fine, kVertexSettings);
  Compared compared;
  int count = 0;
  for (const char* const environment : {"sky", "dim"}) {
    for (int step = 0; step < 6; ++step) {
      DesignState state = turned(environment, step + (environment[0] == 'd' ? 6 : 0));
      state.materials = edits.materials;
      RgbImage image, truth;
      FrameReport report, ignored;
      renderer.render_radiance(state, image, report);
      better.render_radiance(state, truth, ignored);
      const double ratio =
          report.estimate.value() / (test::distance(image, truth) / test::size_of(truth));
      EXPECT_EQ(report.estimate_of_time, 0);
      compared.least = std::min(compared.least, ratio);
      compared.most = std::max(compared.most, ratio);
      compared.mean += ratio;
      ++count;
    }
  }
  compared.mean /= count;
  std::printf("estimate / truth: %.2f to %.2f, mean %.2f\n", compared.least, compared.most,
              compared.mean);
  return compared;
}

TEST(VertexEstimate, ThreeJSymbolsAreThoseOfTriplingCoefficients) {
  // Σ over all m of C(i, j, k)² is (2a + 1)(2b + 1)(2c + 1)/4π (a b c; 0 0 0)².
  constexpr int kDegree = 4;
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
    scene->bake.seed = error < 0.01 ? 7 : 1;
    return test::baked(scene, folder_ / ("bake" + std::to_string(++count_)));
  }

 private:
  test::TemporaryFolder folder_;
  int count_ = 0;
};

void expect_calibrated(const Compared& compared) {
  EXPECT_GT(compared.least, 0.7);
  EXPECT_LT(compared.most, 1.4);
}

TEST_F(Calibration, SamplingOfMattLight) {
  DesignState matt;
  matt.materials["ball"].highlight = Vec3f();
  expect_calibrated(
      compare(bake(0.05, VertexTransfer::shadowed), bake(0.004, VertexTransfer::shadowed), matt));
}

TEST_F(Calibration, SamplingOfHighlights) {
  DesignState glossy;
  glossy.materials["ball"] = {Vec3f(), Vec3f{1, 1, 1}, 30.0};
  glossy.materials["floor"].albedo = Vec3f(0.02f, 0.02f, 0.02f);
  expect_calibrated(
      compare(bake(0.05, VertexTransfer::shadowed), bake(0.004, VertexTransfer::shadowed), glossy));
}

TEST_F(Calibration, SamplingWithLightBetweenSurfaces) {
  expect_calibrated(compare(bake(0.05, VertexTransfer::interreflected),
                            bake(0.004, VertexTransfer::interreflected)));
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
  EXPECT_GT(compared.least, 0.3);
  EXPECT_LT(compared.most, 3);
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
