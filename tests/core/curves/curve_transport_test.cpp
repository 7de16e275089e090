#include "core/curves/curve_transport.h"

#include <gtest/gtest.h>

#include <cmath>

#include "core/curves/quick_image.h"
#include "tests/core/curves/curve_cases.h"

namespace rimlight {
namespace {

constexpr int kSize = 8;
constexpr std::size_t kRows = 70;  // two panels

/// Root of Σ (a − b)² over that of Σ b².
class RelativeError {
 public:
  void add(const Vec3d& found, const Vec3d& expected) {
    error_ += dot(found - expected, found - expected);
    size_ += dot(expected, expected);
  }
  double value() const { return std::sqrt(error_ / size_); }
  double size() const { return std::sqrt(size_); }

 private:
  double error_ = 0, size_ = 0;
};

CurveMaterialState baked(const CurveMaterial& material) { return resolve(material, {}, {}, ""); }

struct Case {
  CurveScene scene;
  CubeLight light = random_light(kSize, 7);
  CurveSky sky{kSize};
  CurveLight curve_light{sky, light, 0};
  CurveTransport transport;

  explicit Case(const CurveMaterial& material)
      : scene(random_scene({material}, kRows, kSize, 3)), transport(scene.receivers()) {}

  void rebuild(const CurveMaterialState& state, std::optional<CurveAxis> axis) {
    for (std::size_t panel = 0; panel < transport.panels().size(); ++panel) {
      if (axis) {
        transport.rebuild(panel, curve_light, state, *axis, 1);
      } else {
        transport.rebuild_fixed(panel, curve_light, state, 1);
      }
    }
  }
  double error(const CurveMaterialState& state, std::optional<CurveAxis> axis) {
    RelativeError error;
    const CurveCoefficients curve =
        axis ? transport.basis(*axis).coefficients(*state.curve(*axis)) : CurveCoefficients{};
    for (std::size_t p = 0; p < transport.panels().size(); ++p) {
      const CurvePanel& panel = transport.panels()[p];
      for (std::size_t row = 0; row < panel.row_count; ++row) {
        Vec3d found;
        if (axis) {
          found = stored_row(transport, p, row, *axis, curve);
        } else {
          for (int c = 0; c < 3; ++c) {
            found[c] = transport.fixed(p)[static_cast<std::size_t>(c) * kPanelRows + row];
          }
        }
        error.add(found, reference_row(transport.receivers(), panel, row, light, state));
      }
    }
    EXPECT_GT(error.size(), 0);
    return error.value();
  }
};

TEST(CurveTransport, TimesTheCurveIsTheSumOverTheSky) {
  int axes = 0;
  for (const CurveCase& item : curve_cases()) {
    Case test(item.material);
    ASSERT_EQ(test.transport.panels().size(), 2u);
    const CurveMaterialState state = baked(item.material);
    for (const CurveAxis axis : {CurveAxis::half_angle, CurveAxis::difference_angle}) {
      if (!state.has(axis)) continue;
      ++axes;
      test.rebuild(state, axis);
      const double error = test.error(state, axis);
      EXPECT_LT(error, 1e-3) << item.name << (axis == CurveAxis::half_angle ? " θ_h" : " θ_d");
      printf("%s %d: %g\n", item.name.c_str(), static_cast<int>(axis), error);
    }
    if (!state.half_angle && !state.difference_angle) {
      test.rebuild(state, std::nullopt);
      const double error = test.error(state, std::nullopt);
      EXPECT_LT(error, 1e-4) << item.name;
      printf("%s: %g\n", item.name.c_str(), error);
    }
  }
  EXPECT_GT(axes, 20);
}

}  // namespace
}  // namespace rimlight
