#pragma once

#include <cstddef>
#include <filesystem>
#include <functional>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "core/light/environment.h"
#include "core/light/light_sequence.h"
#include "core/report/gnuplot.h"
#include "core/report/lit_mesh.h"

namespace rimlight {

/// How a frame follows a turning light in spherical harmonics, and how many coefficients it may
/// change.
struct ShPolicyRun {
  enum class Policy { linear, pbi, benefit } policy = Policy::linear;
  std::size_t budget = 25;  // linear: the first so many, all of them in every frame

  /// "pbi@25".
  std::string name() const;
};

/// One frame of one run. Errors are of irradiance, over all vertices, against all coefficients.
struct ShPolicyRow {
  std::string mesh, light, run;
  int degree = 0;
  int frame = 0;
  bool moving = false;
  double ms = 0;           // choosing and adding
  double relative_l2 = 0;  // ‖shown − full‖ / ‖full‖
  /// Flicker: what a vertex changed by since the frame before, beyond what the full light of it
  /// did; the largest of any vertex, over the root of the mean of squares of the full light.
  double largest_jump = 0;
};

struct ShPolicySettings {
  LightSequence sequence;  // that turns one light
  int most_frames = 0;     // 0: all
  std::vector<ShPolicyRun> runs;
};

/// linear with 25 and 100, pbi and benefit with 25: what chapter 8 of Overbeck 2006 compares.
std::vector<ShPolicyRun> default_sh_policy_runs();

/// Plays a sequence that turns a light over a mesh through every run, each from the full light of
/// the first frame. Throws Error when the sequence does anything else.
std::vector<ShPolicyRow> measure_sh_policies(const LitMesh& lit, const Environment& light,
                                             const ShPolicySettings& settings,
                                             const std::function<void(double)>& progress);

/// docs/formats/report.md.
nlohmann::json to_json(const std::vector<ShPolicyRow>& rows);

/// Error against frame, a picture for each mesh and light. As draw_figures() of figures.h.
Figures draw_figures(const std::vector<ShPolicyRow>& rows, const std::filesystem::path& folder);

}  // namespace rimlight
