#include "core/curves/quick_image.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <optional>
#include <vector>

#include "core/base/check.h"
#include "core/base/parallel.h"
#include "core/curves/surface_light.h"
#include "core/math/random.h"
#include "core/transport/receivers.h"

namespace rimlight {
namespace {

Vec3f shade_surface(const CurveReceivers& receivers, std::size_t surface, const CurveLight& light,
                    const CurveMaterialState& state, const LobeTables& tables) {
  thread_local SurfaceSight means, strongest;
  const CurveSurface& at = receivers.surfaces[surface];
  const PreparedSurface prepared = prepare(at, state, tables);
  means.look_at_means(receivers.visibility, surface, at.share, light);
  strongest.look_at_strongest(receivers.visibility, surface, at.share, light);
  Vec3f radiance;
  for (std::size_t q = 0; q < kSurfacePoints; ++q) {
    if (!prepared.faces_viewer[q]) continue;
    LobeSums sums;
    add_shading(tables, prepared.points[q], means.quarter(q, at.points[q]), sums);
    add_shading(tables, prepared.points[q], strongest.quarter(q, at.points[q]), sums);
    radiance += radiance_of(sums, prepared.diffuse[q]);
  }
  return radiance;
}

/// Finds the row that stands for another: the first of its pair of pixels, of its square of four or
/// of its block, that is like it. Rows are asked for in order.
class Leaders {
 public:
  Leaders(const CurveReceivers& receivers, const CurvePanel& panel, QuickDetail detail)
      : receivers_(receivers), panel_(panel), detail_(detail) {}

  std::optional<std::size_t> find(std::size_t row) {
    if (detail_ == QuickDetail::every_row || surface_count(row) != 1) return std::nullopt;
    // A block is 4 × 2 pixels, row by row (PixelLayout).
    const std::uint32_t receiver = panel_.receivers[row];
    const std::uint32_t block = receiver / kBlockReceivers, place = receiver % kBlockReceivers;
    if (block != block_) rows_ = {kNone, kNone, kNone, kNone};
    block_ = block;
    std::size_t& first = rows_[group(place)];
    if (first != kNone && are_alike(first, row)) return first;
    if (first == kNone) first = row;
    return std::nullopt;
  }

 private:
  static constexpr std::size_t kNone = ~std::size_t{0};

  std::size_t group(std::uint32_t place) const {
    switch (detail_) {
      case QuickDetail::one_of_two:
        return place / 2;
      case QuickDetail::one_of_four:
        return place % 4 / 2;
      default:
        return 0;
    }
  }
  std::size_t surface_count(std::size_t row) const {
    return panel_.first_surface[row + 1] - panel_.first_surface[row];
  }
  const CurveSurface& surface(std::size_t row) const {
    return receivers_.surfaces[panel_.first_surface[row]];
  }
  bool are_alike(std::size_t a, std::size_t b) const {
    const float alike = detail_ == QuickDetail::one_of_eight ? 0.99f : 0.998f;
    const auto like = [&](std::size_t point) {
      return dot(surface(a).points[point].normal, surface(b).points[point].normal) >= alike;
    };
    return surface(a).tint == surface(b).tint && like(0) && like(kSurfacePoints - 1);
  }

  const CurveReceivers& receivers_;
  const CurvePanel& panel_;
  QuickDetail detail_;
  std::uint32_t block_ = 0xffffffffu;
  std::array<std::size_t, 4> rows_{kNone, kNone, kNone, kNone};
};

/// The radiance of a row of one surface, by the other's share of its pixel.
void copy_row(const CurveReceivers& receivers, const CurvePanel& panel, std::size_t from,
              std::size_t to, float* image) {
  const auto share = [&](std::size_t row) {
    return receivers.surfaces[panel.first_surface[row]].share;
  };
  const float scale = share(to) / share(from);
  for (std::size_t c = 0; c < 3; ++c) {
    image[c * kPanelRows + to] = image[c * kPanelRows + from] * scale;
  }
}

}  // namespace

QuickDetail quick_detail(std::size_t row_count) {
  constexpr std::size_t kMostRows = 24'000;  // shaded in about a tenth of a second on two cores
  if (row_count <= kMostRows) return QuickDetail::every_row;
  if (row_count <= 2 * kMostRows) return QuickDetail::one_of_two;
  return row_count <= 4 * kMostRows ? QuickDetail::one_of_four : QuickDetail::one_of_eight;
}

QuickShader::QuickShader(const CurveTransport& rows, std::span<const CurveMaterialState> states)
    : rows_(rows), states_(states) {
  RIMLIGHT_CHECK_EQ(states.size(), rows.material_count());
  for (const auto& state : states) tables_.push_back(make_tables(state, CurveAxis::half_angle));
}

void QuickShader::change(std::size_t material) {
  tables_[material] = make_tables(states_[material], CurveAxis::half_angle);
}

bool QuickShader::shade(const CurveLight& light, std::span<const std::uint32_t> panels,
                        QuickDetail detail, const std::function<bool()>& abandon,
                        std::span<float> image) const {
  RIMLIGHT_CHECK_EQ(image.size(), rows_.panels().size() * kPanelFloats);
  const CurveReceivers& receivers = rows_.receivers();
  RIMLIGHT_CHECK_EQ(light.sky().cube_size(), receivers.visibility.cube_size);
  std::atomic<bool> abandoned = false;
  parallel_for(panels.size(), [&](std::size_t i) {
    if (abandoned.load(std::memory_order_relaxed)) return;
    if (abandon && abandon()) {
      abandoned.store(true, std::memory_order_relaxed);
      return;
    }
    const std::size_t p = panels[i];
    const CurvePanel& panel = rows_.panels()[p];
    float* const to = image.data() + p * kPanelFloats;
    std::fill_n(to, kPanelFloats, 0.0f);
    Leaders leaders(receivers, panel, detail);
    for (std::size_t row = 0; row < panel.row_count; ++row) {
      if (const auto leader = leaders.find(row)) {
        copy_row(receivers, panel, *leader, row, to);
        continue;
      }
      Vec3f radiance;
      for (auto s = panel.first_surface[row]; s < panel.first_surface[row + 1]; ++s) {
        radiance +=
            shade_surface(receivers, s, light, states_[panel.material], tables_[panel.material]);
      }
      for (std::size_t c = 0; c < 3; ++c) to[c * kPanelRows + row] = radiance[static_cast<int>(c)];
    }
  });
  return !abandoned;
}

/// One of each stratum of rows, which lie by tile and material.
void QuickShader::draw_rows(std::span<const std::uint32_t> panels, std::size_t sample,
                            std::uint64_t seed) {
  std::size_t total = 0;
  for (const std::uint32_t panel : panels) total += rows_.panels()[panel].row_count;
  sample_.assign(std::min(sample, total), {});
  std::size_t at = 0, before = 0;  // the panel that is looked at, and the rows before it
  for (std::size_t i = 0; i < sample_.size(); ++i) {
    Random random(seed, i);
    const std::size_t begin = total * i / sample_.size(), end = total * (i + 1) / sample_.size();
    const std::size_t drawn = begin + random.below(end - begin);
    while (drawn - before >= rows_.panels()[panels[at]].row_count) {
      before += rows_.panels()[panels[at++]].row_count;
    }
    sample_[i] = {panels[at], drawn - before, end - begin};
  }
}

double QuickShader::sampled_squared_error(const CurveLight& light,
                                          std::span<const std::uint32_t> panels,
                                          std::span<const float> image, std::size_t sample,
                                          std::uint64_t seed) {
  RIMLIGHT_CHECK_EQ(image.size(), rows_.panels().size() * kPanelFloats);
  draw_rows(panels, sample, seed);
  parallel_for(sample_.size(), [&](std::size_t i) {
    SampledRow& drawn = sample_[i];
    const CurvePanel& panel = rows_.panels()[drawn.panel];
    const Vec3f exact = sum_row(rows_.receivers(), panel, drawn.row, light, states_[panel.material],
                                tables_[panel.material], nullptr);
    for (int c = 0; c < 3; ++c) {
      const std::size_t at =
          drawn.panel * kPanelFloats + static_cast<std::size_t>(c) * kPanelRows + drawn.row;
      const double difference = double{image[at]} - exact[c];
      drawn.squared_error += difference * difference * static_cast<double>(drawn.count);
    }
  });
  double sum = 0;
  for (const SampledRow& drawn : sample_) sum += drawn.squared_error;
  return sum;
}

Vec3f shade_exactly(const CurveReceivers& receivers, const CurvePanel& panel, std::size_t row,
                    const CurveLight& light, const CurveMaterialState& state) {
  const LobeTables tables = make_tables(state, CurveAxis::half_angle);
  return sum_row(receivers, panel, row, light, state, tables, nullptr);
}

}  // namespace rimlight
