// The figures that Overbeck 2006 reports for per-band incremental relighting (§6.3), on lights.
#include <gtest/gtest.h>

#include <cstdio>
#include <string>
#include <tuple>
#include <vector>

#include "core/light/environment.h"
#include "tests/support/real_data.h"
#include "tests/support/turning_light.h"

namespace rimlight {
namespace {

using test::PolicyRun;
using Start = PolicyRun::Start;

/// Environment (a built-in name, or "grace") and texels a side.
class TurningLight : public ::testing::TestWithParam<std::tuple<std::string, int>> {
 protected:
  void SetUp() override {
    const auto& [name, size] = GetParam();
    if (name != "grace") {
      frames_ = turn(builtin_environment(name), haar_, settings_);
    } else if (const auto data = test::real_data()) {
      frames_ = turn(load_environment(*data / "probes" / "grace_probe.hdr"), haar_, settings_);
    } else {
      GTEST_SKIP() << "no real data";
    }
  }

  std::vector<double> errors(const PolicyRun& run) const {
    return lighting_errors(haar_, frames_, run);
  }
  /// Over the frames that turn.
  double mean_error(const PolicyRun& run) const {
    return test::mean_of_first(errors(run), settings_.turning_frames);
  }

  test::TurningLight settings_;
  CubeHaar haar_{std::get<1>(GetParam())};
  std::vector<CubeLight> frames_;
};

INSTANTIATE_TEST_SUITE_P(Lights, TurningLight,
                         ::testing::Combine(::testing::Values("cathedral", "studio", "sunny",
                                                              "grace"),
                                            ::testing::Values(32, 64)),
                         [](const auto& instance) {
                           return std::get<0>(instance.param) + "_" +
                                  std::to_string(std::get<1>(instance.param));
                         });

/// "PBI with 30 wavelets is essentially always better than NWA with 60." Where one texel holds
/// nearly all, as in a clear sky, nothing is coherent from frame to frame, 60 coefficients are
/// nearly the whole light, and no choice of 30 can keep up: there the claim is not made.
TEST_P(TurningLight, ThirtyCoefficientsByBandAreAsGoodAsSixtyAfresh) {
  const double sixty = mean_error({"nwa", 60});
  for (const Start start : {Start::exact, Start::nothing}) {
    for (const char* const policy : {"pbi", "pbi:dealer", "pbi:exhaustive", "benefit"}) {
      const double thirty = mean_error({policy, 30, start});
      std::printf("%s from %s: %.3f of nwa 60's error\n", policy,
                  start == Start::exact ? "exact" : "nothing", thirty / sixty);
      if (std::get<0>(GetParam()) == "sunny") {
        EXPECT_LE(thirty, mean_error({"nwa", 30}));
      } else {
        EXPECT_LE(thirty, 1.05 * sixty);
      }
    }
  }
}

/// "Even a 500 wavelet approximation cannot achieve equal quality within 25 time steps of
/// stopping."
TEST_P(TurningLight, OnceStillThirtyCoefficientsPassFiveHundredWithinTwentyFiveFrames) {
  const double five_hundred = errors({"nwa", 500}).back();
  ASSERT_GT(five_hundred, 0);
  for (const char* const policy : {"pbi", "pbi:dealer", "pbi:exhaustive", "benefit"}) {
    EXPECT_LE(still_frames_until_below(errors({policy, 30}), settings_, five_hundred), 25)
        << policy;
  }
}

TEST_P(TurningLight, BasicIncrementalLeavesGhosts) {
  const double ghosts = mean_error({"bi", 30}) / mean_error({"pbi", 30});
  std::printf("bi: %.3f of pbi's error\n", ghosts);
  EXPECT_GT(ghosts, 1.2);
}

}  // namespace
}  // namespace rimlight
