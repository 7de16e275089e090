#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>

#include "core/report/brdf_edit.h"
#include "core/report/gnuplot.h"

namespace rimlight {

/// {"experiment", "machine", "rows", "summary", "edits", "stale", …}: docs/formats/report.md has
/// every field.
nlohmann::json to_json(const BrdfEditReport& report);

/// Error against frame with 30 terms, and means of moving frames against terms and against
/// milliseconds. Throws Error when the folder cannot be written or gnuplot fails.
Figures draw_figures(const BrdfEditReport& report, const std::filesystem::path& folder);

}  // namespace rimlight
