// Multi-level filtering against the full calculation, and against the same algorithm in double.
#include "core/vertices/multi_level_light.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "core/base/parallel.h"
#include "core/vertices/level_group.h"
#include "tests/core/vertices/random_vertices.h"
#include "tests/core/vertices/reference_light.h"

namespace rimlight {
namespace {

constexpr std::size_t kSums = kLightChannels * kBatchVertices;
constexpr int kDegree = 6;
constexpr std::size_t kVertices = 1500;  // more than a group
constexpr float kInfinity = std::numeric_limits<float>::infinity();

/// Vertices in rows of 30, joined along each row only: 50 pieces.
VertexGraph rows_graph() {
  VertexMesh mesh;
  for (std::uint32_t v = 0; v < kVertices; ++v) {
    mesh.positions.push_back({static_cast<float>(v), 0, 0});
    if (v % 30 != 0) mesh.triangles.push_back({v - 1, v, v});
  }
  return VertexGraph(mesh);
}

class MultiLevel : public testing::Test {
 protected:
  MultiLevel() {
    products.set_light(test::RandomVertices::light(2 * kDegree));
    for (std::uint32_t v = 0; v < kVertices; ++v) {
      if (v % 7 != 0) chosen.push_back(v);
    }
    select(chosen);
  }
  void select(const std::vector<std::uint32_t>& vertices_) {
    selection.select_vertices(vertices_);
    irradiance.assign(selection.panel_count() * kSums, NAN);
    highlights = full_irradiance = full_highlights = irradiance;
    products.irradiance(selection, full_irradiance);
    products.highlights(selection, vertices.gloss(), full_highlights);
  }
  void calculate(const MultiLevelLight::Settings& settings) {
    light.calculate(selection, vertices.gloss(), settings, irradiance, highlights);
  }

  test::RandomVertices vertices{{kVertices, kVertices, 5, kDegree}};
  VertexProducts products{vertices.view()};
  VertexGraph graph = rows_graph(), no_graph;
  MultiLevelLight light{products, graph};
  VertexSelection selection;
  std::vector<std::uint32_t> chosen;
  std::vector<float> irradiance, highlights, full_irradiance, full_highlights;
};

double largest_difference(const std::vector<float>& a, const std::vector<float>& b) {
  double largest = 0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    const double difference = std::abs(static_cast<double>(a[i]) - static_cast<double>(b[i]));
    if (!(difference <= largest)) largest = difference;
  }
  return largest;
}

// Sums of 49 products of numbers about 1, twice over, each rounded.
constexpr double kRounding = 49 * 49 * 0x1p-24;

TEST_F(MultiLevel, WithoutAThresholdIsTheFullCalculation) {
  calculate({2, 0, 0});
  EXPECT_LE(largest_difference(irradiance, full_irradiance), kRounding);
  EXPECT_LE(largest_difference(highlights, full_highlights), kRounding);
  EXPECT_EQ(light.filtered_irradiance(), 0);
  EXPECT_EQ(light.filtered_highlights(), 0);
}

TEST_F(MultiLevel, WithAnInfiniteThresholdIsTheFirstDegreeAboveTheBase) {
  calculate({3, kInfinity, kInfinity});
  EXPECT_EQ(light.filtered_irradiance(), 1);
  EXPECT_EQ(light.filtered_highlights(), 1);
  LevelGroup group;
  group.load(products, selection, vertices.gloss(), 0);
  for (int l = 0; l <= 4; ++l) group.add_degree(products, l);
  std::vector<float> to(LevelGroup::kPanels * kSums);
  group.write(to);
  for (std::size_t k = 0; k < to.size(); ++k) ASSERT_EQ(highlights[k], to[k]) << k;
}

TEST_F(MultiLevel, IncrementsOfAllDegreesSumToTheFullCalculation) {
  LevelGroup group;
  std::vector<float> to(full_highlights.size());
  for (std::size_t first = 0; first < selection.panel_count(); first += LevelGroup::kPanels) {
    group.load(products, selection, vertices.gloss(), first);
    for (int l = 0; l <= kDegree; ++l) group.add_degree(products, l);
    group.write(std::span(to).subspan(first * kSums));
  }
  EXPECT_LE(largest_difference(to, full_highlights), kRounding);
}

/// One vertex at a time, with a group of its own, so that nothing is ever packed.
TEST_F(MultiLevel, PackingChangesNoBit) {
  constexpr float kThreshold = 0.1f;
  MultiLevelLight alone(products, no_graph);
  alone.calculate(selection, vertices.gloss(), {2, kInfinity, kThreshold}, irradiance, highlights);
  LevelGroup group;
  VertexSelection one;
  std::size_t inside = 0, panel_lane = 0;
  for (const std::uint32_t vertex : chosen) {
    one.select_vertices(std::span(&vertex, 1));
    std::vector<float> to(kSums);
    group.load(products, one, vertices.gloss(), 0);
    for (int l = 0; l <= 2; ++l) group.add_degree(products, l);
    group.set_base();
    for (int l = 3; l <= kDegree && group.vertex_count() > 0; ++l) {
      group.add_degree(products, l);
      group.keep_above(kThreshold, to);
    }
    inside += group.vertex_count();
    group.write(to);
    const std::size_t at = panel_lane / kBatchVertices * kSums + panel_lane % kBatchVertices;
    for (std::size_t c = 0; c < kSums; c += kBatchVertices) EXPECT_EQ(highlights[at + c], to[c]);
    ++panel_lane;
  }
  EXPECT_GT(inside, chosen.size() / 20);
  EXPECT_LT(inside, chosen.size() * 19 / 20);
  EXPECT_NEAR(alone.filtered_highlights(),
              1 - static_cast<double>(inside) / static_cast<double>(chosen.size()), 1e-12);
}

/// Filtering of one vertex in double, from its increments [degree + 1][3]; false where rounding
/// could decide otherwise.
bool filter_in_double(int base_degree, double threshold, std::span<const double> increments,
                      std::array<double, 3>& sum) {
  std::array<double, 3> base{};
  sum = {};
  for (int l = 0; l < static_cast<int>(increments.size() / 3); ++l) {
    double largest = 0;
    for (std::size_t c = 0; c < 3; ++c) {
      sum[c] += increments[3 * static_cast<std::size_t>(l) + c];
      if (l <= base_degree) base[c] = sum[c];
      largest = std::max(largest, std::abs(sum[c] - base[c]));
    }
    if (l <= base_degree) continue;
    if (std::abs(largest - threshold) < 1e-4) return false;
    if (largest < threshold) break;
  }
  return true;
}

/// The increments of a vertex' highlight, from products cut off at each degree in turn.
std::vector<double> highlight_increments(const test::RandomVertices& vertices,
                                         std::span<const float> light, std::size_t v) {
  const auto visibility = reference::row_of(vertices.view().visibility, v / kBatchVertices,
                                            sh::coefficient_count(kDegree), v % kBatchVertices);
  const std::span<const float> factors(vertices.lobes.data() + vertices.lobe_of[v] * (kDegree + 1),
                                       kDegree + 1);
  std::vector<double> increments;
  std::array<double, 3> last{};
  for (int l = 0; l <= kDegree; ++l) {
    const auto end = static_cast<std::ptrdiff_t>(sh::coefficient_count(l));
    const std::vector<double> cut(visibility.begin(), visibility.begin() + end);
    for (std::size_t c = 0; c < 3; ++c) {
      const auto channel = light.subspan(c * light.size() / 3, light.size() / 3);
      const double value =
          reference::highlight(reference::product(cut, channel), factors, vertices.mirrored[v]);
      increments.push_back(value - last[c]);
      last[c] = value;
    }
  }
  return increments;
}

TEST_F(MultiLevel, FiltersHighlightsAsInDouble) {
  constexpr float kThreshold = 0.1f;
  MultiLevelLight alone(products, no_graph);
  alone.calculate(selection, vertices.gloss(), {1, kInfinity, kThreshold}, irradiance, highlights);
  const auto given = test::RandomVertices::light(2 * kDegree);
  std::size_t compared = 0, cut = 0;
  for (std::size_t packed = 0; packed < 300; ++packed) {
    const auto increments = highlight_increments(vertices, given, chosen[packed]);
    std::array<double, 3> truth{};
    if (!filter_in_double(1, static_cast<double>(kThreshold), increments, truth)) continue;
    const std::size_t at = packed / kBatchVertices * kSums + packed % kBatchVertices;
    double full = 0;
    for (std::size_t k = 0; k < increments.size(); k += 3) full += increments[k];
    if (std::abs(full - truth[0]) > 1e-3) ++cut;
    for (std::size_t c = 0; c < 3; ++c, ++compared) {
      EXPECT_NEAR(static_cast<double>(highlights[at + c * kBatchVertices]), truth[c], 2e-5);
    }
  }
  EXPECT_GT(compared, 800u);
  EXPECT_GT(cut, 20u);
}

TEST_F(MultiLevel, FiltersIrradianceAsInDouble) {
  constexpr float kThreshold = 0.3f;
  MultiLevelLight alone(products, no_graph);
  alone.calculate(selection, vertices.gloss(), {1, kThreshold, kInfinity}, irradiance, highlights);
  const auto given = test::RandomVertices::light(2 * kDegree);
  std::size_t compared = 0;
  for (std::size_t packed = 0; packed < chosen.size(); ++packed) {
    const std::size_t v = chosen[packed];
    std::vector<double> increments(6 * 3);
    for (std::size_t i = 0; i < 36; ++i) {
      const std::size_t at = (v / kBatchVertices * 36 + i) * kBatchVertices + v % kBatchVertices;
      const double row = static_cast<double>(to_float(vertices.view().irradiance[at]));
      for (std::size_t c = 0; c < 3; ++c) {
        increments[3 * static_cast<std::size_t>(sh::degree_of(i)) + c] +=
            row * static_cast<double>(given[c * given.size() / 3 + i]);
      }
    }
    std::array<double, 3> truth{};
    if (!filter_in_double(1, static_cast<double>(kThreshold), increments, truth)) continue;
    const std::size_t at = packed / kBatchVertices * kSums + packed % kBatchVertices;
    for (std::size_t c = 0; c < 3; ++c, ++compared) {
      EXPECT_NEAR(static_cast<double>(irradiance[at + c * kBatchVertices]), truth[c], 1e-5);
    }
  }
  EXPECT_GT(compared, chosen.size() * 2);
}

TEST_F(MultiLevel, HasTheSameBitsWithAnyThreads) {
  calculate({2, 0.3f, 0.1f});
  const std::vector<float> first_irradiance = irradiance, first_highlights = highlights;
  EXPECT_GT(light.filtered_highlights(), 0.02);
  EXPECT_LT(light.filtered_highlights(), 0.98);
  for (const int threads : {1, 2, 3}) {
    set_thread_count(threads);
    calculate({2, 0.3f, 0.1f});
    EXPECT_EQ(irradiance, first_irradiance) << threads;
    EXPECT_EQ(highlights, first_highlights) << threads;
  }
  set_thread_count(0);
}

TEST_F(MultiLevel, RefinementBringsItCloserToTheFullCalculation) {
  const auto error = [&](MultiLevelLight& by) {
    by.calculate(selection, vertices.gloss(), {2, kInfinity, 0.1f}, irradiance, highlights);
    double sum = 0;
    for (std::size_t k = 0; k < highlights.size(); ++k) {
      sum += std::pow(static_cast<double>(highlights[k] - full_highlights[k]), 2);
    }
    return sum;
  };
  MultiLevelLight alone(products, no_graph);
  const double without = error(alone), with = error(light);
  EXPECT_LT(with, without);
  EXPECT_LT(light.filtered_highlights(), alone.filtered_highlights());
}

TEST_F(MultiLevel, TakesOneVertexAndNone) {
  select({1499});
  calculate({2, 0, 0});
  EXPECT_LE(largest_difference(highlights, full_highlights), kRounding);
  select({});
  calculate({2, 0.1f, 0.1f});
  EXPECT_EQ(light.filtered_highlights(), 0);
}

}  // namespace
}  // namespace rimlight
