#pragma once

#include <filesystem>
#include <functional>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "core/report/gnuplot.h"
#include "core/report/report_page.h"
#include "core/transport/bake_folder.h"

namespace rimlight {

/// One way to encode a frame: a rung of the ladder that clients climb (server/delivery/ladder.h),
/// or lossless.
struct CodecRow {
  std::string codec;  // "vp8", "jpeg", "png"
  int rung = -1;      // -1: lossless, on no rung
  int quality = 0, divisor = 1;
  double bytes = 0;      // a frame's, median; of VP8 those that follow another
  double key_bytes = 0;  // of VP8's first frame, that follows none; else 0
  double ms = 0;         // median; shrinking included
  double psnr_db = 0;    // against the picture as it was shrunk, mean; 99: exact
};

struct CodecReport {
  std::string scene, light;
  int width = 0, height = 0, pictures = 0;
  std::vector<CodecRow> rows;
};

/// Encodes exact pictures of a bake under its first light, each turned a little further than the
/// one before, by every rung and losslessly. One thread encodes VP8, all cores JPEG.
CodecReport measure_codecs(const std::shared_ptr<const Bake>& bake, int pictures,
                           const std::function<void(const std::string&, double)>& progress);

/// docs/formats/report.md.
nlohmann::json to_json(const CodecReport& report);
ReportSection section_of(const CodecReport& report);
/// PSNR against bytes. As draw_figures() of core/report/figures.h.
Figures draw_figures(const CodecReport& report, const std::filesystem::path& folder);

}  // namespace rimlight
