#include "core/vertices/open_irradiance.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "core/base/half.h"
#include "core/basis/cube_map.h"
#include "core/basis/sh.h"
#include "core/basis/sh_zonal.h"
#include "core/math/random.h"
#include "core/math/sampling.h"
#include "core/vertices/vertex_products.h"

namespace rimlight {
namespace {

constexpr std::size_t kVertices = 150;

/// Normals everywhere, the poles included, and a random light.
struct OpenCase {
  int degree;
  std::vector<Vec3f> normals;
  std::vector<float> light;
  VertexSelection selection;  // every second vertex

  explicit OpenCase(int degree_) : degree(degree_), light(3 * sh::coefficient_count(degree_)) {
    Random random(9);
    for (std::size_t i = 0; i < kVertices; ++i) {
      normals.emplace_back(uniform_sphere(random_sample(random)));
    }
    normals[0] = {0, 0, 1};
    normals[2] = {0, 0, -1};
    for (float& value : light) value = static_cast<float>(random.uniform(-1, 1));
    std::vector<std::uint32_t> chosen;
    for (std::uint32_t i = 0; i < kVertices; i += 2) chosen.push_back(i);
    selection.select_vertices(chosen);
  }

  AlignedVector<float> found() const {
    AlignedVector<float> result(selection.panel_count() * 3 * kBatchVertices, -1.0f);
    open_irradiance(selection, normals, light, degree, result);
    return result;
  }
  /// Calls visit(vertex, place of the first channel).
  template <typename Visit>
  void for_each(const Visit& visit) const {
    for (std::size_t panel = 0; panel < selection.panel_count(); ++panel) {
      selection.for_each_vertex(panel, [&](std::size_t vertex, std::size_t lane) {
        visit(vertex, panel * 3 * kBatchVertices + lane);
      });
    }
  }
};

TEST(OpenIrradiance, IsTheLightTimesTheCosineOverTheUpperHalf) {
  constexpr int kSize = 96;
  for (const int degree : {0, 1, 2, 4}) {
    const OpenCase open(degree);
    const auto found = open.found();
    const std::size_t count = sh::coefficient_count(degree);
    std::vector<Vec3d> radiance;  // [texel]: times solid angle
    for (std::size_t t = 0; t < cube::texel_count(kSize); ++t) {
      const auto harmonics = sh::evaluate(cube::texel_direction(t, kSize), degree);
      Vec3d sum;
      for (std::size_t k = 0; k < count; ++k) {
        sum +=
            Vec3d(open.light[k], open.light[count + k], open.light[2 * count + k]) * harmonics[k];
      }
      radiance.push_back(sum * cube::texel_solid_angle(t, kSize));
    }
    open.for_each([&](std::size_t vertex, std::size_t place) {
      if (vertex % 10 != 0 && vertex != 2) return;
      Vec3d expected;
      for (std::size_t t = 0; t < radiance.size(); ++t) {
        const double cosine = dot(cube::texel_direction(t, kSize), Vec3d(open.normals[vertex]));
        if (cosine > 0) expected += radiance[t] * cosine;
      }
      for (int c = 0; c < 3; ++c) {
        const auto at = place + static_cast<std::size_t>(c) * kBatchVertices;
        EXPECT_NEAR(found[at], expected[c], 2e-3) << degree;
      }
    });
  }
}

TEST(OpenIrradiance, NothingIsAtDegreeThree) {
  OpenCase two(2), three(3);
  for (std::size_t c = 0; c < 3; ++c) {
    for (std::size_t k = 0; k < 9; ++k) two.light[c * 9 + k] = three.light[c * 16 + k];
  }
  const auto less = two.found(), more = three.found();
  for (std::size_t i = 0; i < less.size(); ++i) ASSERT_NEAR(less[i], more[i], 2e-6);
}

TEST(OpenIrradiance, PaddingIsBlackAndNeighboursDoNotMatter) {
  OpenCase some(4), all(4);
  std::vector<std::uint32_t> every;
  for (std::uint32_t i = 0; i < kVertices; ++i) every.push_back(i);
  all.selection.select_vertices(every);
  const auto of_some = some.found(), of_all = all.found();
  std::vector<float> values(kVertices);
  all.for_each([&](std::size_t vertex, std::size_t place) { values[vertex] = of_all[place]; });
  some.for_each(
      [&](std::size_t vertex, std::size_t place) { ASSERT_EQ(of_some[place], values[vertex]); });
  const std::size_t lanes = some.selection.lane_count(some.selection.panel_count() - 1);
  ASSERT_LT(lanes, kBatchVertices);
  for (std::size_t lane = lanes; lane < kBatchVertices; ++lane) {
    ASSERT_EQ(of_some[of_some.size() - kBatchVertices + lane], 0);
  }
}

/// The same transport as a bake would have stored it.
AlignedVector<Half> stored_form(const OpenCase& open) {
  const std::size_t count = sh::coefficient_count(open.degree);
  AlignedVector<Half> rows(batch_count(kVertices) * count * kBatchVertices);
  for (std::size_t v = 0; v < kVertices; ++v) {
    const auto turned =
        sh::turned_lobe(sh::clamped_cosine_lobe(open.degree), Vec3d(open.normals[v]));
    for (std::size_t k = 0; k < count; ++k) {
      rows[(v / kBatchVertices * count + k) * kBatchVertices + v % kBatchVertices] =
          to_half(static_cast<float>(turned[k]));
    }
  }
  return rows;
}

TEST(OpenIrradiance, ProductsWithoutAChannelAreThoseWithOneButForItsHalves) {
  const OpenCase open(4);
  const auto rows = stored_form(open);
  VertexTransportView view;
  view.vertex_count = kVertices;
  view.irradiance_degree = open.degree;
  view.irradiance_channels = 1;
  view.irradiance = rows;
  VertexProducts stored(view);
  view.irradiance_channels = 0;
  view.irradiance = {};
  view.normals = open.normals;
  VertexProducts evaluated(view);
  stored.set_light(open.light);
  evaluated.set_light(open.light);
  AlignedVector<float> expected(open.selection.panel_count() * 3 * kBatchVertices);
  AlignedVector<float> found(expected.size());
  stored.irradiance(open.selection, expected);
  evaluated.irradiance(open.selection, found);
  double largest = 0;
  for (std::size_t i = 0; i < found.size(); ++i) {
    // 25 coefficients, each off by 2^-12 of at most 1.1.
    ASSERT_NEAR(found[i], expected[i], 2e-3);
    largest = std::max(largest, std::abs(static_cast<double>(found[i])));
  }
  EXPECT_GT(largest, 1);
}

}  // namespace
}  // namespace rimlight
