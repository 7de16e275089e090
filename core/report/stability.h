#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <nlohmann/json.hpp>
#include <span>
#include <string>
#include <vector>

#include "core/report/gnuplot.h"

namespace rimlight {

/// How a case is measured.
struct StabilityTrial {
  bool fast = false;              // fewer and smaller trials, for test suites
  bool broken = false;            // disturbs what it measures, so that it must fail
  std::size_t edits = 1'000'000;  // of the cases about drift
  std::size_t turns = 1'000'000;  // of the cases about composed rotations

  /// What differs where a case is to be broken.
  template <typename T>
  T either(const T& sound, const T& disturbed) const {
    return broken ? disturbed : sound;
  }
};

struct StabilityMeasure {
  double value = 0;
  std::string note = {};  // what else there is to say: how far a series got, a condition number
};

enum class BoundKind : std::uint8_t { at_most, at_least };

/// Something that must hold at an extreme.
struct StabilityCase {
  std::string name;      // of its own, in words for a command line: "single-lit-texel"
  std::string part;      // "light", "storage", …
  std::string quantity;  // what is measured, with its unit
  BoundKind kind = BoundKind::at_most;
  double bound = 0;
  std::string why;  // where the bound comes from
  std::function<StabilityMeasure(const StabilityTrial&)> measure;
};

/// All cases, part by part; names differ. The table that `rimlight report stability` runs.
const std::vector<StabilityCase>& stability_cases();

/// A case, measured. What threw is a measure that failed, and says so in its note.
struct StabilityRow {
  const StabilityCase* of = nullptr;
  StabilityMeasure measured;
  double seconds = 0;
  bool pass = false;
};

StabilityRow measure_case(const StabilityCase& one, const StabilityTrial& trial);

/// Which cases to run, and how.
struct StabilitySettings {
  std::vector<std::string> cases;   // by name; none: all
  std::vector<std::string> parts;   // of these parts; none: all
  std::vector<std::string> broken;  // to be disturbed: these run too
  StabilityTrial trial;
};

/// Runs the cases that the settings choose, in the table's order. Throws Error for a name that no
/// case or part has, and when nothing is chosen.
std::vector<StabilityRow> measure_stability(
    const StabilitySettings& settings,
    const std::function<void(const std::string& name, double share)>& progress);

/// Whether a value keeps a bound; a NaN keeps none.
bool keeps_bound(const StabilityCase& of, double value);

/// The report: its rows, and how many failed.
nlohmann::json to_json(std::span<const StabilityRow> rows);
/// None: a case is one number.
Figures draw_figures(std::span<const StabilityRow> rows, const std::filesystem::path& folder);

}  // namespace rimlight
