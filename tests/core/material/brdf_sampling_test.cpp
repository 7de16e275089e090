#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <vector>

#include "core/material/brdf.h"
#include "core/math/random.h"
#include "core/math/sampling.h"
#include "tests/core/material/brdf_cases.h"
#include "tests/support/reference/brdf.h"

namespace rimlight {
namespace {

constexpr double kPi = std::numbers::pi;

/// The hemisphere in cells of equal solid angle.
struct Histogram {
  static constexpr int kPolar = 24;
  static constexpr int kAzimuth = 32;
  /// One more for the samples that fell below the horizon.
  std::vector<double> cells = std::vector<double>(kPolar * kAzimuth + 1);

  static std::size_t cell(const Vec3d& direction) {
    const double turn = std::atan2(direction.y, direction.x) / (2 * kPi) + 0.5;
    const int polar = std::min(kPolar - 1, static_cast<int>(direction.z * kPolar));
    const int azimuth = std::min(kAzimuth - 1, static_cast<int>(turn * kAzimuth));
    return static_cast<std::size_t>(polar * kAzimuth + azimuth);
  }
};

/// Probability per cell from density(), by the midpoint rule on a grid fine against the lobe.
Histogram expected_histogram(const Brdf& brdf, const Vec3f& out) {
  constexpr int kFine = 20;
  constexpr int kRows = Histogram::kPolar * kFine;
  constexpr int kColumns = Histogram::kAzimuth * kFine;
  Histogram result;
  double total = 0;
  for (int row = 0; row < kRows; ++row) {
    for (int column = 0; column < kColumns; ++column) {
      const double z = (row + 0.5) / kRows;
      const double phi = 2 * kPi * (column + 0.5) / kColumns - kPi;
      const double r = std::sqrt(1 - z * z);
      const Vec3d in{r * std::cos(phi), r * std::sin(phi), z};
      const double p = density(brdf, Vec3f(in), out) * 2 * kPi / (kRows * kColumns);
      result.cells[Histogram::cell(in)] += p;
      total += p;
    }
  }
  EXPECT_LE(total, 1 + 1e-3);
  result.cells.back() = std::max(0.0, 1 - total);
  return result;
}

/// χ² over cells pooled to at least 20 expected counts, as a standard normal (Wilson and Hilferty).
double chi_squared_deviation(const Histogram& counts, const Histogram& expected, double samples) {
  double chi = 0, cells = -1, pooled_count = 0, pooled_expected = 0;
  for (std::size_t i = 0; i < counts.cells.size(); ++i) {
    pooled_count += counts.cells[i];
    pooled_expected += expected.cells[i] * samples;
    if (pooled_expected < 20) continue;
    const double difference = pooled_count - pooled_expected;
    chi += difference * difference / pooled_expected;
    cells += 1;
    pooled_count = pooled_expected = 0;
  }
  EXPECT_GT(cells, 10);
  const double spread = 2 / (9 * cells);
  return (std::cbrt(chi / cells) - (1 - spread)) / std::sqrt(spread);
}

std::vector<BrdfCase> wide_cases() {
  Brdf glaze{.model = BrdfModel::cook_torrance,
             .albedo = {0.6f, 0.5f, 0.4f},
             .specular = {1, 1, 1},
             .roughness = 0.15f};
  Brdf rough = glaze;
  rough.roughness = 1;
  Brdf metal = glaze;
  metal.eta = {0.18f, 0.42f, 1.37f};
  metal.k = {3.42f, 2.35f, 1.77f};
  metal.roughness = 0.3f;
  return {{"Lambert", {.albedo = {0.8f, 0.3f, 0.05f}}},
          {"Phong",
           {.model = BrdfModel::phong,
            .albedo = {0.5f, 0.2f, 0.1f},
            .specular = {0.4f, 0.4f, 0.4f},
            .exponent = 30}},
          {"glaze", glaze},
          {"rough", rough},
          {"metal", metal},
          {"Blinn–Phong",
           {.model = BrdfModel::blinn_phong,
            .albedo = {0.3f, 0.2f, 0.1f},
            .specular = {0.6f, 0.4f, 0.4f},
            .exponent = 60}},
          {"Ward",
           {.model = BrdfModel::ward,
            .albedo = {0.2f, 0.2f, 0.1f},
            .specular = {0.7f, 0.4f, 0.4f},
            .roughness = 0.15f,
            .roughness_across = 0.5f}},
          {"Ashikhmin–Shirley",
           {.model = BrdfModel::ashikhmin_shirley,
            .albedo = {0.5f, 0.2f, 0.1f},
            .specular = {0.3f, 0.4f, 0.4f},
            .exponent = 100,
            .exponent_across = 8}}};
}

TEST(BrdfSampling, HistogramMatchesTheDensity) {
  constexpr int kSamples = 400'000;
  // 24 tests; 4.5 standard deviations are passed by chance once in 12,000 runs of them all.
  constexpr double kDeviation = 4.5;
  Random random(21);
  for (const BrdfCase& item : wide_cases()) {
    for (const double cosine : {0.95, 0.5, 0.15}) {
      const Vec3f out(at_cosine(cosine));
      Histogram counts;
      for (int i = 0; i < kSamples; ++i) {
        const auto drawn = sample(item.brdf, out, random.uniform_float(), random_sample(random));
        ++counts.cells[drawn ? Histogram::cell(Vec3d(drawn->direction)) : counts.cells.size() - 1];
      }
      const double deviation =
          chi_squared_deviation(counts, expected_histogram(item.brdf, out), kSamples);
      EXPECT_LT(deviation, kDeviation) << item.name << " at " << cosine;
    }
  }
}

TEST(BrdfSampling, WeightIsTheBrdfTimesCosineOverDensity) {
  Random random(22);
  int drawn_count = 0;
  for (const BrdfCase& item : brdf_cases()) {
    for (int i = 0; i < 1000; ++i) {
      const Vec3f out(at_cosine(random.uniform(0.01, 1)));
      const auto drawn = sample(item.brdf, out, random.uniform_float(), random_sample(random));
      if (!drawn) continue;
      ++drawn_count;
      ASSERT_GT(drawn->direction.z, 0);
      ASSERT_NEAR(length(drawn->direction), 1, 1e-6);
      ASSERT_EQ(drawn->density, density(item.brdf, drawn->direction, out));
      const Vec3f product =
          evaluate(item.brdf, drawn->direction, out) * (drawn->direction.z / drawn->density);
      ASSERT_EQ(drawn->weight, product);
    }
  }
  EXPECT_GT(drawn_count, 15'000);
}

// The weight of a visible normal is at most 1; the mixture divides it by no less than 0.1.
TEST(BrdfSampling, WeightsAreBounded) {
  Random random(23);
  for (const BrdfCase& item : brdf_cases()) {
    float worst = 0;
    for (int i = 0; i < 5000; ++i) {
      const Vec3f out(at_cosine(random.uniform(0.01, 1)));
      const auto drawn = sample(item.brdf, out, random.uniform_float(), random_sample(random));
      if (drawn) worst = std::max(worst, max_component(drawn->weight));
    }
    EXPECT_LT(worst, 11) << item.name;
    EXPECT_GT(worst, 0) << item.name;
  }
}

TEST(BrdfSampling, AlbedoBySamplingAgreesWithTheQuadratureAndWithUniformDirections) {
  constexpr int kSamples = 200'000;
  Random random(24);
  for (const BrdfCase& item : wide_cases()) {
    for (const double cosine : {0.9, 0.3}) {
      const Vec3f out(at_cosine(cosine));
      double by_brdf = 0, by_brdf2 = 0, uniform = 0, uniform2 = 0;
      for (int i = 0; i < kSamples; ++i) {
        const auto drawn = sample(item.brdf, out, random.uniform_float(), random_sample(random));
        const double weight = drawn ? drawn->weight.x : 0;
        by_brdf += weight;
        by_brdf2 += weight * weight;
        Vec3d in = uniform_sphere(random_sample(random));
        in.z = std::abs(in.z);
        const double value = evaluate(item.brdf, Vec3f(in), out).x * in.z * 2 * kPi;
        uniform += value;
        uniform2 += value * value;
      }
      const auto variance = [](double sum, double squares) {
        return (squares - sum * sum / kSamples) / kSamples / kSamples;
      };
      // 16 comparisons at 4.5σ.
      const double sigma =
          std::sqrt(variance(by_brdf, by_brdf2) + variance(uniform, uniform2)) + 1e-6;
      EXPECT_NEAR(by_brdf / kSamples, uniform / kSamples, 4.5 * sigma) << item.name;
      double diffuse = 0;
      for (int i = 0; i < 1000; ++i) {  // all diffuse terms are isotropic
        const double mu = (i + 0.5) / 1000;
        const Vec3f in(Vec3d(std::sqrt(1 - mu * mu), 0, mu));
        diffuse += 2 * kPi * evaluate_diffuse(item.brdf, in, out).x * mu / 1000;
      }
      const double specular = item.brdf.model == BrdfModel::lambert
                                  ? 0
                                  : reference::specular_albedo(item.brdf, 0, Vec3d(out), 150);
      EXPECT_NEAR(by_brdf / kSamples, diffuse + specular,
                  4.5 * std::sqrt(variance(by_brdf, by_brdf2)) + 5e-4)
          << item.name << " at " << cosine;
    }
  }
}

TEST(BrdfSampling, ABlackSurfaceAndAHiddenEyeDrawNothing) {
  const Brdf black{.albedo = {}};
  EXPECT_FALSE(sample(black, {0, 0, 1}, 0.5f, {0.3, 0.6}).has_value());
  const Brdf grey;
  EXPECT_FALSE(sample(grey, {0, 1, 0}, 0.5f, {0.3, 0.6}).has_value());
  EXPECT_FALSE(sample(grey, {0, 0, -1}, 0.5f, {0.3, 0.6}).has_value());
  EXPECT_TRUE(sample(grey, {0, 0, 1}, 0.5f, {0.3, 0.6}).has_value());
}

}  // namespace
}  // namespace rimlight
