#include "core/bake/vertex_material.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/bake/diffusion_dipole.h"
#include "core/material/measured_lobe.h"
#include "core/math/quadrature.h"

namespace rimlight {
namespace {

constexpr double kLargestExponent = 1e5;

/// What the gloss of a surface does with light along its normal.
struct GlossMoments {
  Vec3d reflectance;  // ∫ f cos θ dω
  Vec3d along;        // ∫ f cos θ cos α dω
};

/// About how far half vectors stray from the normal: Beckmann's slope, or what cos^n θ_h is near
/// its middle, exp(−n θ_h²/2), taken as one; of the wider axis.
double half_vector_width(const Brdf& brdf) {
  const auto of_exponent = [](float n) { return std::sqrt(2.0 / double{n}); };
  switch (brdf.model) {
    case BrdfModel::blinn_phong:
      return of_exponent(brdf.exponent);
    case BrdfModel::ashikhmin_shirley:
      return of_exponent(std::min(brdf.exponent, brdf.exponent_across));
    case BrdfModel::measured:
      return brdf.measured->roughness();
    case BrdfModel::ward:
      return std::max(brdf.roughness, brdf.roughness_across);
    default:
      return brdf.roughness;
  }
}

/// Over half vectors, to 5 widths of the lobe, or to the horizon; and around, where it matters.
GlossMoments gloss_moments(const Brdf& brdf) {
  constexpr int kPoints = 128;
  const int turns = is_anisotropic(brdf) ? 32 : 1;
  const double end = std::min(std::numbers::pi / 4, std::atan(5 * half_vector_width(brdf)));
  GlossMoments moments;
  for (const QuadraturePoint& point : gauss_legendre(kPoints)) {
    const double angle = end * (point.position + 1);  // α = 2 θ_h
    const double ring =
        2 * std::numbers::pi * std::sin(angle) * std::cos(angle) * end * point.weight;
    for (int turn = 0; turn < turns; ++turn) {
      const double around = 2 * std::numbers::pi * turn / turns;
      const Vec3f in(Vec3d(std::sin(angle) * std::cos(around), std::sin(angle) * std::sin(around),
                           std::cos(angle)));
      const Vec3d f(evaluate_specular(brdf, in, {0, 0, 1}));
      moments.reflectance += f * (ring / turns);
      moments.along += f * (ring / turns * std::cos(angle));
    }
  }
  return moments;
}

/// The share of evenly arriving light that the diffuse part reflects.
Vec3f diffuse_albedo(const Brdf& brdf) {
  constexpr int kPoints = 24;
  Vec3d sum;
  for (const QuadraturePoint& in : gauss_legendre(kPoints)) {
    for (const QuadraturePoint& out : gauss_legendre(kPoints)) {
      // ∫∫ f μ_i μ_o dω_i dω_o / π: both over 2π dμ.
      const double mu_in = (in.position + 1) / 2, mu_out = (out.position + 1) / 2;
      const auto direction = [](double mu) { return Vec3f(Vec3d(std::sqrt(1 - mu * mu), 0, mu)); };
      const Vec3d f(evaluate_diffuse(brdf, direction(mu_in), direction(mu_out)));
      sum += f * (std::numbers::pi * mu_in * mu_out * in.weight * out.weight);
    }
  }
  return Vec3f(sum);
}

/// The Phong lobe that reflects as much of what comes along the normal, with the same mean cosine
/// about the mirror direction: ∫ cos α of (s + 1)/2π cos^s α is (s + 1)/(s + 2).
void map_gloss(const Brdf& brdf, VertexMaterial& material) {
  const GlossMoments moments = gloss_moments(brdf);
  material.highlight = Vec3f(moments.reflectance);
  const double all = moments.reflectance.x + moments.reflectance.y + moments.reflectance.z;
  const double along = moments.along.x + moments.along.y + moments.along.z;
  if (all > 0) {
    const double g = std::min(along / all, 1 - 1e-9);
    material.exponent = std::clamp((2 * g - 1) / (1 - g), 1.0, kLargestExponent);
  }
  material.albedo = diffuse_albedo(brdf);
}

}  // namespace

VertexMaterial vertex_material(const Material& material) {
  const Brdf& brdf = material.brdf;
  VertexMaterial result{.name = material.name, .albedo = brdf.albedo};
  if (brdf.model == BrdfModel::phong) {
    result.highlight = brdf.specular;
    result.exponent = brdf.exponent;
  } else if (brdf.model != BrdfModel::lambert) {
    map_gloss(brdf, result);
  }
  if (material.subsurface) {
    for (int c = 0; c < 3; ++c) {
      result.albedo[c] *= static_cast<float>(dipole_of(*material.subsurface, c).reflectance());
    }
  }
  for (int c = 0; c < 3; ++c) {  // rounding of floats
    result.albedo[c] = std::clamp(result.albedo[c], 0.0f, 1.0f);
    result.highlight[c] = std::clamp(result.highlight[c], 0.0f, 1 - result.albedo[c]);
  }
  return result;
}

}  // namespace rimlight
