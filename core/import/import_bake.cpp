#include "core/import/import_bake.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <system_error>
#include <utility>

#include "core/bake/transport_bake.h"
#include "core/base/check.h"
#include "core/base/error.h"
#include "core/base/stopwatch.h"
#include "core/basis/cube_haar.h"
#include "core/import/imported_rows.h"
#include "core/transport/bake_folder.h"

namespace rimlight {
namespace {

constexpr int kSmallestCubeSize = 8;
constexpr int kLargestCubeSize = 64;
/// The cube map that the resampling error is measured against: four times finer where that is
/// affordable, and never so coarse that a light's details are lost.
int fine_size(int size) { return std::clamp(4 * size, 128, 256); }

std::string text_of(double number) {
  char text[32];
  std::snprintf(text, sizeof text, "%.4g", number);
  return text;
}

std::string sides(int width, int height) {
  return std::to_string(width) + " × " + std::to_string(height) + " pixels";
}

/// The weight of each direction: as given, or its cell.
std::vector<double> weights_of(const DirectionList& list, const DirectionCells& cells) {
  std::vector<double> weights = list.weights;
  for (std::size_t i = 0; i < list.size(); ++i) {
    const double area = cells.solid_angle(i);
    if (!(area > 0)) {
      throw Error(list.source + ": direction " + std::to_string(i),
                  "one that is nearest to nothing", "directions inside the cap");
    }
    if (list.weights.empty()) weights.push_back(area);
  }
  return weights;
}

void check_cap(const DirectionList& list, const SphericalCap& cap) {
  constexpr double kRounding = 1e-6;
  const double degrees = 180 / std::numbers::pi;
  for (std::size_t i = 0; i < list.size(); ++i) {
    const double angle = cap.angle_to(list.directions[i]);
    if (angle <= cap.half_angle + kRounding) continue;
    throw Error(list.source + ": direction " + std::to_string(i),
                text_of(angle * degrees) + " degrees from the cap's axis",
                "at most " + text_of(cap.half_angle * degrees));
  }
}

/// Removes the unfinished bake when an import fails: there is nothing to resume.
class DiscardOnFailure {
 public:
  explicit DiscardOnFailure(std::filesystem::path folder) : folder_(std::move(folder)) {}
  DiscardOnFailure(const DiscardOnFailure&) = delete;
  DiscardOnFailure& operator=(const DiscardOnFailure&) = delete;
  ~DiscardOnFailure() {
    if (done_) return;
    std::error_code ignored;
    std::filesystem::remove_all(folder_, ignored);
  }
  void keep() { done_ = true; }

 private:
  std::filesystem::path folder_;
  bool done_ = false;
};

/// One import from begin to end.
class Import {
 public:
  Import(const DirectionList& list, const ImportSettings& settings)
      : list_(list),
        settings_(settings),
        haar_(settings.cube_size > 0 ? settings.cube_size : cube_size_for(list.size())),
        cells_(list.directions, haar_.size(), settings.cap),
        weights_(weights_of(list, cells_)),
        resampler_(cells_, energies()) {}

  ImportSummary run(const TransportSource& source, const std::filesystem::path& folder,
                    const std::function<void(const BakeProgress&)>& progress) {
    if (progress) progress({"measuring", 0, false});
    summarize(source);
    const std::vector<float> coverage = coverage_of(source.pixels());
    receiver_coverage_ = by_receiver(coverage, source.pixels());
    summary_.resampling = measure_resampling(source, receiver_coverage_, built_in_lights());
    const ImportedRows rows(source.pixels(), haar_.size(), receiver_coverage_,
                            [&](std::size_t first_receiver, GroupRows& coefficients) {
                              fill(source, first_receiver, coefficients);
                            });
    const BakeSummary written = bake_transport(rows, request(), folder, progress);
    summary_.bytes = written.bytes;
    summary_.worst_psnr_db = written.worst_psnr_db;
    summary_.worst_light = written.worst_light;
    return summary_;
  }

 private:
  std::vector<double> energies() const {
    if (settings_.unit == ColumnUnit::irradiance) return weights_;
    return std::vector<double>(list_.size(), 1.0);
  }

  void summarize(const TransportSource& source) {
    if (source.direction_count() != list_.size()) {
      throw Error(list_.source, std::to_string(list_.size()) + " directions",
                  std::to_string(source.direction_count()) + ", one for each column or picture");
    }
    summary_.pixels = source.pixels();
    summary_.directions = list_.size();
    summary_.cube_size = haar_.size();
    summary_.covered = settings_.cap.solid_angle();
    std::vector<double> sorted = weights_;
    std::sort(sorted.begin(), sorted.end());
    for (const double weight : sorted) summary_.weight_sum += weight;
    summary_.median_weight = sorted[sorted.size() / 2];
    summary_.largest_weight = sorted.back();
    summary_.largest_direction = static_cast<std::size_t>(
        std::max_element(weights_.begin(), weights_.end()) - weights_.begin());
  }

  std::vector<float> coverage_of(const PixelLayout& pixels) const {
    if (!settings_.mask) {
      return std::vector<float>(
          static_cast<std::size_t>(pixels.width) * static_cast<std::size_t>(pixels.height), 1.0f);
    }
    const CoverageMask& mask = *settings_.mask;
    if (mask.width != pixels.width || mask.height != pixels.height) {
      throw Error(mask.source, sides(mask.width, mask.height), sides(pixels.width, pixels.height));
    }
    if (std::none_of(mask.shares.begin(), mask.shares.end(), [](float s) { return s > 0; })) {
      throw Error(mask.source, "a mask that covers nothing", "a pixel that is not black in it");
    }
    return mask.shares;
  }

  /// By receiver, padded ones 0.
  static std::vector<float> by_receiver(const std::vector<float>& coverage,
                                        const PixelLayout& pixels) {
    std::vector<float> result(pixels.receiver_count());
    for (std::size_t receiver = 0; receiver < result.size(); ++receiver) {
      const auto [x, y] = pixels.pixel(receiver);
      if (x >= pixels.width || y >= pixels.height) continue;
      result[receiver] =
          coverage[static_cast<std::size_t>(y) * static_cast<std::size_t>(pixels.width) +
                   static_cast<std::size_t>(x)];
    }
    return result;
  }

  std::vector<ResampledLight> built_in_lights() const {
    const int size = fine_size(haar_.size());
    const TransportResampler fine(DirectionCells(list_.directions, size, settings_.cap),
                                  energies());
    std::vector<ResampledLight> lights;
    for (const std::string& name : builtin_environment_names()) {
      const Environment environment = builtin_environment(name);
      lights.push_back({name, fine.light_of_directions(environment.project(size)),
                        resampler_.light_of_directions(environment.project(haar_.size()))});
    }
    return lights;
  }

  /// A group's rows, resampled and transformed. Receivers that nothing covers become black.
  void fill(const TransportSource& source, std::size_t first_receiver,
            GroupRows& coefficients) const {
    AlignedVector<float> rows(list_.size() * kRowLanes);
    source.read_group(first_receiver, rows);
    for (std::size_t lane = 0; lane < kGroupLanes; ++lane) {
      if (receiver_coverage_[first_receiver + lane] > 0) continue;
      for (std::size_t i = lane; i < rows.size(); i += kGroupLanes) rows[i] = 0;
    }
    GroupRows texels(haar_.size());
    resampler_.resample(rows, texels);
    haar_.forward(texels.values, coefficients.values, kRowLanes);
  }

  BakeRequest request() const {
    BakeRequest request;
    request.scene = settings_.name;
    request.camera = settings_.camera;
    request.environments = settings_.environments;
    request.psnr_db = settings_.psnr_db;
    request.stage = "resampling";
    request.settings = {
        {"imported", true},
        {"directions", list_.size()},
        {"unit", settings_.unit == ColumnUnit::irradiance ? "irradiance" : "radiance"},
        {"weights", settings_.unit == ColumnUnit::radiance ? "not needed"
                    : list_.weights.empty()                ? "voronoi"
                                                           : "given"},
        {"covered_steradians", summary_.covered},
        {"psnr_db", settings_.psnr_db}};
    for (const ResamplingError& error : summary_.resampling) {
      request.measured["resampling"][error.light] = {
          {"psnr_db", std::round(error.psnr_db * 100) / 100}, {"relative_l2", error.relative_l2}};
    }
    return request;
  }

  const DirectionList& list_;
  const ImportSettings& settings_;
  CubeHaar haar_;
  DirectionCells cells_;
  std::vector<double> weights_;
  TransportResampler resampler_;
  std::vector<float> receiver_coverage_;
  ImportSummary summary_;
};

}  // namespace

int cube_size_for(std::size_t directions) {
  int size = kSmallestCubeSize;
  while (size < kLargestCubeSize && cube::texel_count(size) < 3 * directions) size *= 2;
  return size;
}

ImportSummary import_bake(const MakeSource& make_source, const DirectionList& directions,
                          const ImportSettings& settings, const std::filesystem::path& folder,
                          const std::function<void(const BakeProgress&)>& progress) {
  RIMLIGHT_CHECK(!settings.environments.empty());
  const Stopwatch watch;
  check_cap(directions, settings.cap);
  Import import(directions, settings);
  // Made once before the pictures are read: it refuses a folder that is no bake. What a killed
  // import left there is of other transport, for all that is known: nothing of it is resumed.
  const std::filesystem::path partial = BakeWriter(folder).partial_folder();
  DiscardOnFailure discard(partial);
  std::error_code error;
  std::filesystem::remove_all(partial, error);
  if (!error) std::filesystem::create_directory(partial, error);
  if (error) throw Error(partial.string(), error.message(), "a folder that can be written");
  ImportSummary summary = import.run(*make_source(partial), folder, progress);
  discard.keep();
  summary.seconds = watch.elapsed_seconds();
  return summary;
}

}  // namespace rimlight
