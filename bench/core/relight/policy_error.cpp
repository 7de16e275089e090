// Error of the lighting under each policy while a light turns, and when it stops (the figure 6.2 of
// Overbeck 2006): area-weighted L1, relative to the light. No times: the same numbers everywhere.
//
//     policy_error [DEGREES_A_FRAME]      [3]
//
// Lights: those made by code and, where RIMLIGHT_DATA names real data, Grace Cathedral.
#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <string>
#include <vector>

#include "core/light/environment.h"
#include "tests/support/real_data.h"
#include "tests/support/turning_light.h"

namespace rimlight {
namespace {

using test::PolicyRun;
using Start = PolicyRun::Start;

const std::vector<PolicyRun> kRuns = {
    {"linear", 30, Start::nothing},   {"nwa", 30, Start::nothing},
    {"nwa", 60, Start::nothing},      {"nwa", 100, Start::nothing},
    {"nwa", 500, Start::nothing},     {"bi", 30, Start::exact},
    {"bi", 30, Start::nothing},       {"pbi", 30, Start::exact},
    {"pbi", 30, Start::nothing},      {"pbi:unweighted", 30, Start::exact},
    {"pbi:dealer", 30, Start::exact}, {"pbi:exhaustive", 30, Start::exact},
    {"benefit", 30, Start::exact}};

void report(const Environment& environment, int size, const test::TurningLight& settings) {
  const CubeHaar haar(size);
  const auto frames = turn(environment, haar, settings);
  const auto errors = [&](const PolicyRun& run) { return lighting_errors(haar, frames, run); };
  const double nwa60 = test::mean_of_first(errors({"nwa", 60}), settings.turning_frames);
  const double nwa500 = errors({"nwa", 500}).back();
  std::printf("\n%s, 6x%dx%d\n%-16s %6s %-8s %9s %10s %9s  %s\n", environment.name().c_str(), size,
              size, "policy", "budget", "from", "mean", "of nwa 60", "worst",
              "still frames until below nwa 500");
  for (const PolicyRun& run : kRuns) {
    const auto found = errors(run);
    const double mean = test::mean_of_first(found, settings.turning_frames);
    const int still = still_frames_until_below(found, settings, nwa500);
    std::printf("%-16s %6zu %-8s %9.4f %10.3f %9.4f  %s\n", run.policy.c_str(), run.budget,
                run.start == Start::exact ? "exact" : "nothing", mean, mean / nwa60,
                *std::max_element(found.begin(), found.begin() + settings.turning_frames),
                still > settings.still_frames ? "never" : std::to_string(still).c_str());
  }
}

}  // namespace
}  // namespace rimlight

int main(int argc, char** argv) {
  using namespace rimlight;
  test::TurningLight settings;
  if (argc > 1) settings.most_degrees_a_frame = std::atof(argv[1]);
  std::vector<Environment> environments;
  for (const std::string& name : builtin_environment_names()) {
    environments.push_back(builtin_environment(name));
  }
  if (const auto data = test::real_data()) {
    environments.push_back(load_environment(*data / "probes" / "grace_probe.hdr"));
  }
  for (const Environment& environment : environments) {
    for (const int size : {32, 64}) report(environment, size, settings);
  }
}
