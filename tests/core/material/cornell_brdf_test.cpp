#include "core/material/cornell_brdf.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "core/material/spectrum.h"
#include "core/math/random.h"
#include "tests/support/brdf_files.h"
#include "tests/support/error_of.h"

namespace rimlight {
namespace {

constexpr double kPi = std::numbers::pi;

Vec3d polar(double theta, double phi) {
  return {std::sin(theta) * std::cos(phi), std::sin(theta) * std::sin(phi), std::cos(theta)};
}

/// Grey samples over the hemisphere with values of a smooth lobe.
double smooth(const Vec3d& in, const Vec3d& out) {
  return 0.1 + std::pow(normalized(in + out).z, 20);
}

std::vector<test::CornellLine> scattered_lines(std::size_t count) {
  Random random(51);
  std::vector<test::CornellLine> lines;
  while (lines.size() < count) {
    const double a = random.uniform(0, 1.4), b = random.uniform(0, 1.4);
    const double turn = random.uniform(-kPi, kPi);
    const double value = smooth(polar(a, 0), polar(b, turn));
    lines.push_back({{a, 0, b, turn}, {value, value}});
  }
  return lines;
}

TEST(CornellBrdf, HasItsSamplesValuesAtThemReciprocalAndMirrored) {
  const auto lines = scattered_lines(300);
  const CornellBrdf brdf(test::cornell_file({450, 650}, lines), "f");
  ASSERT_EQ(brdf.sample_count(), 300u);
  for (const test::CornellLine& line : lines) {
    const Vec3d in = polar(line.angles[0], line.angles[1]);
    const Vec3d out = polar(line.angles[2], line.angles[3]);
    const Vec3d mirrored = polar(line.angles[2], -line.angles[3]);
    for (const auto& value : {brdf.at(in, out), brdf.at(out, in), brdf.at(in, mirrored)}) {
      ASSERT_TRUE(value.has_value());
      for (int c = 0; c < 3; ++c) ASSERT_NEAR((*value)[c], line.values[0], 1e-4);
    }
  }
}

TEST(CornellBrdf, BetweenSamplesFollowsThem) {
  const CornellBrdf brdf(test::cornell_file({450, 650}, scattered_lines(1500)), "f");
  Random random(52);
  double error = 0, sum = 0;
  for (int i = 0; i < 500; ++i) {
    const Vec3d in = polar(random.uniform(0, 1.3), 0);
    const Vec3d out = polar(random.uniform(0, 1.3), random.uniform(-kPi, kPi));
    const auto value = brdf.at(in, out);
    ASSERT_TRUE(value.has_value());
    error += std::abs(value->y - smooth(in, out));
    sum += smooth(in, out);
  }
  EXPECT_LT(error / sum, 0.1);
}

TEST(CornellBrdf, FarFromAllSamplesThereIsNone) {
  const CornellBrdf brdf(test::cornell_file({500}, {{{0.1, 0, 0.1, 0}, {0.5}}}), "f");
  EXPECT_TRUE(brdf.at(polar(0.12, 0), polar(0.1, 0)).has_value());
  EXPECT_FALSE(brdf.at(polar(1.2, 0), polar(1.2, 0)).has_value());
  EXPECT_FALSE(brdf.at(polar(0.1, 0), polar(2, 0)).has_value());
}

TEST(CornellBrdf, NegativeNoiseIsZero) {
  const CornellBrdf brdf(test::cornell_file({480, 510, 540}, {{{0.1, 0, 0.1, 0}, {-0.1, 0.5, 0}}}),
                         "f");
  const auto value = brdf.at(polar(0.1, 0), polar(0.1, 0));
  ASSERT_TRUE(value.has_value());
  EXPECT_GE(value->z, 0);
  EXPECT_NEAR(value->x, 0, 1e-9);  // green is outside of sRGB: its red would be negative
  EXPECT_GT(value->y, 0.03);
}

TEST(CornellBrdf, RefusesWhatIsNoSuchFile) {
  const auto error = [](const std::string& text) {
    return test::error_of([&] { CornellBrdf(text, "f"); });
  };
  EXPECT_EQ(error("1 500 0.1 0 0.1 0 0.5"), "no error");
  EXPECT_EQ(error(""),
            "f: line 1: found the end of the file, expected a number of wavelengths, 1 to 1000");
  EXPECT_NE(error("# only a comment"), "no error");
  EXPECT_NE(error("1001 500"), "no error");
  EXPECT_NE(error("1.5 500 600 0.1 0 0.1 0 0.5 1"), "no error");
  EXPECT_NE(error("2 600 500 0.1 0 0.1 0 0.5 0.5"), "no error");
  EXPECT_NE(error("1 nan 0.1 0 0.1 0 0.5"), "no error");
  EXPECT_EQ(error("1\n500\n"), "f: line 3: found no sample, expected at least one sample");
  EXPECT_EQ(error("1\n500\n0.1 0 0.1 0\n"),
            "f: line 4: found the end of the file, expected a BRDF value within ±1000000");
  EXPECT_EQ(error("1\n500\n0.1 0 2 0 1\n"),
            "f: line 3: found \"2\", expected a polar angle in [0, π/2]");
  EXPECT_NE(error("1 500 0.1 0 0.1 0 inf"), "no error");
  EXPECT_NE(error("1 500 0.1 0 0.1 0 0.5x"), "no error");
  EXPECT_NE(error("1 500 0.1 0 0.1 0 1e7"), "no error");
}

TEST(Spectrum, FlatIsWhiteAtEveryResolution) {
  for (const std::vector<double>& wavelengths :
       {std::vector<double>{550}, std::vector<double>{400, 700},
        std::vector<double>{300, 512, 900}}) {
    const SpectrumToRgb converter(wavelengths);
    const Vec3d rgb = converter.rgb(std::vector<double>(wavelengths.size(), 0.7));
    for (int c = 0; c < 3; ++c) EXPECT_NEAR(rgb[c], 0.7, 1e-12);
  }
}

TEST(Spectrum, ALineIsTheSameAtEveryResolution) {
  std::vector<double> fine, values;
  for (double w = 400; w <= 700; w += 5) {
    fine.push_back(w);
    values.push_back((w - 400) / 300);
  }
  const Vec3d a = SpectrumToRgb(fine).rgb(values);
  const Vec3d b = SpectrumToRgb(std::vector<double>{400, 700}).rgb(std::vector<double>{0, 1});
  for (int c = 0; c < 3; ++c) EXPECT_NEAR(a[c], b[c], 1e-12);
  EXPECT_GT(a.x, a.y);
  EXPECT_GT(a.y, a.z);
}

TEST(Spectrum, ObserverIsTheCies) {
  // CIE 1931, 2°, as tabulated; the fit is good to 2 % of the peak.
  EXPECT_NEAR(colour_matching(555).y, 1.0, 0.02);
  EXPECT_NEAR(colour_matching(600).x, 1.0622, 0.02);
  EXPECT_NEAR(colour_matching(450).z, 1.7721, 0.04);
  EXPECT_NEAR(colour_matching(500).y, 0.323, 0.02);
  EXPECT_NEAR(colour_matching(700).x, 0.0114, 0.02);
}

TEST(Spectrum, PureColoursAreTheirs) {
  const SpectrumToRgb converter(std::vector<double>{450, 540, 620});
  const Vec3d blue = converter.rgb(std::vector<double>{1, 0, 0});
  const Vec3d green = converter.rgb(std::vector<double>{0, 1, 0});
  const Vec3d red = converter.rgb(std::vector<double>{0, 0, 1});
  EXPECT_GT(blue.z, 2 * std::max(blue.x, blue.y));
  EXPECT_GT(green.y, 2 * std::max(green.x, green.z));
  EXPECT_GT(red.x, 2 * std::max(red.y, red.z));
}

}  // namespace
}  // namespace rimlight
