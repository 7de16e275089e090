#include "core/vertices/bake_error.h"

#include <gtest/gtest.h>

#include <limits>
#include <numbers>

#include "core/basis/sh.h"

namespace rimlight {
namespace {

using nlohmann::json;

double total(const std::vector<double>& squares) {
  double sum = 0;
  for (std::size_t l = 0; l < squares.size(); ++l) {
    sum += squares[l] * static_cast<double>(2 * l + 1);
  }
  return sum;
}

TEST(BakeError, BandsAreReadAsHalvedSquares) {
  const json measured = {{"visibility",
                          {{"rms_error", 0.5},
                           {"rms_by_band",
                            {{"irradiance", {0.1, 0.2, 0.4}},
                             {"irradiance_beside_highlight", {0.2, 0.2, 0.2}},
                             {"visibility", {1, 2, 4}}}}}}};
  const VertexBakeError error = bake_error_of({{"transfer", "shadowed"}}, measured, {}, 2);
  EXPECT_TRUE(error.is_known);
  ASSERT_EQ(error.sampling.matt.size(), 3u);
  EXPECT_DOUBLE_EQ(error.sampling.matt[2], 0.08);
  EXPECT_DOUBLE_EQ(error.sampling.glossy[0], 0.02);
  EXPECT_DOUBLE_EQ(error.sampling.visibility[1], 2);
  EXPECT_TRUE(error.irradiance_left_out.empty());
}

TEST(BakeError, AnOlderBakesOneNumberIsSharedOut) {
  const json measured = {{"visibility", {{"rms_error", 0.2}}}};
  const VertexBakeError error = bake_error_of(json::object(), measured, json::object(), 3);
  EXPECT_TRUE(error.is_known);
  for (std::size_t l = 0; l <= 3; ++l) {
    EXPECT_DOUBLE_EQ(error.sampling.matt[l], 0.02);
    EXPECT_DOUBLE_EQ(error.sampling.glossy[l] + error.sampling.visibility[l], 0.02);
  }
}

TEST(BakeError, TotalsOfWhatIsSpreadOverBandsAreKept) {
  const json measured = {{"visibility", {{"rms_error", 0}}}, {"indirect", {{"rms_error", 0.1}}}};
  const json left_out = {
      {"irradiance", {{"degree_asked", 6}, {"degree_stored", 3}, {"relative_error", 0.1}}},
      {"irradiance_colour", {{"relative_error", 0.2}}},
      {"visibility", {{"degree_asked", 6}, {"degree_stored", 4}, {"relative_error", 0.3}}}};
  const VertexBakeError error = bake_error_of({{"degree", 6}}, measured, left_out, 4);
  const double pi = std::numbers::pi;
  EXPECT_NEAR(total(error.sampling.matt), 0.5 * 0.01 * 49, 1e-12);
  EXPECT_NEAR(total(error.irradiance_left_out), (0.01 + 0.04) * 2 * pi / 3, 1e-12);
  EXPECT_NEAR(total(error.visibility_left_out), 0.09 * 2 * pi, 1e-12);
  for (std::size_t l = 0; l <= 4; ++l) EXPECT_EQ(error.visibility_left_out[l], 0);
  EXPECT_GT(error.visibility_left_out[5], 0);
}

TEST(BakeError, OpenTransportHasNoSamplingError) {
  const VertexBakeError error = bake_error_of({{"transfer", "unshadowed"}}, {}, {}, 4);
  EXPECT_TRUE(error.is_known);
  EXPECT_TRUE(error.sampling.matt.empty());
}

TEST(BakeError, WhatPeopleWroteThereDoesNoHarm) {
  const double infinite = std::numeric_limits<double>::infinity();
  for (const json& odd : std::vector<json>{nullptr,
                                           3,
                                           "x",
                                           json::array({1}),
                                           {{"visibility", 3}},
                                           {{"visibility", {{"rms_error", -1}}}},
                                           {{"visibility", {{"rms_error", infinite}}}},
                                           {{"visibility", {{"rms_error", "0.1"}}}}}) {
    const VertexBakeError error = bake_error_of(odd, odd, odd, 5);
    EXPECT_FALSE(error.is_known) << odd;
    EXPECT_EQ(total(error.sampling.matt) + total(error.irradiance_left_out), 0) << odd;
  }
  const json bands = {
      {"visibility", {{"rms_error", 1}, {"rms_by_band", {{"irradiance", {1, 2}}}}}}};
  EXPECT_TRUE(bake_error_of({}, bands, {}, 5).sampling.matt.empty());
  for (const json& degree : std::vector<json>{-1e30, 1e30, 33, "6", 2.5}) {
    const json left_out = {
        {"irradiance", {{"degree_asked", degree}, {"degree_stored", 2}, {"relative_error", 0.1}}}};
    const json asked = {{"degree", degree}};
    EXPECT_LE(bake_error_of(asked, {}, left_out, 5).irradiance_left_out.size(), 33u) << degree;
  }
}

}  // namespace
}  // namespace rimlight
