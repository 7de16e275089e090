// The estimate against the true error, computed in double from M and the stored transport.
#include "core/relight/error_estimate.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <array>
#include <cmath>
#include <cstdio>
#include <memory>
#include <string>
#include <vector>

#include "core/math/random.h"
#include "core/relight/policy_settings.h"
#include "tests/support/policy_case.h"
#include "tests/support/random_transport.h"
#include "tests/support/reference/columns.h"
#include "tests/support/reference/pixel_haar.h"

namespace rimlight {
namespace {

constexpr int kSize = 4;
constexpr std::size_t kTiles = 3;
constexpr std::size_t kReceivers = kTiles * kTileReceivers;
const CubeHaar kHaar(kSize);
const std::size_t kColumns = kHaar.coefficient_count();
using Matrix = Eigen::MatrixXd;

/// One channel of all columns: [receiver][column].
Matrix zeros() {
  return Matrix::Zero(static_cast<Eigen::Index>(kReceivers), static_cast<Eigen::Index>(kColumns));
}

/// A transport M, what is stored of it, and its sketch.
class Case {
 public:
  /// `error`: of a number of M, as a share of the root mean square of all.
  Case(std::uint64_t seed, double density, double error)
      : stored_(test::random_transport(
            {.tile_count = kTiles, .column_count = kColumns, .density = density, .seed = seed})),
        reflectance_(kTiles) {
    Random random(seed, 17);
    for (std::size_t i = 0; i < kReceivers; ++i) {
      const auto value = [&] { return static_cast<float>(random.uniform(0.1, 2)); };
      reflectance_.set(i, {value(), value(), value()});
    }
    std::array<Channel, 3> channels;
    fill_stored(channels);
    fill_error(error, random, channels);
    for (std::size_t c = 0; c < 3; ++c) {
      Matrix both(kReceivers, 2 * kColumns);
      both << channels[c].error, channels[c].stored;
      products_[c] = Matrix::Zero(both.cols(), both.cols());
      products_[c].selfadjointView<Eigen::Lower>().rankUpdate(both.transpose());
    }
    SketchSums sums(kColumns, 1e-7f);
    for (std::size_t first = 0; first < kReceivers; first += 64) {
      sums.add_group(first, rows(channels, first));
    }
    sketch_ = make_sketch(sums, stored_.view(), reflectance_);
  }

  const Sketch& sketch() const { return sketch_; }

  struct Norms {
    double error, residual, compression;
  };
  /// ‖M t − M̂ h‖ = ‖E t + M̂ (t − h)‖, ‖M̂ (t − h)‖ and ‖E t‖ with E = M − M̂: with all inner
  /// products of the columns of [E M̂], ‖[E M̂] v‖² = vᵀ G v.
  Norms norms(const CubeLight& target, const CubeLight& held) const {
    const auto count = static_cast<Eigen::Index>(kColumns);
    Eigen::Vector3d squares = Eigen::Vector3d::Zero();
    for (int c = 0; c < 3; ++c) {
      Eigen::VectorXd lost = Eigen::VectorXd::Zero(2 * count), late = lost;
      for (Eigen::Index j = 0; j < count; ++j) {
        const auto column = static_cast<std::size_t>(j);
        lost[j] = target.at(column)[c];
        late[count + j] = lost[j] - static_cast<double>(held.at(column)[c]);
      }
      const auto product = products_[static_cast<std::size_t>(c)].selfadjointView<Eigen::Lower>();
      const auto square = [&](const Eigen::VectorXd& v) { return v.dot(product * v); };
      squares += Eigen::Vector3d(square(lost + late), square(late), square(lost));
    }
    return {std::sqrt(squares[0]), std::sqrt(squares[1]), std::sqrt(squares[2])};
  }

 private:
  struct Channel {
    Matrix stored, error;  // M̂ and M − M̂, [receiver][column]
  };

  void fill_stored(std::array<Channel, 3>& channels) {
    for (Channel& channel : channels) channel.stored = zeros();
    const std::vector<float> zero(kTileFloats);
    for (std::size_t j = 0; j < kColumns; ++j) {
      const std::vector<ColumnDelta> one = {{static_cast<std::uint32_t>(j), {1, 1, 1}}};
      for (std::size_t tile = 0; tile < kTiles; ++tile) {
        const auto held = reference::add_columns(stored_.view(), tile, one, zero);
        const auto radiance =
            reference::restore_radiance(held.value, reflectance_.tile_span(tile), false);
        for (std::size_t i = 0; i < kTileFloats; ++i) {
          const std::size_t receiver = tile * kTileReceivers + i / kBlockFloats * 8 + i % 8;
          at(channels[i % kBlockFloats / 8].stored, receiver, j) = radiance[i];
        }
      }
    }
  }

  /// Random, of another size in each column.
  static void fill_error(double error, Random& random, std::array<Channel, 3>& channels) {
    double square = 0;
    for (const Channel& channel : channels) square += channel.stored.squaredNorm();
    const double size = error * std::sqrt(square / static_cast<double>(3 * kReceivers * kColumns));
    for (Channel& channel : channels) {
      channel.error = zeros();
      for (std::size_t j = 0; j < kColumns; ++j) {
        const double of_column = size * random.uniform(0, 2);
        for (std::size_t r = 0; r < kReceivers; ++r) {
          at(channel.error, r, j) = of_column * random.uniform(-1.7, 1.7);
        }
      }
    }
  }

  static double& at(Matrix& matrix, std::size_t row, std::size_t column) {
    return matrix(static_cast<Eigen::Index>(row), static_cast<Eigen::Index>(column));
  }

  /// A group's rows of M, [column][3][64].
  static std::vector<float> rows(std::array<Channel, 3>& channels, std::size_t first) {
    std::vector<float> rows;
    for (std::size_t j = 0; j < kColumns; ++j) {
      for (Channel& channel : channels) {
        for (std::size_t r = first; r < first + 64; ++r) {
          rows.push_back(static_cast<float>(at(channel.stored, r, j) + at(channel.error, r, j)));
        }
      }
    }
    return rows;
  }

  Transport stored_;
  ReceiverValues reflectance_;
  std::array<Matrix, 3> products_;
  Sketch sketch_;
};

/// One for all tests: sketching takes a while.
const Case& little_compressed() {
  static const Case made(1, 0.3, 0.02);
  return made;
}
const Case& much_compressed() {
  static const Case made(2, 0.1, 0.1);
  return made;
}

/// Finer bands are darker; a few coefficients are most of it.
CubeLight random_light(std::uint64_t seed) {
  Random random(seed, 41);
  CubeLight light(kSize);
  for (std::size_t i = 0; i < light.count(); ++i) {
    const double size = std::pow(random.uniform(), 4) / (1 + kHaar.band_of(i));
    for (int c = 0; c < 3; ++c) {
      light.channel(c)[i] = static_cast<float>(size * random.uniform(-1, 1));
    }
  }
  return light;
}

/// A light on the way from one to the other.
CubeLight between(const CubeLight& a, const CubeLight& b, float t) {
  CubeLight light(kSize);
  for (std::size_t i = 0; i < light.values.size(); ++i) {
    light.values[i] = (1 - t) * a.values[i] + t * b.values[i];
  }
  return light;
}

/// How often estimates were near the truth.
struct Tally {
  int frames = 0, within = 0;
  double ratio_sum = 0, worst = 0;

  void add(double estimate, double truth) {
    const double ratio = estimate / truth;
    ++frames;
    within += std::abs(ratio - 1) <= 0.15;
    ratio_sum += ratio;
    worst = std::max(worst, std::abs(ratio - 1));
  }
  void expect_calibrated(const std::string& name) const {
    std::printf("%-20s %d frames, mean %.3f, worst %.3f\n", name.c_str(), frames,
                ratio_sum / frames, worst);
    EXPECT_GE(within, 0.95 * frames) << name;
    EXPECT_NEAR(ratio_sum / frames, 1, 0.05) << name;
  }
};

TEST(ErrorEstimate, IsCalibratedOverPoliciesLightsAndTransports) {
  Tally errors, residuals;
  for (const char* const name : {"nwa", "bi", "pbi", "benefit"}) {
    const auto policy = make_policy(parse_policy(name, "test"));
    Tally of_policy;
    for (const Case* const transport : {&little_compressed(), &much_compressed()}) {
      ErrorEstimator estimator(transport->sketch());
      CubeLight held(kSize);
      for (int frame = 0; frame < 24; ++frame) {
        const auto seed = static_cast<std::uint64_t>(frame / 8);
        const CubeLight target =
            between(random_light(seed), random_light(seed + 1), static_cast<float>(frame % 8) / 8);
        const PlanRequest request{.basis = kHaar,
                                  .target = target,
                                  .held = held,
                                  .budget = Budget::coefficients(15),
                                  .column_norm_squared = transport->sketch().norm_squared};
        test::apply(test::plan_of(*policy, request), kHaar, target, held);
        const ErrorEstimate estimate = estimator.estimate(target, held);
        const Case::Norms truth = transport->norms(target, held);
        ASSERT_GT(truth.residual, 0);
        for (Tally* const tally : {&errors, &of_policy}) tally->add(estimate.error, truth.error);
        residuals.add(estimate.residual, truth.residual);
      }
    }
    of_policy.expect_calibrated(name);
  }
  errors.expect_calibrated("error");
  residuals.expect_calibrated("part of time");
}

TEST(ErrorEstimate, WithoutAResidualItIsThatOfCompression) {
  Tally tally;
  for (const Case* const transport : {&little_compressed(), &much_compressed()}) {
    ErrorEstimator estimator(transport->sketch());
    for (std::uint64_t seed = 0; seed < 20; ++seed) {
      const CubeLight light = random_light(seed);
      const ErrorEstimate estimate = estimator.estimate(light, light);
      EXPECT_EQ(estimate.residual, 0);
      tally.add(estimate.error, transport->norms(light, light).compression);
    }
  }
  tally.expect_calibrated("compression");
}

TEST(ErrorEstimate, TimeAndCompressionAreToldApart) {
  const Case& transport = much_compressed();
  ErrorEstimator estimator(transport.sketch());
  const CubeLight target = random_light(5);
  int of_time = 0, of_compression = 0;
  for (const float t : {0.0f, 0.3f, 0.7f, 0.9f, 0.99f, 0.999f}) {
    const CubeLight held = between(CubeLight(kSize), target, t);
    const ErrorEstimate estimate = estimator.estimate(target, held);
    const Case::Norms truth = transport.norms(target, held);
    // Compression is far below the one, then far above the other.
    of_time += truth.residual > 3 * truth.compression;
    of_compression += truth.compression > 3 * truth.residual;
    EXPECT_NEAR(estimate.residual, truth.residual, 0.15 * truth.residual) << t;
    EXPECT_NEAR(estimate.error, truth.error, 0.15 * truth.error) << t;
  }
  EXPECT_GE(of_time, 2);
  EXPECT_GE(of_compression, 2);
}

TEST(ErrorEstimate, OfBlackIsZeroAndScalesWithTheLight) {
  const Case& transport = much_compressed();
  ErrorEstimator estimator(transport.sketch());
  const CubeLight black(kSize);
  const ErrorEstimate nothing = estimator.estimate(black, black);
  EXPECT_EQ(nothing.error, 0);
  EXPECT_EQ(nothing.residual, 0);
  CubeLight target = random_light(1), held = random_light(2);
  const ErrorEstimate once = estimator.estimate(target, held);
  EXPECT_GT(once.residual, 0);
  for (CubeLight* const light : {&target, &held}) {
    for (float& value : light->values) value *= 4;  // exact in binary
  }
  const ErrorEstimate four = estimator.estimate(target, held);
  EXPECT_EQ(four.error, 4 * once.error);
  EXPECT_EQ(four.residual, 4 * once.residual);
  // A light that is held although nothing is asked for is all of time's.
  const ErrorEstimate ghost = estimator.estimate(black, held);
  const double truth = transport.norms(black, held).residual;
  EXPECT_EQ(ghost.error, ghost.residual);
  EXPECT_NEAR(ghost.error, truth, 0.15 * truth);
}

}  // namespace
}  // namespace rimlight
