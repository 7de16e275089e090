#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <span>

#include "core/report/adaptive_sh.h"
#include "core/report/gnuplot.h"

namespace rimlight {

/// {"experiment", "machine", "rows"}: docs/formats/report.md has every field.
nlohmann::json to_json(std::span<const AdaptiveShRow> rows);

/// Frames a second against the number of coefficients, one picture a mesh and light. Throws Error
/// when the folder cannot be written or gnuplot fails.
Figures draw_figures(std::span<const AdaptiveShRow> rows, const std::filesystem::path& folder);

}  // namespace rimlight
