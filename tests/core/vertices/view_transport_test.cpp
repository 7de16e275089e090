// Vertices as linear functions of the light: exact, and steady while a light turns.
#include "core/vertices/view_transport.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "core/base/check.h"
#include "core/base/parallel.h"
#include "core/basis/sh_rotation.h"
#include "core/math/random.h"
#include "core/math/rotation.h"
#include "core/vertices/multi_level_light.h"
#include "tests/core/vertices/random_vertices.h"
#include "tests/support/allocation_count.h"

namespace rimlight {
namespace {

constexpr std::size_t kSums = kLightChannels * kBatchVertices;

/// Panels of random transport, falling from band to band.
PanelTransport random_panels(std::size_t panels, std::size_t channels, int degree,
                             std::vector<float>& values) {
  const std::size_t count = sh::coefficient_count(degree);
  Random random(5);
  values.resize(panels * channels * count * kBatchVertices);
  for (std::size_t i = 0; i < values.size(); ++i) {
    const auto l = static_cast<double>(sh::degree_of(i / kBatchVertices % count));
    values[i] = to_float(to_half(static_cast<float>(random.uniform(-1, 1) / (1 + l * l))));
  }
  PanelTransport transport;
  transport.assign({panels * kBatchVertices, channels, degree},
                   [&](std::size_t panel, std::span<float> to) {
                     std::copy_n(values.begin() + static_cast<std::ptrdiff_t>(panel * to.size()),
                                 to.size(), to.begin());
                   });
  return transport;
}

TEST(PanelTransport, IsTheSumInDouble) {
  for (const std::size_t channels : {std::size_t{1}, std::size_t{3}}) {
    for (const int light_degree : {2, 4, 7}) {
      std::vector<float> values;
      PanelTransport transport = random_panels(2, channels, 4, values);
      const auto light = test::RandomVertices::light(light_degree);
      transport.choose_bands(light, 0);
      std::vector<float> to(2 * kSums, NAN);
      transport.apply(light, to);
      const std::size_t given = light.size() / 3, used = std::min<std::size_t>(25, given);
      for (std::size_t k = 0; k < to.size(); ++k) {
        const std::size_t panel = k / kSums, c = k % kSums / kBatchVertices;
        const std::size_t block = panel * channels + (channels == 1 ? 0 : c);
        double truth = 0;
        for (std::size_t i = 0; i < used; ++i) {
          truth +=
              static_cast<double>(values[(block * 25 + i) * kBatchVertices + k % kBatchVertices]) *
              static_cast<double>(light[c * given + i]);
        }
        EXPECT_NEAR(static_cast<double>(to[k]), truth, 25 * 25 * 0x1p-24) << k;
      }
    }
  }
}

/// Over many rotations of the light, the mean square of what was left out is as predicted: at most
/// tolerance², and with one band more above it.
TEST(PanelTransport, LeavesOutWhatTheToleranceSays) {
  constexpr float kTolerance = 0.02f;
  std::vector<float> values;
  PanelTransport transport = random_panels(1, 1, 10, values);
  const auto light = test::RandomVertices::light(10);
  std::vector<float> turned(light.size()), all(kSums), some(kSums);
  Random random(9);
  std::array<double, 3> square{};
  constexpr int kRotations = 400;
  double left_out = -1;
  for (int i = 0; i < kRotations; ++i) {
    sh::Rotation(random_rotation(random), 10).apply(light, turned);
    transport.choose_bands(turned, 0);
    EXPECT_EQ(transport.left_out(), 0);
    transport.apply(turned, all);
    transport.choose_bands(turned, kTolerance);
    if (i > 0) {
      EXPECT_EQ(transport.left_out(), left_out) << "a turn changes no choice";
    }
    left_out = transport.left_out();
    transport.apply(turned, some);
    for (std::size_t k = 0; k < kSums; ++k) {
      square[k / kBatchVertices] += std::pow(static_cast<double>(all[k] - some[k]), 2);
    }
  }
  EXPECT_GT(left_out, 0);
  EXPECT_LT(left_out, 1);
  for (double& sum : square) sum = std::sqrt(sum / (kRotations * kBatchVertices));
  // 64 vertices in 400 rotations, which the vertices share: to about 3 %.
  const double worst = *std::ranges::max_element(square);
  EXPECT_LT(worst, 1.1 * static_cast<double>(kTolerance));
  EXPECT_GT(worst, 0.2 * static_cast<double>(kTolerance)) << "no more than needed";
}

TEST(PanelTransport, PaddingDoesNotThinOutWhatIsLeftOut) {
  const auto light = test::RandomVertices::light(6);
  std::array<double, 2> left_out{};
  for (const std::size_t vertices : {std::size_t{1}, kBatchVertices}) {
    PanelTransport transport;
    transport.assign({vertices, 1, 6}, [&](std::size_t, std::span<float> to) {
      for (std::size_t k = 0; k < to.size(); ++k) {
        const auto l = static_cast<float>(sh::degree_of(k / kBatchVertices));
        to[k] = k % kBatchVertices < vertices ? 1 / (1 + l * l * l) : 0;
      }
    });
    transport.choose_bands(light, 0.02f);
    left_out[vertices == 1 ? 0 : 1] = transport.left_out();
  }
  EXPECT_EQ(left_out[0], left_out[1]);
  EXPECT_GT(left_out[0], 0);
}

TEST(PanelTransport, WantsAChoiceFirst) {
  std::vector<float> values, to(kSums);
  PanelTransport transport = random_panels(1, 1, 2, values);
  EXPECT_THROW(transport.apply(test::RandomVertices::light(2), to), CheckFailure);
}

class ViewTransportTest : public testing::Test {
 protected:
  static constexpr int kDegree = 5;
  static constexpr std::size_t kVertices = 500;

  ViewTransportTest() {
    std::vector<std::uint32_t> chosen;
    for (std::uint32_t v = 1; v < kVertices; v += 2) chosen.push_back(v);
    selection.select_vertices(chosen);
    irradiance.resize(selection.panel_count() * kSums);
    highlights = full_irradiance = full_highlights = irradiance;
  }
  void calculate_full(std::span<const float> light) {
    products.set_light(light);
    products.irradiance(selection, full_irradiance);
    products.highlights(selection, vertices.gloss(), full_highlights);
  }

  test::RandomVertices vertices{{kVertices, kVertices, 4, kDegree, 3}};
  VertexProducts products{vertices.view()};
  ViewTransport view{vertices.view()};
  VertexSelection selection;
  std::vector<float> irradiance, highlights, full_irradiance, full_highlights;
};

double largest_difference(const std::vector<float>& a, const std::vector<float>& b) {
  double largest = 0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    largest = std::max(largest, std::abs(static_cast<double>(a[i] - b[i])));
  }
  return largest;
}

double largest(const std::vector<float>& a) {
  return largest_difference(a, std::vector<float>(a.size()));
}

TEST_F(ViewTransportTest, IsTheFullCalculationButForRounding) {
  view.set_view(selection, vertices.gloss());
  for (const int light_degree : {0, kDegree, 2 * kDegree, 2 * kDegree + 3}) {
    const auto light = test::RandomVertices::light(light_degree);
    calculate_full(light);
    view.calculate(light, {}, irradiance, highlights);
    EXPECT_LE(largest_difference(irradiance, full_irradiance), 1e-5);
    // T in halves: relative 2⁻¹¹ each, of signs that differ.
    EXPECT_LE(largest_difference(highlights, full_highlights), 3e-3 * largest(full_highlights));
    EXPECT_GT(largest(full_highlights), 0.1);
  }
}

TEST_F(ViewTransportTest, HasTheSameBitsWithAnyThreads) {
  const auto light = test::RandomVertices::light(2 * kDegree);
  std::vector<float> first;
  for (const int threads : {1, 2, 3}) {
    set_thread_count(threads);
    view.set_view(selection, vertices.gloss());
    view.calculate(light, {0.01f, 0.01f}, irradiance, highlights);
    if (first.empty()) first = highlights;
    EXPECT_EQ(highlights, first) << threads;
  }
  set_thread_count(0);
}

TEST_F(ViewTransportTest, ALightChangeAllocatesNothing) {
  if (!test::kCountsAllocations) GTEST_SKIP() << "ThreadSanitizer has an operator new of its own";
  const auto light = test::RandomVertices::light(2 * kDegree);
  run_alone([&] {
    std::size_t before = 0;
    for (int round = 0; round < 2; ++round) {
      if (round == 0) view.set_view(selection, vertices.gloss());
      before = test::allocation_count();
      view.calculate(light, {0.01f, 0.01f}, irradiance, highlights);
    }
    EXPECT_EQ(test::allocation_count(), before);
  });
}

/// How much any vertex changes from step to step of a slow turn beyond what the full calculation
/// changes: thresholds jump, linear functions of the light do not.
TEST_F(ViewTransportTest, FlickersLessThanAFourthOfFiltering) {
  const VertexGraph no_graph;
  MultiLevelLight filtering(products, no_graph);
  const auto light = test::RandomVertices::light(2 * kDegree);
  std::vector<float> turned(light.size()), beside = irradiance;
  std::vector<float> filtered_error, view_error;
  view.set_view(selection, vertices.gloss());
  double filtering_flicker = 0, view_flicker = 0, filtering_square = 0, view_square = 0;
  const auto compare = [&](std::vector<float>& last, const std::vector<float>& now, double& flicker,
                           double& square) {
    std::vector<float> error(now.size());
    for (std::size_t k = 0; k < now.size(); ++k) {
      error[k] = now[k] - full_highlights[k];
      square += std::pow(static_cast<double>(error[k]), 2);
    }
    if (!last.empty()) flicker = std::max(flicker, largest_difference(error, last));
    last = error;
  };
  for (int frame = 0; frame < 40; ++frame) {
    sh::Rotation(axis_angle({0, 1, 0}, 0.005 * frame), 2 * kDegree).apply(light, turned);
    calculate_full(turned);
    filtering.calculate(selection, vertices.gloss(), {2, 0, 0.1f}, irradiance, highlights);
    EXPECT_GT(filtering.filtered_highlights(), 0.02);
    EXPECT_LT(filtering.filtered_highlights(), 0.98);
    compare(filtered_error, highlights, filtering_flicker, filtering_square);
    view.calculate(turned, {0, 0.03f}, beside, highlights);
    EXPECT_GT(view.highlights().left_out(), 0);
    compare(view_error, highlights, view_flicker, view_square);
  }
  EXPECT_LT(view_flicker, filtering_flicker / 4);
  EXPECT_LT(view_square, filtering_square);
}

}  // namespace
}  // namespace rimlight
