#include "core/vertices/vertex_materials.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>
#include <numbers>

#include "core/basis/sh.h"
#include "core/vertices/lobe_curve.h"
#include "tests/core/vertices/vertex_case.h"
#include "tests/support/error_of.h"

namespace rimlight {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

constexpr double kPi = std::numbers::pi;

double value_at(const std::vector<double>& curve, double angle) {
  const double at = angle / (kPi / 2) * static_cast<double>(curve.size() - 1);
  const auto first = std::min(static_cast<std::size_t>(at), curve.size() - 2);
  return std::lerp(curve[first], curve[first + 1], at - static_cast<double>(first));
}

/// ∫ curve · P_l over the sphere by the midpoint rule in the angle.
std::vector<double> integrals(const std::vector<double>& curve, int degree) {
  constexpr int kSteps = 63 * 640;  // kinks stand between steps for curves of 2, 8, 10, 22, 64
  std::vector<double> sums(static_cast<std::size_t>(degree) + 1, 0.0);
  for (int i = 0; i < kSteps; ++i) {
    const double angle = (i + 0.5) * kPi / 2 / kSteps;
    const auto p = sh::legendre(std::cos(angle), degree);
    const double area = 2 * kPi * std::sin(angle) * kPi / 2 / kSteps;
    for (std::size_t l = 0; l < p.size(); ++l) sums[l] += value_at(curve, angle) * area * p[l];
  }
  return sums;
}

std::vector<double> peak_of(std::size_t values, std::size_t at) {
  std::vector<double> curve(values, 0.0);
  curve[at] = 3;
  return curve;
}

TEST(LobeCurve, IsTheQuadratureOfItsCurve) {
  constexpr int kDegree = 20;
  for (const std::vector<double>& curve :
       {std::vector<double>{1, 1}, std::vector<double>{0, 7}, peak_of(64, 0), peak_of(64, 63),
        peak_of(64, 21), peak_of(8, 3), std::vector<double>{1e6, 1e-3, 0, 2, 0, 0, 9, 1, 1, 4}}) {
    const auto expected = integrals(curve, kDegree);
    const sh::ZonalLobe lobe = curve_lobe(curve, kDegree);
    ASSERT_EQ(lobe.size(), expected.size());
    EXPECT_NEAR(lobe[0] * std::sqrt(4 * kPi), 1, 1e-14) << "the integral";
    for (std::size_t l = 0; l < lobe.size(); ++l) {
      const double axial = std::sqrt((2 * static_cast<double>(l) + 1) / (4 * kPi));
      EXPECT_NEAR(lobe[l], axial * expected[l] / expected[0], 1e-6) << l;
    }
  }
}

TEST(LobeCurve, ACosineHasThePlainLobesCoefficients) {
  std::vector<double> curve;
  for (int i = 0; i < 64; ++i) curve.push_back(5 * std::cos(i * kPi / 2 / 63));
  const auto lobe = curve_lobe(curve, 12);
  const auto cosine = sh::phong_lobe(1, 12);
  for (std::size_t l = 0; l < lobe.size(); ++l) EXPECT_NEAR(lobe[l], cosine[l], 1e-4) << l;
}

TEST(LobeCurve, ItsScaleIsNothing) {
  const std::vector<double> curve{4, 2, 0, 1};
  const auto lobe = curve_lobe(curve, 8);
  for (const double scale : {std::ldexp(1.0, -1000), std::ldexp(1.0, 17)}) {
    std::vector<double> scaled = curve;
    for (double& value : scaled) value *= scale;
    EXPECT_EQ(curve_lobe(scaled, 8), lobe);
  }
}

TEST(LobeCurve, BadOnesAreRefused) {
  const auto error = [](const std::vector<double>& curve) {
    return test::error_of([&] { curve_lobe(curve, 4); });
  };
  EXPECT_THAT(error({}), HasSubstr("lobe: found 0 values"));
  EXPECT_THAT(error({1}), HasSubstr("1 values"));
  EXPECT_THAT(error(std::vector<double>(65, 1.0)), HasSubstr("65 values"));
  EXPECT_THAT(error({0, 0, 0}), HasSubstr("nothing but zeros"));
  EXPECT_THAT(error({1, -1e-9}), HasSubstr("0 to 1000000"));
  EXPECT_THAT(error({1, 1.1e6}), HasSubstr("0 to 1000000"));
  EXPECT_THAT(error({std::numeric_limits<double>::quiet_NaN(), 1}), HasSubstr("nan"));
}

/// The factors of one material's lobe.
std::vector<float> shown_lobe(const VertexMaterials& materials, std::uint32_t material) {
  const float* const lobe = materials.lobe(material);
  return {lobe, lobe + sh::coefficient_count(5)};
}

TEST(VertexMaterials, ALobeStandsInThePlaceOfTheExponentWhileItIsSet) {
  const VertexScene scene = test::VertexCase().scene;
  VertexMaterials materials(scene, sh::coefficient_count(5));
  const auto phong = shown_lobe(materials, 0), other = shown_lobe(materials, 1);
  std::map<std::string, MaterialEdit> edits;
  edits["brass"].lobe = std::vector<double>{0, 1, 0};
  ASSERT_TRUE(materials.set(edits));
  const auto ring = shown_lobe(materials, 0);
  const auto lobe = curve_lobe(*edits["brass"].lobe, 5);
  for (std::size_t k = 0; k < ring.size(); ++k) {
    const int l = sh::degree_of(k);
    EXPECT_NEAR(ring[k], std::sqrt(4 * kPi / (2 * l + 1)) * lobe[static_cast<std::size_t>(l)],
                1e-6);
  }
  EXPECT_NE(ring, phong);
  EXPECT_EQ(shown_lobe(materials, 1), other);
  EXPECT_FALSE(materials.set(edits)) << "nothing new";
  edits["brass"].exponent = 3;
  EXPECT_TRUE(materials.set(edits));
  EXPECT_EQ(shown_lobe(materials, 0), ring);
  edits["enamel"].lobe = std::vector<double>{1, 0, 0};
  const auto before = shown_lobe(materials, 1);
  edits["brass"].lobe = std::vector<double>{0, 0};
  EXPECT_THAT(test::error_of([&] { materials.set(edits); }), HasSubstr("materials/brass/lobe"));
  EXPECT_EQ(shown_lobe(materials, 1), before) << "a refused edit changes nothing";
  EXPECT_TRUE(materials.set({}));
  EXPECT_EQ(shown_lobe(materials, 0), phong);
}

TEST(VertexMaterials, ALobeSharperThanTheDegreeIsSaid) {
  const VertexScene scene = test::VertexCase().scene;
  VertexMaterials materials(scene, sh::coefficient_count(5));
  std::map<std::string, MaterialEdit> edits;
  edits["brass"].lobe = std::vector<double>{1, 1, 1};
  materials.set(edits);
  EXPECT_THAT(materials.unshown(), IsEmpty());
  edits["brass"].lobe = peak_of(64, 0);
  materials.set(edits);
  EXPECT_THAT(materials.unshown(), ElementsAre(HasSubstr("sharpness of brass")));
}

TEST(VertexMaterials, EditsOfBrdfsAreKeptAndSaidNotToBeShown) {
  const VertexScene scene = test::VertexCase().scene;
  std::vector<MaterialEdit> each(4);
  each[0].roughness = 0.5;
  each[1].half_angle = CurveEdit{CurveScale::linear, {{0, {1, 1, 1}}}, {}};
  each[2].measured = "gold";
  each[3].k = Vec3f{1, 2, 3};
  for (const MaterialEdit& edit : each) {
    VertexMaterials materials(scene, sh::coefficient_count(5));
    materials.set({{"brass", edit}});
    EXPECT_THAT(materials.unshown(), ElementsAre(HasSubstr("the edited BRDF of brass")));
  }
}

}  // namespace
}  // namespace rimlight
