#include "core/bake/sky_visibility.h"

#include <gtest/gtest.h>

#include <cstdlib>
#include <memory>
#include <vector>

#include "core/bake/lambert_kernel.h"
#include "tests/core/bake/bake_scenes.h"
#include "tests/core/bake/random_samples.h"

namespace rimlight {
namespace {

constexpr int kSize = 8;
constexpr std::uint64_t kSeed = 0x123456789abcdef;
enum class Answer { none, dark, lit, both };

/// One group's visibility, and the same by a ray at a time.
class SkyVisibilityTest : public testing::Test {
 protected:
  void trace(const GroupSamples& samples) {
    surfaces_.assign(samples);
    visibility_->clear(surfaces_.layer_count(), texels_);
    for (std::size_t i = 0; i < surfaces_.layer_count(); ++i) {
      for (std::size_t texel = 0; texel < texels_.count(); ++texel) {
        visibility_->responding(i, texel) =
            facing_lanes(surfaces_.layer(i), texels_.quarters(texel));
      }
    }
    visibility_->trace(scene_, surfaces_, texels_, kSeed);
  }

  bool responds(std::size_t layer, std::size_t texel, std::size_t lane) const {
    return (visibility_->responding(layer, texel) & lane_bit(lane)) != 0;
  }

  /// How many of a surface's rays first … first + count − 1 to a texel escape.
  int escaped(std::size_t layer, std::size_t texel, std::size_t lane, int first, int count) {
    rays_->rays.count = 0;
    add_shadow_rays(
        {surfaces_, layer, texels_.patch(texel), lane_bit(lane), first, count, 0, kSeed}, *rays_);
    int lit = 0;
    for (std::size_t i = 0; i < rays_->rays.count; ++i) {
      const auto& o = rays_->rays.origin;
      const auto& d = rays_->rays.direction;
      const Ray ray{{o[0][i], o[1][i], o[2][i]}, normalized(Vec3f{d[0][i], d[1][i], d[2][i]})};
      lit += scene_.intersect(ray) ? 0 : 1;
    }
    return lit;
  }

  /// What the first rays of a lane's surfaces to a texel say: all of them together.
  Answer answer(std::size_t texel, std::size_t lane) {
    bool lit = false, dark = false;
    for (std::size_t i = 0; i < surfaces_.layer_count(); ++i) {
      if (!responds(i, texel, lane)) continue;
      (escaped(i, texel, lane, 0, 1) == 1 ? lit : dark) = true;
    }
    return lit && dark ? Answer::both : lit ? Answer::lit : dark ? Answer::dark : Answer::none;
  }

  std::vector<Answer> answers() {
    std::vector<Answer> result;  // [texel][lane]
    for (std::size_t texel = 0; texel < texels_.count(); ++texel) {
      for (std::size_t lane = 0; lane < kGroupLanes; ++lane) result.push_back(answer(texel, lane));
    }
    return result;
  }

  /// Whether both answers are given around (texel, lane), but not there.
  static bool surroundings_disagree(const std::vector<Answer>& answers, std::size_t texel,
                                    std::size_t lane) {
    bool lit = false, dark = false;
    const auto look = [&](std::size_t other_texel, std::size_t other_lane) {
      const Answer one = answers[other_texel * kGroupLanes + other_lane];
      lit |= one == Answer::lit || one == Answer::both;
      dark |= one == Answer::dark || one == Answer::both;
    };
    constexpr std::size_t kFace = kSize * kSize;
    const auto row = static_cast<int>(texel % kFace / kSize);
    const auto column = static_cast<int>(texel % kSize);
    for (int y = std::max(row - 1, 0); y <= std::min(row + 1, kSize - 1); ++y) {
      for (int x = std::max(column - 1, 0); x <= std::min(column + 1, kSize - 1); ++x) {
        if (x == column && y == row) continue;
        look(texel / kFace * kFace + static_cast<std::size_t>(y * kSize + x), lane);
      }
    }
    const PixelLayout layout{PixelLayout::kTileSide, PixelLayout::kTileSide};
    const PixelLayout::Pixel at = layout.pixel(lane);
    for (std::size_t other = 0; other < kGroupLanes; ++other) {
      const PixelLayout::Pixel pixel = layout.pixel(other);
      if (other == lane || std::abs(pixel.x - at.x) > 1 || std::abs(pixel.y - at.y) > 1) continue;
      look(texel, other);
    }
    return lit && dark;
  }

  void expect_brute_force() {
    const std::vector<Answer> all = answers();
    int plain = 0, refined = 0, penumbra = 0;
    for (std::size_t i = 0; i < surfaces_.layer_count(); ++i) {
      for (std::size_t texel = 0; texel < texels_.count(); ++texel) {
        for (std::size_t lane = 0; lane < kGroupLanes; ++lane) {
          const int lit = visibility_->lit_rays(i, texel)[lane];
          const bool more = (visibility_->refined(i, texel) & lane_bit(lane)) != 0;
          if (!responds(i, texel, lane)) {
            ASSERT_EQ(lit, 0);
            ASSERT_FALSE(more);
            continue;
          }
          ASSERT_EQ(more, surroundings_disagree(all, texel, lane)) << texel << " " << lane;
          ASSERT_EQ(lit,
                    escaped(i, texel, lane, 0, 1) + (more ? escaped(i, texel, lane, 1, 4) : 0));
          ASSERT_FLOAT_EQ(visibility_->visibility(i, texel, lane),
                          static_cast<float>(lit) / (more ? 5.0f : 1.0f));
          ++(more ? refined : plain);
          penumbra += more && lit > 0 && lit < 5 ? 1 : 0;
        }
      }
    }
    EXPECT_GT(plain, 1000);
    EXPECT_GT(refined, 1000);
    EXPECT_GT(penumbra, 200);
  }

  RayScene scene_{corner_scene(lambert(0.5f))};
  TexelQuadrature texels_{kSize};
  GroupSurfaces surfaces_;
  std::unique_ptr<SkyVisibility> visibility_ = std::make_unique<SkyVisibility>();
  std::unique_ptr<ShadowRays> rays_ = std::make_unique<ShadowRays>();
};

TEST_F(SkyVisibilityTest, OfACameraGroupIsThatOfARayAtATime) {
  GroupSamples samples;
  const BakeSettings& bake = scene_.scene().bake;
  sample_group(scene_, {bake.width, bake.height}, 27 * kGroupLanes, 4, 1, samples);
  trace(samples);
  EXPECT_EQ(shadow_ray_coherence(surfaces_), Coherence::high);
  expect_brute_force();
}

TEST_F(SkyVisibilityTest, OfPixelsWithManySurfacesIsThatOfARayAtATime) {
  trace(test::random_samples({.rays = 8, .edges = true}, 2));
  EXPECT_EQ(shadow_ray_coherence(surfaces_), Coherence::low);
  EXPECT_GT(surfaces_.layer_count(), 1u);
  expect_brute_force();
}

TEST_F(SkyVisibilityTest, NothingOfTheGroupBeforeStays) {
  trace(test::random_samples({.rays = 8, .edges = true}, 3));
  visibility_->clear(1, texels_);
  surfaces_.assign(test::random_samples({.rays = 8}, 4));
  visibility_->responding(0, 5) = surfaces_.layer(0).lanes;
  visibility_->trace(scene_, surfaces_, texels_, kSeed);
  for (std::size_t texel = 0; texel < texels_.count(); ++texel) {
    const bool asked = texel == 5;
    EXPECT_TRUE(asked || visibility_->refined(0, texel) == 0);
    for (std::size_t lane = 0; lane < kGroupLanes; ++lane) {
      EXPECT_TRUE(asked || visibility_->lit_rays(0, texel)[lane] == 0);
    }
  }
}

}  // namespace
}  // namespace rimlight
