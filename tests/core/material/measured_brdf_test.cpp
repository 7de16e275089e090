#include "core/material/measured_brdf.h"

#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <numbers>

#include "core/material/factorization.h"
#include "core/math/random.h"
#include "core/math/sampling.h"
#include "tests/support/brdf_files.h"
#include "tests/support/error_of.h"
#include "tests/support/real_data.h"
#include "tests/support/temporary_folder.h"

namespace rimlight {
namespace {

Vec3d albedo(const MeasuredBrdf& brdf, double cosine) {
  constexpr int kSamples = 4000;
  Random random(81);
  const Vec3d in{std::sqrt(1 - cosine * cosine), 0, cosine};
  Vec3d sum;
  for (int i = 0; i < kSamples; ++i) {
    const auto value = brdf.at(in, cosine_hemisphere(random_sample(random)));
    if (value) sum += *value * (std::numbers::pi / kSamples);
  }
  return sum;
}

void write(const std::filesystem::path& path, const std::string& bytes) {
  std::ofstream(path, std::ios::binary) << bytes;
}

TEST(MeasuredBrdf, IsReadByTheEndingOfItsName) {
  const test::TemporaryFolder folder;
  write(folder.path() / "a.binary", test::merl_file([](int, std::size_t) { return 3.0; }));
  write(folder.path() / "a.brdf", test::cornell_file({500}, {{{0.1, 0, 0.1, 0}, {0.002}}}));
  write(folder.path() / "a.bsdf", test::rgl_file(test::small_rgl_fields(1, 125, {1, 1, 1})));
  for (const char* const name : {"a.binary", "a.brdf", "a.bsdf"}) {
    const auto brdf = load_measured_brdf(folder.path() / name);
    const auto value = brdf->at(HalfDifference{0.05, 0.05, 0.1});
    ASSERT_TRUE(value.has_value()) << name;
    EXPECT_NEAR(value->x, 0.002, 1e-5) << name;
  }
}

TEST(MeasuredBrdf, RefusesOtherFiles) {
  const test::TemporaryFolder folder;
  write(folder.path() / "a.txt", "1");
  write(folder.path() / "short.binary", "90 90 180");
  const auto error = [&](const char* name) {
    return test::error_of([&] { load_measured_brdf(folder.path() / name); });
  };
  EXPECT_NE(error("a.txt").find("expected .binary, .brdf or .bsdf"), std::string::npos);
  EXPECT_NE(error("short.binary").find("9 bytes"), std::string::npos);
  EXPECT_NE(error("none.bsdf"), "no error");
  std::filesystem::create_directory(folder.path() / "folder.brdf");
  EXPECT_NE(error("folder.brdf"), "no error");
}

TEST(MeasuredBrdf, RealMaterialsHaveTheirColoursAndFit) {
  const auto data = test::real_data();
  if (!data) GTEST_SKIP() << "no real data";
  const auto paper = load_measured_brdf(*data / "brdf/paper_white_rgb.bsdf");
  for (const double cosine : {1.0, 0.6, 0.3}) {
    const Vec3d share = albedo(*paper, cosine);
    EXPECT_GT(share.x, 0.7);
    EXPECT_LT(share.z, 1.05);
  }
  const auto blue = load_measured_brdf(*data / "brdf/acryl_blue.brdf");
  const auto red = load_measured_brdf(*data / "brdf/garnet_red.brdf");
  EXPECT_GT(albedo(*blue, 0.8).z, 5 * albedo(*blue, 0.8).x);
  EXPECT_GT(albedo(*red, 0.8).x, 2 * albedo(*red, 0.8).z);
  const FactoredBrdf fit = factorize(*paper, "paper");
  EXPECT_LT(fit.error.logarithmic.y, 0.1);  // paper is nearly Lambert's
}

}  // namespace
}  // namespace rimlight
