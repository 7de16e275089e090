#include "core/basis/daubechies_interval.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "core/base/check.h"
#include "core/math/random.h"

namespace rimlight {
namespace {

using Vector = std::vector<double>;

Vector random_values(std::size_t count, std::uint64_t seed) {
  Random random(seed);
  Vector values(count);
  for (double& value : values) value = random.uniform(-1, 1);
  return values;
}

Vector forward(const DaubechiesInterval& basis, Vector samples, std::size_t lanes = 1) {
  Vector coefficients(samples.size());
  basis.forward(samples, coefficients, lanes);
  return coefficients;
}

Vector inverse(const DaubechiesInterval& basis, const Vector& coefficients, std::size_t lanes = 1) {
  Vector samples(coefficients.size());
  basis.inverse(coefficients, samples, lanes);
  return samples;
}

Vector unit(std::size_t size, std::size_t at) {
  Vector vector(size);
  vector[at] = 1;
  return vector;
}

/// The basis functions, row by row, as the inverse makes them.
std::vector<Vector> functions(const DaubechiesInterval& basis) {
  std::vector<Vector> rows;
  for (std::size_t j = 0; j < basis.size(); ++j) {
    rows.push_back(inverse(basis, unit(basis.size(), j)));
  }
  return rows;
}

double dot_product(const Vector& a, const Vector& b) {
  double sum = 0;
  for (std::size_t i = 0; i < a.size(); ++i) sum += a[i] * b[i];
  return sum;
}

const std::vector<std::size_t> kSizes{4, 8, 16, 32, 256, 512};

TEST(DaubechiesInterval, IsOrthonormal) {
  for (const std::size_t size : kSizes) {
    const std::vector<Vector> rows = functions(DaubechiesInterval(size));
    double worst = 0;
    for (std::size_t i = 0; i < size; ++i) {
      for (std::size_t j = 0; j <= i; ++j) {
        worst = std::max(worst, std::abs(dot_product(rows[i], rows[j]) - (i == j ? 1 : 0)));
      }
    }
    EXPECT_LT(worst, 1e-12) << size;
    RecordProperty("worst_" + std::to_string(size), std::to_string(worst));
  }
}

TEST(DaubechiesInterval, ForwardTakesProductsWithTheBasisFunctions) {
  for (const std::size_t size : kSizes) {
    const DaubechiesInterval basis(size);
    const std::vector<Vector> rows = functions(basis);
    const Vector samples = random_values(size, 1);
    const Vector coefficients = forward(basis, samples);
    for (std::size_t j = 0; j < size; ++j) {
      ASSERT_NEAR(coefficients[j], dot_product(rows[j], samples), 1e-12) << size << ", " << j;
    }
  }
}

TEST(DaubechiesInterval, ConstantsAndLinesHaveNoDetailsAtTheEndsToo) {
  for (const std::size_t size : kSizes) {
    const DaubechiesInterval basis(size);
    Vector line(size);
    for (std::size_t i = 0; i < size; ++i) line[i] = 3 - 0.7 * static_cast<double>(i);
    const Vector of_constant = forward(basis, Vector(size, 2.5)), of_line = forward(basis, line);
    const double root = std::sqrt(static_cast<double>(size));
    EXPECT_NEAR(of_constant[0], 2.5 * root, 1e-11);
    EXPECT_NEAR(of_constant[1], 0, 1e-11);
    EXPECT_LT(of_line[1], -0.1);
    for (std::size_t j = 2; j < size; ++j) {
      ASSERT_NEAR(of_constant[j], 0, 1e-12 * root) << size << ", " << j;
      // The line reaches 0.7 · size.
      ASSERT_NEAR(of_line[j], 0, 1e-12 * root * static_cast<double>(size)) << size << ", " << j;
    }
    // A parabola is no line: the test can tell.
    for (double& x : line) x *= x;
    EXPECT_GT(std::abs(forward(basis, line)[3]), 0.1);
  }
}

TEST(DaubechiesInterval, InverseUndoesForward) {
  for (const std::size_t size : kSizes) {
    const DaubechiesInterval basis(size);
    const Vector samples = random_values(size, 2);
    const Vector back = inverse(basis, forward(basis, samples));
    for (std::size_t i = 0; i < size; ++i) ASSERT_NEAR(back[i], samples[i], 1e-13) << size;
    std::vector<float> single(samples.begin(), samples.end()), scratch = single;
    std::vector<float> coefficients(size), again(size);
    basis.forward(scratch, coefficients);
    basis.inverse(coefficients, again);
    // 2 · 5 · log2(512) rounded operations on values below √512.
    for (std::size_t i = 0; i < size; ++i) ASSERT_NEAR(again[i], single[i], 1e-4) << size;
  }
}

TEST(DaubechiesInterval, InnerRowsAreDaubechiesFilters) {
  // Daubechies (1988): (1 ± √3) and (3 ± √3), over 4√2. The finest wavelet in the middle has the
  // mirrored ones, with alternating signs.
  const DaubechiesInterval basis(64);
  const Vector wavelet = inverse(basis, unit(64, 32 + 10));
  const double root3 = std::sqrt(3.0), scale = 1 / (4 * std::sqrt(2.0));
  const Vector expected{(1 - root3) * scale, -(3 - root3) * scale, (3 + root3) * scale,
                        -(1 + root3) * scale};
  for (std::size_t i = 0; i < 64; ++i) {
    const double tap = i >= 19 && i < 23 ? expected[i - 19] : 0;
    EXPECT_NEAR(wavelet[i], tap, 1e-15) << i;
  }
}

// A wavelet of band b reaches over less than five of its steps, and its middle lies where its
// position says: curves bent at one place change few coefficients.
TEST(DaubechiesInterval, IsLocal) {
  const DaubechiesInterval basis(256);
  for (int band = 0; band < basis.band_count(); ++band) {
    const std::size_t wavelets = std::size_t{2} << band, step = basis.band_step(band);
    for (std::size_t position = 0; position < wavelets; ++position) {
      const Vector row = inverse(basis, unit(256, wavelets + position));
      const auto is_there = [](double x) { return std::abs(x) > 1e-13; };
      const auto first = std::find_if(row.begin(), row.end(), is_there) - row.begin();
      const auto last = row.rend() - std::find_if(row.rbegin(), row.rend(), is_there);
      EXPECT_LE(static_cast<std::size_t>(last - first), 5 * step) << band << ", " << position;
      const double middle = 0.5 * static_cast<double>(first + last);
      const double wanted = (static_cast<double>(position) + 0.5) * static_cast<double>(step);
      EXPECT_NEAR(middle, wanted, 3.0 * static_cast<double>(step)) << band << ", " << position;
    }
  }
}

TEST(DaubechiesInterval, AnEndDoesNotShowAtTheOther) {
  const DaubechiesInterval basis(256);
  const Vector coefficients = forward(basis, unit(256, 255));
  const Vector left_end = unit(256, 0);
  // Only the coarsest bands, whose wavelets reach over the whole curve, know both ends.
  for (int band = 3; band < basis.band_count(); ++band) {
    Vector detail(256);
    for (std::size_t j = basis.band_begin(band); j < basis.band_begin(band + 1); ++j) {
      detail[j] = coefficients[j];
    }
    EXPECT_NEAR(dot_product(inverse(basis, detail), left_end), 0, 1e-14) << band;
    EXPECT_GT(dot_product(detail, detail), 1e-6) << band;
  }
}

TEST(DaubechiesInterval, BandsCoverTheCoefficientsInOrder) {
  for (const std::size_t size : kSizes) {
    const DaubechiesInterval basis(size);
    EXPECT_EQ(basis.band_begin(0), 0u);
    EXPECT_EQ(basis.band_begin(basis.band_count()), size);
    for (int band = 0; band < basis.band_count(); ++band) {
      EXPECT_EQ(basis.band_of(basis.band_begin(band)), band);
      EXPECT_EQ(basis.band_of(basis.band_begin(band + 1) - 1), band);
      EXPECT_EQ(basis.band_step(band) * (std::size_t{2} << band), size);
    }
  }
  EXPECT_EQ(DaubechiesInterval(256).band_count(), 7);
}

TEST(DaubechiesInterval, ManyLanesEqualEachLaneAlone) {
  const DaubechiesInterval basis(32);
  for (const std::size_t lanes : {2u, 8u, 13u}) {
    const Vector samples = random_values(32 * lanes, 3);
    const Vector together = forward(basis, samples, lanes);
    const Vector back = inverse(basis, together, lanes);
    for (std::size_t lane = 0; lane < lanes; ++lane) {
      Vector alone(32);
      for (std::size_t i = 0; i < 32; ++i) alone[i] = samples[i * lanes + lane];
      const Vector coefficients = forward(basis, alone);
      const Vector alone_back = inverse(basis, coefficients);
      for (std::size_t i = 0; i < 32; ++i) {
        ASSERT_EQ(together[i * lanes + lane], coefficients[i]) << lanes;
        ASSERT_EQ(back[i * lanes + lane], alone_back[i]) << lanes;
      }
    }
  }
}

TEST(DaubechiesInterval, ZeroSpikeAndLargeCurvesStayFinite) {
  const DaubechiesInterval basis(256);
  for (const double c : forward(basis, Vector(256))) EXPECT_EQ(c, 0);
  Vector steps(256);
  for (std::size_t i = 0; i < 256; ++i) steps[i] = i % 7 == 0 ? 1e6 : 0;
  const Vector back = inverse(basis, forward(basis, steps));
  for (std::size_t i = 0; i < 256; ++i) ASSERT_NEAR(back[i], steps[i], 1e-7);
}

TEST(DaubechiesInterval, RefusesSizesThatAreNoPowerOfTwo) {
  for (const std::size_t size : {0u, 1u, 2u, 3u, 12u, 257u}) {
    EXPECT_THROW(DaubechiesInterval{size}, CheckFailure) << size;
  }
  const DaubechiesInterval basis(8);
  Vector right(8), wrong(7);
  EXPECT_THROW(basis.forward(wrong, right), CheckFailure);
  EXPECT_THROW(basis.inverse(right, wrong), CheckFailure);
}

}  // namespace
}  // namespace rimlight
