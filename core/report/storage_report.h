#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>

#include "core/report/gnuplot.h"
#include "core/report/storage_comparison.h"

namespace rimlight {

/// {"experiment", "machine", "rows", …}: docs/formats/report.md has every field.
nlohmann::json to_json(const StorageComparison& comparison);

/// Bytes against error: the plain way's curve, and where the bake lies. Throws Error when the
/// folder cannot be written or gnuplot fails.
Figures draw_figures(const StorageComparison& comparison, const std::filesystem::path& folder);

}  // namespace rimlight
