#include "core/bake/vertex_material.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "core/bake/diffusion_dipole.h"
#include "core/math/random.h"
#include "core/math/sampling.h"

namespace rimlight {
namespace {

Material glossy(float roughness, const Vec3f& eta, const Vec3f& k, const Vec3f& albedo) {
  Material material;
  material.brdf = {.model = BrdfModel::cook_torrance,
                   .albedo = albedo,
                   .specular = {1, 1, 1},
                   .roughness = roughness,
                   .eta = eta,
                   .k = k};
  return material;
}

TEST(VertexMaterial, LambertAndPhongStayAsTheyAre) {
  Material material;
  material.name = "wax";
  material.brdf = {.model = BrdfModel::phong,
                   .albedo = {0.5f, 0.4f, 0.3f},
                   .specular = {0.1f, 0.2f, 0.3f},
                   .exponent = 77};
  const VertexMaterial phong = vertex_material(material);
  EXPECT_EQ(phong.name, "wax");
  EXPECT_EQ(phong.albedo, material.brdf.albedo);
  EXPECT_EQ(phong.highlight, material.brdf.specular);
  EXPECT_EQ(phong.exponent, 77);
  material.brdf.model = BrdfModel::lambert;
  EXPECT_EQ(vertex_material(material).albedo, material.brdf.albedo);
  EXPECT_EQ(vertex_material(material).highlight, Vec3f());
}

Material lobe(BrdfModel model, float width, float width_across) {
  Material material;
  material.brdf = {.model = model,
                   .albedo = {},
                   .specular = {0.3f, 0.5f, 0.6f},
                   .exponent = 2 / (width * width),
                   .roughness = width,
                   .exponent_across = 2 / (width_across * width_across),
                   .roughness_across = width_across};
  return material;
}

/// By random directions, uniform over the hemisphere: nothing shared with the quadrature.
void expect_alike(const Material& material) {
  const VertexMaterial found = vertex_material(material);
  Random random(5);
  Vec3d reflected, along;
  constexpr int kRays = 400'000;
  for (int i = 0; i < kRays; ++i) {
    // Beyond twice 45° of half vector nothing is meant to count.
    const Vec3d in(uniform_sphere({random.uniform() / 2, random.uniform()}));
    const Vec3d f = Vec3d(evaluate_specular(material.brdf, Vec3f(in), {0, 0, 1})) *
                    (in.z * 2 * std::numbers::pi / kRays);
    reflected += f;
    along += f * in.z;
  }
  for (int c = 0; c < 3; ++c) EXPECT_NEAR(found.highlight[c], reflected[c], 0.03 * reflected[c]);
  const double g = (along.x + along.y + along.z) / (reflected.x + reflected.y + reflected.z);
  const double cosine = (found.exponent + 1) / (found.exponent + 2);
  EXPECT_NEAR(1 - cosine, 1 - g, 0.03 * (1 - g));
}

TEST(VertexMaterial, AGlossReflectsAtNormalIncidenceWhatItsLobeDoesAndAsNarrowly) {
  for (const float width : {0.15f, 0.3f, 0.6f}) {
    SCOPED_TRACE(width);
    expect_alike(glossy(width, {0.2f, 0.5f, 1.4f}, {3.3f, 2.2f, 1.9f}, {}));
    expect_alike(lobe(BrdfModel::blinn_phong, width, width));
    expect_alike(lobe(BrdfModel::ward, width, width));
    expect_alike(lobe(BrdfModel::ward, width, 0.4f));
    expect_alike(lobe(BrdfModel::ashikhmin_shirley, width, 0.4f));
  }
}

TEST(VertexMaterial, NarrowGlossTendsToTheKnownExponent) {
  // exp(−tan²θ_h/m²) ≈ exp(−α²/4m²), and cos^s α ≈ exp(−s α²/2).
  for (const double roughness : {0.01, 0.03}) {
    const VertexMaterial found = vertex_material(
        glossy(static_cast<float>(roughness), {1.5f, 1.5f, 1.5f}, {}, {0.2f, 0.2f, 0.2f}));
    EXPECT_NEAR(found.exponent * 2 * roughness * roughness, 1, 0.02);
    EXPECT_NEAR(found.highlight.x, 0.04, 0.001);  // ((η − 1)/(η + 1))²
  }
}

TEST(VertexMaterial, NoMaterialReflectsMoreThanItGets) {
  Random random(9);
  for (int i = 0; i < 60; ++i) {
    const auto in = [&](double low, double high) {
      return static_cast<float>(random.uniform(low, high));
    };
    const bool metal = i % 2 == 0;
    const Vec3f k = metal ? Vec3f(in(0.1, 20), in(0.1, 20), in(0.1, 20)) : Vec3f();
    const Vec3f albedo = metal ? Vec3f() : Vec3f(1, in(0, 1), in(0, 1));
    const VertexMaterial found =
        vertex_material(glossy(in(0.01, 1), {in(1, 20), in(1, 4), in(1, 2)}, k, albedo));
    for (int c = 0; c < 3; ++c) {
      EXPECT_GE(found.highlight[c], 0);
      EXPECT_LE(found.albedo[c] + found.highlight[c], 1 + 1e-6);
    }
    EXPECT_GE(found.exponent, 1);
    EXPECT_LE(found.exponent, 1e5);
  }
}

TEST(VertexMaterial, AMediumsReflectanceIsInTheAlbedo) {
  Material material;
  material.brdf.albedo = {1, 1, 0.5f};
  material.subsurface = Subsurface{{0.1f, 1, 10}, {5, 5, 5}, 1.3f};
  const VertexMaterial found = vertex_material(material);
  const DiffusionDipole red(static_cast<double>(0.1f), 5, static_cast<double>(1.3f));
  EXPECT_NEAR(found.albedo.x, red.reflectance(), 1e-6);
  EXPECT_GT(found.albedo.x, found.albedo.y);
  EXPECT_GT(found.albedo.y, 2 * found.albedo.z);
}

TEST(DiffusionDipole, IntegratesToItsReflectance) {
  for (const double absorption : {0.0, 0.02, 1.0, 30.0}) {
    const DiffusionDipole dipole(absorption, 2.5, 1.4);
    // ∫ R 2πr dr by small steps of log r, to a radius where the closed form says how much is left.
    double sum = 0, largest = 100 * dipole.reach(0.3);
    constexpr int kSteps = 200'000;
    for (int i = 0; i < kSteps; ++i) {
      const double low = largest * std::exp(-25.0 * (i + 1) / kSteps);
      const double high = largest * std::exp(-25.0 * i / kSteps);
      const double r = (low + high) / 2;
      sum += dipole.at(r) * 2 * std::numbers::pi * r * (high - low);
    }
    EXPECT_NEAR(sum, dipole.within(largest), 1e-6 * dipole.reflectance());
    EXPECT_NEAR(dipole.within(0), 0, 1e-15);
    EXPECT_LT(dipole.reflectance(), 1 + 1e-12);
    const double reach = dipole.reach(0.01);
    EXPECT_NEAR(dipole.within(reach), 0.99 * dipole.reflectance(), 1e-6);
  }
  EXPECT_NEAR(DiffusionDipole(0, 7, 1.3).reflectance(), 1, 1e-12);  // nothing is absorbed
}

TEST(DiffusionDipole, ReflectsWhatThePapersFormulaSays) {
  // Jensen et al. 2001: R = α′/2 (1 + e^(−4/3 A √(3(1 − α′)))) e^(−√(3(1 − α′))).
  for (const double albedo : {0.2, 0.8, 0.99}) {
    const double scattering = 4 * albedo, absorption = 4 - scattering, eta = 1.3;
    const double fresnel = -1.440 / (eta * eta) + 0.710 / eta + 0.668 + 0.0636 * eta;
    const double a = (1 + fresnel) / (1 - fresnel), root = std::sqrt(3 * (1 - albedo));
    const double expected = albedo / 2 * (1 + std::exp(-4.0 / 3 * a * root)) * std::exp(-root);
    EXPECT_NEAR(DiffusionDipole(absorption, scattering, eta).reflectance(), expected, 1e-12);
  }
}

}  // namespace
}  // namespace rimlight
