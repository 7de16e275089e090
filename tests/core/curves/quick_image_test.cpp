#include "core/curves/quick_image.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "core/basis/cube_map.h"
#include "tests/core/curves/curve_cases.h"

namespace rimlight {
namespace {

constexpr int kSize = 16;

/// All models at once.
struct QuickCase {
  CurveScene scene;
  CurveSky sky{kSize};
  CubeLight light = random_light(kSize, 9);
  CurveTransport transport;
  std::vector<CurveMaterialState> states;
  std::vector<float> image;

  QuickCase() : scene(random_scene(materials(), 40, kSize, 8)), transport(scene.receivers()) {
    for (const CurveMaterial& material : scene.materials) states.push_back(baked_state(material));
    image.resize(transport.panels().size() * kPanelFloats);
  }
  static std::vector<CurveMaterial> materials() {
    std::vector<CurveMaterial> result;
    for (const CurveCase& item : curve_cases()) {
      const Brdf& brdf = item.material.brdf;
      // Narrow lobes ask more of means than they can give.
      if (brdf.roughness < 0.1f || brdf.exponent > 100) continue;
      result.push_back(item.material);
    }
    return result;
  }
  void shade(std::size_t strongest) {
    const CurveLight found(sky, light, strongest);
    ASSERT_TRUE(QuickShader(transport, states)
                    .shade(found, transport.all_panels(), QuickDetail::every_row, {}, image));
  }
  Vec3d row(std::size_t panel, std::size_t row) const {
    return row_of(std::span(image).subspan(panel * kPanelFloats, kPanelFloats), row);
  }
  template <typename Visit>
  void for_each_row(const Visit& visit) const {
    for (std::size_t p = 0; p < transport.panels().size(); ++p) {
      for (std::size_t row = 0; row < transport.panels()[p].row_count; ++row) visit(p, row);
    }
  }
  double squared_error(const CurveLight& found) const {
    double sum = 0;
    for_each_row([&](std::size_t p, std::size_t at) {
      const CurvePanel& panel = transport.panels()[p];
      const Vec3d difference = row(p, at) - Vec3d(shade_exactly(transport.receivers(), panel, at,
                                                                found, states[panel.material]));
      sum += dot(difference, difference);
    });
    return sum;
  }
};

TEST(QuickImage, IsExactWhenAllTexelsAreAmongTheStrongest) {
  QuickCase test;
  test.shade(test.light.count());
  std::size_t rows = 0;
  RelativeError error;
  test.for_each_row([&](std::size_t p, std::size_t row) {
    const CurvePanel& panel = test.transport.panels()[p];
    error.add(test.row(p, row), reference_row(test.transport.receivers(), panel, row, test.light,
                                              test.states[panel.material]));
    ++rows;
  });
  EXPECT_EQ(rows, test.states.size() * 40);
  EXPECT_LT(error.value(), 1e-4);
}

TEST(QuickImage, ShadesARowExactlyAsTheSumOverTheSky) {
  QuickCase test;
  const CurveLight light(test.sky, test.light, 0);
  RelativeError error;
  test.for_each_row([&](std::size_t p, std::size_t row) {
    const CurvePanel& panel = test.transport.panels()[p];
    const CurveMaterialState& state = test.states[panel.material];
    error.add(Vec3d(shade_exactly(test.transport.receivers(), panel, row, light, state)),
              reference_row(test.transport.receivers(), panel, row, test.light, state));
  });
  EXPECT_LT(error.value(), 1e-4);
}

TEST(QuickImage, ComesNearWithFewStrongTexels) {
  QuickCase test;
  const CurveLight none(test.sky, test.light, 0), few(test.sky, test.light, 32);
  test.shade(0);
  const double without = test.squared_error(none);
  test.shade(32);
  const double with = test.squared_error(few);
  EXPECT_LT(with, 0.3 * without);
  double size = 0;
  for (const float value : test.image) size += double{value} * value;
  EXPECT_LT(with, 0.04 * size);
}

TEST(QuickImage, ASampleOfRowsTellsItsError) {
  QuickCase test;
  test.shade(16);
  const CurveLight light(test.sky, test.light, 16);
  const double expected = test.squared_error(light);
  QuickShader shader(test.transport, test.states);
  const auto panels = test.transport.all_panels();
  const double all = shader.sampled_squared_error(light, panels, test.image, 1'000'000, 1);
  EXPECT_NEAR(all, expected, 1e-6 * expected);
  double sum = 0;
  constexpr int kSeeds = 60;
  for (std::uint64_t seed = 0; seed < kSeeds; ++seed) {
    sum += shader.sampled_squared_error(light, panels, test.image, 50, seed);
  }
  EXPECT_NEAR(sum / kSeeds, expected, 0.25 * expected);
  EXPECT_EQ(shader.sampled_squared_error(light, panels, test.image, 0, 1), 0);
  EXPECT_EQ(shader.sampled_squared_error(light, {}, test.image, 50, 1), 0);
}

TEST(QuickImage, IsBlackUnderABlackLight) {
  QuickCase test;
  const CurveLight light(test.sky, CubeLight(kSize), 5);
  std::ranges::fill(test.image, 7.0f);
  ASSERT_TRUE(
      QuickShader(test.transport, test.states)
          .shade(light, test.transport.all_panels(), QuickDetail::every_row, {}, test.image));
  EXPECT_TRUE(std::ranges::all_of(test.image, [](float value) { return value == 0; }));
}

TEST(QuickImage, IsAbandoned) {
  QuickCase test;
  const CurveLight light(test.sky, test.light, 5);
  EXPECT_FALSE(QuickShader(test.transport, test.states)
                   .shade(
                       light, test.transport.all_panels(), QuickDetail::every_row,
                       [] { return true; }, test.image));
}

TEST(QuickDetail, RowsThatAreLikeNoOtherAreShadedAllTheSame) {
  QuickCase test;
  test.shade(20);
  const auto every_row = test.image;
  const CurveLight light(test.sky, test.light, 20);
  for (const QuickDetail detail :
       {QuickDetail::one_of_two, QuickDetail::one_of_four, QuickDetail::one_of_eight}) {
    ASSERT_TRUE(QuickShader(test.transport, test.states)
                    .shade(light, test.transport.all_panels(), detail, {}, test.image));
    EXPECT_EQ(test.image, every_row);
  }
}

/// 64 pixels of one surface, of which each shows its own share, the last ones turned away.
struct FlatCase {
  CurveScene scene{kSize};
  std::vector<CurveMaterialState> states;

  FlatCase() {
    const CurveScene random = random_scene({QuickCase::materials()[0]}, 1, kSize, 4);
    std::vector<std::uint8_t> fifths(cube::texel_count(kSize));
    random.visibility.view().unpack(0, fifths);
    for (std::uint32_t receiver = 0; receiver < 64; ++receiver) {
      CurveSurface surface = random.surfaces[0];
      surface.receiver = receiver;
      surface.share = 0.25f + 0.01f * static_cast<float>(receiver);
      if (receiver >= 60) surface.points = random.surfaces[1].points;
      scene.surfaces.push_back(surface);
      scene.visibility.add(fifths);
    }
    scene.materials = random.materials;
    states.push_back(baked_state(scene.materials[0]));
  }
};

TEST(QuickDetail, LikeRowsTakeTheRadianceOfOneByTheirShare) {
  const FlatCase test;
  const CurveTransport transport(test.scene.receivers());
  const CurveSky sky(kSize);
  const CurveLight light(sky, random_light(kSize, 3), 20);
  std::vector<float> all(kPanelFloats), some(kPanelFloats);
  const auto panels = transport.all_panels();
  const QuickShader shader(transport, test.states);
  ASSERT_TRUE(shader.shade(light, panels, QuickDetail::every_row, {}, all));
  for (const QuickDetail detail :
       {QuickDetail::one_of_two, QuickDetail::one_of_four, QuickDetail::one_of_eight}) {
    std::ranges::fill(some, NAN);
    ASSERT_TRUE(shader.shade(light, panels, detail, {}, some));
    // Radiance is in proportion to the share, so that copies are exact here.
    for (std::size_t i = 0; i < kPanelFloats; ++i) {
      EXPECT_NEAR(some[i], all[i], 1e-5f * all[i]) << i;
    }
  }
}

TEST(QuickDetail, FollowsTheNumberOfRows) {
  EXPECT_EQ(quick_detail(0), QuickDetail::every_row);
  EXPECT_EQ(quick_detail(24'000), QuickDetail::every_row);
  EXPECT_EQ(quick_detail(24'001), QuickDetail::one_of_two);
  EXPECT_EQ(quick_detail(96'000), QuickDetail::one_of_four);
  EXPECT_EQ(quick_detail(1'000'000), QuickDetail::one_of_eight);
}

}  // namespace
}  // namespace rimlight
