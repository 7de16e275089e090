#include "core/report/sh_policies.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>

#include "core/base/error.h"
#include "core/base/stopwatch.h"
#include "core/basis/sh_rotation.h"
#include "core/report/report_files.h"
#include "core/vertices/incremental_irradiance.h"
#include "core/vertices/sh_band_policy.h"
#include "core/vertices/sh_benefit_policy.h"

namespace rimlight {
namespace {

using Policy = ShPolicyRun::Policy;

/// Chooses as a run asks for.
class Chooser {
 public:
  Chooser(const ShPolicyRun& run, int degree, const std::vector<float>& energies)
      : run_(run), band_(degree), benefit_(energies) {
    first_.resize(std::min(run.budget, sh::coefficient_count(degree)));
    std::iota(first_.begin(), first_.end(), 0u);
  }

  std::span<const std::uint32_t> choose(std::span<const float> target,
                                        std::span<const float> held) {
    switch (run_.policy) {
      case Policy::pbi:
        return band_.choose(target, held, run_.budget);
      case Policy::benefit:
        return benefit_.choose(target, held, run_.budget);
      case Policy::linear:
        break;
    }
    return first_;
  }

  /// What a run shows of its first light: linear ones their first coefficients.
  std::vector<float> first_light(std::vector<float> light) const {
    if (run_.policy != Policy::linear) return light;
    const std::size_t count = light.size() / 3;
    for (std::size_t i = 0; i < light.size(); ++i) {
      if (i % count >= first_.size()) light[i] = 0;
    }
    return light;
  }

 private:
  const ShPolicyRun& run_;
  ShBandPolicy band_;
  ShBenefitPolicy benefit_;
  std::vector<std::uint32_t> first_;
};

using Image = std::vector<float>;  // [batch][3][kBatchVertices]

struct TurnedLight {
  bool moving = false;
  std::vector<float> light;
  Image full;
};

std::vector<TurnedLight> turn_light(const LitMesh& lit, const Environment& light,
                                    const ShPolicySettings& settings) {
  if (!settings.sequence.rotated_light()) {
    throw Error(settings.sequence.name, "a sequence that does something else",
                "one that turns a single light and does nothing else");
  }
  const auto source = light_coefficients(light, lit.degree);
  const int all = settings.sequence.frame_count();
  const int count = settings.most_frames > 0 ? std::min(settings.most_frames, all) : all;
  IncrementalIrradiance exact(lit.view());
  std::vector<TurnedLight> frames;
  for (int i = 0; i < count; ++i) {
    TurnedLight& frame = frames.emplace_back();
    frame.moving = settings.sequence.is_moving(i);
    frame.light.resize(source.size());
    sh::Rotation(*settings.sequence.rotation_at(i), lit.degree).apply(source, frame.light);
    exact.set(frame.light);
    frame.full.assign(exact.irradiance().begin(), exact.irradiance().end());
  }
  return frames;
}

double squared_norm(const Image& image) {
  return std::inner_product(image.begin(), image.end(), image.begin(), 0.0);
}

/// The largest |(a − b) − (c − d)| of a vertex, over its channels; c and d may be empty.
double largest_change(std::span<const float> a, std::span<const float> b, std::span<const float> c,
                      std::span<const float> d) {
  double largest = 0;
  constexpr std::size_t kPerBatch = 3 * kBatchVertices;
  for (std::size_t batch = 0; batch < a.size(); batch += kPerBatch) {
    for (std::size_t lane = 0; lane < kBatchVertices; ++lane) {
      double square = 0;
      for (std::size_t at = batch + lane; at < batch + kPerBatch; at += kBatchVertices) {
        square += std::pow((double{a[at]} - b[at]) - (double{c[at]} - d[at]), 2);
      }
      largest = std::max(largest, square);
    }
  }
  return std::sqrt(largest);
}

}  // namespace

std::string ShPolicyRun::name() const {
  const char* const policy_name = policy == Policy::linear ? "linear"
                                  : policy == Policy::pbi  ? "pbi"
                                                           : "benefit";
  return policy_name + ("@" + std::to_string(budget));
}

std::vector<ShPolicyRun> default_sh_policy_runs() {
  return {{Policy::linear, 25}, {Policy::linear, 100}, {Policy::pbi, 25}, {Policy::benefit, 25}};
}

std::vector<ShPolicyRow> measure_sh_policies(const LitMesh& lit, const Environment& light,
                                             const ShPolicySettings& settings,
                                             const std::function<void(double)>& progress) {
  const std::vector<TurnedLight> frames = turn_light(lit, light, settings);
  const std::vector<float> energies = column_energies(lit.view());
  std::vector<ShPolicyRow> rows;
  for (std::size_t r = 0; r < settings.runs.size(); ++r) {
    Chooser chooser(settings.runs[r], lit.degree, energies);
    IncrementalIrradiance shown(lit.view());
    shown.set(chooser.first_light(frames.front().light));
    Image before;
    for (std::size_t i = 0; i < frames.size(); ++i) {
      const TurnedLight& frame = frames[i];
      before.assign(shown.irradiance().begin(), shown.irradiance().end());
      Stopwatch watch;
      shown.update(chooser.choose(frame.light, shown.held()), frame.light);
      ShPolicyRow& row = rows.emplace_back();
      row.ms = watch.lap_ms();
      row.mesh = lit.name;
      row.light = light.name();
      row.run = settings.runs[r].name();
      row.degree = lit.degree;
      row.frame = static_cast<int>(i);
      row.moving = frame.moving;
      const Image now(shown.irradiance().begin(), shown.irradiance().end());
      const double size = std::sqrt(squared_norm(frame.full));
      Image difference(now.size());
      std::ranges::transform(now, frame.full, difference.begin(), std::minus<>());
      row.relative_l2 = std::sqrt(squared_norm(difference)) / size;
      const Image& full_before = frames[i == 0 ? 0 : i - 1].full;
      const double mean = size / std::sqrt(static_cast<double>(lit.mesh.positions.size()));
      row.largest_jump = largest_change(now, before, frame.full, full_before) / mean;
    }
    if (progress) progress(static_cast<double>(r + 1) / static_cast<double>(settings.runs.size()));
  }
  return rows;
}

nlohmann::json to_json(const std::vector<ShPolicyRow>& rows) {
  nlohmann::json result = {{"experiment", "sh-policies"},
                           {"machine", describe_machine()},
                           {"rows", nlohmann::json::array()}};
  for (const ShPolicyRow& row : rows) {
    result["rows"].push_back({{"mesh", row.mesh},
                              {"light", row.light},
                              {"degree", row.degree},
                              {"run", row.run},
                              {"frame", row.frame},
                              {"moving", row.moving},
                              {"ms", row.ms},
                              {"relative_l2", row.relative_l2},
                              {"largest_jump", row.largest_jump}});
  }
  return result;
}

Figures draw_figures(const std::vector<ShPolicyRow>& rows, const std::filesystem::path& folder) {
  using Curves = std::map<std::string, std::vector<std::vector<double>>>;  // by run
  std::map<std::string, Curves> pictures;
  for (const ShPolicyRow& row : rows) {
    // What is exact has no place on a logarithmic axis.
    if (!(row.relative_l2 > 0)) continue;
    pictures[row.mesh + ", " + row.light][row.run].push_back(
        {static_cast<double>(row.frame), row.relative_l2});
  }
  Figures figures;
  for (const auto& [title, curves] : pictures) {
    const std::string picture = "sh-policies-" + std::to_string(figures.scripts.size()) + ".png";
    GnuplotScript script(picture);
    script.add("set title " + gnuplot_quote("Error of irradiance against frame: " + title));
    script.add("set xlabel \"frame\"\nset logscale y\nset key outside right");
    script.add("set ylabel \"error, L2, relative\"");
    std::string plot;
    std::size_t count = 0;
    for (const auto& [run, points] : curves) {
      const std::string data = "d" + std::to_string(count++);
      script.add_data(data, points);
      plot += (plot.empty() ? "plot $" : ", $") + data + " using 1:2 with lines lw 1.5 title " +
              gnuplot_quote(run);
    }
    script.add(plot);
    draw_figure(script, folder / picture, figures);
  }
  return figures;
}

}  // namespace rimlight
