#include "cli/import_report.h"

#include <cmath>
#include <cstdio>
#include <nlohmann/json.hpp>

namespace rimlight {
namespace {

nlohmann::json describe(const ImportSummary& summary, const std::filesystem::path& folder) {
  nlohmann::json resampling = nlohmann::json::object();
  for (const ResamplingError& error : summary.resampling) {
    resampling[error.light] = {{"psnr_db", error.psnr_db}, {"relative_l2", error.relative_l2}};
  }
  return {{"bake", folder.string()},
          {"seconds", summary.seconds},
          {"width", summary.pixels.width},
          {"height", summary.pixels.height},
          {"directions", summary.directions},
          {"cube_size", summary.cube_size},
          {"weight_sum", summary.weight_sum},
          {"covered_steradians", summary.covered},
          {"largest_weight", summary.largest_weight},
          {"largest_weight_of", summary.largest_direction},
          {"median_weight", summary.median_weight},
          {"resampling", resampling},
          {"transport_bytes", summary.bytes},
          {"worst_psnr_db", summary.worst_psnr_db},
          {"worst_light", summary.worst_light}};
}

/// What looks like a mistake, though it need not be one.
void warn(const ImportSummary& summary) {
  constexpr double kOdd = 0.05, kGap = 6;
  if (std::abs(summary.weight_sum - summary.covered) > kOdd * summary.covered) {
    std::fprintf(stderr,
                 "rimlight import: the weights sum to %.4g sr where %.4g sr are covered: the "
                 "picture is brighter or darker by that\n",
                 summary.weight_sum, summary.covered);
  }
  if (summary.largest_weight > kGap * summary.median_weight) {
    std::fprintf(stderr,
                 "rimlight import: direction %zu stands for %.3g sr, the median for %.3g: if the "
                 "lights cover a part of the sphere only, say which with --cap\n",
                 summary.largest_direction, summary.largest_weight, summary.median_weight);
  }
}

void print(const ImportSummary& summary, const std::filesystem::path& folder) {
  std::fprintf(stderr, "%s: %.0f s, %zu directions on 6 × %d × %d texels, %.1f MiB of transport\n",
               folder.c_str(), summary.seconds, summary.directions, summary.cube_size,
               summary.cube_size, static_cast<double>(summary.bytes) / (1 << 20));
  std::fprintf(stderr, "  resampling:");
  for (const ResamplingError& error : summary.resampling) {
    std::fprintf(stderr, " %s %.1f dB,", error.light.c_str(), error.psnr_db);
  }
  std::fprintf(stderr, " against the directions themselves\n");
  std::fprintf(stderr, "  compression: %.1f dB under its worst check light (%s)\n",
               summary.worst_psnr_db, summary.worst_light.c_str());
}

}  // namespace

void report_import(const ImportSummary& summary, const std::filesystem::path& folder, bool json) {
  warn(summary);
  if (json) {
    std::printf("%s\n", describe(summary, folder).dump().c_str());
  } else {
    print(summary, folder);
  }
}

}  // namespace rimlight
