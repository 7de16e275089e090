// Looks for extremes that the table of stability cases does not have yet: random inputs over whole
// domains and their corners, from seeds that a failure prints. What is found becomes a case of
// core/report/stability.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <string>

#include "core/base/half.h"
#include "core/basis/cube_haar.h"
#include "core/basis/sh_product.h"
#include "core/basis/sh_rotation.h"
#include "core/basis/sh_window.h"
#include "core/basis/sh_zonal.h"
#include "core/image/tone_map.h"
#include "core/light/light_rotation.h"
#include "core/light/sun_and_sky.h"
#include "core/material/brdf.h"
#include "core/material/curve_points.h"
#include "core/math/random.h"
#include "core/math/sampling.h"
#include "core/relight/policy_settings.h"

namespace rimlight {
namespace {

/// How many inputs of each kind; RIMLIGHT_SEARCH=100 looks a hundred times as long.
std::uint64_t trials(std::uint64_t count) {
  const char* const times = std::getenv("RIMLIGHT_SEARCH");
  return times == nullptr ? count
                          : count * static_cast<std::uint64_t>(std::max(1, std::stoi(times)));
}

/// A number that is often at an end of a range: 0, least, most, or any decade in between.
double corner(Random& random, double least, double most) {
  switch (random.below(6)) {
    case 0:
      return 0;
    case 1:
      return least;
    case 2:
      return most;
    default:
      return least * std::pow(most / least, random.uniform());
  }
}

/// A turn that is often none, tiny, half a turn, or along an axis.
Quaternion any_turn(Random& random) {
  const Vec3d axes[] = {{1, 0, 0}, {0, 1, 0}, {0, 0, -1}, {1, 1, 1}};
  const double angles[] = {0,
                           1e-300,
                           1e-15,
                           1e-7,
                           1e-3,
                           std::numbers::pi / 2,
                           std::numbers::pi,
                           std::numbers::pi - 1e-12,
                           2 * std::numbers::pi};
  if (random.below(2) == 0) return random_rotation(random);
  const Vec3d axis =
      random.below(2) == 0 ? axes[random.below(4)] : uniform_sphere(random_sample(random));
  return normalized(axis_angle(axis, angles[random.below(9)]));
}

/// Texels of any decades: few of them lit, many, or all alike.
CubeLight any_light(Random& random, int size) {
  CubeLight light(size);
  const double share = corner(random, 1e-3, 1), most = corner(random, 1e-8, 1e8);
  const bool even = random.below(4) == 0;
  for (std::size_t t = 0; t < light.count(); ++t) {
    if (random.uniform() >= share) continue;
    for (int c = 0; c < 3; ++c) {
      const double value = even ? most : corner(random, 1e-8, std::max(1e-8, most));
      light.channel(c)[t] = static_cast<float>(value);
    }
  }
  return light;
}

TEST(StabilitySearch, TurnedLightKeepsItsEnergyAndNeverExceedsWhatItHad) {
  for (std::uint64_t seed = 0; seed < trials(300); ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    Random random(seed, 1);
    const int size = 2 << random.below(5);
    LightRotator rotator(any_light(random, size));
    const Vec3d before = integral(rotator.source());
    CubeLight turned;
    rotator.rotate(any_turn(random), turned);
    const Vec3d after = integral(turned);
    for (int c = 0; c < 3; ++c) {
      ASSERT_LE(std::abs(after[c] - before[c]), 1e-3 * before[c]);
    }
    for (const float value : turned.values) ASSERT_TRUE(value >= 0 && std::isfinite(value));
  }
}

TEST(StabilitySearch, ASunAndItsSkyAreTheLight) {
  for (std::uint64_t seed = 0; seed < trials(300); ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    Random random(seed, 2);
    const CubeLight light = any_light(random, 4 << random.below(4));
    const SunAndSky split = split_sun(light);
    const Vec3d whole = integral(light), sky = integral(split.sky);
    for (int c = 0; c < 3; ++c) {
      const double sun = split.sun ? split.sun->irradiance[c] : 0;
      // Irradiance falls short of ∫ L by the cosine of the spot's radius.
      ASSERT_LE(sky[c] + sun, whole[c] * (1 + 1e-4));
      ASSERT_GE(sky[c] + sun, whole[c] * 0.9);
    }
    for (const float value : split.sky.values) ASSERT_TRUE(value >= 0 && std::isfinite(value));
    if (split.sun) {
      ASSERT_NEAR(length(split.sun->direction), 1, 1e-9);
    }
  }
}

TEST(StabilitySearch, HaarIsItsOwnInverse) {
  for (std::uint64_t seed = 0; seed < trials(200); ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    Random random(seed, 3);
    const int size = 2 << random.below(6);
    CubeLight light = any_light(random, size);
    const std::vector<float> truth(light.channel(0).begin(), light.channel(0).end());
    std::vector<float> coefficients(truth.size()), texels(truth.size());
    const CubeHaar haar(size);
    haar.forward(light.channel(0), coefficients);
    haar.inverse(coefficients, texels);
    const float largest = *std::ranges::max_element(truth);
    for (std::size_t i = 0; i < truth.size(); ++i) {
      ASSERT_LE(std::abs(double{texels[i]} - double{truth[i]}), 64 * 0x1p-24 * double{largest});
    }
  }
}

TEST(StabilitySearch, TurnsOfHarmonicsComeBackAndKeepEveryBand) {
  for (std::uint64_t seed = 0; seed < trials(100); ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    Random random(seed, 4);
    const int degree = static_cast<int>(random.below(sh::kLargestLightDegree + 1));
    std::vector<double> source(sh::coefficient_count(degree)), turned(source.size()),
        back(source.size());
    for (double& value : source) value = corner(random, 1e-100, 1e100);
    const Quaternion q = any_turn(random);
    const double scale = corner(random, 1e-100, 1e100) + 1e-100;
    const Quaternion scaled{q.x * scale, q.y * scale, q.z * scale, q.w * scale};
    sh::Rotation(scaled, degree).apply(source, turned);
    sh::Rotation(conjugate(q), degree).apply(turned, back);
    for (int l = 0; l <= degree; ++l) {
      double largest = 0, worst = 0;
      for (std::size_t i = sh::index(l, -l); i <= sh::index(l, l); ++i) {
        largest = std::max(largest, std::abs(source[i]));
        worst = std::max(worst, std::abs(back[i] - source[i]));
      }
      // 1e-13 of a band's norm, which is √(2l + 1) of its largest at most, each way.
      ASSERT_LE(worst, 2e-13 * std::sqrt(2 * l + 1) * largest) << "band " << l;
    }
  }
}

TEST(StabilitySearch, AFittedWindowKeepsALightAboveItsLimit) {
  int windows = 0;
  for (std::uint64_t seed = 0; seed < trials(60); ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    Random random(seed, 5);
    const int degree = static_cast<int>(1 + random.below(20));
    std::vector<float> light(sh::coefficient_count(degree));
    for (std::size_t lamp = 0; lamp <= random.below(4); ++lamp) {
      const double power = corner(random, 1e-8, 1e8) + 1e-8;
      const auto basis = sh::evaluate(uniform_sphere(random_sample(random)), degree);
      for (std::size_t i = 0; i < basis.size(); ++i)
        light[i] += static_cast<float>(power * basis[i]);
    }
    const sh::FittedWindow window = sh::fitted_window(light);
    windows += window.time > 0 ? 1 : 0;
    ASSERT_GE(window.least_after, -0.02 - 1e-3);
    for (std::size_t l = 1; l < window.factors.size(); ++l) {
      ASSERT_TRUE(window.factors[l] >= 0 && window.factors[l] <= window.factors[l - 1]);
    }
  }
  EXPECT_GT(windows, 0);
}

TEST(StabilitySearch, BrdfsAreReciprocalFiniteAndDrawnAsTheySay) {
  const BrdfModel models[] = {BrdfModel::lambert,       BrdfModel::phong,
                              BrdfModel::cook_torrance, BrdfModel::blinn_phong,
                              BrdfModel::ward,          BrdfModel::ashikhmin_shirley};
  for (std::uint64_t seed = 0; seed < trials(20'000); ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    Random random(seed, 6);
    Brdf brdf;
    brdf.model = models[random.below(6)];
    const auto part = static_cast<float>(random.uniform());
    brdf.specular = Vec3f::filled(part);
    brdf.albedo = Vec3f::filled(1 - part);
    const auto within = [&](double least, double most) {
      return static_cast<float>(std::clamp(corner(random, least, most), least, most));
    };
    brdf.exponent = within(1, 1e5);
    brdf.exponent_across = within(1, 1e5);
    brdf.roughness = within(1e-4, 1);
    brdf.roughness_across = within(1e-4, 1);
    brdf.eta = Vec3f::filled(within(0.05, 100));
    brdf.k = Vec3f::filled(static_cast<float>(corner(random, 1e-6, 100)));
    const auto direction = [&] {
      const double z =
          random.below(3) == 0 ? std::pow(10, random.uniform(-20, 0)) : random.uniform();
      const double azimuth = random.uniform(0, 7), r = std::sqrt(std::max(0.0, 1 - z * z));
      return Vec3f(Vec3d(r * std::cos(azimuth), r * std::sin(azimuth), z));
    };
    const Vec3f in = direction(), out = direction();
    const Vec3f there = evaluate(brdf, in, out), back = evaluate(brdf, out, in);
    ASSERT_TRUE(is_finite(there) && there.x >= 0);
    ASSERT_LE(std::abs(double{there.x} - double{back.x}), 1e-3 * double{there.x} + 1e-30);
    const auto drawn = sample(brdf, out, random.uniform_float(), random_sample(random));
    if (!drawn) continue;
    ASSERT_TRUE(is_finite(drawn->weight) && drawn->weight.x >= 0 && drawn->density > 0);
    ASSERT_TRUE(std::isfinite(drawn->density));
  }
}

TEST(StabilitySearch, CurvesThroughAnyPointsStayBetweenThem) {
  for (std::uint64_t seed = 0; seed < trials(2'000); ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    Random random(seed, 7);
    std::vector<CurvePoint> points;
    double position = corner(random, 1e-12, 0.5), least = 1e300, most = 0;
    while (position <= 1 && points.size() < 12) {
      const double value = corner(random, 1e-12, kLargestCurveValue);
      points.push_back({position, Vec3d::filled(value)});
      least = std::min(least, value);
      most = std::max(most, value);
      position += corner(random, 1e-9, 0.3) + 1e-12;
    }
    const auto scale = random.below(2) == 0 ? CurveScale::linear : CurveScale::logarithmic;
    const auto axis = random.below(2) == 0 ? CurveAxis::half_angle : CurveAxis::difference_angle;
    const BrdfCurve curve = curve_from_points(axis, scale, points, "curve");
    for (const Vec3f& value : curve.values) {
      ASSERT_TRUE(std::isfinite(value.x));
      ASSERT_GE(double{value.x}, std::max(0.0, least - kSmallestCurveValue) * (1 - 1e-6));
      ASSERT_LE(double{value.x}, std::max(most, kSmallestCurveValue) * (1 + 1e-6));
    }
  }
}

TEST(StabilitySearch, PlansKeepAnyBudget) {
  const char* const names[] = {"linear",         "nwa",    "bi", "pbi", "pbi:dealer",
                               "pbi:exhaustive", "benefit"};
  for (std::uint64_t seed = 0; seed < trials(300); ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    Random random(seed, 8);
    const CubeHaar haar(2 << random.below(4));
    const CubeLight target = any_light(random, haar.size()), held = any_light(random, haar.size());
    std::vector<float> norms(target.values.size());
    for (float& norm : norms) norm = static_cast<float>(corner(random, 1e-20, 1e10));
    std::vector<std::uint32_t> bytes(target.count());
    for (std::uint32_t& size : bytes) {
      size = static_cast<std::uint32_t>(corner(random, 1, 4e9));
    }
    const auto unit = random.below(2) == 0 ? Budget::Unit::bytes : Budget::Unit::coefficients;
    const Budget budget{unit, static_cast<std::size_t>(corner(random, 1, 1e12))};
    const char* const name = names[random.below(7)];
    const auto policy = make_policy(parse_policy(name, "policy"));
    PlanWorkspace workspace;
    UpdatePlan plan;
    policy->make_plan({haar, target, held, budget, norms, bytes, 0}, workspace, plan);
    double spent = 0;
    for (const ColumnDelta& delta : plan.columns) {
      spent += unit == Budget::Unit::bytes ? bytes[delta.column] : 1;
      ASSERT_TRUE(is_finite(delta.delta)) << name;
    }
    ASSERT_LE(spent, static_cast<double>(budget.amount)) << name;
  }
}

TEST(StabilitySearch, BytesRiseWithRadianceUnderAnyExposure) {
  for (std::uint64_t seed = 0; seed < trials(500); ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    Random random(seed, 9);
    std::vector<float> radiance(40);
    for (float& value : radiance) value = static_cast<float>(corner(random, 1e-38, 3e38));
    std::ranges::sort(radiance);
    std::vector<std::uint8_t> rgb(3 * radiance.size());
    tone_map(radiance, radiance, radiance, static_cast<float>(corner(random, 1e-19, 1e19)), rgb);
    for (std::size_t i = 3; i < rgb.size(); ++i) ASSERT_GE(rgb[i], rgb[i - 3]);
  }
}

}  // namespace
}  // namespace rimlight
