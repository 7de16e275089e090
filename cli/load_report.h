#pragma once

#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "cli/load_client.h"
#include "core/vertices/vertex_renderer.h"

namespace rimlight {

/// One thing that `load` checks. Without a verdict it was not run.
struct LoadCheck {
  std::string name;
  std::optional<bool> pass;
  std::string detail;
};

/// What all clients of a run saw together.
struct LoadReport {
  double frames_per_second = 0;  // of all clients together, frames in motion alone
  double latency_p50_ms = 0, latency_p95_ms = 0, latency_p99_ms = 0;
  double bytes_per_frame = 0;
  std::int64_t skipped = 0;
  double exact_after_ms = 0;  // the last exact frame after the last edit: the longest of all
  RungCounts rungs;           // of frames in motion
  std::vector<LoadCheck> checks;

  /// Of the client on a narrow link alone, which is in none of the numbers above.
  struct Slow {
    double frames_per_second = 0;
    double latency_p50_ms = 0, latency_p99_ms = 0;  // of its own edits
    RungCounts rungs;
  };
  std::optional<Slow> slow;

  bool passed() const;
  nlohmann::json to_json() const;
  std::string to_text() const;
};

/// Whether a frame in motion that shows nothing new is a fault: with the default script only.
enum class ScriptKind { every_edit_changes, any };

/// Everything but the comparison with the bake.
LoadReport summarize(const std::vector<LoadRecord>& records, ScriptKind script);

/// Compares each client's last frame with what `rimlight render` makes of its state.
/// An empty `bake_folder` gives a check that was not run.
LoadCheck compare_with_bake(const std::vector<LoadRecord>& records, const std::string& bake_folder,
                            const VertexSettings& vertices);

/// The smallest value that at least `share` of the values do not exceed; 0 of none. Sorts them.
double percentile(std::vector<double>& values, double share);

}  // namespace rimlight
