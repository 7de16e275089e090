#include "core/report/storage_comparison.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "core/bake/check_lights.h"
#include "core/image/metrics.h"
#include "core/report/storage_report.h"
#include "core/transport/reference_rows.h"
#include "tests/support/ball_source.h"
#include "tests/support/error_of.h"
#include "tests/support/temporary_folder.h"

namespace rimlight {
namespace {

constexpr int kSide = 48, kCubeSize = 8;

/// A bake of a ball, with the rows of all its receivers, and its comparison, made once.
class Storage : public ::testing::Test {
 protected:
  static void SetUpTestSuite() {
    folder_ = new test::TemporaryFolder;
    bake_ball(*folder_ / "ball.bake", test::BallSource(kSide, kCubeSize), 64 * 64);
    bake_ = new Bake(*folder_ / "ball.bake");
    comparison_ = new StorageComparison(compare_storage(
        *bake_, [](double share) { EXPECT_TRUE(share > 0 && share <= 1) << share; }));
  }
  static void TearDownTestSuite() {
    delete comparison_;
    delete bake_;
    delete folder_;
  }

  static test::TemporaryFolder* folder_;
  static Bake* bake_;
  static StorageComparison* comparison_;
};
test::TemporaryFolder* Storage::folder_ = nullptr;
Bake* Storage::bake_ = nullptr;
StorageComparison* Storage::comparison_ = nullptr;

/// What a threshold keeps of a channel-interleaved group, entry by entry.
struct Kept {
  std::size_t entries = 0;
  LightImages images, references;  // [light][receiver]
};

Kept prune(const Bake& bake, float threshold, const std::vector<CheckLight>& lights) {
  const auto rows = ReferenceRows::open(bake);
  Kept kept;
  kept.images.resize(lights.size());
  kept.references.resize(lights.size());
  for (std::size_t group = 0; group < rows->groups().size(); ++group) {
    for (std::size_t lane = 0; lane < 64; ++lane) {
      const auto [x, y] = bake.manifest().pixels.pixel(rows->groups()[group] + lane);
      if (x >= kSide || y >= kSide) continue;
      if (!(bake.coverage()[static_cast<std::size_t>(y * kSide + x)] > 0)) continue;
      std::vector<Vec3d> image(lights.size()), whole(lights.size());
      for (std::size_t column = 0; column < bake.transport().column_count(); ++column) {
        const float* const row = rows->group(group).data() + column * 192;
        const Vec3d entry(Vec3f{row[lane], row[64 + lane], row[128 + lane]});
        const bool keep = std::abs(entry.x) >= threshold || std::abs(entry.y) >= threshold ||
                          std::abs(entry.z) >= threshold;
        kept.entries += keep;
        for (std::size_t light = 0; light < lights.size(); ++light) {
          const Vec3d part = entry * Vec3d(lights[light].coefficients.at(column));
          whole[light] += part;
          if (keep) image[light] += part;
        }
      }
      for (std::size_t light = 0; light < lights.size(); ++light) {
        kept.images[light].emplace_back(image[light]);
        kept.references[light].emplace_back(whole[light]);
      }
    }
  }
  return kept;
}

float largest_entry(const Bake& bake) {
  const auto rows = ReferenceRows::open(bake);
  float largest = 0;
  for (std::size_t group = 0; group < rows->groups().size(); ++group) {
    for (const float value : rows->group(group)) largest = std::max(largest, std::abs(value));
  }
  return largest;
}

TEST_F(Storage, EachThresholdKeepsWhatPruningEntryByEntryDoes) {
  const auto lights = make_check_lights(CubeHaar(kCubeSize));
  const float largest = largest_entry(*bake_);
  for (const int point : {7, 23, 39}) {
    const float threshold = largest * std::exp2(-static_cast<float>(point + 1) / 4);
    const Kept kept = prune(*bake_, threshold, lights);
    const StoragePoint& measured = comparison_->csr[static_cast<std::size_t>(point)];
    ASSERT_EQ(comparison_->receivers, kept.images[0].size());
    EXPECT_NEAR(
        measured.bytes_per_receiver,
        16.0 * static_cast<double>(kept.entries) / static_cast<double>(comparison_->receivers), 0.1)
        << point;
    const auto exposures = check_exposures(lights, kept.references);
    double worst = 99;
    for (std::size_t light = 0; light < lights.size(); ++light) {
      worst = std::min(worst,
                       display_psnr(kept.images[light], kept.references[light], exposures[light]));
    }
    EXPECT_NEAR(measured.worst_psnr_db, worst, 0.02) << point;
  }
}

TEST_F(Storage, TheBakesPointIsWhatTheBakeMeasured) {
  double worst = 99;
  for (const auto& [light, psnr] : bake_->manifest().measured.at("psnr_db").items()) {
    worst = std::min(worst, psnr.get<double>());
  }
  EXPECT_NEAR(comparison_->stored.worst_psnr_db, worst, 0.05);
  EXPECT_GT(comparison_->stored.bytes_per_receiver, 12);
  EXPECT_LT(comparison_->stored.bytes_per_receiver, 12.0 * 6 * kCubeSize * kCubeSize);
}

TEST_F(Storage, BytesRiseAsTheThresholdFallsAndTheBakesErrorLiesBetweenTwo) {
  const auto& csr = comparison_->csr;
  for (std::size_t i = 1; i < csr.size(); ++i) {
    EXPECT_GE(csr[i].bytes_per_receiver, csr[i - 1].bytes_per_receiver);
  }
  EXPECT_GT(csr.back().worst_psnr_db, 80);
  const double bytes = comparison_->csr_bytes_at_stored_error;
  std::size_t after = 0;
  while (csr[after].worst_psnr_db < comparison_->stored.worst_psnr_db) ++after;
  ASSERT_GT(after, 0u);
  EXPECT_GE(bytes, csr[after - 1].bytes_per_receiver);
  EXPECT_LE(bytes, csr[after].bytes_per_receiver);
}

TEST_F(Storage, TheReportHasARowForEachWayAndThreshold) {
  const nlohmann::json report = to_json(*comparison_);
  EXPECT_EQ(report.at("experiment"), "storage");
  ASSERT_EQ(report.at("rows").size(), 1 + comparison_->csr.size());
  EXPECT_EQ(report.at("rows")[0].at("storage"), "bake");
  EXPECT_NEAR(report.at("bake_over_csr").get<double>() *
                  report.at("csr_bytes_at_the_bakes_error").get<double>(),
              comparison_->stored.bytes_per_receiver, 1e-6);
  const Figures figures = draw_figures(*comparison_, *folder_ / "");
  ASSERT_EQ(figures.scripts.size(), 1u);
  EXPECT_TRUE(std::filesystem::exists(figures.scripts[0]));
}

TEST(StorageComparison, NeedsReferenceRows) {
  const test::TemporaryFolder folder;
  bake_ball(folder / "ball.bake", test::BallSource(16, 4), 0);
  const Bake bake(folder / "ball.bake");
  EXPECT_THAT(test::error_of([&] { (void)compare_storage(bake, [](double) {}); }),
              ::testing::HasSubstr("--reference"));
}

}  // namespace
}  // namespace rimlight
