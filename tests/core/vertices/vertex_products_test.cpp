// The full calculation against sums in double, one vertex at a time.
#include "core/vertices/vertex_products.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "core/base/check.h"
#include "core/base/parallel.h"
#include "tests/core/vertices/random_vertices.h"
#include "tests/core/vertices/reference_light.h"
#include "tests/support/allocation_count.h"

namespace rimlight {
namespace {

constexpr std::size_t kSums = kLightChannels * kBatchVertices;
using Selected = std::vector<std::uint32_t>;

/// Every vertex that is a multiple of 3, and the last.
Selected some_vertices(std::size_t count) {
  Selected chosen;
  for (std::uint32_t v = 0; v < count; v += 3) chosen.push_back(v);
  if (chosen.back() + 1 != count) chosen.push_back(static_cast<std::uint32_t>(count - 1));
  return chosen;
}

TEST(VertexSelection, PacksVerticesInOrder) {
  const Selected chosen = some_vertices(517);
  VertexSelection selection;
  selection.select_vertices(chosen);
  ASSERT_EQ(selection.vertex_count(), chosen.size());
  EXPECT_EQ(selection.vertex_end(), 517u);
  std::size_t seen = 0;
  for (std::size_t panel = 0; panel < selection.panel_count(); ++panel) {
    std::size_t lanes = 0;
    selection.for_each_vertex(panel, [&](std::size_t vertex, std::size_t lane) {
      EXPECT_EQ(lane, lanes++);
      EXPECT_EQ(vertex, chosen[seen++]);
    });
    EXPECT_EQ(lanes, selection.lane_count(panel));
  }
  EXPECT_EQ(seen, chosen.size());
}

TEST(VertexSelection, RefusesAnotherOrder) {
  VertexSelection selection;
  EXPECT_THROW(selection.select_vertices(Selected{3, 2}), CheckFailure);
  EXPECT_THROW(selection.select_vertices(Selected{70, 2}), CheckFailure);
  EXPECT_THROW(selection.select_vertices(Selected{2, 2}), CheckFailure);
  selection.select_vertices({});
  EXPECT_EQ(selection.panel_count(), 0u);
}

TEST(VertexProducts, IrradianceIsTheSumInDouble) {
  for (const std::size_t channels : {std::size_t{1}, std::size_t{3}}) {
    const test::RandomVertices vertices({300, 100, 5, 3, channels});
    VertexProducts products(vertices.view());
    const auto light = test::RandomVertices::light(7);
    products.set_light(light);
    VertexSelection selection;
    selection.select_vertices(some_vertices(300));
    std::vector<float> to(selection.panel_count() * kSums, NAN);
    products.irradiance(selection, to);
    const std::size_t count = sh::coefficient_count(5);
    double worst = 0;
    for (std::size_t panel = 0; panel < selection.panel_count(); ++panel) {
      selection.for_each_vertex(panel, [&](std::size_t vertex, std::size_t lane) {
        for (std::size_t c = 0; c < kLightChannels; ++c) {
          const std::size_t block = vertex / kBatchVertices * channels + (channels == 1 ? 0 : c);
          const auto row =
              reference::row_of(vertices.view().irradiance, block, count, vertex % kBatchVertices);
          const double truth = std::inner_product(
              row.begin(), row.end(), light.begin() + static_cast<std::ptrdiff_t>(c * 64), 0.0);
          const float sum = to[panel * kSums + c * kBatchVertices + lane];
          worst = std::max(worst, std::abs(static_cast<double>(sum) - truth));
        }
      });
    }
    EXPECT_LE(worst, 36 * 0x1p-24 * 36) << channels;
    EXPECT_EQ(to.back(), 0) << "padding";
  }
}

class VertexProductsOfDegree : public testing::TestWithParam<int> {};

TEST_P(VertexProductsOfDegree, IncidentLightAndHighlightsAreTheSumsInDouble) {
  const int degree = GetParam();
  const test::RandomVertices vertices({150, 130, 2, degree});
  VertexProducts products(vertices.view());
  const auto light = test::RandomVertices::light(2 * degree);
  products.set_light(light);
  VertexSelection selection;
  selection.select_vertices(some_vertices(130));
  const std::size_t count = sh::coefficient_count(degree), stride = products.row_stride();
  std::vector<float> rows(130 * kLightChannels * stride, -1.0f);
  std::vector<float> highlights(selection.panel_count() * kSums, NAN);
  products.incident_by_vertex(selection, rows);
  products.highlights(selection, vertices.gloss(), highlights);
  EXPECT_EQ(rows[kLightChannels * stride], -1) << "vertex 1 is not selected";
  double worst = 0;
  for (std::size_t panel = 0; panel < selection.panel_count(); ++panel) {
    selection.for_each_vertex(panel, [&](std::size_t vertex, std::size_t lane) {
      const auto visibility = reference::row_of(vertices.view().visibility, vertex / kBatchVertices,
                                                count, vertex % kBatchVertices);
      const std::span<const float> factors(
          vertices.lobes.data() + vertices.lobe_of[vertex] * static_cast<std::size_t>(degree + 1),
          static_cast<std::size_t>(degree) + 1);
      for (std::size_t c = 0; c < kLightChannels; ++c) {
        const auto truth = reference::product(
            visibility, std::span(light).subspan(c * light.size() / 3, light.size() / 3));
        for (std::size_t i = 0; i < count; ++i) {
          const float value = rows[(vertex * kLightChannels + c) * stride + i];
          worst = std::max(worst, std::abs(static_cast<double>(value) - truth[i]));
        }
        const double shine = reference::highlight(truth, factors, vertices.mirrored[vertex]);
        const float value = highlights[panel * kSums + c * kBatchVertices + lane];
        worst = std::max(worst, std::abs(static_cast<double>(value) - shine));
      }
    });
  }
  RecordProperty("worst", std::to_string(worst));
  EXPECT_LE(worst, 2e-6 * static_cast<double>(count));
}
INSTANTIATE_TEST_SUITE_P(Degrees, VertexProductsOfDegree, testing::Values(0, 1, 2, 4, 7));

TEST(VertexProducts, AVertexHasTheSameBitsWhateverElseIsSelectedAndWithAnyThreads) {
  const test::RandomVertices vertices({1000, 1000, 3, 4});
  VertexProducts products(vertices.view());
  products.set_light(test::RandomVertices::light(8));
  VertexSelection all, some;
  Selected every(1000);
  std::iota(every.begin(), every.end(), 0u);
  all.select_vertices(every);
  some.select_vertices(some_vertices(1000));
  std::vector<float> to_all(all.panel_count() * kSums), to_some(some.panel_count() * kSums);
  products.highlights(all, {vertices.mirrored, vertices.lobes, {}}, to_all);
  for (const int threads : {1, 2, 3}) {
    set_thread_count(threads);
    products.highlights(some, {vertices.mirrored, vertices.lobes, {}}, to_some);
    std::size_t compared = 0;
    for (std::size_t panel = 0; panel < some.panel_count(); ++panel) {
      some.for_each_vertex(panel, [&](std::size_t vertex, std::size_t lane) {
        for (std::size_t c = 0; c < kLightChannels; ++c, ++compared) {
          EXPECT_EQ(to_some[panel * kSums + c * kBatchVertices + lane],
                    to_all[vertex / kBatchVertices * kSums + c * kBatchVertices +
                           vertex % kBatchVertices]);
        }
      });
    }
    EXPECT_EQ(compared, 3 * some.vertex_count());
  }
  set_thread_count(0);
}

TEST(VertexProducts, AllocatesNothingOnceWarm) {
  if (!test::kCountsAllocations) GTEST_SKIP() << "ThreadSanitizer has an operator new of its own";
  const test::RandomVertices vertices({300, 300, 3, 4});
  VertexProducts products(vertices.view());
  const auto light = test::RandomVertices::light(8);
  const Selected chosen = some_vertices(300);
  VertexSelection selection;
  selection.select_vertices(chosen);
  std::vector<float> sums(selection.panel_count() * kSums);
  std::vector<float> rows(300 * kLightChannels * products.row_stride());
  run_alone([&] {
    std::size_t before = 0;
    for (int round = 0; round < 2; ++round) {
      before = test::allocation_count();
      products.set_light(light);
      selection.select_vertices(chosen);
      products.irradiance(selection, sums);
      products.incident_by_vertex(selection, rows);
      products.highlights(selection, vertices.gloss(), sums);
    }
    EXPECT_EQ(test::allocation_count(), before);
  });
  EXPECT_NE(sums[0], 0);
}

TEST(PanelTransposition, PutsLanesInRowsAndPadsThem) {
  for (const std::size_t coefficients : {std::size_t{1}, std::size_t{16}, std::size_t{25}}) {
    constexpr std::size_t kStride = 40;
    std::vector<float> panel(coefficients * kBatchVertices), rows(kStride * kBatchVertices, NAN);
    std::iota(panel.begin(), panel.end(), 1.0f);
    transpose_panel(panel.data(), coefficients, rows.data(), kStride);
    for (std::size_t k = 0; k < rows.size(); ++k) {
      const std::size_t lane = k / kStride, i = k % kStride;
      EXPECT_EQ(rows[k], i < coefficients ? panel[i * kBatchVertices + lane] : 0) << k;
    }
  }
}

TEST(VertexProducts, RefusesWhatDoesNotFit) {
  const test::RandomVertices vertices({100, 64, 3, 4});
  VertexTransportView view = vertices.view();
  VertexProducts products(view);
  VertexSelection selection;
  selection.select_vertices(Selected{70});
  std::vector<float> sums(kSums);
  EXPECT_THROW(products.highlights(selection, vertices.gloss(), sums), CheckFailure);
  selection.select_vertices(Selected{3});
  EXPECT_THROW(products.highlights(selection, {vertices.mirrored, {}, {}}, sums), CheckFailure);
  EXPECT_THROW(products.highlights(selection, {{}, vertices.lobes, {}}, sums), CheckFailure);
  EXPECT_THROW(products.irradiance(selection, std::span(sums).first(64)), CheckFailure);
  view.irradiance_channels = 2;
  EXPECT_THROW(VertexProducts{view}, CheckFailure);
  view.irradiance_channels = 3;
  EXPECT_THROW(VertexProducts{view}, CheckFailure);
}

}  // namespace
}  // namespace rimlight
