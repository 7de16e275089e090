// BRDFs at the ends of their parameters' ranges: finite, and no more light out than in.
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <string>

#include "core/base/parallel.h"
#include "core/material/albedo.h"
#include "core/material/brdf.h"
#include "core/math/random.h"
#include "core/math/sampling.h"
#include "core/report/stability/cases.h"

namespace rimlight::stability {
namespace {

constexpr std::array kRoughness = {1e-4f, 1e-3f, 0.01f, 0.1f, 1.0f};
constexpr std::array kIndex = {1.0f, 1.0001f, 1.5f, 10.0f, 100.0f};
constexpr std::array kAbsorption = {0.0f, 1e-3f, 5.0f, 100.0f};

Brdf conductor(float roughness, float eta, float k) {
  Brdf brdf;
  brdf.model = BrdfModel::cook_torrance;
  brdf.albedo = {1, 1, 1};
  brdf.specular = {1, 1, 1};
  brdf.roughness = roughness;
  brdf.eta = Vec3f::filled(eta);
  brdf.k = Vec3f::filled(k);
  return brdf;
}

std::vector<Brdf> conductors(const StabilityTrial& trial) {
  std::vector<Brdf> all;
  for (const float roughness : kRoughness) {
    for (const float eta : kIndex) {
      for (const float k : kAbsorption) {
        const bool corner = (roughness == 1e-4f || roughness == 1) && (eta == 1 || eta == 100);
        if (trial.fast && !(corner && (k == 0 || k == 100))) continue;
        all.push_back(conductor(roughness, eta, k));
      }
    }
  }
  return all;
}

std::vector<Brdf> other_models() {
  std::vector<Brdf> all;
  for (const BrdfModel model :
       {BrdfModel::phong, BrdfModel::blinn_phong, BrdfModel::ward, BrdfModel::ashikhmin_shirley}) {
    for (const float sharp : {0.0f, 0.5f, 1.0f}) {
      for (const float specular : {0.0f, 0.5f, 1.0f}) {
        Brdf brdf;
        brdf.model = model;
        brdf.specular = Vec3f::filled(specular);
        brdf.albedo = Vec3f::filled(1 - specular);
        brdf.exponent = brdf.exponent_across = std::pow(1e5f, sharp);
        brdf.roughness = brdf.roughness_across = std::pow(1e-4f, sharp);
        all.push_back(brdf);
      }
    }
  }
  return all;
}

/// The largest share of light that any of the materials reflects.
double largest_of(const std::vector<Brdf>& all, double disturbed) {
  std::vector<double> largest(all.size());
  parallel_for(all.size(), [&](std::size_t i) {
    const auto f = [&](const Vec3d& in, const Vec3d& out) {
      return Vec3d(evaluate(all[i], Vec3f(in), Vec3f(out))) * disturbed;
    };
    largest[i] = largest_albedo(directional_albedos(f, 2));
  });
  return *std::ranges::max_element(largest);
}

StabilityMeasure energy_of_conductors(const StabilityTrial& trial) {
  const auto all = conductors(trial);
  return {largest_of(all, trial.either(1.0, 1.2)), std::to_string(all.size()) + " materials"};
}

StabilityMeasure energy_of_other_models(const StabilityTrial& trial) {
  const auto all = other_models();
  return {largest_of(all, trial.either(1.0, 1.2)), std::to_string(all.size()) + " materials"};
}

/// A direction above the horizon, often at grazing angles, or along the normal.
Vec3f extreme_direction(Random& random) {
  const double azimuth = random.uniform(0, 2 * std::numbers::pi);
  const double kind = random.uniform();
  double z = random.uniform();
  if (kind < 0.3) z = std::pow(10, random.uniform(-30, -2));
  if (kind > 0.7) z = 1 - std::pow(10, random.uniform(-16, -2));
  const double r = std::sqrt(std::max(0.0, 1 - z * z));
  return {static_cast<float>(r * std::cos(azimuth)), static_cast<float>(r * std::sin(azimuth)),
          static_cast<float>(z)};
}

bool is_sound(const Vec3f& value) {
  return is_finite(value) && value.x >= 0 && value.y >= 0 && value.z >= 0;
}

/// How many values, densities and samples of a material are negative or no numbers.
int count_faults(const Brdf& brdf, int pairs, bool broken) {
  Random random(1);
  int faults = 0;
  for (int i = 0; i < pairs; ++i) {
    const Vec3f out = extreme_direction(random);
    Vec3f in = extreme_direction(random);
    if (i % 3 == 0) in = {-out.x, -out.y, out.z};  // the mirror direction
    if (i % 7 == 0) in = {-out.x, -out.y, std::max(out.z, 1e-30f)};
    if (broken && i == 0) in.x = std::numeric_limits<float>::quiet_NaN();
    const float chance = density(brdf, in, out);
    faults += is_sound(evaluate(brdf, in, out)) ? 0 : 1;
    faults += std::isfinite(chance) && chance >= 0 ? 0 : 1;
    const auto drawn = sample(brdf, out, random.uniform_float(), random_sample(random));
    if (!drawn) continue;
    const bool sound = is_sound(drawn->weight) && drawn->density > 0 &&
                       std::isfinite(drawn->density) && drawn->direction.z > 0 &&
                       std::abs(length(drawn->direction) - 1) < 1e-4f;
    faults += sound ? 0 : 1;
  }
  return faults;
}

StabilityMeasure finite_everywhere(const StabilityTrial& trial) {
  std::vector<Brdf> all = conductors({});
  for (const Brdf& brdf : other_models()) all.push_back(brdf);
  all.push_back({});
  std::vector<int> faults(all.size());
  parallel_for(all.size(), [&](std::size_t i) {
    faults[i] = count_faults(all[i], trial.fast ? 300 : 10'000, trial.broken);
  });
  int sum = 0;
  for (const int count : faults) sum += count;
  return {static_cast<double>(sum), std::to_string(all.size()) + " materials"};
}

/// The mean weight of samples is the share of light that a surface reflects: ∫ f cos θ dω.
StabilityMeasure sampled_energy(const StabilityTrial& trial) {
  std::vector<Brdf> all = conductors(trial);
  for (const Brdf& brdf : other_models()) all.push_back(brdf);
  std::vector<double> largest(all.size());
  const int count = trial.fast ? 4'000 : 20'000;
  parallel_for(all.size(), [&](std::size_t i) {
    for (const double cosine : {1.0, 0.7, 0.2, 0.02}) {
      const Vec3f out(Vec3d(std::sqrt(1 - cosine * cosine), 0, cosine));
      Random random(2, i);
      double sum = 0, squares = 0;
      for (int k = 0; k < count; ++k) {
        const auto drawn = sample(all[i], out, random.uniform_float(), random_sample(random));
        const double weight = drawn ? double{max_component(drawn->weight)} : 0;
        sum += weight;
        squares += weight * weight;
      }
      const double mean = sum / count;
      const double error = std::sqrt(std::max(0.0, squares / count - mean * mean) / count);
      // Five standard errors: some 500 means are looked at.
      largest[i] = std::max(largest[i], mean * trial.either(1.0, 1.5) - 5 * error);
    }
  });
  return {*std::ranges::max_element(largest), std::to_string(all.size()) + " materials"};
}

}  // namespace

std::vector<StabilityCase> materials_cases() {
  using enum BoundKind;
  const std::string part = "materials";
  const std::string energy = "no surface reflects more than it gets; 1 % for the quadrature";
  return {
      {"energy-of-conductors", part,
       "largest directional albedo of Cook–Torrance, roughness 1e-4 … 1, n 1 … 100, k 0 … 100",
       at_most, 1.01, energy, energy_of_conductors},
      {"energy-of-other-models", part,
       "the same of Phong, Blinn–Phong, Ward, Ashikhmin–Shirley, exponents to 1e5, roughness from "
       "1e-4",
       at_most, 1.01, energy, energy_of_other_models},
      {"finite-brdfs", part,
       "values, densities and samples that are negative or no numbers, grazing and mirror "
       "directions",
       at_most, 0, "a BRDF and its densities are finite and not negative", finite_everywhere},
      {"sampled-energy", part, "largest mean weight of samples, less five standard errors", at_most,
       1.001, "the mean weight is the directional albedo, at most 1; weights are floats",
       sampled_energy},
  };
}

}  // namespace rimlight::stability
