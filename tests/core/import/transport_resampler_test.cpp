// Resampling from directions to texels: energy, and the light that it amounts to.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/base/aligned_vector.h"
#include "core/image/metrics.h"
#include "core/import/resampling_error.h"
#include "core/import/transport_resampler.h"
#include "core/light/environment.h"
#include "tests/core/import/direction_sets.h"

namespace rimlight {
namespace {

AlignedVector<float> random_rows(std::size_t directions, std::uint64_t seed) {
  AlignedVector<float> rows(directions * kRowLanes);
  Random random(seed);
  for (float& value : rows) value = random.uniform_float();
  return rows;
}

CubeLight random_light(int size, std::uint64_t seed) {
  CubeLight light(size);
  Random random(seed);
  for (float& value : light.values) value = random.uniform_float();
  return light;
}

std::vector<double> areas_of(const DirectionCells& cells) {
  std::vector<double> areas;
  for (std::size_t i = 0; i < cells.direction_count(); ++i) areas.push_back(cells.solid_angle(i));
  return areas;
}

/// Σ_t light_t · texel_t for one lane of one channel.
double under_light(const GroupRows& texels, const CubeLight& light, int channel, std::size_t lane) {
  double sum = 0;
  for (std::size_t texel = 0; texel < light.count(); ++texel) {
    sum += static_cast<double>(light.at(texel)[channel]) *
           static_cast<double>(
               texels.row(texel)[static_cast<std::size_t>(channel) * kGroupLanes + lane]);
  }
  return sum;
}

/// Fewer directions than texels, and more.
class Resampler : public ::testing::TestWithParam<int> {};

TEST_P(Resampler, AUniformEnvironmentGivesTheWeightedSumOfTheColumns) {
  const auto directions = random_directions(GetParam(), 3);
  const DirectionCells cells(directions, 8);
  std::vector<double> weights;
  Random random(4);
  for (std::size_t i = 0; i < directions.size(); ++i) weights.push_back(random.uniform(0.01, 2));
  const auto rows = random_rows(directions.size(), 5);
  GroupRows texels(8);
  std::fill(texels.values.begin(), texels.values.end(), 7.0f);  // overwritten
  TransportResampler(cells, weights).resample(rows, texels);
  CubeLight uniform(8);
  std::fill(uniform.values.begin(), uniform.values.end(), 1.0f);
  for (int channel = 0; channel < 3; ++channel) {
    for (std::size_t lane = 0; lane < kGroupLanes; lane += 7) {
      double expected = 0;
      for (std::size_t i = 0; i < directions.size(); ++i) {
        expected +=
            weights[i] *
            static_cast<double>(
                rows[i * kRowLanes + static_cast<std::size_t>(channel) * kGroupLanes + lane]);
      }
      EXPECT_NEAR(under_light(texels, uniform, channel, lane) / expected, 1, 1e-5);
    }
  }
}

TEST_P(Resampler, LightOfDirectionsIsWhatTheTexelsAnswer) {
  const auto directions = random_directions(GetParam(), 6);
  const DirectionCells cells(directions, 8);
  const TransportResampler resampler(cells, areas_of(cells));
  const auto rows = random_rows(directions.size(), 7);
  const CubeLight light = random_light(8, 8);
  GroupRows texels(8);
  resampler.resample(rows, texels);
  const auto values = resampler.light_of_directions(light);
  ASSERT_EQ(values.size(), directions.size());
  for (int channel = 0; channel < 3; ++channel) {
    for (std::size_t lane = 0; lane < kGroupLanes; lane += 5) {
      double expected = 0;
      for (std::size_t i = 0; i < values.size(); ++i) {
        expected +=
            static_cast<double>(values[i][channel]) *
            static_cast<double>(
                rows[i * kRowLanes + static_cast<std::size_t>(channel) * kGroupLanes + lane]);
      }
      EXPECT_NEAR(under_light(texels, light, channel, lane) / expected, 1, 1e-5);
    }
  }
}

TEST_P(Resampler, ConstantTransportStaysConstant) {
  const auto directions = random_directions(GetParam(), 9);
  const DirectionCells cells(directions, 8);
  const AlignedVector<float> rows(directions.size() * kRowLanes, 0.5f);
  GroupRows texels(8);
  TransportResampler(cells, areas_of(cells)).resample(rows, texels);
  for (std::size_t texel = 0; texel < cube::texel_count(8); ++texel) {
    const double expected = 0.5 * cube::texel_solid_angle(texel, 8);
    EXPECT_NEAR(static_cast<double>(texels.row(texel)[77]) / expected, 1, 1e-5);
  }
}

INSTANTIATE_TEST_SUITE_P(Counts, Resampler, ::testing::Values(1, 40, 3000));

TEST(TransportResampler, ACosineComesNearItsIntegralAsDirectionsGetMore) {
  // ∫ max(cos, 0)/π dω = 1: what Voronoi areas are worth as weights.
  const Vec3d normal = normalized(Vec3d(0.3, 0.9, -0.2));
  double last = 1;
  for (const int count : {100, 1000, 10'000}) {
    const auto directions = random_directions(count, 11);
    const DirectionCells cells(directions, 32);
    const auto weights = areas_of(cells);
    double total = 0;
    for (std::size_t i = 0; i < directions.size(); ++i) {
      total += weights[i] * std::max(dot(normal, directions[i]), 0.0) / std::numbers::pi;
    }
    EXPECT_LT(std::abs(total - 1), last);
    last = std::abs(total - 1);
  }
  EXPECT_LT(last, 1e-3);
}

/// Two groups of pixels of random numbers.
class RandomSource : public TransportSource {
 public:
  explicit RandomSource(std::size_t directions) : directions_(directions) {}
  PixelLayout pixels() const override { return {12, 7}; }
  std::size_t direction_count() const override { return directions_; }
  void read_group(std::size_t first_receiver, std::span<float> rows) const override {
    const auto values = random_rows(directions_, first_receiver);
    std::copy(values.begin(), values.end(), rows.begin());
  }

 private:
  std::size_t directions_;
};

TEST(ResamplingError, IsThatOfPicturesFromBothLights) {
  constexpr std::size_t kDirections = 20;
  const RandomSource source(kDirections);
  const PixelLayout pixels = source.pixels();
  std::vector<float> coverage(pixels.receiver_count());
  for (std::size_t i = 0; i < coverage.size(); ++i) {
    const auto [x, y] = pixels.pixel(i);
    coverage[i] = x < 12 && y < 7 && x != 5 ? 1.0f : 0.0f;
  }
  ResampledLight light{"one", {}, {}};
  Random random(31);
  for (std::size_t i = 0; i < kDirections; ++i) {
    const float value = random.uniform_float();
    light.direct.emplace_back(value, 2 * value, value);
    light.resampled.emplace_back(value + 0.02f * random.uniform_float(), 2 * value, value);
  }
  ResampledLight same{"same", light.direct, light.direct};
  const auto errors = measure_resampling(source, coverage, {light, same});
  ASSERT_EQ(errors.size(), 2u);
  EXPECT_EQ(errors[1].light, "same");
  EXPECT_EQ(errors[1].relative_l2, 0);
  EXPECT_EQ(errors[1].psnr_db, 99);

  std::vector<Vec3f> direct, resampled;
  for (std::size_t receiver = 0; receiver < coverage.size(); ++receiver) {
    if (coverage[receiver] == 0) continue;
    const std::size_t lane = receiver % kGroupLanes;
    const auto rows = random_rows(kDirections, receiver - lane);
    Vec3d a, b;
    for (std::size_t i = 0; i < kDirections; ++i) {
      const Vec3d m(Vec3f(rows[i * kRowLanes + lane], rows[i * kRowLanes + kGroupLanes + lane],
                          rows[i * kRowLanes + 2 * kGroupLanes + lane]));
      a += m * Vec3d(light.direct[i]);
      b += m * Vec3d(light.resampled[i]);
    }
    direct.emplace_back(a);
    resampled.emplace_back(b);
  }
  EXPECT_EQ(direct.size(), 11u * 7u);
  EXPECT_NEAR(errors[0].relative_l2, relative_l2(resampled, direct), 1e-6);
  EXPECT_NEAR(errors[0].psnr_db, display_psnr(resampled, direct, auto_exposure_scale(direct)), 0.1);
  EXPECT_GT(errors[0].relative_l2, 1e-4);
}

}  // namespace
}  // namespace rimlight
