#include "core/report/transport_errors.h"

#include <gtest/gtest.h>

#include <cmath>

#include "core/bake/reference_output.h"
#include "core/basis/cube_map.h"
#include "core/light/environment.h"
#include "tests/support/ball_source.h"
#include "tests/support/temporary_folder.h"

namespace rimlight {
namespace {

using test::BallSource;

constexpr int kSide = 64, kSize = 8;
constexpr std::size_t kReceivers = kSide * kSide;

CubeLight coefficients_of(CubeLight texels) {
  const CubeHaar haar(texels.size);
  CubeLight result(texels.size);
  for (int c = 0; c < 3; ++c) haar.forward(texels.channel(c), result.channel(c));
  return result;
}

CubeLight sunny(int size) { return coefficients_of(builtin_environment("sunny").project(size)); }

/// The image of one in kGroupsPerCheck of the groups, with what `source` makes of them: [receiver].
std::vector<Vec3d> image_of(const Bake& bake, const BallSource& source, const CubeLight& light) {
  const auto rows = ReferenceRows::open(bake);
  std::vector<Vec3d> image;
  BakedGroup group(source.cube_size());
  for (std::size_t i = 0; i < rows->groups().size(); i += kGroupsPerCheck) {
    source.find_rows(rows->groups()[i], group);
    for (std::size_t lane = 0; lane < kGroupLanes; ++lane) {
      Vec3d sum;
      for (std::size_t column = 0; column < light.count(); ++column) {
        const float* const row = group.coefficients.row(column) + lane;
        const Vec3f of_light = light.at(column);
        sum = sum + Vec3d{double{row[0]} * of_light.x, double{row[kGroupLanes]} * of_light.y,
                          double{row[2 * kGroupLanes]} * of_light.z};
      }
      image.push_back(sum);
    }
  }
  return image;
}

double relative_distance(const std::vector<Vec3d>& a, const std::vector<Vec3d>& b) {
  double distance = 0, size = 0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    distance += dot(a[i] - b[i], a[i] - b[i]);
    size += dot(b[i], b[i]);
  }
  return std::sqrt(distance / size);
}

TEST(TransportErrors, NoiseIsThatOfOneTraceAsTwoTell) {
  const test::TemporaryFolder folder;
  const BallSource truth(kSide, kSize), first(kSide, kSize, 0.1, 1), second(kSide, kSize, 0.1, 2);
  bake_ball(folder / "ball.bake", first, kReceivers, &second);
  const Bake bake(folder / "ball.bake");
  const TransportErrors errors(bake);
  EXPECT_EQ(errors.finer_size(), 0);
  const std::vector<CubeLight> lights = {sunny(kSize), CubeLight(kSize)};
  const auto found = errors.find(lights, {});
  ASSERT_TRUE(found[0].noise);
  const double expected =
      relative_distance(image_of(bake, first, lights[0]), image_of(bake, truth, lights[0]));
  EXPECT_GT(expected, 0.01);
  // Two draws of the same noise differ: some 300 receivers, each a sum of a few bright texels.
  EXPECT_NEAR(*found[0].noise, expected, 0.15 * expected);
  EXPECT_FALSE(found[0].resolution);
  EXPECT_FALSE(found[1].noise) << "a black image has no relative error";
}

TEST(TransportErrors, AreZeroOfTransportWithoutNoise) {
  const test::TemporaryFolder folder;
  const BallSource source(kSide, kSize);
  bake_ball(folder / "ball.bake", source, kReceivers, &source);
  const Bake bake(folder / "ball.bake");
  const std::vector<CubeLight> lights = {sunny(kSize)};
  EXPECT_EQ(TransportErrors(bake).find(lights, {})[0].noise, 0.0);
}

TEST(TransportErrors, OfResolutionIsWhatTexelsOfHalfTheSizeMake) {
  const test::TemporaryFolder folder;
  const BallSource source(kSide, kSize), finer(kSide, 2 * kSize);
  bake_ball(folder / "ball.bake", source, kReceivers, nullptr, &finer);
  const Bake bake(folder / "ball.bake");
  const TransportErrors errors(bake);
  ASSERT_EQ(errors.finer_size(), 2 * kSize);
  const CubeLight fine = sunny(2 * kSize);
  const std::vector<CubeLight> lights = {sunny(kSize)}, finer_lights = {fine};
  const auto found = errors.find(lights, finer_lights);
  // The light without its finest band has the mean of four texels in each of them.
  CubeLight coarse = fine;
  for (int c = 0; c < 3; ++c) {
    const auto channel = coarse.channel(c);
    std::fill(channel.begin() + static_cast<std::ptrdiff_t>(cube::texel_count(kSize)),
              channel.end(), 0.0f);
  }
  const auto whole = image_of(bake, finer, fine), averaged = image_of(bake, finer, coarse);
  const double expected = relative_distance(averaged, whole);
  EXPECT_GT(expected, 1e-3);
  ASSERT_TRUE(found[0].resolution);
  EXPECT_NEAR(*found[0].resolution, expected, 0.05 * expected);  // norms of N and of 2N
  EXPECT_FALSE(found[0].noise);
}

TEST(TransportErrors, AreUnknownOfABakeWithoutSecondRows) {
  const test::TemporaryFolder folder;
  const BallSource source(kSide, kSize);
  const std::vector<CubeLight> lights = {sunny(kSize)};
  for (const std::size_t receivers : {std::size_t{0}, kReceivers}) {
    const auto path = folder / ("ball" + std::to_string(receivers) + ".bake");
    bake_ball(path, source, receivers);
    const Bake bake(path);
    const auto found = TransportErrors(bake).find(lights, {});
    EXPECT_FALSE(found[0].noise || found[0].resolution);
  }
}

}  // namespace
}  // namespace rimlight
