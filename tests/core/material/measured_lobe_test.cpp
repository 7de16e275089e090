// Measured BRDFs in factors as materials: values, and directions drawn from their θ_h.
#include "core/material/measured_lobe.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include "core/material/albedo.h"
#include "core/math/random.h"

namespace rimlight {
namespace {

constexpr double kPi = std::numbers::pi;

struct LobeCase {
  std::string name;
  MeasuredLobe lobe;
};

/// A lobe over θ_h; the other factors vary as much as measured ones do.
template <typename Half>
MeasuredLobe lobe_of(const Half& half) {
  FactoredBrdf factors;
  for (std::size_t i = 0; i < kCurveBins; ++i) {
    factors.half_angle.values[i] = half(i);
    const auto share = static_cast<float>(i) / kCurveBins;
    factors.difference_angle.values[i] = {0.5f + share, 1, 1.5f - share};
  }
  for (std::size_t i = 0; i < kRestKnots; ++i) {
    const auto share = static_cast<float>(i) / kRestKnots;
    factors.rest[i] = {0.8f + 0.3f * share, 1, 0.9f};
  }
  return MeasuredLobe(factors);
}

std::vector<LobeCase> lobe_cases() {
  const auto at = [](std::size_t i) {
    return bin_begin(CurveAxis::half_angle, static_cast<double>(i) + 0.5);
  };
  return {{"wide", lobe_of([&](std::size_t i) {
             const auto value = static_cast<float>(0.1 + 0.8 * std::exp(-8 * at(i) * at(i)));
             return Vec3f{value, 0.5f * value, 0.2f};
           })},
          {"cut off", lobe_of([](std::size_t i) {
             return i >= 60 && i < 140 ? Vec3f{0.9f, 0.4f, 0.1f} : Vec3f{};
           })},
          {"constant", lobe_of([](std::size_t) {
             return Vec3f{0.2f, 0.2f, 0.2f};
           })}};
}

/// What nothing but their bounds holds.
std::vector<LobeCase> extreme_cases() {
  return {{"black", lobe_of([](std::size_t) { return Vec3f{}; })},
          {"a spike", lobe_of([](std::size_t i) {
             return i == 2 ? Vec3f{1e6f, 1e6f, 1e6f} : Vec3f{};
           })},
          {"one bin at grazing", lobe_of([](std::size_t i) {
             return i == 255 ? Vec3f{1, 1, 1} : Vec3f{};
           })},
          {"all", lobe_of([](std::size_t) {
             return Vec3f{1e6f, 0, 1e6f};
           })}};
}

Brdf brdf_of(const MeasuredLobe& lobe) {
  return {.model = BrdfModel::measured, .albedo = {}, .measured = &lobe};
}

Vec3f at_cosine(double cosine) { return Vec3f(Vec3d(std::sqrt(1 - cosine * cosine), 0, cosine)); }

TEST(MeasuredLobe, IsTheProductOfItsFactorsBothWaysRound) {
  Random random(1);
  for (const LobeCase& item : lobe_cases()) {
    const Brdf brdf = brdf_of(item.lobe);
    int positive = 0;
    for (int i = 0; i < 2000; ++i) {
      const Vec3f in(cosine_hemisphere(random_sample(random)));
      const Vec3f out(cosine_hemisphere(random_sample(random)));
      const Vec3f value = evaluate(brdf, in, out);
      const Vec3d expected = evaluate(item.lobe.factors(), Vec3d(in), Vec3d(out));
      for (int c = 0; c < 3; ++c) EXPECT_NEAR(value[c], expected[c], 1e-6 * expected[c]);
      const Vec3f back = evaluate(brdf, out, in);
      for (int c = 0; c < 3; ++c) EXPECT_NEAR(value[c], back[c], 1e-6f * value[c]);
      positive += value.x > 0 ? 1 : 0;
      EXPECT_EQ(evaluate(brdf, Vec3f{in.x, in.y, -in.z}, out), Vec3f());
    }
    EXPECT_GT(positive, 200) << item.name;
  }
}

TEST(MeasuredLobe, DrawsAsItsDensitySays) {
  constexpr int kPolar = 10, kAzimuth = 12, kFine = 60, kSamples = 300'000;
  Random random(2);
  for (const LobeCase& item : lobe_cases()) {
    const Brdf brdf = brdf_of(item.lobe);
    for (const double cosine : {0.95, 0.5, 0.15}) {
      const Vec3f out = at_cosine(cosine);
      std::vector<double> expected(kPolar * kAzimuth), counts(kPolar * kAzimuth);
      double total = 0;
      for (int row = 0; row < kPolar * kFine; ++row) {
        for (int column = 0; column < kAzimuth * kFine; ++column) {
          const double z = (row + 0.5) / (kPolar * kFine), r = std::sqrt(1 - z * z);
          const double phi = 2 * kPi * (column + 0.5) / (kAzimuth * kFine) - kPi;
          const Vec3f in(Vec3d(r * std::cos(phi), r * std::sin(phi), z));
          const double p =
              double{density(brdf, in, out)} * 2 * kPi / (kPolar * kFine * kAzimuth * kFine);
          expected[static_cast<std::size_t>(row / kFine * kAzimuth + column / kFine)] += p;
          total += p;
        }
      }
      EXPECT_LE(total, 1.002) << item.name;
      EXPECT_GT(total, 0.4) << item.name;
      for (int i = 0; i < kSamples; ++i) {
        // Twice the lobe's own random number: sample() may not draw what the BRDF has no light of.
        const float choice = random.uniform_float();
        const Sample2 sample2 = random_sample(random);
        const Vec3f in =
            choice < 0.5f ? item.lobe.draw(out, sample2) : Vec3f(cosine_hemisphere(sample2));
        if (!(in.z > 0)) continue;
        const double turn = std::atan2(double{in.y}, double{in.x}) / (2 * kPi) + 0.5;
        const int row = std::min(kPolar - 1, static_cast<int>(in.z * kPolar));
        const int column = std::min(kAzimuth - 1, static_cast<int>(turn * kAzimuth));
        counts[static_cast<std::size_t>(row * kAzimuth + column)] += 1;
      }
      // 1080 cells at 5σ: by chance once in 1,600 runs; and 1 % for the midpoint rule over bins.
      for (std::size_t i = 0; i < counts.size(); ++i) {
        const double mean = expected[i] * kSamples;
        EXPECT_NEAR(counts[i], mean, 5 * std::sqrt(mean + 1) + 0.01 * mean)
            << item.name << " at " << cosine << ", cell " << i;
      }
    }
  }
}

TEST(MeasuredLobe, AlbedoBySamplingIsThatOfTheQuadrature) {
  constexpr int kSamples = 100'000;
  Random random(3);
  for (const LobeCase& item : lobe_cases()) {
    const Brdf brdf = brdf_of(item.lobe);
    const auto albedos = directional_albedos(
        [&](const Vec3d& in, const Vec3d& out) { return evaluate(item.lobe.factors(), in, out); });
    for (const DirectionalAlbedo& at : albedos) {
      if (at.cosine < 0.1) continue;  // where the quadrature is rough
      double sum = 0, squares = 0;
      for (int i = 0; i < kSamples; ++i) {
        const auto drawn =
            sample(brdf, at_cosine(at.cosine), random.uniform_float(), random_sample(random));
        const double weight = drawn ? double{drawn->weight.x} : 0;
        sum += weight;
        squares += weight * weight;
      }
      const double mean = sum / kSamples;
      const double sigma = std::sqrt((squares / kSamples - mean * mean) / kSamples);
      EXPECT_NEAR(mean, at.albedo.x, 4.5 * sigma + 0.01 * at.albedo.x)
          << item.name << " at " << at.cosine;
      EXPECT_GT(at.albedo.x, 0);
    }
  }
}

TEST(MeasuredLobe, IsFiniteForAnyCurve) {
  Random random(4);
  for (const LobeCase& item : extreme_cases()) {
    const Brdf brdf = brdf_of(item.lobe);
    int drawn_count = 0;
    for (int i = 0; i < 5000; ++i) {
      const Vec3f out = at_cosine(i % 2 == 0 ? random.uniform(1e-6, 1) : 1e-5);
      const auto drawn = sample(brdf, out, random.uniform_float(), random_sample(random));
      if (!drawn) continue;
      ++drawn_count;
      ASSERT_TRUE(is_finite(drawn->direction) && is_finite(drawn->weight)) << item.name;
      ASSERT_GT(drawn->density, 0) << item.name;
      ASSERT_TRUE(std::isfinite(drawn->density)) << item.name;
    }
    EXPECT_EQ(drawn_count > 0, item.name != "black") << item.name;
    EXPECT_EQ(density(brdf, {0, 0, -1}, {0, 0, 1}), 0);
    EXPECT_TRUE(std::isfinite(item.lobe.roughness())) << item.name;
  }
}

TEST(MeasuredLobe, HasTheRoughnessOfBeckmannsThatItIs) {
  for (const float roughness : {0.02f, 0.1f, 0.3f, 0.6f}) {
    const Brdf beckmann{.model = BrdfModel::cook_torrance, .albedo = {}, .roughness = roughness};
    FactoredBrdf factors;
    factors.half_angle = *factor_curve(beckmann, CurveAxis::half_angle);
    const MeasuredLobe lobe(factors);
    EXPECT_NEAR(lobe.roughness(), roughness, 0.05f * roughness + 1e-3f);
    EXPECT_EQ(is_glossy(brdf_of(lobe)), roughness < 0.35f);
    EXPECT_FALSE(is_anisotropic(brdf_of(lobe)));
  }
}

}  // namespace
}  // namespace rimlight
