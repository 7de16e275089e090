#include "cli/codec_report.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>

#include "core/base/stopwatch.h"
#include "core/image/codec.h"
#include "core/image/picture_scaler.h"
#include "core/image/vp8_codec.h"
#include "core/relight/frame_renderer.h"
#include "core/report/report_files.h"
#include "server/delivery/ladder.h"

namespace rimlight {
namespace {

using nlohmann::json;
using server::kRungs;
using server::Rung;

/// Twice what a drag turns between two frames.
constexpr double kStepDegrees = 1.5;

double median(std::vector<double> values) {
  if (values.empty()) return 0;
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::ranges::nth_element(values, middle);
  return *middle;
}

double psnr_db(const Rgb8Image& picture, const Rgb8Image& exact) {
  constexpr double kCap = 99;
  double sum = 0;
  for (std::size_t i = 0; i < exact.bytes.size(); ++i) {
    const double difference = double{picture.bytes[i] * 1.0} - exact.bytes[i];
    sum += difference * difference;
  }
  if (sum == 0) return kCap;
  return 10 * std::log10(255.0 * 255.0 * static_cast<double>(exact.bytes.size()) / sum);
}

std::vector<Rgb8Image> turned_pictures(
    const std::shared_ptr<const Bake>& bake, int count,
    const std::function<void(const std::string&, double)>& progress) {
  FrameRenderer renderer(bake, {});
  DesignState state;
  state.environment = bake->environments().front().environment->name();
  std::vector<Rgb8Image> pictures(static_cast<std::size_t>(count));
  for (int i = 0; i < count; ++i) {
    state.rotation = axis_angle({0, 1, 0}, i * kStepDegrees * std::numbers::pi / 180);
    FrameReport ignored;
    renderer.render_exact(state, pictures[static_cast<std::size_t>(i)], ignored);
    progress("exact pictures", static_cast<double>(i + 1) / count);
  }
  return pictures;
}

/// What one rung makes of the pictures.
class RungMeter {
 public:
  explicit RungMeter(const Rung& rung) : rung_(rung) {}

  void add(const Rgb8Image& picture) {
    Stopwatch watch;
    const Rgb8Image* sent = &picture;
    if (rung_.divisor > 1) {
      scaler_.shrink(picture, rung_.divisor, small_);
      sent = &small_;
    }
    const bool is_key = count_++ == 0;
    if (rung_.codec == server::Codec::vp8) {
      if (!encoder_) encoder_.emplace(sent->width, sent->height, rung_.quality);
      encoder_->encode(*sent, {.from_last = !is_key, .from_golden = false}, bytes_);
    } else {
      jpeg_.encode(*sent, rung_.quality, bytes_);
    }
    const double ms = watch.lap_ms();
    if (rung_.codec == server::Codec::vp8) {
      decoder_.value().decode(bytes_, "a frame", decoded_);
    } else {
      decoded_ = decode_jpeg(bytes_.data(), bytes_.size(), "a frame");
    }
    psnr_ += psnr_db(decoded_, *sent);
    if (is_key) {
      key_bytes_ = static_cast<double>(bytes_.size());
      if (rung_.codec == server::Codec::vp8) return;
    }
    ms_.push_back(ms);
    sizes_.push_back(static_cast<double>(bytes_.size()));
  }

  CodecRow row(std::size_t number) const {
    const bool is_vp8 = rung_.codec == server::Codec::vp8;
    return {.codec = is_vp8 ? "vp8" : "jpeg",
            .rung = static_cast<int>(number),
            .quality = rung_.quality,
            .divisor = rung_.divisor,
            .bytes = median(sizes_),
            .key_bytes = is_vp8 ? key_bytes_ : 0,
            .ms = median(ms_),
            .psnr_db = psnr_ / count_};
  }

 private:
  const Rung rung_;
  PictureScaler scaler_;
  JpegEncoder jpeg_;
  std::optional<Vp8Encoder> encoder_;
  std::optional<Vp8Decoder> decoder_ = has_vp8() ? std::make_optional<Vp8Decoder>() : std::nullopt;
  Rgb8Image small_, decoded_;
  std::vector<std::uint8_t> bytes_;
  std::vector<double> ms_, sizes_;
  double psnr_ = 0, key_bytes_ = 0;
  int count_ = 0;
};

CodecRow lossless(const std::vector<Rgb8Image>& pictures) {
  std::vector<double> ms, sizes;
  std::vector<std::uint8_t> png;
  for (const Rgb8Image& picture : pictures) {
    Stopwatch watch;
    encode_png(picture, png);
    ms.push_back(watch.lap_ms());
    sizes.push_back(static_cast<double>(png.size()));
  }
  const Rgb8Image decoded = decode_png(png.data(), png.size(), "a frame");
  return {.codec = "png",
          .bytes = median(sizes),
          .ms = median(ms),
          .psnr_db = psnr_db(decoded, pictures.back())};
}

}  // namespace

CodecReport measure_codecs(const std::shared_ptr<const Bake>& bake, int pictures,
                           const std::function<void(const std::string&, double)>& progress) {
  const std::vector<Rgb8Image> exact = turned_pictures(bake, pictures, progress);
  CodecReport report{.scene = bake->manifest().scene,
                     .light = bake->environments().front().environment->name(),
                     .width = exact.front().width,
                     .height = exact.front().height,
                     .pictures = pictures,
                     .rows = {}};
  for (std::size_t i = has_vp8() ? 0 : server::kVp8Rungs; i < kRungs.size(); ++i) {
    RungMeter meter(kRungs[i]);
    for (const Rgb8Image& picture : exact) meter.add(picture);
    report.rows.push_back(meter.row(i));
    progress("rungs", static_cast<double>(i + 1) / static_cast<double>(kRungs.size()));
  }
  report.rows.push_back(lossless(exact));
  return report;
}

json to_json(const CodecReport& report) {
  json rows = json::array();
  for (const CodecRow& row : report.rows) {
    json one = {{"codec", row.codec},     {"rung", row.rung < 0 ? json(nullptr) : json(row.rung)},
                {"quality", row.quality}, {"divisor", row.divisor},
                {"bytes", row.bytes},     {"key_bytes", row.key_bytes},
                {"ms", row.ms},           {"psnr_db", row.psnr_db}};
    rows.push_back(std::move(one));
  }
  return {{"experiment", "codecs"},      {"machine", describe_machine()}, {"scene", report.scene},
          {"light", report.light},       {"width", report.width},         {"height", report.height},
          {"pictures", report.pictures}, {"rows", std::move(rows)}};
}

ReportSection section_of(const CodecReport& report) {
  ReportSection section{.title = "Codecs: " + report.scene + ", " + report.light,
                        .question =
                            "What each rung of the ladder makes of a picture whose light "
                            "turns: bytes, time and error."};
  section.remarks.push_back(std::to_string(report.pictures) + " exact pictures of " +
                            std::to_string(report.width) + " x " + std::to_string(report.height) +
                            ", the light " + fixed(kStepDegrees, 1) + " degrees further in each.");
  Table table{
      .caption = "Medians; PSNR of the picture as it was shrunk, mean",
      .columns = {"codec", "rung", "quality", "side by", "bytes", "key frame", "ms", "PSNR, dB"}};
  for (const CodecRow& row : report.rows) {
    table.rows.push_back({row.codec, row.rung < 0 ? "-" : std::to_string(row.rung),
                          row.codec == "png" ? "-" : std::to_string(row.quality),
                          std::to_string(row.divisor), fixed(row.bytes, 0),
                          row.key_bytes > 0 ? fixed(row.key_bytes, 0) : "-", fixed(row.ms, 2),
                          fixed(row.psnr_db, 1)});
  }
  section.tables.push_back(std::move(table));
  return section;
}

Figures draw_figures(const CodecReport& report, const std::filesystem::path& folder) {
  GnuplotScript script("codecs.png");
  script.add("set title " + gnuplot_quote("Frames of " + report.scene + ", " + report.light));
  script.add("set xlabel \"bytes a frame\"\nset logscale x\nset key bottom right");
  script.add("set ylabel \"PSNR as displayed, dB\"");
  std::string plot;
  for (const std::string codec : {"vp8", "jpeg"}) {
    std::vector<std::vector<double>> points;
    for (const CodecRow& row : report.rows) {
      if (row.codec == codec) points.push_back({row.bytes, row.psnr_db});
    }
    if (points.empty()) continue;
    script.add_data(codec, points);
    plot += (plot.empty() ? "plot $" : ", $") + codec + " using 1:2 with linespoints pt 7 title " +
            gnuplot_quote(codec);
  }
  script.add(plot);
  Figures figures;
  draw_figure(script, folder / "codecs.png", figures);
  return figures;
}

}  // namespace rimlight
