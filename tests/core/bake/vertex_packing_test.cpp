#include "core/bake/vertex_packing.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/basis/sh.h"
#include "core/math/random.h"

namespace rimlight {
namespace {

/// Random coefficients that fall with the degree.
CalculatedTransport falling(std::size_t channels, double colour) {
  CalculatedTransport transport{
      .vertex_count = 130, .highlight_count = 70, .degree = 6, .irradiance = {}, .visibility = {}};
  Random random(1);
  const std::size_t count = sh::coefficient_count(transport.degree);
  const auto value = [&](std::size_t i) {
    return random.uniform(-1, 1) * std::pow(0.4, sh::degree_of(i % count));
  };
  std::vector<double> grey;
  for (std::size_t i = 0; i < transport.vertex_count * count; ++i) grey.push_back(value(i));
  for (std::size_t c = 0; c < channels; ++c) {
    transport.irradiance.emplace_back();
    for (std::size_t i = 0; i < grey.size(); ++i) {
      transport.irradiance.back().push_back(static_cast<float>(grey[i] + colour * value(i)));
    }
  }
  for (std::size_t i = 0; i < transport.highlight_count * count; ++i) {
    transport.visibility.push_back(static_cast<float>(value(i)));
  }
  return transport;
}

/// What is stored of a vertex' coefficient; 0 beyond the stored degree.
double stored_value(const VertexTransportView& view, std::size_t vertex, std::size_t channel,
                    std::size_t i) {
  const std::size_t count = sh::coefficient_count(view.irradiance_degree);
  if (i >= count) return 0;
  const std::size_t c = std::min(channel, view.irradiance_channels - 1);
  const std::size_t row = (vertex / kBatchVertices * view.irradiance_channels + c) * count + i;
  return to_float(view.irradiance[row * kBatchVertices + vertex % kBatchVertices]);
}

/// L2 at a vertex, rms over vertices and channels, as a share of the clamped cosine's.
double relative_difference(const CalculatedTransport& from, const VertexTransportView& view) {
  const std::size_t count = sh::coefficient_count(from.degree);
  double sum = 0;
  for (std::size_t c = 0; c < from.irradiance.size(); ++c) {
    for (std::size_t v = 0; v < from.vertex_count; ++v) {
      for (std::size_t i = 0; i < count; ++i) {
        sum += std::pow(stored_value(view, v, c, i) - from.irradiance[c][v * count + i], 2);
      }
    }
  }
  const auto rows = static_cast<double>(from.irradiance.size() * from.vertex_count);
  return std::sqrt(sum / rows) / std::sqrt(2 * std::numbers::pi / 3);
}

TEST(VertexPacking, KeepsEverythingWhereAsked) {
  const CalculatedTransport transport = falling(3, 0.5);
  const StoredTransport stored = pack(transport, {.error = 1, .keep_bands = true});
  EXPECT_EQ(stored.view.irradiance_degree, 6);
  EXPECT_EQ(stored.view.visibility_degree, 6);
  EXPECT_EQ(stored.view.irradiance_channels, 3u);
  EXPECT_EQ(stored.irradiance.size(), 3u * 3 * 49 * 64);
  EXPECT_EQ(stored.visibility.size(), 2u * 49 * 64);
  EXPECT_LT(relative_difference(transport, stored.view), 2e-4);  // halves
  EXPECT_GT(relative_difference(transport, stored.view), 0);
  for (std::size_t v = 0; v < 70; ++v) {
    for (std::size_t i = 0; i < 49; ++i) {
      const Half half = stored.visibility[(v / 64 * 49 + i) * 64 + v % 64];
      EXPECT_EQ(half, to_half(transport.visibility[v * 49 + i]));
    }
  }
  for (std::size_t row = 2 * 3 * 49; row < 3 * 3 * 49; ++row) {
    for (std::size_t lane = 130 % 64; lane < 64; ++lane) {
      EXPECT_EQ(stored.irradiance[row * 64 + lane], 0);
    }
  }
}

TEST(VertexPacking, LeavesOutBandsAndSaysWhatThatCosts) {
  const CalculatedTransport transport = falling(3, 3);
  int last = 7;
  for (const double error : {5e-4, 0.05, 0.3, 1.0}) {
    const StoredTransport stored = pack(transport, {.error = error});
    const int degree = stored.view.irradiance_degree;
    ASSERT_EQ(stored.view.irradiance_channels, 3u);
    EXPECT_LT(degree, last) << error;
    last = degree;
    const auto& said = stored.left_out["irradiance"];
    EXPECT_EQ(said["degree_asked"], 6);
    EXPECT_EQ(said["degree_stored"], degree);
    EXPECT_EQ(said["coefficients_left_out"], 49u - sh::coefficient_count(degree));
    EXPECT_LE(said["relative_error"].get<double>(), error);
    EXPECT_NEAR(relative_difference(transport, stored.view), said["relative_error"].get<double>(),
                1e-3);  // halves, 49 of them
    // One band less would cost more than allowed.
    if (degree == 6) continue;
    CalculatedTransport lower = transport;
    double energy = 0;
    for (const auto& values : lower.irradiance) {
      for (std::size_t i = 0; i < values.size(); ++i) {
        if (sh::degree_of(i % 49) >= degree) energy += static_cast<double>(values[i]) * values[i];
      }
    }
    EXPECT_GT(std::sqrt(energy / (3 * 130)) / std::sqrt(2 * std::numbers::pi / 3), error);
  }
  EXPECT_LT(last, 5);
}

/// Of the clamped cosine's energy, 2π/3, half is in band 1; of the hemisphere's, 2π, 3/8.
TEST(VertexPacking, AnOpenVertexLosesItsShareOfUnshadowedLight) {
  constexpr double kPi = std::numbers::pi;
  CalculatedTransport open{
      .vertex_count = 70, .highlight_count = 5, .degree = 1, .irradiance = {{}}, .visibility = {}};
  for (std::size_t v = 0; v < 70; ++v) {
    for (const double c : {std::sqrt(kPi) / 2, 0.0, std::sqrt(kPi / 3), 0.0}) {
      open.irradiance[0].push_back(static_cast<float>(c));
    }
    if (v >= 5) continue;
    for (const double c : {std::sqrt(kPi), 0.0, std::sqrt(3 * kPi) / 2, 0.0}) {
      open.visibility.push_back(static_cast<float>(c));
    }
  }
  const auto degrees = [&](double error) {
    const StoredTransport stored = pack(open, {.error = error});
    return std::pair(stored.view.irradiance_degree, stored.view.visibility_degree);
  };
  EXPECT_EQ(degrees(0.61), std::pair(1, 1));
  EXPECT_EQ(degrees(0.62), std::pair(1, 0));
  EXPECT_EQ(degrees(0.70), std::pair(1, 0));
  EXPECT_EQ(degrees(0.71), std::pair(0, 0));
  const auto left_out = pack(open, {.error = 1}).left_out;
  EXPECT_NEAR(left_out["irradiance"]["relative_error"].get<double>(), std::sqrt(0.5), 1e-6);
  EXPECT_NEAR(left_out["visibility"]["relative_error"].get<double>(), std::sqrt(0.375), 1e-6);
}

TEST(VertexPacking, OneChannelIsEnoughForLightWithoutColour) {
  const StoredTransport grey = pack(falling(3, 0), {.error = 1e-4});
  EXPECT_EQ(grey.view.irradiance_channels, 1u);
  EXPECT_EQ(grey.left_out["irradiance_colour"]["channels_left_out"], 2);
  const CalculatedTransport pale = falling(3, 0.01);
  const StoredTransport stored = pack(pale, {.error = 0.01});
  EXPECT_EQ(stored.view.irradiance_channels, 1u);
  EXPECT_GT(stored.left_out["irradiance_colour"]["relative_error"].get<double>(), 1e-4);
  EXPECT_LE(relative_difference(pale, stored.view),
            stored.left_out["irradiance_colour"]["relative_error"].get<double>() +
                stored.left_out["irradiance"]["relative_error"].get<double>() + 2e-4);
  EXPECT_EQ(pack(pale, {.error = 1e-4}).view.irradiance_channels, 3u);
  EXPECT_EQ(pack(falling(1, 0), {.error = 1e-4}).view.irradiance_channels, 1u);
}

TEST(VertexPacking, WithoutHighlightsThereIsNoVisibility) {
  CalculatedTransport transport = falling(1, 0);
  transport.highlight_count = 0;
  transport.visibility.clear();
  const StoredTransport stored = pack(transport, {.error = 1e-4});
  EXPECT_TRUE(stored.visibility.empty());
  EXPECT_EQ(stored.left_out["visibility"]["vertices_left_out"], 130);
}

}  // namespace
}  // namespace rimlight
