#pragma once

#include <filesystem>

#include "core/report/error_vs_time.h"
#include "core/report/gnuplot.h"

namespace rimlight {

/// Draws a report with gnuplot where it is installed, and leaves the scripts, which hold their
/// data. For each light: error against frame (Overbeck 2006, figure 6.2) in the light and in the
/// image; against milliseconds; resets by band (6.4); coverage (5.3); energy by spatial and
/// temporal band (5.4); quality against terms (7.1). Figures that the report has no data for are
/// left out. Throws Error when the folder cannot be written or gnuplot fails.
Figures draw_figures(const ErrorVsTimeReport& report, const std::filesystem::path& folder);

}  // namespace rimlight
