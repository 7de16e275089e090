#include "core/transport/receiver_planes.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "core/base/aligned_vector.h"
#include "core/math/random.h"
#include "tests/support/reference/pixel_haar.h"

namespace rimlight {
namespace {

constexpr std::size_t kLanes = PixelLayout::kGroupReceivers;
constexpr std::size_t kColumns = 90;
using Rows = std::vector<float>;
using Reflectance = std::array<float, kGroupFloats>;

/// M of a textured group: colour of the pixel times something smooth, and a little of its own.
Rows random_rows(std::uint64_t seed, double own) {
  Rows rows(kColumns * kGroupFloats);
  for (std::size_t column = 0; column < kColumns; ++column) {
    for (std::size_t i = 0; i < kGroupFloats; ++i) {
      Random of_pixel(seed, i), of_column(seed, 1000 + column),
          of_entry(seed, 9000 + column * 777 + i);
      const double albedo = of_pixel.uniform(0.05, 1);
      rows[column * kGroupFloats + i] =
          static_cast<float>(albedo * (of_column.uniform(-1, 1) + own * of_entry.uniform(-1, 1)));
    }
  }
  return rows;
}

Reflectance reflectance_of(const Rows& rows) {
  Reflectance reflectance;
  find_reflectance(rows, reflectance);
  return reflectance;
}

/// Planes back to M, by the definitions.
std::vector<double> decode(const Rows& planes, const Reflectance& reflectance) {
  std::vector<double> rows(planes.size());
  for (std::size_t at = 0; at < planes.size(); at += kGroupFloats) {
    for (std::size_t lane = 0; lane < kLanes; ++lane) {
      for (std::size_t c = 0; c < 3; ++c) {
        double sum = 0;
        for (std::size_t plane = 0; plane < kPlanes; ++plane) {
          const double factor = kPlaneFactors[plane][static_cast<int>(c)];
          for (std::size_t i = 0; i < kLanes; ++i) {
            sum += factor * static_cast<double>(planes[at + plane * kLanes + i]) *
                   reference::pixel_haar_function(i, lane);
          }
        }
        rows[at + c * kLanes + lane] = sum * static_cast<double>(reflectance[c * kLanes + lane]);
      }
    }
  }
  return rows;
}

TEST(ReceiverPlanes, FactorsHaveOneLengthAndLumaIsLikeAllChannels) {
  for (const Vec3f& factor : kPlaneFactors) EXPECT_NEAR(dot(factor, factor), 3, 1e-6);
  EXPECT_EQ(kPlaneFactors[0], Vec3f(1, 1, 1));
}

TEST(ReceiverPlanes, DecodeToTheRowsTheyWereMadeOf) {
  for (const double own : {0.0, 0.1, 3.0}) {
    const Rows rows = random_rows(1, own);
    const Reflectance reflectance = reflectance_of(rows);
    Rows planes = rows;
    to_planes(planes, reflectance);
    const auto decoded = decode(planes, reflectance);
    for (std::size_t i = 0; i < rows.size(); ++i) {
      ASSERT_NEAR(decoded[i], rows[i], 2e-5 * (1 + own)) << i;
    }
  }
}

TEST(ReceiverPlanes, WithoutAnythingOfItsOwnAColumnIsOneNumber) {
  Rows planes = random_rows(2, 0);
  to_planes(planes, reflectance_of(planes));
  for (std::size_t at = 0; at < planes.size(); at += kGroupFloats) {
    for (std::size_t i = 1; i < kGroupFloats; ++i) {
      ASSERT_LE(std::abs(planes[at + i]), 1e-6 * std::abs(planes[at])) << at << " " << i;
    }
  }
}

TEST(ReceiverPlanes, ReflectanceHasAMeanSquareOfOneAndFollowsTheRowsSize) {
  Rows rows = random_rows(3, 0.2);
  const Reflectance before = reflectance_of(rows);
  double square = 0;
  for (const float value : before) square += value * value;
  EXPECT_NEAR(square / kGroupFloats, 1, 1e-5);
  for (float& value : rows) value *= 1e-9f;  // units do not matter
  const Reflectance scaled = reflectance_of(rows);
  for (std::size_t i = 0; i < kGroupFloats; ++i) ASSERT_NEAR(scaled[i], before[i], 1e-5);
  // A pixel far darker than the others keeps a part of its darkness in T.
  for (std::size_t at = 0; at < rows.size(); at += kGroupFloats) rows[at + 9] *= 1e-6f;
  EXPECT_EQ(reflectance_of(rows)[9], kLeastReflectance);
}

TEST(ReceiverPlanes, PixelsWithoutTransportCostNothing) {
  Rows rows = random_rows(4, 0);
  for (std::size_t at = 0; at < rows.size(); at += kLanes) {
    for (const std::size_t lane : {0u, 7u, 8u, 33u, 63u}) rows[at + lane] = 0;
  }
  const Reflectance reflectance = reflectance_of(rows);
  for (const std::size_t lane : {0u, 7u, 8u, 33u, 63u}) EXPECT_EQ(reflectance[kLanes + lane], 0);
  Rows planes = rows;
  to_planes(planes, reflectance);
  for (std::size_t at = 0; at < planes.size(); at += kGroupFloats) {
    for (std::size_t i = 1; i < kGroupFloats; ++i) {
      ASSERT_LE(std::abs(planes[at + i]), 1e-6 * std::abs(planes[at]));
    }
  }
  const auto decoded = decode(planes, reflectance);
  for (std::size_t i = 0; i < rows.size(); ++i) ASSERT_NEAR(decoded[i], rows[i], 1e-5);
}

TEST(ReceiverPlanes, NothingStaysNothing) {
  Rows rows(kColumns * kGroupFloats);
  const Reflectance reflectance = reflectance_of(rows);
  EXPECT_TRUE(std::ranges::all_of(reflectance, [](float value) { return value == 0; }));
  to_planes(rows, reflectance);
  EXPECT_TRUE(std::ranges::all_of(rows, [](float value) { return value == 0; }));
}

TEST(ReceiverPlanes, AChannelWithoutTransportIsKeptBlack) {
  Rows rows = random_rows(6, 0.5);
  for (std::size_t at = 0; at < rows.size(); at += kGroupFloats) rows[at + kLanes + 12] = 0;
  Rows planes = rows;
  const Reflectance reflectance = reflectance_of(rows);
  EXPECT_EQ(reflectance[kLanes + 12], 0);
  to_planes(planes, reflectance);
  const auto decoded = decode(planes, reflectance);
  for (std::size_t i = 0; i < rows.size(); ++i) ASSERT_NEAR(decoded[i], rows[i], 4e-5);
}

TEST(RestoreRadiance, IsTheReferencesSum) {
  Random random(8);
  AlignedVector<float> held(kTileFloats), reflectance(kTileFloats);
  for (float& value : held) value = static_cast<float>(random.uniform(-1, 1));
  for (float& value : reflectance) value = static_cast<float>(random.uniform(0, 2));
  const std::vector<double> before(held.begin(), held.end());
  const auto expected = reference::restore_radiance(before, reflectance, false);
  restore_radiance(std::span<float, kTileFloats>(held),
                   std::span<const float, kTileFloats>(reflectance));
  for (std::size_t i = 0; i < kTileFloats; ++i) ASSERT_NEAR(held[i], expected[i], 8e-6) << i;
}

}  // namespace
}  // namespace rimlight
