#include "core/curves/curve_transport.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "core/base/check.h"
#include "core/base/parallel.h"
#include "tests/core/curves/curve_cases.h"

namespace rimlight {
namespace {

constexpr CurveAxis kAxes[] = {CurveAxis::half_angle, CurveAxis::difference_angle};
/// 16 bits of each coefficient, and what float decides about the border of two bins.
constexpr double kTolerance = 1e-3;

const char* name_of(CurveAxis axis) { return axis == CurveAxis::half_angle ? "θ_h" : "θ_d"; }

/// The error of T̂ ĉ + fixed, or of `fixed` alone.
RelativeError error_of(const PanelCase& test, const CurveMaterialState& state,
                       std::optional<CurveAxis> axis) {
  RelativeError error;
  const CurveCoefficients curve =
      axis ? test.transport.basis(*axis).coefficients(*state.curve(*axis)) : CurveCoefficients{};
  test.for_each_row([&](std::size_t p, std::size_t row) {
    const Vec3d found = axis ? stored_row(test.transport, p, row, *axis, curve)
                             : row_of(test.transport.fixed(p), row);
    error.add(found, reference_row(test.transport.receivers(), test.transport.panels()[p], row,
                                   test.light, state));
  });
  return error;
}

CurveMaterial glaze() {
  return {"glaze",
          {.model = BrdfModel::cook_torrance,
           .albedo = {0.8f, 0.3f, 0.1f},
           .specular = {1, 0.9f, 0.8f}}};
}

TEST(CurveTransport, TimesTheCurveIsTheSumOverTheSky) {
  int axes = 0;
  double worst = 0;
  for (const CurveCase& item : curve_cases()) {
    PanelCase test(item.material);
    ASSERT_EQ(test.transport.panels().size(), 2u);
    const CurveMaterialState state = baked_state(item.material);
    for (const CurveAxis axis : kAxes) {
      if (!state.has(axis)) continue;
      ++axes;
      test.rebuild(state, axis);
      const RelativeError error = error_of(test, state, axis);
      EXPECT_GT(error.size(), 0) << item.name;
      EXPECT_LT(error.value(), kTolerance) << item.name << " " << name_of(axis);
      worst = std::max(worst, error.value());
    }
  }
  EXPECT_EQ(axes, 2 * 12 + 3 + 3 + 2);
  RecordProperty("worst", std::to_string(worst));
}

TEST(CurveTransport, ModelsWithoutFactorsAreFixedAlone) {
  int models = 0;
  for (const CurveCase& item : curve_cases()) {
    const CurveMaterialState state = baked_state(item.material);
    if (state.half_angle || state.difference_angle) continue;
    ++models;
    PanelCase test(item.material);
    test.rebuild(state, std::nullopt);
    const RelativeError error = error_of(test, state, std::nullopt);
    EXPECT_GT(error.size(), 0) << item.name;
    // cos^n in floats multiplies rounding by n.
    const double narrow =
        item.material.brdf.model == BrdfModel::phong ? item.material.brdf.exponent : 0;
    EXPECT_LT(error.value(), 1e-5 + 1e-7 * narrow) << item.name;
  }
  EXPECT_EQ(models, 5);
}

/// Curves that no model has.
TEST(CurveTransport, AnyDrawnCurveGivesTheSumOverTheSky) {
  PanelCase test(glaze());
  struct Drawn {
    const char* name;
    float (*value)(std::size_t bin);
  };
  const Drawn drawings[] = {
      {"nothing", [](std::size_t) { return 0.0f; }},
      {"a constant", [](std::size_t) { return 1.0f; }},
      {"a million everywhere", [](std::size_t) { return 1e6f; }},
      {"a spike of one bin", [](std::size_t bin) { return bin == 150 ? 1e6f : 0.0f; }},
      {"a step", [](std::size_t bin) { return bin < 100 ? 3.0f : 0.0f; }},
      {"teeth", [](std::size_t bin) { return bin % 2 == 0 ? 1.0f : 1e-3f; }}};
  for (const Drawn& drawing : drawings) {
    for (const CurveAxis axis : kAxes) {
      CurveMaterialState state = baked_state(glaze());
      auto& curve = axis == CurveAxis::half_angle ? state.half_angle : state.difference_angle;
      for (std::size_t i = 0; i < kCurveBins; ++i) {
        curve->values[i] = Vec3f{1, 0.5f, 0.25f} * drawing.value(i);
      }
      for (const CurveAxis made : kAxes) {  // as what is multiplied, and as a part of T′
        test.rebuild(state, made);
        EXPECT_LT(error_of(test, state, made).value(), kTolerance)
            << drawing.name << " over " << name_of(axis) << ", T′ over " << name_of(made);
      }
    }
  }
}

TEST(CurveTransport, AnAllZeroCurveLeavesWhatIsFixed) {
  PanelCase test(glaze());
  const CurveMaterialState state = baked_state(glaze());
  test.rebuild(state, CurveAxis::half_angle);
  CurveMaterialState diffuse = state;
  diffuse.brdf.model = BrdfModel::cook_torrance;
  diffuse.half_angle->values = {};
  test.for_each_row([&](std::size_t p, std::size_t row) {
    const Vec3d expected = reference_row(test.transport.receivers(), test.transport.panels()[p],
                                         row, test.light, diffuse);
    const Vec3d found = row_of(test.transport.fixed(p), row);
    for (int c = 0; c < 3; ++c) EXPECT_NEAR(found[c], expected[c], 1e-5 * (expected[c] + 1e-3));
  });
}

TEST(CurveTransport, ABlackLightIsBlack) {
  for (const CurveCase& item : curve_cases()) {
    PanelCase test(item.material, CubeLight(PanelCase::kSize));
    const CurveMaterialState state = baked_state(item.material);
    test.rebuild(state, std::nullopt);
    for (const CurveAxis axis : kAxes) {
      if (state.has(axis)) test.rebuild(state, axis);
      for (std::size_t p = 0; p < 2; ++p) {
        EXPECT_TRUE(std::ranges::all_of(test.transport.fixed(p), [](float v) { return v == 0; }));
        EXPECT_TRUE(
            std::ranges::all_of(test.transport.numbers(p, axis), [](auto v) { return v == 0; }));
        EXPECT_TRUE(
            std::ranges::all_of(test.transport.steps(p, axis), [](float v) { return v == 0; }));
      }
    }
  }
}

TEST(CurveTransport, IsLinearInTheLight) {
  const CubeLight first = random_light(PanelCase::kSize, 1),
                  second = random_light(PanelCase::kSize, 2);
  CubeLight both = first;
  for (std::size_t i = 0; i < both.values.size(); ++i) both.values[i] += 2 * second.values[i];
  PanelCase a(glaze(), first), b(glaze(), second), sum(glaze(), both);
  const CurveMaterialState state = baked_state(glaze());
  for (const CurveAxis axis : kAxes) {
    const CurveCoefficients curve = sum.transport.basis(axis).coefficients(*state.curve(axis));
    for (PanelCase* test : {&a, &b, &sum}) test->rebuild(state, axis);
    RelativeError error;
    sum.for_each_row([&](std::size_t p, std::size_t row) {
      error.add(stored_row(a.transport, p, row, axis, curve) +
                    stored_row(b.transport, p, row, axis, curve) * 2.0,
                stored_row(sum.transport, p, row, axis, curve));
    });
    EXPECT_LT(error.value(), 1e-4);
  }
}

TEST(CurveTransport, BothAxesGiveTheSameImage) {
  PanelCase test(glaze());
  const CurveMaterialState state = baked_state(glaze());
  RelativeError error;
  for (const CurveAxis axis : kAxes) test.rebuild(state, axis);
  test.for_each_row([&](std::size_t p, std::size_t row) {
    Vec3d images[2];
    for (std::size_t i = 0; i < 2; ++i) {
      images[i] = stored_row(test.transport, p, row, kAxes[i],
                             test.transport.basis(kAxes[i]).coefficients(*state.curve(kAxes[i])));
    }
    error.add(images[0], images[1]);
  });
  EXPECT_LT(error.value(), 2e-4);
}

TEST(CurveTransport, PanelsAreMadeInAnyOrderByAnyThreadsWithTheSameBits) {
  PanelCase one(glaze()), many(glaze());
  const CurveMaterialState state = baked_state(glaze());
  one.rebuild(state, CurveAxis::half_angle);
  parallel_for(4, [&](std::size_t i) {
    // Each twice, the last first.
    if (i % 2 == 1) return;
    const std::size_t panel = 1 - i / 2;
    for (int again = 0; again < 2; ++again) {
      many.transport.rebuild(panel, many.curve_light, state, CurveAxis::half_angle, 1);
    }
  });
  for (std::size_t p = 0; p < 2; ++p) {
    const auto axis = CurveAxis::half_angle;
    EXPECT_TRUE(
        std::ranges::equal(one.transport.numbers(p, axis), many.transport.numbers(p, axis)));
    EXPECT_TRUE(std::ranges::equal(one.transport.steps(p, axis), many.transport.steps(p, axis)));
    EXPECT_TRUE(std::ranges::equal(one.transport.fixed(p), many.transport.fixed(p)));
  }
}

TEST(CurveTransport, TellsWhatEachPanelIsFreshFor) {
  PanelCase test(glaze());
  CurveTransport& transport = test.transport;
  EXPECT_EQ(transport.fresh_for(0, CurveAxis::half_angle), 0u);
  EXPECT_TRUE(transport.numbers(0, CurveAxis::half_angle).empty());
  const CurveMaterialState state = baked_state(glaze());
  transport.rebuild(1, test.curve_light, state, CurveAxis::half_angle, 7);
  EXPECT_EQ(transport.fresh_for(0, CurveAxis::half_angle), 0u);
  EXPECT_EQ(transport.fresh_for(1, CurveAxis::half_angle), 7u);
  EXPECT_EQ(transport.fresh_for(1, CurveAxis::difference_angle), 0u);
  EXPECT_EQ(transport.fixed_fresh_for(1), 7u);
  EXPECT_TRUE(transport.numbers(1, CurveAxis::difference_angle).empty());
  transport.rebuild_fixed(0, test.curve_light, state, 9);
  EXPECT_EQ(transport.fixed_fresh_for(0), 9u);
  EXPECT_EQ(transport.fresh_for(0, CurveAxis::half_angle), 0u);
  CurveMaterialState lambert = baked_state({"", {}});
  EXPECT_THROW(transport.rebuild(0, test.curve_light, lambert, CurveAxis::half_angle, 9),
               CheckFailure);
}

TEST(CurvePanels, HoldRowsOfOneMaterialAndOneTile) {
  const CurveScene scene = random_scene({glaze(), glaze(), glaze()}, 130, 8, 5);
  const CurveReceivers receivers = scene.receivers();
  const std::vector<CurvePanel> panels = make_panels(receivers);
  ASSERT_EQ(panels.size(), 9u);
  std::size_t next = 0, rows = 0;
  for (const CurvePanel& panel : panels) {
    EXPECT_GT(panel.row_count, 0u);
    rows += panel.row_count;
    EXPECT_EQ(panel.first_surface[0], next);
    for (std::size_t row = 0; row < panel.row_count; ++row) {
      ASSERT_LT(panel.first_surface[row], panel.first_surface[row + 1]);
      for (auto i = panel.first_surface[row]; i < panel.first_surface[row + 1]; ++i) {
        EXPECT_EQ(receivers.surfaces[i].receiver, panel.receivers[row]);
        EXPECT_EQ(receivers.surfaces[i].material, panel.material);
        EXPECT_EQ(receivers.surfaces[i].receiver / 4096, panel.tile);
      }
    }
    for (std::size_t row = panel.row_count; row < kPanelRows; ++row) {
      EXPECT_EQ(panel.first_surface[row + 1], panel.first_surface[panel.row_count]);
    }
    next = panel.first_surface[kPanelRows];
  }
  EXPECT_EQ(next, receivers.surfaces.size());
  EXPECT_EQ(rows, 390u);
  EXPECT_EQ(panels[0].row_count, kPanelRows);
  EXPECT_EQ(panels[2].row_count, 2u);
  CurveReceivers unsorted = receivers;
  std::vector<CurveSurface> surfaces(receivers.surfaces.rbegin(), receivers.surfaces.rend());
  unsorted.surfaces = surfaces;
  EXPECT_THROW(make_panels(unsorted), CheckFailure);
}

}  // namespace
}  // namespace rimlight
