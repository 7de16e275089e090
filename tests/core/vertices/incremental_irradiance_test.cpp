#include "core/vertices/incremental_irradiance.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "core/base/check.h"
#include "core/base/parallel.h"
#include "core/math/random.h"
#include "tests/core/vertices/random_vertices.h"
#include "tests/support/every_target.h"

namespace rimlight {
namespace {

using test::RandomVertices;

constexpr int kDegree = 4;
constexpr std::size_t kCount = sh::coefficient_count(kDegree);

RandomVertices::Shape shape(std::size_t vertices, std::size_t channels) {
  return {
      .vertices = vertices, .highlights = 0, .irradiance_degree = kDegree, .channels = channels};
}

std::vector<std::uint32_t> some_coefficients(Random& random, std::size_t most) {
  std::vector<std::uint32_t> all(kCount);
  std::iota(all.begin(), all.end(), 0u);
  for (std::size_t i = kCount; i > 1; --i) std::swap(all[i - 1], all[random.below(i)]);
  all.resize(random.below(most + 1));
  std::ranges::sort(all);
  return all;
}

/// Relative to Σ |product|, the worst over vertices and channels, in double.
double worst_error(const VertexTransportView& view, const IncrementalIrradiance& shown) {
  double worst = 0;
  for (std::size_t v = 0; v < view.vertex_count; ++v) {
    const std::size_t batch = v / kBatchVertices, lane = v % kBatchVertices;
    for (std::size_t c = 0; c < 3; ++c) {
      const std::size_t channel = view.irradiance_channels == 1 ? 0 : c;
      double sum = 0, size = 0;
      for (std::size_t i = 0; i < kCount; ++i) {
        const std::size_t at =
            ((batch * view.irradiance_channels + channel) * kCount + i) * kBatchVertices + lane;
        const double product =
            double{to_float(view.irradiance[at])} * double{shown.held()[c * kCount + i]};
        sum += product;
        size += std::abs(product);
      }
      const float found = shown.irradiance()[(batch * 3 + c) * kBatchVertices + lane];
      worst = std::max(worst, std::abs(found - sum) / std::max(size, 1e-30));
    }
  }
  return worst;
}

TEST(IncrementalIrradiance, IsTransportTimesTheHeldLightUnderEveryTarget) {
  const int targets = test::for_every_target([] {
    for (const std::size_t channels : {1u, 3u}) {
      for (const std::size_t vertices : {1u, 64u, 65u, 200u}) {
        const RandomVertices made(shape(vertices, channels));
        IncrementalIrradiance shown(made.view());
        Random random(vertices);
        for (int frame = 0; frame < 12; ++frame) {
          const auto target = RandomVertices::light(kDegree, static_cast<std::uint64_t>(frame));
          const auto coefficients = some_coefficients(random, kCount);
          shown.update(coefficients, target);
          for (const std::uint32_t i : coefficients) {
            for (std::size_t c = 0; c < 3; ++c) {
              ASSERT_EQ(shown.held()[c * kCount + i], target[c * kCount + i]);
            }
          }
          // Each of 12 frames rounds a sum that was at most twice as large once.
          ASSERT_LT(worst_error(made.view(), shown), 12 * 4 * kCount * 0x1p-24);
        }
      }
    }
  });
  EXPECT_GT(targets, 1);
}

TEST(IncrementalIrradiance, SetDependsOnTheTargetAlone) {
  const RandomVertices made(shape(130, 3));
  const auto target = RandomVertices::light(kDegree, 5);
  IncrementalIrradiance fresh(made.view()), used(made.view());
  Random random(1);
  for (int i = 0; i < 5; ++i) {
    used.update(some_coefficients(random, kCount), RandomVertices::light(kDegree, 10));
  }
  fresh.set(target);
  used.set(target);
  EXPECT_TRUE(std::ranges::equal(fresh.irradiance(), used.irradiance()));
  EXPECT_TRUE(std::ranges::equal(used.held(), target));
}

TEST(IncrementalIrradiance, RoundingOfManyFramesDoesNotShow) {
  const RandomVertices made(shape(70, 1));
  IncrementalIrradiance shown(made.view());
  Random random(2);
  std::vector<float> target = RandomVertices::light(kDegree, 0);
  for (int frame = 0; frame < 40'000; ++frame) {  // some six rounds through the batches
    for (float& value : target) value += static_cast<float>(random.uniform(-0.01, 0.01));
    shown.update(some_coefficients(random, kCount), target);
  }
  const double worst = worst_error(made.view(), shown);
  EXPECT_LT(worst, 1e-5);
  EXPECT_GT(worst, 0) << "nothing was rounded";
}

TEST(IncrementalIrradiance, HasTheSameBitsAtAnyNumberOfThreads) {
  const RandomVertices made(shape(700, 1));
  std::vector<std::vector<float>> images;
  for (const int threads : {1, 2, 3}) {
    set_thread_count(threads);
    IncrementalIrradiance shown(made.view());
    Random random(3);
    for (int frame = 0; frame < 50; ++frame) {
      shown.update(some_coefficients(random, kCount),
                   RandomVertices::light(kDegree, static_cast<std::uint64_t>(frame)));
    }
    images.emplace_back(shown.irradiance().begin(), shown.irradiance().end());
  }
  set_thread_count(0);
  EXPECT_EQ(images[0], images[1]);
  EXPECT_EQ(images[0], images[2]);
}

TEST(IncrementalIrradiance, RefusesWhatDoesNotFit) {
  const RandomVertices made(shape(10, 1));
  IncrementalIrradiance shown(made.view());
  const std::vector<std::uint32_t> beyond = {kCount};
  EXPECT_THROW(shown.update(beyond, RandomVertices::light(kDegree)), CheckFailure);
  EXPECT_THROW(shown.set(RandomVertices::light(kDegree + 1)), CheckFailure);
  VertexTransportView wrong = made.view();
  wrong.irradiance_channels = 3;
  EXPECT_THROW(IncrementalIrradiance{wrong}, CheckFailure);
}

}  // namespace
}  // namespace rimlight
