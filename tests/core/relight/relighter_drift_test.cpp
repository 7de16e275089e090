// Rounding of very many increments, and the rebuilding that keeps it from showing.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <string>
#include <vector>

#include "core/base/parallel.h"
#include "core/math/random.h"
#include "core/relight/relighter.h"
#include "tests/support/random_transport.h"

namespace rimlight {
namespace {

constexpr int kSize = 4;
constexpr std::size_t kTiles = 3;
const CubeHaar kHaar(kSize);

/// Dense, so that every column adds to nearly every number: the most roundings.
const TransportView& transport() {
  static const Transport made = test::random_transport(
      {.tile_count = kTiles, .column_count = kHaar.coefficient_count(), .density = 0.7});
  return made.view();
}

const ReceiverValues& reflectance() {
  static const ReceiverValues made = [] {
    ReceiverValues values(kTiles);
    for (std::size_t i = 0; i < kTiles * kTileReceivers; ++i) values.set(i, {1, 1, 1});
    return values;
  }();
  return made;
}

/// 20,000, or how many the environment asks for: RIMLIGHT_DRIFT_EDITS=1000000 takes a minute.
int edit_count() {
  const char* const asked = std::getenv("RIMLIGHT_DRIFT_EDITS");
  return asked == nullptr ? 20'000 : std::max(1, std::stoi(asked));
}

std::vector<float> image_of(const Relighter& relighter) {
  std::vector<float> image(kTiles * kTileFloats);
  for (std::size_t tile = 0; tile < kTiles; ++tile) {
    relighter.find_radiance(
        tile, std::span<float, kTileFloats>(image.data() + tile * kTileFloats, kTileFloats));
  }
  return image;
}

double distance(const std::vector<float>& image, const std::vector<float>& reference) {
  double difference = 0, size = 0;
  for (std::size_t i = 0; i < image.size(); ++i) {
    difference += std::pow(double{image[i]} - double{reference[i]}, 2);
    size += std::pow(double{reference[i]}, 2);
  }
  return std::sqrt(difference / size);
}

/// Edits that each move 3 to 30 columns of a light somewhere else, and what becomes of the image.
class Edits {
 public:
  explicit Edits(std::uint64_t seed) : random_(seed) {
    plan_.bands.assign(static_cast<std::size_t>(kHaar.band_count()), {});
  }

  /// The columns of one edit, by increments.
  void edit() {
    moved_.clear();
    for (std::size_t i = 3 + random_.below(28); i-- > 0;) {
      moved_.push_back(random_.below(kHaar.coefficient_count()));
    }
    std::ranges::sort(moved_);
    // Not std::ranges::unique(): clang 14 cannot compile GCC 12's.
    moved_.erase(std::unique(moved_.begin(), moved_.end()), moved_.end());
    plan_.columns.clear();
    for (BandUpdate& band : plan_.bands) band = {};
    for (const std::size_t column : moved_) {
      for (int c = 0; c < 3; ++c) {
        target_.channel(c)[column] = static_cast<float>(random_.uniform(-1, 1));
      }
      BandUpdate& band = plan_.bands[static_cast<std::size_t>(kHaar.band_of(column))];
      if (band.count++ == 0) band.first = plan_.columns.size();
      band.action = BandAction::increment;
      plan_.columns.push_back({static_cast<std::uint32_t>(column),
                               target_.at(column) - relighter_.held().layer(0).at(column)});
    }
    relighter_.apply(plan_, target_);
    additions_ += plan_.columns.size();
  }

  /// Adds the last edit to an image that is never rebuilt.
  void add_to(std::vector<ReceiverValues>& bands) const {
    for (std::size_t b = 0; b < bands.size(); ++b) {
      const auto columns =
          std::span(plan_.columns).subspan(plan_.bands[b].first, plan_.bands[b].count);
      const auto add = [&](std::size_t tile) {
        add_columns(transport(), tile, columns, bands[b].tile(tile));
      };
      parallel_for(kTiles, add);
    }
  }

  const Relighter& relighter() const { return relighter_; }
  const CubeLight& target() const { return target_; }
  std::size_t last_columns() const { return plan_.columns.size(); }
  std::size_t additions() const { return additions_; }

 private:
  Random random_;
  CubeLight target_{kSize};
  Relighter relighter_{transport(), reflectance(), kHaar};
  UpdatePlan plan_;
  std::vector<std::size_t> moved_;
  std::size_t additions_ = 0;
};

/// B of bands that were never rebuilt.
std::vector<float> image_of(const std::vector<ReceiverValues>& bands) {
  std::vector<float> image(kTiles * kTileFloats);
  for (std::size_t tile = 0; tile < kTiles; ++tile) {
    const std::span<float, kTileFloats> of_tile(image.data() + tile * kTileFloats, kTileFloats);
    for (const ReceiverValues& band : bands) {
      for (std::size_t i = 0; i < kTileFloats; ++i) of_tile[i] += band.tile(tile)[i];
    }
    restore_radiance(of_tile, reflectance().tile_span(tile));
  }
  return image;
}

TEST(RelighterDrift, RoundingOfManyEditsNeverShows) {
  Edits edits(1);
  std::vector<ReceiverValues> never_rebuilt(static_cast<std::size_t>(kHaar.band_count()),
                                            ReceiverValues(kTiles));
  const int count = edit_count();
  double worst = 0, without = 0;
  for (int i = 1; i <= count; ++i) {
    edits.edit();
    edits.add_to(never_rebuilt);
    if (i % std::max(1, count / 20) != 0) continue;
    Relighter fresh(transport(), reflectance(), kHaar);
    ASSERT_TRUE(fresh.apply_exact(edits.relighter().held().layer(0), {}));
    const auto exact = image_of(fresh);
    worst = std::max(worst, distance(image_of(edits.relighter()), exact));
    without = distance(image_of(never_rebuilt), exact);
  }
  EXPECT_EQ(edits.relighter().held().layer(0).values, edits.target().values);
  RecordProperty("worst", std::to_string(worst * 1e6) + "e-6");
  RecordProperty("without_rebuilding", std::to_string(without * 1e6) + "e-6");
  std::printf("%d edits, %zu columns: %.2e; without rebuilding %.2e\n", count, edits.additions(),
              worst, without);
  EXPECT_LT(worst, 1e-5);
  EXPECT_GT(worst, 1e-8) << "nothing was rounded";
  EXPECT_GT(without, 1.5 * worst);
}

TEST(RelighterDrift, RebuildsAreSpreadOverFrames) {
  Edits edits(2);
  std::size_t rebuilt = 0, before = 0;
  while (edits.additions() < 2 * Relighter::kMostAdditions + 1000) {
    edits.edit();
    before = rebuilt;
    rebuilt += edits.relighter().tiles_rebuilt();
    // A round through all tiles for every kMostAdditions columns, no sooner and no later.
    ASSERT_EQ(rebuilt, edits.additions() * kTiles / Relighter::kMostAdditions);
    ASSERT_LE(rebuilt - before, 1u) << edits.last_columns() << " columns";
  }
  EXPECT_GE(rebuilt, 2 * kTiles);
}

TEST(RelighterDrift, ATileIsRebuiltToTheBitsOfAFreshOne) {
  Edits edits(3);
  std::size_t compared = 0;
  for (std::size_t rebuilt = 0; rebuilt < 2 * kTiles;) {
    edits.edit();
    if (edits.relighter().tiles_rebuilt() == 0) continue;
    const std::size_t tile = rebuilt++ % kTiles;  // in turn
    Relighter fresh(transport(), reflectance(), kHaar);
    ASSERT_TRUE(fresh.apply_exact(edits.relighter().held().layer(0), {}));
    const auto of_tile = [tile](const std::vector<float>& image) {
      const auto first = image.begin() + static_cast<std::ptrdiff_t>(tile * kTileFloats);
      return std::vector<float>(first, first + kTileFloats);
    };
    EXPECT_EQ(of_tile(image_of(edits.relighter())), of_tile(image_of(fresh)));
    ++compared;
  }
  EXPECT_EQ(compared, 2 * kTiles);
}

TEST(RelighterDrift, RebuildingGivesTheSameBitsAtAnyThreadCount) {
  std::vector<std::vector<float>> images;
  for (const int threads : {1, 2, 3}) {
    set_thread_count(threads);
    Edits edits(4);
    while (edits.additions() < Relighter::kMostAdditions) edits.edit();
    images.push_back(image_of(edits.relighter()));
  }
  set_thread_count(0);
  EXPECT_EQ(images[0], images[1]);
  EXPECT_EQ(images[0], images[2]);
}

}  // namespace
}  // namespace rimlight
