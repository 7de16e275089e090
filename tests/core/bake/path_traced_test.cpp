// The bake, uncompressed, against a path tracer under the same lit texel: per pixel and in the
// mean.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "core/bake/direct_transport.h"
#include "core/bake/indirect_transport.h"
#include "tests/core/bake/bake_scenes.h"
#include "tests/support/path_tracer.h"

namespace rimlight {
namespace {

constexpr int kCubeSize = 8;  // as coarse as indirect light: every texel is exact
constexpr int kRepeats = 64;
constexpr int kOracleSamples = 100;  // in each repeat

/// Mean and squared standard error of independent repeats.
struct Estimate {
  double sum = 0, squares = 0;
  int count = 0;

  void add(double value) {
    sum += value;
    squares += value * value;
    ++count;
  }
  double mean() const { return sum / count; }
  double variance_of_mean() const {
    return std::max(0.0, squares / count - mean() * mean()) / (count - 1);
  }
};

/// One group's pixels, and their sum: its spread over repeats knows that pixels share samples.
struct GroupEstimate {
  std::vector<Estimate> pixels{kGroupLanes};
  Estimate total;
};

struct Comparison {
  std::vector<double> deviations;  // per pixel, in standard errors
  double ratio = 0;                // of the whole image, bake to oracle
  double ratio_error = 0;          // its standard error
};

/// A texel of the sky that the corner scenes see.
std::size_t lit_texel() { return cube::texel_of({0.5, 0.7, 0.6}, kCubeSize); }

/// Every receiver of one group, baked `kRepeats` times with different seeds.
GroupEstimate baked(const RayScene& rays, std::size_t group) {
  const BakeSettings& bake = rays.scene().bake;
  const DirectTransport direct(rays, kCubeSize);
  IndirectSettings settings;
  settings.cube_size = kCubeSize;
  settings.bounces = bake.bounces;
  const IndirectTransport indirect(rays, settings);
  GroupEstimate estimate;
  GroupRows rows(kCubeSize);
  GroupSamples samples;
  for (std::uint64_t seed = 0; seed < kRepeats; ++seed) {
    sample_group(rays, {bake.width, bake.height}, group * kGroupLanes, bake.primary_rays, seed,
                 samples);
    std::fill(rows.values.begin(), rows.values.end(), 0.0f);
    direct.add(samples, seed + 100, rows);
    indirect.add(samples, seed + 100, rows);
    double total = 0;
    for (std::size_t lane = 0; lane < kGroupLanes; ++lane) {
      const double value = rows.row(lit_texel())[kGroupLanes + lane];
      estimate.pixels[lane].add(value);
      total += value;
    }
    estimate.total.add(total);
  }
  return estimate;
}

GroupEstimate path_traced(const RayScene& rays, std::size_t group) {
  const BakeSettings& bake = rays.scene().bake;
  const test::TexelPathTracer tracer(rays, kCubeSize, lit_texel(), bake.bounces);
  const PixelLayout layout{bake.width, bake.height};
  GroupEstimate estimate;
  for (int repeat = 0; repeat < kRepeats; ++repeat) {
    double total = 0;
    for (std::size_t lane = 0; lane < kGroupLanes; ++lane) {
      const PixelLayout::Pixel pixel = layout.pixel(group * kGroupLanes + lane);
      Random random(77 + static_cast<std::uint64_t>(repeat), group * kGroupLanes + lane);
      double sum = 0;
      for (int i = 0; i < kOracleSamples; ++i)
        sum += tracer.sample_pixel(pixel.x, pixel.y, random).y;
      estimate.pixels[lane].add(sum / kOracleSamples);
      total += sum / kOracleSamples;
    }
    estimate.total.add(total);
  }
  return estimate;
}

Comparison compare(const Scene& ours, const Scene& oracle) {
  const RayScene our_rays(std::make_shared<const Scene>(ours));
  const RayScene oracle_rays(std::make_shared<const Scene>(oracle));
  Comparison result;
  double sum = 0, oracle_sum = 0, variance = 0;
  for (const std::size_t group : {18u, 27u, 36u}) {
    const GroupEstimate a = baked(our_rays, group);
    const GroupEstimate b = path_traced(oracle_rays, group);
    sum += a.total.mean();
    oracle_sum += b.total.mean();
    variance += a.total.variance_of_mean() + b.total.variance_of_mean();
    for (std::size_t lane = 0; lane < kGroupLanes; ++lane) {
      const Estimate& one = a.pixels[lane];
      const Estimate& other = b.pixels[lane];
      const double both = one.variance_of_mean() + other.variance_of_mean();
      if (both > 0) result.deviations.push_back((one.mean() - other.mean()) / std::sqrt(both));
    }
  }
  result.ratio = sum / oracle_sum;
  result.ratio_error = std::sqrt(variance) / oracle_sum;
  return result;
}

/// Each pixel's deviation follows Student's t with 63 degrees of freedom or more, for which 5
/// standard errors have a probability of 5e-6: 0.1 % over 200 pixels.
constexpr double kMostDeviation = 5;

/// `most_noise`: of the ratio; below 0.006, a difference of 2 % is told.
void expect_equal(const Comparison& comparison, double most_noise) {
  ASSERT_GT(comparison.deviations.size(), 100u);
  for (const double deviation : comparison.deviations)
    EXPECT_LT(std::abs(deviation), kMostDeviation);
  EXPECT_LT(comparison.ratio_error, most_noise);
  EXPECT_NEAR(comparison.ratio, 1, 3 * comparison.ratio_error);
}

TEST(BakeAgainstPathTracer, ALambertCornerIsTheSameUnderOneTexel) {
  expect_equal(compare(*corner_scene(lambert(0.7f)), *corner_scene(lambert(0.7f))), 0.006);
}

TEST(BakeAgainstPathTracer, AnAlbedoThatIsTwoPercentWrongIsFound) {
  const Comparison wrong =
      compare(*corner_scene(lambert(0.7f * 1.02f)), *corner_scene(lambert(0.7f)));
  EXPECT_GT(std::abs(wrong.ratio - 1), 3 * wrong.ratio_error) << "ratio " << wrong.ratio;
}

TEST(BakeAgainstPathTracer, AMetalBoxOnALambertFloorIsTheSameUnderOneTexel) {
  auto scene = corner_scene(lambert(0.7f));
  scene->materials.push_back(metal(0.3f));
  scene->meshes.back().material = 1;
  expect_equal(compare(*scene, *scene), 0.01);
}

}  // namespace
}  // namespace rimlight
