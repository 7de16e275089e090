// A stiff series of bounces: inside a sphere with an opening, f of its surface, under a uniform sky
// of radiance 1. From any point of a sphere's inside any part of it fills the same share of the
// cosine-weighted view, so that radiance is the same everywhere:
//
//     B = ρ (f + (1 − f) B) = ρ f / (1 − ρ (1 − f)),    after k reflections B − B (ρ (1 − f))^k
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <numbers>
#include <string>

#include "core/bake/vertex_bounces.h"
#include "core/bake/vertex_sh_bake.h"
#include "core/report/stability/cases.h"
#include "core/report/stability/small_scenes.h"

namespace rimlight::stability {
namespace {

struct Cavity {
  double open;  // f
  float albedo;

  double radiance() const { return albedo * open / (1 - double{albedo} * (1 - open)); }
  /// Of the whole, what so many reflections leave out.
  double left_after(int reflections) const {
    return std::pow(double{albedo} * (1 - open), reflections);
  }
};

std::string percent(double share) {
  char text[32];
  std::snprintf(text, sizeof text, "%.3g %%", 100 * share);
  return text;
}

/// The mean radiance of the vertices, by the bake's own rays and bounces.
StabilityMeasure at_vertices(const Cavity& cavity, const StabilityTrial& trial) {
  const auto scene =
      open_sphere({cavity.open, cavity.albedo, BakeKind::vertex_sh, trial.fast ? 32 : 64});
  scene->bake.vertex.most_rays = trial.fast ? 512 : 4096;
  if (trial.broken) scene->materials[0].brdf.albedo *= 0.97f;
  const PreparedVertices prepared = prepare_vertices(*scene);
  const CalculatedVertices found = calculate_vertices(*scene, prepared, {});
  const std::vector<float>& irradiance = found.transport.irradiance.at(0);
  const std::size_t coefficients = sh::coefficient_count(found.transport.degree);
  double sum = 0;
  for (std::size_t i = 0; i < irradiance.size(); i += coefficients) sum += double{irradiance[i]};
  // A uniform sky of radiance 1 has the one coefficient √4π.
  const double mean = sum / static_cast<double>(found.transport.vertex_count) *
                      std::sqrt(4 * std::numbers::pi) * cavity.albedo / std::numbers::pi;
  const std::string note = found.measured.at("bounces").dump() + " bounces";
  return {std::abs(mean / cavity.radiance() - 1), note};
}

/// The mean radiance of an image's pixels, against as many reflections as its paths have.
StabilityMeasure in_pixels(const Cavity& cavity, const StabilityTrial& trial) {
  const auto scene = open_sphere({.open = cavity.open, .albedo = cavity.albedo});
  scene->bake.bounces = 64;
  if (trial.fast) scene->bake.primary_rays = 4;
  if (trial.broken) scene->materials[0].brdf.albedo *= 0.95f;
  const auto picture = picture_of(scene, uniform_sky(scene->bake.cube_size));
  double sum = 0;
  for (const Vec3f& radiance : picture) sum += double{radiance.x};
  const double left = cavity.left_after(scene->bake.bounces + 1);
  const double mean = sum / static_cast<double>(picture.size());
  return {std::abs(mean / (cavity.radiance() * (1 - left)) - 1),
          "64 bounces leave out " + percent(left)};
}

/// One surface that sees nothing but itself and a pinhole: the terms are too few, and what is left
/// is what the bake says is left.
StabilityMeasure pinhole(const StabilityTrial& trial) {
  constexpr double kOpen = 1e-4;
  constexpr float kAlbedo = 0.9999f;
  const GatherMatrix matrix{{0, 1}, {0}, {static_cast<float>(1 - kOpen)}};
  VertexMesh mesh;
  mesh.positions.resize(1);
  mesh.materials.resize(1);
  const std::vector<Material> materials(1);
  const std::vector<float> albedo = {kAlbedo};
  std::vector<float> light = {1};
  const Bounces bounces =
      add_bounces(matrix, albedo, SubsurfaceSpread(mesh, materials), 0, 1, 1e-3, light);
  const double whole = 1 / (1 - double{kAlbedo} * double{matrix.weight[0]});
  const double said = bounces.left * trial.either(1.0, 0.5);
  return {(whole - double{light[0]}) / said,
          std::to_string(bounces.count) + " bounces leave " + percent(said / whole)};
}

using Measure = StabilityMeasure (*)(const Cavity&, const StabilityTrial&);

StabilityCase make_case(const std::string& name, Measure measure, const Cavity& cavity,
                        const std::string& why) {
  return {name,
          "interreflection",
          "relative error of the mean radiance against the closed form",
          BoundKind::at_most,
          0.02,
          why,
          [measure, cavity](const StabilityTrial& trial) { return measure(cavity, trial); }};
}

}  // namespace

std::vector<StabilityCase> interreflection_cases() {
  const std::string vertices =
      "rays are asked for an error of 0.5 %; flat faces in the sphere's place, 64 around, change "
      "the "
      "view by (π/64)² = 0.24 %, which a narrow opening makes larger";
  const std::string pixels =
      "against as many reflections as the bake's paths have; noise of 256 pixels, and flat faces";
  return {
      make_case("vertices-albedo-0.99", at_vertices, {0.1, 0.99f}, vertices),
      make_case("vertices-albedo-0.9999", at_vertices, {0.1, 0.9999f}, vertices),
      make_case("vertices-narrow-opening", at_vertices, {0.02, 0.9999f}, vertices),
      {"pinhole", "interreflection",
       "what a series that did not end lacks, over what it says it lacks", BoundKind::at_most, 1.01,
       "the end of a geometric series; sums of 4,096 floats", pinhole},
      make_case("pixels-albedo-0.99", in_pixels, {0.1, 0.99f}, pixels),
      make_case("pixels-albedo-0.9999", in_pixels, {0.1, 0.9999f}, pixels),
      make_case("pixels-narrow-opening", in_pixels, {0.02, 0.9999f}, pixels),
  };
}

}  // namespace rimlight::stability
