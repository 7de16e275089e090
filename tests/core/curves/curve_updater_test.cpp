#include "core/curves/curve_updater.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "core/base/check.h"
#include "core/base/parallel.h"
#include "core/math/random.h"
#include "tests/core/curves/curve_cases.h"
#include "tests/support/allocation_count.h"

namespace rimlight {
namespace {

constexpr int kSize = 8;
constexpr CurvePolicy kPolicies[] = {CurvePolicy::nwa, CurvePolicy::bi, CurvePolicy::benefit};

constexpr FrameBudget coefficients(double count) {
  return {FrameBudget::Unit::coefficients, count};
}

/// Two glossy materials (130 and 130 rows) with T′ over θ_h, and one that has no curve.
struct UpdaterCase {
  CurveScene scene;
  CurveSky sky{kSize};
  CurveLight light{sky, random_light(kSize, 4), 0};
  CurveTransport transport;
  std::vector<CurveMaterialState> states;

  UpdaterCase() : scene(random_scene(materials(), 130, kSize, 2)), transport(scene.receivers()) {
    for (const CurveMaterial& material : scene.materials) states.push_back(baked_state(material));
    for (std::size_t p = 0; p < transport.panels().size(); ++p) rebuild(p, light);
    for (std::uint32_t m = 0; m < 2; ++m) transport.find_norms(m, CurveAxis::half_angle);
  }
  static std::vector<CurveMaterial> materials() {
    const Brdf glaze{.model = BrdfModel::cook_torrance, .specular = {1, 0.9f, 0.8f}};
    const Brdf plastic{.model = BrdfModel::blinn_phong, .albedo = {}, .specular = {1, 1, 1}};
    return {{"glaze", glaze}, {"plastic", plastic}, {"chalk", {}}};
  }
  void rebuild(std::size_t panel, const CurveLight& from) {
    const CurveMaterialState& state = states[transport.panels()[panel].material];
    if (state.has(CurveAxis::half_angle)) {
      transport.rebuild(panel, from, state, CurveAxis::half_angle, 1);
    } else {
      transport.rebuild_fixed(panel, from, state, 1);
    }
  }
  CurveCoefficients bump(std::uint64_t seed) const {
    Random random(seed);
    BrdfCurve curve{CurveAxis::half_angle, {}};
    const double middle = random.uniform(0, 200), width = random.uniform(3, 60);
    for (std::size_t i = 0; i < kCurveBins; ++i) {
      const double x = (static_cast<double>(i) - middle) / width;
      curve.values[i] = Vec3f{1, 2, 0.1f} * static_cast<float>(1e-3 + std::exp(-x * x));
    }
    return transport.basis(CurveAxis::half_angle).coefficients(curve);
  }
  CurveUpdater updater(CurvePolicy policy) const {
    CurveUpdater result(transport, policy);
    for (std::uint32_t m = 0; m < 2; ++m) result.show(m, CurveAxis::half_angle, bump(m));
    result.show(2, std::nullopt, {});
    return result;
  }
};

/// ‖image − (T̂ curve + fixed)‖ and the size of the latter.
RelativeError image_error(const UpdaterCase& test, const CurveUpdater& updater,
                          const std::function<CurveCoefficients(std::uint32_t)>& curve) {
  RelativeError error;
  for (std::size_t p = 0; p < test.transport.panels().size(); ++p) {
    const CurvePanel& panel = test.transport.panels()[p];
    for (std::size_t row = 0; row < panel.row_count; ++row) {
      const Vec3d expected =
          updater.axis(panel.material)
              ? stored_row(test.transport, p, row, CurveAxis::half_angle, curve(panel.material))
              : row_of(test.transport.fixed(p), row);
      error.add(row_of(updater.image(p), row), expected);
    }
  }
  return error;
}

bool same_images(const UpdaterCase& test, const CurveUpdater& a, const CurveUpdater& b) {
  for (std::size_t p = 0; p < test.transport.panels().size(); ++p) {
    if (!std::ranges::equal(a.image(p), b.image(p))) return false;
  }
  return true;
}

TEST(CurveUpdater, TheImageIsAlwaysTransportTimesWhatIsHeld) {
  const UpdaterCase test;
  for (const CurvePolicy policy : kPolicies) {
    CurveUpdater updater = test.updater(policy);
    for (std::uint64_t frame = 0; frame < 40; ++frame) {
      updater.set_target(static_cast<std::uint32_t>(frame % 2), test.bump(frame));
      updater.update(coefficients(static_cast<double>(frame)));
      const RelativeError error =
          image_error(test, updater, [&](std::uint32_t m) { return updater.held(m); });
      ASSERT_GT(error.size(), 0);
      ASSERT_LT(error.value(), 1e-5) << frame;
    }
  }
}

TEST(CurveUpdater, AnExactUpdateAfterAnyEditsIsTheFreshProduct) {
  const UpdaterCase test;
  for (const CurvePolicy policy : kPolicies) {
    CurveUpdater edited = test.updater(policy), fresh = test.updater(policy);
    for (std::uint64_t frame = 0; frame < 30; ++frame) {
      edited.set_target(static_cast<std::uint32_t>(frame % 2), test.bump(frame));
      edited.update(coefficients(7));
    }
    for (std::uint32_t m = 0; m < 2; ++m) fresh.set_target(m, edited.target(m));
    EXPECT_FALSE(same_images(test, edited, fresh));
    ASSERT_TRUE(edited.apply_exact({}));
    ASSERT_TRUE(fresh.apply_exact({}));
    EXPECT_TRUE(same_images(test, edited, fresh));
    for (std::uint32_t m = 0; m < 2; ++m) fresh.show(m, CurveAxis::half_angle, edited.target(m));
    EXPECT_TRUE(same_images(test, edited, fresh));
    EXPECT_EQ(edited.squared_error(), 0);
  }
}

TEST(CurveUpdater, NeverSpendsMoreThanItsBudget) {
  const UpdaterCase test;
  for (const CurvePolicy policy : kPolicies) {
    CurveUpdater updater = test.updater(policy);
    for (const double amount : {0.0, 1.0, 5.0, 100.0}) {
      for (std::uint32_t m = 0; m < 2; ++m) updater.set_target(m, test.bump(50 + m));
      EXPECT_EQ(updater.update(coefficients(amount)).columns, static_cast<std::size_t>(amount));
    }
    for (const double bytes : {0.0, 383.0, 5e3, 1e5}) {
      for (std::uint32_t m = 0; m < 2; ++m) updater.set_target(m, test.bump(60 + m));
      const CurveUpdateReport report = updater.update({FrameBudget::Unit::bytes, bytes});
      EXPECT_LE(static_cast<double>(report.bytes), bytes);
      EXPECT_EQ(report.bytes, report.columns * 3 * 384);  // three panels a material
      EXPECT_GT(static_cast<double>(report.bytes) + 3 * 384, bytes);
    }
  }
}

TEST(CurveUpdater, AnyTimeAppliesAColumnAndEnoughTimeAppliesAll) {
  const UpdaterCase test;
  CurveUpdater updater = test.updater(CurvePolicy::bi);
  updater.set_target(0, test.bump(9));
  EXPECT_GE(updater.update({FrameBudget::Unit::milliseconds, 0}).columns, 1u);
  for (int frame = 0; frame < 5; ++frame) updater.update({FrameBudget::Unit::milliseconds, 1000});
  EXPECT_TRUE(updater.is_at_target(0));
  EXPECT_EQ(updater.update({FrameBudget::Unit::milliseconds, 5}).columns, 0u);
}

TEST(CurveUpdater, PoliciesChooseWhatTheySay) {
  const UpdaterCase test;
  const CurveCoefficients target = test.bump(12);
  const auto size = [](const Vec3f& v) { return std::abs(v.x) + std::abs(v.y) + std::abs(v.z); };
  for (const CurvePolicy policy : kPolicies) {
    CurveUpdater updater = test.updater(policy);
    const CurveCoefficients held = updater.held(0);
    updater.set_target(0, target);
    ASSERT_EQ(updater.update(coefficients(20)).columns, 20u);
    const auto gain = [&](std::size_t k) -> double {
      const Vec3f delta = policy == CurvePolicy::nwa ? target[k] : target[k] - held[k];
      if (policy != CurvePolicy::benefit) return size(delta);
      return dot(Vec3d(delta) * Vec3d(delta),
                 test.transport.column_norm_squared(0, CurveAxis::half_angle, k));
    };
    double least_chosen = 1e30, most_left = 0;
    for (std::size_t k = 0; k < kCurveBins; ++k) {
      if (gain(k) == 0) continue;
      const bool is_chosen = updater.held(0)[k] == target[k];
      if (!is_chosen) {
        EXPECT_EQ(updater.held(0)[k], policy == CurvePolicy::nwa ? Vec3f{} : held[k]);
      }
      (is_chosen ? least_chosen : most_left) =
          is_chosen ? std::min(least_chosen, gain(k)) : std::max(most_left, gain(k));
    }
    EXPECT_GT(least_chosen, 0);
    EXPECT_GE(least_chosen * (1 + 1e-6), most_left);
  }
}

TEST(CurveUpdater, TellsTheErrorOfWhatCurvesLack) {
  const UpdaterCase test;
  CurveUpdater updater = test.updater(CurvePolicy::benefit);
  for (std::uint32_t m = 0; m < 2; ++m) updater.set_target(m, test.bump(30 + m));
  for (int frame = 0; frame < 5; ++frame) {
    updater.update(coefficients(15));
    const RelativeError error =
        image_error(test, updater, [&](std::uint32_t m) { return updater.target(m); });
    const double expected = error.value() * error.size();
    EXPECT_NEAR(std::sqrt(updater.squared_error()), expected, 0.01 * expected);
  }
}

TEST(CurveUpdater, APanelMadeAnewIsShownAfterRefresh) {
  UpdaterCase test;
  CurveUpdater updater = test.updater(CurvePolicy::bi);
  const CurveLight other(test.sky, random_light(kSize, 77), 0);
  for (std::size_t p = 0; p < test.transport.panels().size(); p += 2) {
    test.rebuild(p, other);
    updater.refresh(p);
  }
  const auto held = [&](std::uint32_t m) { return updater.held(m); };
  EXPECT_LT(image_error(test, updater, held).value(), 1e-6);
  updater.set_target(1, test.bump(5));
  updater.update(coefficients(40));
  EXPECT_LT(image_error(test, updater, held).value(), 1e-6);
}

TEST(CurveUpdater, AnAbandonedExactUpdateChangesNothing) {
  const UpdaterCase test;
  CurveUpdater updater = test.updater(CurvePolicy::bi), untouched = test.updater(CurvePolicy::bi);
  const CurveCoefficients held = updater.held(0);
  updater.set_target(0, test.bump(8));
  EXPECT_FALSE(updater.apply_exact([] { return true; }));
  EXPECT_TRUE(same_images(test, updater, untouched));
  EXPECT_EQ(updater.held(0), held);
  EXPECT_FALSE(updater.is_at_target(0));
}

/// Half a million additions, there and back: what rounding leaves is bounded by the panels that are
/// made afresh.
TEST(CurveUpdater, RoundingNeverShows) {
  const UpdaterCase test;
  CurveUpdater updater = test.updater(CurvePolicy::bi);
  std::size_t columns = 0, rebuilt = 0;
  for (std::uint64_t frame = 0; columns < 500'000; ++frame) {
    updater.set_target(0, test.bump(frame % 5));
    const CurveUpdateReport report = updater.update(coefficients(256));
    columns += report.columns;
    rebuilt += report.panels_rebuilt;
  }
  EXPECT_NEAR(static_cast<double>(rebuilt), 3.0 * 500'000 / CurveUpdater::kMostAdditions, 3);
  const RelativeError error =
      image_error(test, updater, [&](std::uint32_t m) { return updater.held(m); });
  EXPECT_LT(error.value(), 1e-4);
}

TEST(CurveUpdater, AnyNumberOfThreadsGivesTheSameBits) {
  const UpdaterCase test;
  const auto play = [&] {
    CurveUpdater updater = test.updater(CurvePolicy::benefit);
    for (std::uint64_t frame = 0; frame < 20; ++frame) {
      updater.set_target(static_cast<std::uint32_t>(frame % 2), test.bump(frame));
      updater.update(coefficients(11));
    }
    return updater;
  };
  set_thread_count(1);
  const CurveUpdater one = play();
  set_thread_count(0);
  EXPECT_TRUE(same_images(test, one, play()));
}

TEST(CurveUpdater, AllocatesNothing) {
  const UpdaterCase test;
  for (const CurvePolicy policy : kPolicies) {
    CurveUpdater updater = test.updater(policy);
    const CurveCoefficients targets[] = {test.bump(1), test.bump(2), test.bump(3)};
    set_thread_count(1);
    updater.set_target(0, targets[2]);
    updater.update(coefficients(3));
    const std::size_t before = test::allocation_count();
    for (std::size_t frame = 0; frame < 6; ++frame) {
      updater.set_target(static_cast<std::uint32_t>(frame % 2), targets[frame % 3]);
      updater.update(coefficients(30));
      updater.update({FrameBudget::Unit::milliseconds, 1});
    }
    EXPECT_EQ(test::allocation_count(), before);
    set_thread_count(0);
  }
}

TEST(CurveUpdater, RefusesTargetsThatAreNoCurve) {
  const UpdaterCase test;
  CurveUpdater updater = test.updater(CurvePolicy::bi);
  EXPECT_THROW(updater.set_target(2, {}), CheckFailure);
  CurveCoefficients target = test.bump(1);
  target[7].y = NAN;
  EXPECT_THROW(updater.set_target(0, target), CheckFailure);
  EXPECT_THROW(updater.show(0, CurveAxis::difference_angle, {}), CheckFailure);
}

}  // namespace
}  // namespace rimlight
