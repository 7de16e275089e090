#include "core/report/error_vs_time.h"

#include <algorithm>
#include <map>

#include "core/base/error.h"
#include "core/relight/prepared_environment.h"
#include "core/report/run_summary.h"
#include "core/report/timed_run.h"

namespace rimlight {
namespace {

constexpr int kBackgroundSize = 256;  // as a server's
constexpr int kCoverageFrames = 5;    // Overbeck 2006, figure 5.3
constexpr int kCoverageFirst[] = {30, 75, 120};

class Experiment {
 public:
  Experiment(const Bake& bake, const ErrorVsTimeSettings& settings, const ReportProgress& progress)
      : bake_(bake), settings_(settings), progress_(progress), receivers_(bake), errors_(bake) {
    report_.scene = bake.manifest().scene;
    report_.sequence = settings.sequence.name;
    report_.has_reference_rows = receivers_.has_rows();
    report_.receivers = receivers_.count();
    if (!progress_) progress_ = [](const std::string&, double) {};
    report_.cube_size = bake.manifest().cube_size;
    report_.policies = settings.policies;
  }

  ErrorVsTimeReport run() {
    check_policies();
    const auto names = settings_.sequence.light_names();
    const bool takes_light = std::ranges::count(names, kGivenLight) > 0;
    if (!takes_light) {
      play_light("", nullptr);
    } else if (!settings_.lights.empty()) {
      for (const auto& light : settings_.lights) play_light(light->name(), light);
    } else {
      for (const BakedEnvironment& one : bake_.environments()) {
        play_light(one.environment->name(), one.environment);
      }
    }
    return std::move(report_);
  }

 private:
  void check_policies() const {
    std::vector<std::string> known;
    for (const TimedPolicy& policy : settings_.policies) {
      const std::string name = policy.name();
      if (std::ranges::count(known, name) > 0) throw Error(quote(name), "it twice", "it once");
      if (!policy.other.empty() && std::ranges::count(known, policy.other) == 0) {
        throw Error(quote(name), "no earlier " + quote(policy.other),
                    "the policy that it spends as much as before it");
      }
      known.push_back(name);
    }
  }

  LitSequence prepare(const std::string& name, const std::shared_ptr<const Environment>& given) {
    const int size = bake_.manifest().cube_size;
    const LightSequence& sequence = settings_.sequence;
    const LightEnvironments environments = load_environments(sequence, given);
    LitSequence lit{name, LightSequencePlayer(sequence, size, environments), {}, {}, nullptr};
    if (errors_.finer_size() > 0) {
      lit.finer_player.emplace(sequence, errors_.finer_size(), environments);
    }
    if (const auto turned = sequence.rotated_light()) {
      const auto prepared = prepare_environment(environments.at(*turned), {size, kBackgroundSize});
      lit.background = {prepared, &prepared->background};
    }
    const int all = sequence.frame_count();
    const int count = settings_.most_frames > 0 ? std::min(settings_.most_frames, all) : all;
    find_references(
        bake_, receivers_, errors_, count,
        [&](double share) { progress_(name + ": reference images", share); }, lit);
    return lit;
  }

  void play_light(const std::string& name, const std::shared_ptr<const Environment>& given) {
    LitSequence lit = prepare(name, given);
    LightReport& of_light = report_.lights.emplace_back();
    of_light.light = name;
    std::vector<CubeLight> targets;
    for (const ReferenceFrame& frame : lit.frames) targets.push_back(frame.target);
    of_light.spatio_temporal_norms =
        spatio_temporal_norms(CubeHaar(bake_.manifest().cube_size), targets);
    std::map<std::string, FrameMeans> spent;  // by run
    for (std::size_t i = 0; i < settings_.policies.size(); ++i) {
      TimedPolicy policy = settings_.policies[i];
      if (!policy.other.empty()) {
        const FrameMeans& of_other = spent.at(policy.other);
        const bool in_bytes = policy.budget.unit == FrameBudget::Unit::bytes;
        policy.budget.amount = in_bytes ? of_other.median_bytes : of_other.median_ms;
      }
      const TimedRun run = play(bake_, receivers_, policy, lit);
      spent[policy.name()] = mean_of(frames_that_count(run.rows));
      add_coverage(policy.name(), run, of_light);
      report_.rows.insert(report_.rows.end(), run.rows.begin(), run.rows.end());
      progress_(name + ": " + policy.name(),
                static_cast<double>(i + 1) / static_cast<double>(settings_.policies.size()));
    }
  }

  void add_coverage(const std::string& name, const TimedRun& run, LightReport& report) const {
    const CubeHaar haar(bake_.manifest().cube_size);
    const int count = static_cast<int>(run.chosen.size());
    for (const int first : kCoverageFirst) {
      if (first + kCoverageFrames > count) break;
      const auto frames =
          std::span(run.chosen).subspan(static_cast<std::size_t>(first), kCoverageFrames);
      report.coverage.push_back({name, first, kCoverageFrames, find_coverage(haar, frames)});
    }
  }

  const Bake& bake_;
  const ErrorVsTimeSettings& settings_;
  ReportProgress progress_;
  MeasuredReceivers receivers_;
  TransportErrors errors_;
  ErrorVsTimeReport report_;
};

}  // namespace

ErrorVsTimeReport measure_error_vs_time(const Bake& bake, const ErrorVsTimeSettings& settings,
                                        const ReportProgress& progress) {
  return Experiment(bake, settings, progress).run();
}

}  // namespace rimlight
