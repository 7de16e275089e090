#include "core/material/rgl_brdf.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "core/math/random.h"
#include "core/math/sampling.h"
#include "tests/core/material/measured_cases.h"
#include "tests/support/brdf_files.h"
#include "tests/support/error_of.h"

namespace rimlight {
namespace {

std::vector<RglGrid> random_grids(std::size_t count, std::size_t columns, std::size_t rows) {
  Random random(61);
  std::vector<RglGrid> grids;
  for (std::size_t i = 0; i < count; ++i) {
    std::vector<float> values(columns * rows);
    for (float& value : values) value = random.uniform_float() * random.uniform_float();
    grids.emplace_back(columns, rows, values);
  }
  return grids;
}

TEST(RglGrid, IsBilinearBetweenItsValues) {
  const RglGrid grid(3, 2, std::vector<float>{0, 1, 4, 2, -5, 6});
  EXPECT_EQ(grid.at({0, 0}), 0);
  EXPECT_EQ(grid.at({1, 1}), 6);
  EXPECT_EQ(grid.at({0.5, 1}), 0);  // negative: 0
  EXPECT_NEAR(grid.at({0.75, 0}), 2.5, 1e-15);
  EXPECT_NEAR(grid.at({0.25, 0.5}), (0 + 1 + 2 + 0) / 4.0, 1e-15);
  EXPECT_EQ(grid.at({-1, 7}), 2);
}

// Against sums over a fine grid of the density itself.
TEST(RglWarp, UniformIsTheDensitysIntegral) {
  constexpr int kSteps = 720;  // a multiple of the cells, so that no kink lies inside a step
  const RglWarp warp(random_grids(2, 5, 4));
  for (const RglWarp::Place at :
       {RglWarp::Place{0, 0}, RglWarp::Place{0, 0.3}, RglWarp::Place{0, 1}}) {
    for (const SquarePoint point :
         {SquarePoint{0.25, 0.5}, SquarePoint{0.7, 0.2}, SquarePoint{1, 1}, SquarePoint{0.05, 0.95},
          SquarePoint{0, 0}}) {
      double row = 0, row_below = 0, whole = 0, below = 0;
      for (int i = 0; i < kSteps; ++i) {
        const double x = (i + 0.5) / kSteps;
        row += warp.density(at, {x, point.y}) / kSteps;
        if (x < point.x) row_below += warp.density(at, {x, point.y}) / kSteps;
        for (int j = 0; j < kSteps; j += 1) {
          const double y = (j + 0.5) / kSteps;
          const double p = warp.density(at, {x, y}) / (kSteps * kSteps);
          whole += p;
          if (y < point.y) below += p;
        }
      }
      const SquarePoint uniform = warp.uniform(at, point);
      EXPECT_NEAR(whole, 1, 1e-5);
      EXPECT_NEAR(uniform.x, row_below / row, 2e-3);
      EXPECT_NEAR(uniform.y, below, 2e-3);
    }
  }
}

TEST(RglWarp, AGridOfZerosIsTheIdentityInXAndFinite) {
  const RglWarp warp({RglGrid(4, 4, std::vector<float>(16))});
  const SquarePoint uniform = warp.uniform({0, 0.5}, {0.3, 0.6});
  EXPECT_EQ(uniform.x, 0.3);
  EXPECT_EQ(uniform.y, 0);
}

TEST(RglBrdf, ConstantTablesAreTheirQuotient) {
  const std::string file = test::rgl_file(test::small_rgl_fields(0.9f, 0.5f, {1, 0.5f, 0}));
  const RglBrdf brdf(bytes_of(file), "f");
  Random random(62);
  for (int i = 0; i < 200; ++i) {
    const Vec3d in = cosine_hemisphere(random_sample(random));
    const Vec3d out = cosine_hemisphere(random_sample(random));
    const auto value = brdf.at(in, out);
    ASSERT_TRUE(value.has_value());
    const double f = 0.9 / (4 * 0.5 * out.z);
    ASSERT_NEAR(value->x, f, 1e-6 * f);
    ASSERT_NEAR(value->y, f / 2, 1e-6 * f);
    ASSERT_EQ(value->z, 0);
  }
}

TEST(RglBrdf, TablesAreReadAtTheirAngles) {
  // ndf rises with √θ_h; sigma with √θ_i; R by its own two coordinates and with θ_i.
  auto fields = test::small_rgl_fields(1, 1, {0, 0, 0});
  for (std::size_t i = 0; i < 16; ++i) {
    fields[2].values[i] = 1 + static_cast<float>(i % 8) / 7;
    fields[3].values[i] = 2 + static_cast<float>(i % 8) / 7;
  }
  for (std::size_t i = 0; i < fields[5].values.size(); ++i) {
    const std::size_t column = i % 5, row = i / 5 % 4, channel = i / 20 % 3, angle = i / 60;
    const float by_channel[] = {static_cast<float>(column) / 4, static_cast<float>(row) / 3,
                                static_cast<float>(angle)};
    fields[5].values[i] = by_channel[channel];
  }
  const std::string file = test::rgl_file(fields);
  const RglBrdf brdf(bytes_of(file), "f");
  Random random(63);
  for (int i = 0; i < 200; ++i) {
    const Vec3d in = cosine_hemisphere(random_sample(random));
    const Vec3d out = cosine_hemisphere(random_sample(random));
    const Vec3d half = normalized(in + out);
    const double pi = std::acos(-1.0), theta = std::acos(in.z);
    const double u_half = std::sqrt(std::acos(half.z) * 2 / pi), u_in = std::sqrt(theta * 2 / pi);
    double turn = (std::atan2(half.y, half.x) - std::atan2(in.y, in.x)) / (2 * pi) + 0.5;
    turn -= std::floor(turn);
    const double scale = (2 + u_half) / (4 * (1 + u_in) * out.z);
    const double angle = theta < 0.8 ? theta / 0.8 : 1 + (theta - 0.8) / (1.5707964 - 0.8);
    const auto value = brdf.at(in, out);
    ASSERT_TRUE(value.has_value());
    ASSERT_NEAR(value->x, scale * u_half, 1e-5 * scale);
    ASSERT_NEAR(value->y, scale * turn, 1e-5 * scale);
    ASSERT_NEAR(value->z, scale * angle, 1e-5 * scale);
  }
}

TEST(RglBrdf, NoSampleWhereTheDistributionVanishes) {
  const std::string file = test::rgl_file(test::small_rgl_fields(0, 0.5f, {1, 1, 1}));
  EXPECT_FALSE(RglBrdf(bytes_of(file), "f").at({0, 0, 1}, {0, 0, 1}).has_value());
}

TEST(RglBrdf, RefusesWhatIsNoSuchFile) {
  const auto error = [](const std::string& file) {
    return test::error_of([&] { RglBrdf(bytes_of(file), "f"); });
  };
  const auto with = [&](const auto& change) {
    auto fields = test::small_rgl_fields(1, 1, {1, 1, 1});
    change(fields);
    return error(test::rgl_file(fields));
  };
  EXPECT_EQ(with([](auto&) {}), "no error");
  EXPECT_NE(error(""), "no error");
  const std::string good = test::rgl_file(test::small_rgl_fields(1, 1, {1, 1, 1}));
  for (std::size_t size = 0; size < good.size(); size += 3) {
    ASSERT_NE(error(good.substr(0, size)), "no error") << size;
  }
  std::string other = good;
  other[12] = 2;
  EXPECT_EQ(error(other), "f: found version 2.0, expected version 1.0");
  EXPECT_NE(with([](auto& f) { f.pop_back(); }), "no error");  // spectral: no rgb
  EXPECT_NE(with([](auto& f) { f[0] = {"phi_i", {4}, {0, 1, 2, 3}}; }), "no error");  // anisotropic
  EXPECT_NE(with([](auto& f) { f[1].values = {0, 2, 1}; }), "no error");
  EXPECT_NE(with([](auto& f) { f[3].shape = {400, 5}; }), "no error");  // beyond the end
  EXPECT_NE(with([](auto& f) { f[3].shape = {1, 16}; }), "no error");
  EXPECT_NE(with([](auto& f) { f[4].shape = {1, 2, 9, 7}; }), "no error");
  EXPECT_NE(with([](auto& f) { f[4].type = 11; }), "no error");
  EXPECT_NE(with([](auto& f) { f[4].type = 12; }), "no error");
  EXPECT_NE(with([](auto& f) { f[2].values[3] = std::numeric_limits<float>::infinity(); }),
            "no error");
  // 2^64 / 4 floats and more: products of sizes that do not fit.
  const std::uint64_t huge = std::uint64_t{1} << 62;
  EXPECT_NE(with([&](auto& f) { f[3].shape = {huge, 4}; }), "no error");
  EXPECT_NE(with([&](auto& f) { f[3].shape = {0, huge}; }), "no error");
}

}  // namespace
}  // namespace rimlight
