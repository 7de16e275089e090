#include "core/relight/relighter.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <memory>
#include <vector>

#include "core/base/parallel.h"
#include "core/math/random.h"
#include "core/relight/policies.h"
#include "tests/support/random_transport.h"
#include "tests/support/reference/columns.h"
#include "tests/support/reference/pixel_haar.h"

namespace rimlight {
namespace {

constexpr int kSize = 8;
constexpr std::size_t kTiles = 3;
const CubeHaar kHaar(kSize);
using Image = std::vector<float>;  // [tile][block][3][8]

const TransportView& transport() {
  static const Transport made = test::random_transport(
      {.tile_count = kTiles, .column_count = kHaar.coefficient_count(), .density = 0.05});
  return made.view();
}

const ReceiverValues& reflectance() {
  static const ReceiverValues made = [] {
    ReceiverValues values(kTiles);
    Random random(17);
    for (std::size_t i = 0; i < kTiles * kTileReceivers; ++i) {
      const auto value = [&] { return static_cast<float>(random.uniform(0.1, 2)); };
      values.set(i, {value(), value(), value()});
    }
    return values;
  }();
  return made;
}

/// A light that moves: frame by frame a little of it changes, more in the finer bands.
CubeLight moving_light(int frame) {
  CubeLight light(kSize);
  for (std::size_t i = 0; i < light.count(); ++i) {
    Random random(3, i);
    const int band = kHaar.band_of(i);
    const double speed = random.uniform(0, 0.1) * (1 << band);
    for (int c = 0; c < 3; ++c) {
      const double phase = random.uniform(0, 6.3);
      light.channel(c)[i] = static_cast<float>(std::sin(phase + speed * frame) / (1 + band));
    }
  }
  return light;
}

Image image_of(const Relighter& relighter) {
  Image image(relighter.tile_count() * kTileFloats);
  for (std::size_t tile = 0; tile < relighter.tile_count(); ++tile) {
    relighter.find_radiance(
        tile, std::span<float, kTileFloats>(image.data() + tile * kTileFloats, kTileFloats));
  }
  return image;
}

std::vector<ColumnDelta> all_columns(const CubeLight& light) {
  std::vector<ColumnDelta> columns;
  for (std::uint32_t i = 0; i < light.count(); ++i) columns.push_back({i, light.at(i)});
  return columns;
}

/// |image − M · light| against a bound of roundings: each of `additions` rounds by 2⁻²⁴ twelve
/// times (see the kernel's test) of at most the magnitudes that were ever added; the pixel Haar
/// transform and the reflectance a few times more.
void expect_product(const Image& image, const CubeLight& light, double additions) {
  const std::vector<float> zero(kTileFloats);
  const auto columns = all_columns(light);
  double size = 0;
  for (std::size_t tile = 0; tile < kTiles; ++tile) {
    const auto held = reference::add_columns(transport(), tile, columns, zero);
    const auto of_tile = reflectance().tile_span(tile);
    const auto value = reference::restore_radiance(held.value, of_tile, false);
    const auto magnitude = reference::restore_radiance(held.magnitude, of_tile, true);
    for (std::size_t i = 0; i < kTileFloats; ++i) {
      const double bound = 0x1p-24 * (12 * additions + 16) * magnitude[i] + 1e-30;
      ASSERT_TRUE(std::abs(image[tile * kTileFloats + i] - value[i]) <= bound)
          << tile << " " << i << " " << image[tile * kTileFloats + i] << " " << value[i];
      size += std::abs(value[i]);
    }
  }
  ASSERT_GT(size, 0);
}

struct Session {
  Relighter relighter{transport(), reflectance(), kHaar};
  PlanWorkspace workspace;
  UpdatePlan plan;

  void frame(const UpdatePolicy& policy, const CubeLight& target, std::size_t budget) {
    policy.make_plan({kHaar, target, relighter.held(), Budget::coefficients(budget)}, workspace,
                     plan);
    relighter.apply(plan, target);
  }
};

TEST(Relighter, StartsBlack) {
  const Session session;
  const Image image = image_of(session.relighter);
  EXPECT_TRUE(std::ranges::all_of(image, [](float value) { return value == 0; }));
}

TEST(Relighter, AfterEachFrameTheImageIsTheProductWithHeld) {
  const NwaPolicy nwa;
  const PbiPolicy pbi;
  for (const UpdatePolicy* policy :
       {static_cast<const UpdatePolicy*>(&nwa), static_cast<const UpdatePolicy*>(&pbi)}) {
    Session session;
    int resets = 0, increments = 0;
    for (int frame = 0; frame < 12; ++frame) {
      const CubeLight target = moving_light(frame);
      session.frame(*policy, target, 60);
      for (const BandUpdate& update : session.plan.bands) {
        resets += update.action == BandAction::reset;
        increments += update.action == BandAction::increment;
      }
      ASSERT_EQ(session.relighter.last_terms(), 60u);
      // Deltas of at most twice the size, 60 a frame: 13 · 120 additions and more than the held
      // light's own magnitude, so a factor 4.
      expect_product(image_of(session.relighter), session.relighter.held().layer(0),
                     4 * 13 * 120.0);
    }
    EXPECT_GT(resets, 0);
    EXPECT_EQ(increments > 0, policy == &pbi);
  }
}

TEST(Relighter, HeldIsTheTargetAtAddedColumnsAndZeroElsewhereInResetBands) {
  Session session;
  session.frame(PbiPolicy(), moving_light(0), 100);
  const CubeLight before = session.relighter.held().layer(0);
  const CubeLight target = moving_light(40);
  session.frame(PbiPolicy(), target, 50);
  for (int band = 0; band < kHaar.band_count(); ++band) {
    const BandUpdate& update = session.plan.bands[static_cast<std::size_t>(band)];
    for (std::size_t i = kHaar.band_begin(band); i < kHaar.band_begin(band + 1); ++i) {
      const auto columns = std::span(session.plan.columns).subspan(update.first, update.count);
      const bool added =
          std::ranges::any_of(columns, [i](const ColumnDelta& c) { return c.column == i; });
      const Vec3f expected = added                                ? target.at(i)
                             : update.action == BandAction::reset ? Vec3f{}
                                                                  : before.at(i);
      ASSERT_EQ(session.relighter.held().layer(0).at(i), expected) << i;
    }
  }
}

TEST(Relighter, AResetBandIsReallyZero) {
  Session session;
  session.frame(PbiPolicy(), moving_light(0), 1000);
  ASSERT_FALSE(session.relighter.is_zero(2));
  CubeLight target = moving_light(0);
  for (int c = 0; c < 3; ++c)
    std::ranges::fill(target.channel(c).subspan(kHaar.band_begin(2)), 0.0f);
  session.frame(PbiPolicy(), target, 1000);
  EXPECT_TRUE(session.relighter.is_zero(2));
  EXPECT_FALSE(session.relighter.is_zero(1));
  Session without;
  without.frame(PbiPolicy(), target, 1000);
  EXPECT_EQ(image_of(session.relighter), image_of(without.relighter)) << "a ghost stays";
  // And a dark light leaves nothing at all.
  session.frame(PbiPolicy(), CubeLight(kSize), 30);
  const Image dark = image_of(session.relighter);
  EXPECT_TRUE(std::ranges::all_of(dark, [](float value) { return value == 0; }));
  // A band that was zeroed without touching its image starts from zero again.
  session.frame(PbiPolicy(), moving_light(7), 1000);
  Session fresh;
  fresh.frame(PbiPolicy(), moving_light(7), 1000);
  EXPECT_EQ(image_of(session.relighter), image_of(fresh.relighter));
}

/// What no policy here asks for, but a plan may: PBI resets a band whose held light is zero.
TEST(Relighter, AnIncrementOfAZeroedBandStartsFromZero) {
  Session session, fresh;
  session.frame(PbiPolicy(), moving_light(0), 1000);
  session.frame(PbiPolicy(), CubeLight(kSize), 1000);
  const CubeLight target = moving_light(1);
  const std::size_t column = kHaar.band_begin(1) + 3;
  UpdatePlan plan;
  plan.bands = {{}, {BandAction::increment, 0, 1}, {}};
  plan.columns = {{static_cast<std::uint32_t>(column), target.at(column)}};
  session.relighter.apply(plan, target);
  fresh.relighter.apply(plan, target);
  EXPECT_EQ(image_of(session.relighter), image_of(fresh.relighter));
}

TEST(Relighter, NwaWithABudgetOfEverythingIsTheExactImageBitForBit) {
  Session session, exact;
  for (int frame = 0; frame < 3; ++frame) {
    session.frame(NwaPolicy(), moving_light(frame), kHaar.coefficient_count());
  }
  ASSERT_TRUE(exact.relighter.apply_exact(moving_light(2), {}));
  EXPECT_EQ(image_of(session.relighter), image_of(exact.relighter));
  EXPECT_EQ(session.relighter.held().layer(0).values, exact.relighter.held().layer(0).values);
}

TEST(Relighter, PbiConvergesWhileTheLightIsStill) {
  constexpr std::size_t kBudget = 25;
  Session session;
  for (int frame = 0; frame < 10; ++frame) session.frame(PbiPolicy(), moving_light(frame), kBudget);
  const CubeLight target = moving_light(10);
  const std::size_t frames = (kHaar.coefficient_count() + kBudget - 1) / kBudget;
  double previous = 1e300;
  for (std::size_t frame = 0; frame < frames; ++frame) {
    session.frame(PbiPolicy(), target, kBudget);
    const double residual = weighted_distance(kHaar, target, session.relighter.held().layer(0));
    ASSERT_LE(residual, previous);
    previous = residual;
  }
  EXPECT_EQ(previous, 0);
  EXPECT_EQ(session.relighter.held().layer(0).values, target.values);
  expect_product(image_of(session.relighter), target, 4 * 1000.0);
  session.frame(PbiPolicy(), target, kBudget);
  EXPECT_EQ(session.relighter.last_terms(), 0u);
}

TEST(Relighter, TheExactImageDependsOnTheTargetAlone) {
  Session moved, fresh;
  for (int frame = 0; frame < 8; ++frame) moved.frame(PbiPolicy(), moving_light(frame), 40);
  ASSERT_TRUE(moved.relighter.apply_exact(moving_light(8), {}));
  ASSERT_TRUE(fresh.relighter.apply_exact(moving_light(8), {}));
  EXPECT_EQ(image_of(moved.relighter), image_of(fresh.relighter));
  EXPECT_EQ(moved.relighter.last_terms(), kHaar.coefficient_count());
  expect_product(image_of(fresh.relighter), moving_light(8), 2 * 384.0);
  // And increments go on from there.
  moved.frame(PbiPolicy(), moving_light(9), 40);
  expect_product(image_of(moved.relighter), moved.relighter.held().layer(0), 4 * 1000.0);
}

TEST(Relighter, IsLinearInTheLight) {
  Session once, twice;
  CubeLight light = moving_light(1);
  ASSERT_TRUE(once.relighter.apply_exact(light, {}));
  for (float& value : light.values) value *= 2;  // exact in binary
  ASSERT_TRUE(twice.relighter.apply_exact(light, {}));
  const Image a = image_of(once.relighter), b = image_of(twice.relighter);
  for (std::size_t i = 0; i < a.size(); ++i) ASSERT_EQ(2 * a[i], b[i]);
}

TEST(Relighter, AnAbandonedExactImageLeavesEverythingAsItWas) {
  Session session, undisturbed;
  for (int frame = 0; frame < 5; ++frame) {
    session.frame(PbiPolicy(), moving_light(frame), 40);
    undisturbed.frame(PbiPolicy(), moving_light(frame), 40);
  }
  for (int after = 0; after < static_cast<int>(kTiles); ++after) {
    std::atomic<int> asked = 0;
    EXPECT_FALSE(session.relighter.apply_exact(moving_light(9), [&] { return asked++ == after; }));
    EXPECT_GT(asked, after);
    EXPECT_EQ(image_of(session.relighter), image_of(undisturbed.relighter)) << after;
    EXPECT_EQ(session.relighter.held().layer(0).values,
              undisturbed.relighter.held().layer(0).values);
  }
  session.frame(PbiPolicy(), moving_light(6), 40);
  undisturbed.frame(PbiPolicy(), moving_light(6), 40);
  EXPECT_EQ(image_of(session.relighter), image_of(undisturbed.relighter));
  ASSERT_TRUE(session.relighter.apply_exact(moving_light(9), [] { return false; }));
  Session fresh;
  ASSERT_TRUE(fresh.relighter.apply_exact(moving_light(9), {}));
  EXPECT_EQ(image_of(session.relighter), image_of(fresh.relighter));
}

TEST(Relighter, TheSameFramesHaveTheSameBitsAtAnyThreadCount) {
  std::vector<Image> moving, exact;
  for (const int threads : {1, 2, 3}) {
    set_thread_count(threads);
    Session session;
    for (int frame = 0; frame < 8; ++frame) session.frame(PbiPolicy(), moving_light(frame), 40);
    moving.push_back(image_of(session.relighter));
    ASSERT_TRUE(session.relighter.apply_exact(moving_light(8), {}));
    exact.push_back(image_of(session.relighter));
  }
  set_thread_count(0);
  for (const auto& images : {moving, exact}) {
    EXPECT_EQ(images[0], images[1]);
    EXPECT_EQ(images[0], images[2]);
  }
}

}  // namespace
}  // namespace rimlight
