#include "core/vertices/vertex_lighting.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "core/basis/cube_map.h"
#include "core/basis/sh_kernel.h"
#include "core/basis/sh_projection.h"
#include "core/vertices/vertex_light.h"
#include "core/vertices/vertex_lobe_kernel.h"
#include "core/vertices/vertex_renderer.h"
#include "tests/core/vertices/vertex_case.h"
#include "tests/support/error_of.h"
#include "tests/support/every_target.h"

namespace rimlight {
namespace {

using test::RandomVertices;

std::vector<std::uint32_t> every(std::uint32_t step, std::uint32_t end) {
  std::vector<std::uint32_t> vertices;
  for (std::uint32_t v = 0; v < end; v += step) vertices.push_back(v);
  return vertices;
}

bool same(const VertexLighting& a, const VertexLighting& b,
          const std::vector<std::uint32_t>& vertices) {
  for (const std::uint32_t vertex : vertices) {
    if (a.irradiance(vertex) != b.irradiance(vertex)) return false;
    const std::size_t floats = 3 * a.stride();
    if (!std::equal(a.incident(vertex), a.incident(vertex) + floats, b.incident(vertex))) {
      return false;
    }
  }
  return true;
}

TEST(VertexLighting, InStepsItIsTheSameAsAtOnceBitForBit) {
  const RandomVertices random({});
  VertexLighting at_once(random.view()), in_steps(random.view());
  const auto all = every(1, 200), some = every(3, 200);
  const auto light = RandomVertices::light(8);
  at_once.set_light(light);
  at_once.light(all, all);
  in_steps.set_light(RandomVertices::light(8, 99));
  in_steps.light(all, all);  // another light, to be forgotten
  EXPECT_FALSE(same(at_once, in_steps, all));
  in_steps.set_light(light);
  in_steps.light(some, {});
  in_steps.light(all, some);
  in_steps.light(some, all);
  EXPECT_TRUE(same(at_once, in_steps, all));
  EXPECT_NE(at_once.irradiance(3), Vec3f());
}

TEST(VertexLighting, AskingForNothingIsFine) {
  const RandomVertices random({});
  VertexLighting lighting(random.view());
  lighting.set_light(RandomVertices::light(8));
  lighting.light({}, {});
}

TEST(VertexLight, TurningIsProjectingTurnedDirections) {
  const auto environment = test::sky("sky");
  const CubeLight texels = environment->project(16);
  const Quaternion turn = normalized(Quaternion{0.4, 0.1, -0.6, 0.5});
  constexpr int kDegree = 9;
  const VertexLight light(texels, kDegree, LightWindow::none);
  std::vector<float> turned(light.coefficients().size());
  light.turn(turn, turned);
  const auto expected = sh::project(sh::cube_quadrature(16, turn), texels.values, kDegree);
  double size = 0, change = 0;
  for (std::size_t i = 0; i < turned.size(); ++i) {
    size += std::abs(expected[i]);
    change += std::abs(expected[i] - light.coefficients()[i]);
    EXPECT_NEAR(turned[i], expected[i], 2e-4);  // of some 75: float projections of 1,536 texels
  }
  EXPECT_GT(size, 50);
  EXPECT_GT(change, 5);
}

TEST(VertexLight, WindowsLeaveTheMeanAndTakeTheRinging) {
  CubeLight texels(16);  // a small sun in an even sky
  std::ranges::fill(texels.values, 0.5f);
  for (int c = 0; c < 3; ++c) texels.channel(c)[300] = 300;
  const VertexLight plain(texels, 9, LightWindow::none);
  const auto least = [](const VertexLight& light) {
    const auto values =
        sh::reconstruct(light.coefficients(), 9, sh::cube_quadrature(16).directions);
    return *std::min_element(values.begin(), values.end());
  };
  EXPECT_LT(least(plain), -0.1f);
  for (const LightWindow window : {LightWindow::hann, LightWindow::lanczos, LightWindow::fitted}) {
    const VertexLight light(texels, 9, window);
    for (std::size_t c = 0; c < 3; ++c) {
      EXPECT_EQ(light.coefficients()[c * 100], plain.coefficients()[c * 100]);
    }
    EXPECT_GT(least(light), least(plain));
  }
}

TEST(VertexLight, TheDefaultWindowLeavesNothingFarBelowZero) {
  CubeLight texels(16);  // a small sun, and next to nothing else
  std::ranges::fill(texels.values, 0.01f);
  for (int c = 0; c < 3; ++c) texels.channel(c)[300] = 3000;
  const auto least_over_mean = [&](LightWindow window) {
    const VertexLight light(texels, 20, window);
    const auto quadrature = sh::cube_quadrature(48);
    const auto values = sh::reconstruct(light.coefficients(), 20, quadrature.directions);
    const float mean = light.coefficients()[0] * 0.28209479f;  // Y_00
    return *std::min_element(values.begin(), values.end()) / mean;
  };
  EXPECT_LT(least_over_mean(LightWindow::none), -1);
  EXPECT_GT(least_over_mean(VertexSettings().window), -0.1f);
}

TEST(VertexLight, WindowsHaveNames) {
  EXPECT_EQ(parse_window("none", "x"), LightWindow::none);
  EXPECT_EQ(parse_window("hann", "x"), LightWindow::hann);
  EXPECT_EQ(parse_window("lanczos", "x"), LightWindow::lanczos);
  EXPECT_EQ(parse_window("fitted", "x"), LightWindow::fitted);
  EXPECT_THAT(test::error_of([] { parse_window("Hann", "--window"); }),
              testing::HasSubstr("--window: found \"Hann\", expected one of \"none\" \"hann\""));
}

TEST(VertexLobeKernel, EveryTargetIsWithinRoundingOfTheDoubleSum) {
  Random random(11);
  for (const std::size_t stride : {16u, 48u, 128u}) {
    constexpr std::size_t kPoints = 5;
    AlignedVector<float> harmonics(kPoints * stride), lobes(kPoints * stride),
        rows(kPoints * 9 * stride);
    for (auto* values : {&harmonics, &lobes, &rows}) {
      for (float& value : *values) value = static_cast<float>(random.uniform(-1, 1));
    }
    std::vector<MirroringPoint> points(kPoints);
    for (std::size_t i = 0; i < kPoints; ++i) {
      for (std::size_t k = 0; k < 3; ++k) {
        points[i].corners[k] = rows.data() + (3 * i + k) * 3 * stride;
        points[i].weights[k] = static_cast<float>(random.uniform(0, 1));
      }
      points[i].lobe = lobes.data() + i * stride;
    }
    const int targets = test::for_every_target([&] {
      std::vector<float> radiance(3 * kPoints, 77);
      gather_lobes(points, harmonics.data(), stride, radiance.data());
      for (std::size_t i = 0; i < kPoints; ++i) {
        for (std::size_t c = 0; c < 3; ++c) {
          double sum = 0, size = 0;
          for (std::size_t corner = 0; corner < 3; ++corner) {
            for (std::size_t k = 0; k < stride; ++k) {
              const double term = double{harmonics[i * stride + k]} * points[i].lobe[k] *
                                  points[i].weights[corner] *
                                  points[i].corners[corner][c * stride + k];
              sum += term;
              size += std::abs(term);
            }
          }
          const double bound = static_cast<double>(stride + 5) * 0x1p-24 * size;
          ASSERT_NEAR(radiance[3 * i + c], sum, bound) << stride << " " << i << " " << c;
        }
      }
    });
    EXPECT_GT(targets, 0);
  }
}

}  // namespace
}  // namespace rimlight
