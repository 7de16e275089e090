#include "tests/support/turning_light.h"

#include <algorithm>
#include <numbers>
#include <numeric>

#include "core/light/light_rotation.h"
#include "core/relight/policy_settings.h"
#include "tests/support/policy_case.h"

namespace rimlight::test {

std::vector<CubeLight> turn(const Environment& environment, const CubeHaar& haar,
                            const TurningLight& settings) {
  LightRotator rotator(environment.project(haar.size()));
  std::vector<CubeLight> frames;
  CubeLight texels;
  double degrees = 0;
  for (int frame = 0; frame < settings.turning_frames; ++frame) {
    const double t = frame / (settings.turning_frames - 1.0);
    degrees += settings.most_degrees_a_frame * t * t * (3 - 2 * t);
    rotator.rotate(axis_angle({0, 1, 0}, degrees * std::numbers::pi / 180), texels);
    frames.emplace_back(haar.size());
    for (int c = 0; c < 3; ++c) haar.forward(texels.channel(c), frames.back().channel(c));
  }
  for (int i = 0; i < settings.still_frames; ++i) frames.push_back(CubeLight(frames.back()));
  return frames;
}

std::vector<double> lighting_errors(const CubeHaar& haar, const std::vector<CubeLight>& frames,
                                    const PolicyRun& run) {
  const auto policy = make_policy(parse_policy(run.policy, "policy"));
  const std::size_t columns = haar.coefficient_count();
  std::vector<float> norm_squared(3 * columns);
  for (std::size_t i = 0; i < norm_squared.size(); ++i) {
    norm_squared[i] = static_cast<float>(haar.band_area(haar.band_of(i % columns)));
  }
  const bool exact = run.start == PolicyRun::Start::exact;
  CubeLight held = exact ? frames.front() : CubeLight(haar.size());
  PlanWorkspace workspace;
  UpdatePlan plan;
  std::vector<double> errors;
  for (const CubeLight& target : frames) {
    policy->make_plan({haar, target, held, Budget::coefficients(run.budget), norm_squared},
                      workspace, plan);
    apply(plan, haar, target, held);
    errors.push_back(weighted_distance(haar, target, held) / weighted_size(haar, target));
  }
  return errors;
}

double mean_of_first(const std::vector<double>& errors, int count) {
  return std::accumulate(errors.begin(), errors.begin() + count, 0.0) / count;
}

int still_frames_until_below(const std::vector<double>& errors, const TurningLight& settings,
                             double level) {
  const auto still = errors.begin() + settings.turning_frames;
  const auto found = std::find_if(still, errors.end(), [&](double e) { return e < level; });
  return static_cast<int>(found - still) + 1;
}

}  // namespace rimlight::test
