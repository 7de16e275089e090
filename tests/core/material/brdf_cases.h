#pragma once

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "core/material/brdf.h"

namespace rimlight {

struct BrdfCase {
  std::string name;
  Brdf brdf;
};

/// Materials over the whole domain, its corners included.
inline std::vector<BrdfCase> brdf_cases() {
  std::vector<BrdfCase> cases;
  cases.push_back({"white Lambert", {.albedo = {1, 1, 1}}});
  cases.push_back({"coloured Lambert", {.albedo = {0.8f, 0.3f, 0.05f}}});
  for (const float exponent : {1.0f, 20.0f, 1000.0f, 1e5f}) {
    cases.push_back({"Phong " + std::to_string(exponent),
                     {.model = BrdfModel::phong,
                      .albedo = {0.5f, 0.2f, 0},
                      .specular = {0.5f, 0.6f, 1},
                      .exponent = exponent}});
  }
  struct Index {
    const char* name;
    Vec3f eta, k;
    float specular;
  };
  const Index indices[] = {{"glaze", {1.5f, 1.5f, 1.5f}, {}, 1},
                           {"half glaze", {1.33f, 1.78f, 2.4f}, {}, 0.5f},
                           {"gold", {0.18f, 0.42f, 1.37f}, {3.42f, 2.35f, 1.77f}, 1},
                           {"corners", {1, 20, 0.05f}, {0, 20, 0}, 1},
                           {"far corners", {100, 100, 1}, {0, 100, 100}, 1}};
  for (const Index& index : indices) {
    for (const float roughness : {1e-4f, 0.01f, 0.1f, 0.3f, 1.0f}) {
      cases.push_back({std::string(index.name) + " of roughness " + std::to_string(roughness),
                       {.model = BrdfModel::cook_torrance,
                        .albedo = {1, 1, 1},
                        .specular = Vec3f::filled(index.specular),
                        .roughness = roughness,
                        .eta = index.eta,
                        .k = index.k}});
    }
  }
  for (const float exponent : {1.0f, 3.0f, 60.0f, 1e5f}) {
    cases.push_back({"Blinn–Phong " + std::to_string(exponent),
                     {.model = BrdfModel::blinn_phong,
                      .albedo = {0.5f, 0.2f, 0},
                      .specular = {0.5f, 0.6f, 1},
                      .exponent = exponent}});
  }
  const float slopes[][2] = {{1e-4f, 1e-4f}, {1e-4f, 1}, {0.05f, 0.4f}, {0.3f, 0.3f}, {1, 1}};
  for (const auto& slope : slopes) {
    cases.push_back({"Ward " + std::to_string(slope[0]) + " by " + std::to_string(slope[1]),
                     {.model = BrdfModel::ward,
                      .albedo = {0.5f, 0.2f, 0},
                      .specular = {0.5f, 0.6f, 1},
                      .roughness = slope[0],
                      .roughness_across = slope[1]}});
  }
  const float exponents[][2] = {{1, 1}, {1, 1e5f}, {10, 400}, {80, 80}, {1e5f, 1e5f}};
  for (const auto& exponent : exponents) {
    cases.push_back(
        {"Ashikhmin–Shirley " + std::to_string(exponent[0]) + " by " + std::to_string(exponent[1]),
         {.model = BrdfModel::ashikhmin_shirley,
          .albedo = {1, 1, 0.3f},
          .specular = {0, 0.3f, 1},
          .exponent = exponent[0],
          .exponent_across = exponent[1]}});
  }
  return cases;
}

/// The angle over which the specular lobe falls off, where it is narrowest.
inline double lobe_width(const Brdf& brdf) {
  switch (brdf.model) {
    case BrdfModel::lambert:
      return 1;
    case BrdfModel::cook_torrance:
      return brdf.roughness;
    case BrdfModel::ward:
      return std::min(brdf.roughness, brdf.roughness_across);
    case BrdfModel::ashikhmin_shirley:
      return 1 / std::sqrt(std::max(brdf.exponent, brdf.exponent_across));
    default:
      return 1 / std::sqrt(brdf.exponent);
  }
}

/// The direction at a polar angle of the given cosine, in the x–z plane turned by 0.7.
inline Vec3d at_cosine(double cosine) {
  const double sine = std::sqrt(1 - cosine * cosine);
  return {sine * std::cos(0.7), sine * std::sin(0.7), cosine};
}

/// From the zenith to half a degree above the horizon, and beyond.
inline const std::vector<double> kOutCosines{1, 0.95, 0.8, 0.6, 0.4, 0.25, 0.12, 0.05, 0.01, 1e-3};

}  // namespace rimlight
