// Columns added layer by layer: images whose layers show different lights.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "core/base/check.h"
#include "core/math/random.h"
#include "core/relight/relighter.h"
#include "tests/support/random_transport.h"
#include "tests/support/reference/columns.h"
#include "tests/support/reference/pixel_haar.h"

namespace rimlight {
namespace {

constexpr std::size_t kTiles = 3;
const CubeHaar kHaar(8);
using TileImage = std::vector<float>;

const TransportView& transport() {
  static const Transport made = test::random_transport(
      {.tile_count = kTiles, .column_count = kHaar.coefficient_count(), .density = 0.05});
  return made.view();
}

const ReceiverValues& reflectance() {
  static const ReceiverValues made = [] {
    ReceiverValues values(kTiles);
    for (std::size_t i = 0; i < kTiles * kTileReceivers; ++i) values.set(i, {1, 0.5f, 2});
    return values;
  }();
  return made;
}

/// Random plans of some layers of some columns, here and there a reset or a cleared band.
class LayeredEdits {
 public:
  LayeredEdits(HeldImages images, std::uint64_t seed)
      : random_(seed), relighter_(transport(), reflectance(), kHaar, images) {
    plan_.bands.resize(3);
  }

  void edit() {
    for (float& value : target_.values) value = static_cast<float>(random_.uniform(-1, 1));
    plan_.columns.clear();
    const bool all_reset = !relighter_.holds_bands() && random_.below(8) == 0;
    for (int band = 0; band < kHaar.band_count(); ++band) {
      const bool reset = relighter_.holds_bands() ? random_.below(25) == 0 : all_reset;
      plan_band(band, reset);
    }
    relighter_.apply(plan_, target_);
    move_expected();
  }

  const Relighter& relighter() const { return relighter_; }
  const std::array<CubeLight, kLayers>& expected() const { return expected_; }

 private:
  void plan_band(int band, bool reset) {
    BandUpdate& update = plan_.bands[static_cast<std::size_t>(band)];
    const bool cleared = reset && random_.below(2) == 0;
    update = {reset ? BandAction::reset : BandAction::increment, plan_.columns.size(), 0};
    for (std::size_t i = kHaar.band_begin(band); i < kHaar.band_begin(band + 1); ++i) {
      if (cleared || random_.below(2) == 0) continue;
      std::array<Vec3f, kLayers> deltas;
      for (std::size_t layer = 0; layer < kLayers; ++layer) {
        const Vec3f held = reset ? Vec3f{} : relighter_.held().layer(layer).at(i);
        deltas[layer] = target_.at(i) - held;
      }
      append_deltas(i, deltas, static_cast<LayerSet>(random_.below(8)), plan_.columns);
    }
    update.count = plan_.columns.size() - update.first;
    if (!reset && update.count == 0) update.action = BandAction::hold;
  }

  void move_expected() {
    for (int band = 0; band < kHaar.band_count(); ++band) {
      if (plan_.bands[static_cast<std::size_t>(band)].action != BandAction::reset) continue;
      for (std::size_t i = kHaar.band_begin(band); i < kHaar.band_begin(band + 1); ++i) {
        for (CubeLight& layer : expected_) {
          for (int c = 0; c < 3; ++c) layer.channel(c)[i] = 0;
        }
      }
    }
    for (const ColumnDelta& column : plan_.columns) {
      for (std::size_t layer = 0; layer < kLayers; ++layer) {
        if ((column.layers >> layer & 1) == 0) continue;
        for (int c = 0; c < 3; ++c) {
          expected_[layer].channel(c)[column.column] = target_.channel(c)[column.column];
        }
      }
    }
  }

  Random random_;
  CubeLight target_{kHaar.size()};
  std::array<CubeLight, kLayers> expected_{CubeLight(kHaar.size()), CubeLight(kHaar.size()),
                                           CubeLight(kHaar.size())};
  UpdatePlan plan_;
  Relighter relighter_;
};

TileImage tile_of(const Relighter& relighter, std::size_t tile) {
  TileImage image(kTileFloats);
  relighter.find_radiance(tile, std::span<float, kTileFloats>(image.data(), kTileFloats));
  return image;
}

/// Every layer of every column, at its own light.
std::vector<ColumnDelta> all_layers(const std::array<CubeLight, kLayers>& lights) {
  std::vector<ColumnDelta> columns;
  for (std::size_t i = 0; i < kHaar.coefficient_count(); ++i) {
    std::array<Vec3f, kLayers> values;
    for (std::size_t layer = 0; layer < kLayers; ++layer) values[layer] = lights[layer].at(i);
    append_deltas(i, values, kAllLayers, columns);
  }
  return columns;
}

class LayeredRelighter : public ::testing::TestWithParam<HeldImages> {};

TEST_P(LayeredRelighter, TheImageIsTheSumOfEachLayersProductWithItsLight) {
  LayeredEdits edits(GetParam(), 5);
  const std::vector<float> zero(kTileFloats);
  for (int frame = 0; frame < 40; ++frame) {
    edits.edit();
    for (std::size_t layer = 0; layer < kLayers; ++layer) {
      ASSERT_EQ(edits.relighter().held().layer(layer).values, edits.expected()[layer].values);
    }
    if (frame % 8 != 7) continue;
    for (std::size_t tile = 0; tile < kTiles; ++tile) {
      const auto held =
          reference::add_columns(transport(), tile, all_layers(edits.expected()), zero);
      const auto of_tile = reflectance().tile_span(tile);
      const auto value = reference::restore_radiance(held.value, of_tile, false);
      const auto magnitude = reference::restore_radiance(held.magnitude, of_tile, true);
      const TileImage image = tile_of(edits.relighter(), tile);
      for (std::size_t i = 0; i < kTileFloats; ++i) {
        // 40 frames of additions to each number at most, twelve roundings each.
        ASSERT_NEAR(image[i], value[i], 0x1p-24 * 12 * 40 * magnitude[i] + 1e-6)
            << tile << " " << i;
      }
    }
  }
}

TEST_P(LayeredRelighter, RebuiltTilesHaveTheBitsOfAFreshImage) {
  LayeredEdits edits(GetParam(), 6);
  std::size_t next = 0, rebuilds = 0;
  for (int frame = 0; rebuilds < 2 * kTiles; ++frame) {
    ASSERT_LT(frame, 4000);
    edits.edit();
    const std::size_t rebuilt = edits.relighter().tiles_rebuilt();
    if (rebuilt == 0) continue;
    // The same image from nothing: every band reset, all layers at their lights.
    Relighter fresh(transport(), reflectance(), kHaar, GetParam());
    UpdatePlan plan;
    plan.columns = all_layers(edits.expected());
    plan.bands.assign(3, {BandAction::reset, 0, 0});
    for (const ColumnDelta& column : plan.columns) {
      ++plan.bands[static_cast<std::size_t>(kHaar.band_of(column.column))].count;
    }
    for (std::size_t b = 1; b < 3; ++b) {
      plan.bands[b].first = plan.bands[b - 1].first + plan.bands[b - 1].count;
    }
    fresh.apply(plan, edits.expected()[0]);
    for (std::size_t i = 0; i < rebuilt; ++i, ++next, ++rebuilds) {
      ASSERT_EQ(tile_of(edits.relighter(), next % kTiles), tile_of(fresh, next % kTiles));
    }
  }
}

TEST_P(LayeredRelighter, AnExactImageLeavesNothingToRebuildAndAnEmptyPlanRebuildsNothing) {
  Relighter relighter(transport(), reflectance(), kHaar, GetParam());
  CubeLight light(kHaar.size());
  std::ranges::fill(light.values, 0.5f);
  UpdatePlan all, nothing;
  nothing.bands.resize(3);
  all.bands.assign(3, {BandAction::reset, 0, 0});
  for (int band = 0; band < 3; ++band) {
    BandUpdate& update = all.bands[static_cast<std::size_t>(band)];
    update.first = kHaar.band_begin(band);
    update.count = kHaar.band_begin(band + 1) - update.first;
  }
  for (std::uint32_t i = 0; i < kHaar.coefficient_count(); ++i) {
    all.columns.push_back({i, light.at(i)});
  }
  const std::size_t before_a_rebuild = Relighter::kMostAdditions / (kTiles * all.columns.size());
  for (int round = 0; round < 2; ++round) {
    for (std::size_t i = 0; i < before_a_rebuild; ++i) {
      relighter.apply(all, light);
      ASSERT_EQ(relighter.tiles_rebuilt(), 0u) << round;
    }
    if (round == 0) {
      ASSERT_TRUE(relighter.apply_exact(light, {}));
    }
  }
  relighter.apply(nothing, light);
  EXPECT_EQ(relighter.tiles_rebuilt(), 0u);
  relighter.apply(all, light);
  EXPECT_EQ(relighter.tiles_rebuilt(), 1u);
}

INSTANTIATE_TEST_SUITE_P(HeldImages, LayeredRelighter,
                         ::testing::Values(HeldImages::by_band, HeldImages::together),
                         [](const auto& images) {
                           return images.param == HeldImages::by_band ? "ByBand" : "Together";
                         });

TEST(HeldImages, TheExactImageHasTheSameBitsWhateverItIsHeldAs) {
  Random random(3);
  CubeLight light(kHaar.size());
  for (float& value : light.values) value = static_cast<float>(random.uniform(-1, 1));
  Relighter by_band(transport(), reflectance(), kHaar, HeldImages::by_band);
  LayeredEdits moved(HeldImages::together, 8);
  for (int frame = 0; frame < 5; ++frame) moved.edit();
  Relighter together(transport(), reflectance(), kHaar, HeldImages::together);
  for (Relighter* const relighter : {&by_band, &together}) {
    ASSERT_TRUE(relighter->apply_exact(light, {}));
    EXPECT_EQ(relighter->held().layer(2).values, light.values);
  }
  for (std::size_t tile = 0; tile < kTiles; ++tile) {
    EXPECT_EQ(tile_of(by_band, tile), tile_of(together, tile));
  }
}

TEST(HeldImages, BandsHeldTogetherAreResetTogether) {
  Relighter relighter(transport(), reflectance(), kHaar, HeldImages::together);
  UpdatePlan plan;
  plan.bands.resize(3);
  plan.bands[1].action = BandAction::reset;
  EXPECT_THROW(relighter.apply(plan, CubeLight(kHaar.size())), CheckFailure);
}

}  // namespace
}  // namespace rimlight
