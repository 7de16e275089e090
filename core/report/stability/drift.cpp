// Rounding of very many incremental edits, and what rebuilding leaves of it.
#include <algorithm>
#include <cmath>
#include <string>

#include "core/math/random.h"
#include "core/relight/relighter.h"
#include "core/report/stability/cases.h"
#include "core/report/stability/random_tiles.h"
#include "core/vertices/incremental_irradiance.h"

namespace rimlight::stability {
namespace {

constexpr int kSize = 4;

std::size_t edit_count(const StabilityTrial& trial) {
  return trial.fast ? std::max<std::size_t>(1, trial.edits / 200) : trial.edits;
}

double relative_l2(std::span<const float> values, std::span<const float> reference) {
  double difference = 0, size = 0;
  for (std::size_t i = 0; i < values.size(); ++i) {
    difference += std::pow(double{values[i]} - double{reference[i]}, 2);
    size += std::pow(double{reference[i]}, 2);
  }
  return std::sqrt(difference / size);
}

/// A few columns that an edit moves, ascending, each once.
std::vector<std::uint32_t> moved_columns(Random& random, std::size_t columns) {
  std::vector<std::uint32_t> moved;
  for (std::size_t i = 3 + random.below(28); i-- > 0;) {
    moved.push_back(static_cast<std::uint32_t>(random.below(columns)));
  }
  std::ranges::sort(moved);
  // Not std::ranges::unique(): clang 14 cannot compile GCC 12's.
  moved.erase(std::unique(moved.begin(), moved.end()), moved.end());
  return moved;
}

/// An image under a light of which each edit moves 3 to 30 columns somewhere else.
class EditedImage {
 public:
  EditedImage() { plan_.bands.assign(static_cast<std::size_t>(haar_.band_count()), {}); }

  void edit() {
    plan_.columns.clear();
    for (BandUpdate& band : plan_.bands) band = {};
    for (const std::uint32_t column : moved_columns(random_, haar_.coefficient_count())) {
      for (int c = 0; c < 3; ++c) {
        target_.channel(c)[column] = static_cast<float>(random_.uniform(-1, 1));
      }
      BandUpdate& band = plan_.bands[static_cast<std::size_t>(haar_.band_of(column))];
      if (band.count++ == 0) band.first = plan_.columns.size();
      band.action = BandAction::increment;
      plan_.columns.push_back({column, target_.at(column) - relighter_.held().layer(0).at(column)});
    }
    relighter_.apply(plan_, target_);
    additions_ += plan_.columns.size();
  }

  /// Against one fresh product of the light that the image should show.
  double error(float disturbed) const {
    Relighter fresh(transport_.view(), reflectance_, haar_);
    CubeLight target = target_;
    for (float& value : target.values) value *= disturbed;
    static_cast<void>(fresh.apply_exact(target, {}));
    return relative_l2(image_of(relighter_), image_of(fresh));
  }

  std::size_t additions() const { return additions_; }

 private:
  static std::vector<float> image_of(const Relighter& relighter) {
    std::vector<float> image(kTileFloats);
    relighter.find_radiance(0, std::span<float, kTileFloats>(image.data(), kTileFloats));
    return image;
  }

  CubeHaar haar_{kSize};
  Transport transport_{
      make_tiles({.columns = haar_.coefficient_count(), .density = 0.7, .seed = 1})};
  ReceiverValues reflectance_ = white(1);
  Relighter relighter_{transport_.view(), reflectance_, haar_};
  Random random_{1};
  CubeLight target_{kSize};
  UpdatePlan plan_;
  std::size_t additions_ = 0;
};

StabilityMeasure edits_of_an_image(const StabilityTrial& trial) {
  EditedImage image;
  const std::size_t count = edit_count(trial);
  double worst = 0;
  for (std::size_t i = 1; i <= count; ++i) {
    image.edit();
    if (i % std::max<std::size_t>(1, count / 20) != 0) continue;
    worst = std::max(worst, image.error(trial.either(1.0f, 1.00002f)));
  }
  return {worst,
          std::to_string(count) + " edits of " + std::to_string(image.additions()) + " columns"};
}

/// Harmonics of 256 vertices to degree 3, in halves.
class EditedVertices {
 public:
  EditedVertices() {
    Random random(2);
    irradiance_.resize(batch_count(kVertices) * kCoefficients * kBatchVertices);
    for (Half& value : irradiance_) value = to_half(static_cast<float>(random.uniform(-1, 1)));
  }

  double error_after(std::size_t edits, float disturbed) {
    const VertexTransportView view{.vertex_count = kVertices,
                                   .irradiance_degree = 3,
                                   .irradiance = irradiance_,
                                   .visibility = {}};
    IncrementalIrradiance edited(view), fresh(view);
    std::vector<float> target(3 * kCoefficients);
    Random random(3);
    double worst = 0;
    for (std::size_t i = 1; i <= edits; ++i) {
      const auto moved = moved_columns(random, kCoefficients);
      for (const std::uint32_t column : moved) {
        for (std::size_t c = 0; c < 3; ++c) {
          target[c * kCoefficients + column] = static_cast<float>(random.uniform(-1, 1));
        }
      }
      edited.update(moved, target);
      if (i % std::max<std::size_t>(1, edits / 20) != 0) continue;
      std::vector<float> asked = target;
      for (float& value : asked) value *= disturbed;
      fresh.set(asked);
      worst = std::max(worst, relative_l2(edited.irradiance(), fresh.irradiance()));
    }
    return worst;
  }

 private:
  static constexpr std::size_t kVertices = 256, kCoefficients = 16;
  AlignedVector<Half> irradiance_;
};

StabilityMeasure edits_of_vertices(const StabilityTrial& trial) {
  const std::size_t count = edit_count(trial);
  return {EditedVertices().error_after(count, trial.either(1.0f, 1.00002f)),
          std::to_string(count) + " edits"};
}

}  // namespace

std::vector<StabilityCase> drift_cases() {
  using enum BoundKind;
  const std::string part = "drift";
  const std::string why =
      "80,000 additions round to √(80,000/3) · 2⁻²⁴ = 9.7e-6 at most before a tile is rebuilt";
  return {
      {"edits-of-an-image", part, "relative L2 of the image after --edits edits, the worst of 20",
       at_most, 1e-5, why, edits_of_an_image},
      {"edits-of-vertices", part, "relative L2 of irradiance after --edits edits, the worst of 20",
       at_most, 1e-5, why, edits_of_vertices},
  };
}

}  // namespace rimlight::stability
