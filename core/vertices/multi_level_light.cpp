#include "core/vertices/multi_level_light.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <functional>

#include "core/base/check.h"
#include "core/base/parallel.h"
#include "core/vertices/level_group.h"

namespace rimlight {
namespace {

constexpr std::size_t kSums = kLightChannels * kBatchVertices;
using Sums = std::array<float, kSums>;

/// The lanes where light and base are `threshold` apart in some channel.
std::uint64_t lanes_above(const Sums& light, const Sums& base, float threshold) {
  std::uint64_t above = 0;
  for (std::size_t k = 0; k < kSums; ++k) {
    above |= std::uint64_t{std::abs(light[k] - base[k]) >= threshold} << (k % kBatchVertices);
  }
  return above;
}

/// The irradiance of one batch, filtered.
struct FilteredBatch {
  alignas(64) Sums light{}, base{};
  std::uint64_t inside = 0;
};

/// Adds the coefficients of degrees first … last to the lanes of a mask.
void add_degrees(const BatchSum& whole, int first, int last, std::uint64_t lanes, Sums& light) {
  BatchSum part = whole;
  const std::size_t below = sh::coefficient_count(first - 1);
  part.transport += below * kBatchVertices;
  part.light += below;
  part.count = sh::coefficient_count(last) - below;
  alignas(64) Sums sums;
  sum_batch(part, sums.data());
  for (std::size_t k = 0; k < kSums; ++k) {
    if (((lanes >> (k % kBatchVertices)) & 1) != 0) light[k] += sums[k];
  }
}

FilteredBatch filter_batch(const BatchSum& whole, int degree, std::uint64_t lanes,
                           const MultiLevelLight::Settings& settings) {
  FilteredBatch batch;
  batch.inside = lanes;
  const int base = std::min(settings.base_degree, degree);
  add_degrees(whole, 0, base, lanes, batch.light);
  batch.base = batch.light;
  for (int l = base + 1; l <= degree && batch.inside != 0; ++l) {
    add_degrees(whole, l, l, batch.inside, batch.light);
    batch.inside &= lanes_above(batch.light, batch.base, settings.irradiance_threshold);
  }
  return batch;
}

}  // namespace

MultiLevelLight::MultiLevelLight(const VertexProducts& products, const VertexGraph& graph)
    : products_(products), graph_(graph) {}

void MultiLevelLight::calculate(const VertexSelection& selection, const VertexGloss& gloss,
                                const Settings& settings, std::span<float> irradiance,
                                std::span<float> highlights) {
  products_.check(selection, gloss);
  RIMLIGHT_CHECK(settings.base_degree >= 0);
  RIMLIGHT_CHECK_EQ(irradiance.size(), selection.panel_count() * kSums);
  RIMLIGHT_CHECK_EQ(highlights.size(), irradiance.size());
  irradiance_region_.reset(selection);
  highlight_region_.reset(selection);
  irradiance_base_.assign(irradiance.size(), 0.0f);
  highlight_base_.assign(irradiance.size(), 0.0f);
  filter_irradiance(selection, settings, irradiance);
  filter_highlights(selection, gloss, settings, highlights);
  const FilteredLight diffuse = {irradiance_base_, irradiance};
  irradiance_region_.refine(
      graph_, settings.irradiance_threshold,
      [this](const VertexSelection& some, std::span<float> to) { products_.irradiance(some, to); },
      diffuse);
  irradiance_region_.smooth(graph_, diffuse);
  const FilteredLight shine = {highlight_base_, highlights};
  highlight_region_.refine(
      graph_, settings.highlight_threshold,
      [this, &gloss](const VertexSelection& some, std::span<float> to) {
        products_.highlights(some, gloss, to);
      },
      shine);
  highlight_region_.smooth(graph_, shine);
}

void MultiLevelLight::filter_irradiance(const VertexSelection& selection, const Settings& settings,
                                        std::span<float> to) {
  std::ranges::fill(to, 0.0f);
  const VertexTransportView& transport = products_.transport();
  const std::size_t count = sh::coefficient_count(transport.irradiance_degree);
  const std::size_t size = transport.irradiance_channels * count * kBatchVertices;
  constexpr std::size_t kPieces = 16;
  const auto& pieces = selection.pieces();
  const auto body = [&](std::size_t chunk) {
    const std::size_t end = std::min(pieces.size(), (chunk + 1) * kPieces);
    for (std::size_t p = chunk * kPieces; p < end; ++p) {
      const BatchSum whole = {transport.irradiance.data() + pieces[p].batch * size,
                              transport.irradiance_channels,
                              count,
                              products_.irradiance_light().data(),
                              count,
                              count};
      const FilteredBatch batch =
          filter_batch(whole, transport.irradiance_degree, pieces[p].lanes, settings);
      std::size_t packed = pieces[p].first;
      for (std::uint64_t lanes = pieces[p].lanes; lanes != 0; lanes &= lanes - 1, ++packed) {
        const auto lane = static_cast<std::size_t>(std::countr_zero(lanes));
        const std::size_t at = packed / kBatchVertices * kSums + packed % kBatchVertices;
        if (((batch.inside >> lane) & 1) != 0) irradiance_region_.add(packed);
        for (std::size_t c = 0; c < kSums; c += kBatchVertices) {
          to[at + c] = batch.light[c + lane];
          irradiance_base_[at + c] = batch.base[c + lane];
        }
      }
    }
  };
  parallel_for((pieces.size() + kPieces - 1) / kPieces, std::cref(body));
}

void MultiLevelLight::filter_highlights(const VertexSelection& selection, const VertexGloss& gloss,
                                        const Settings& settings, std::span<float> to) {
  std::ranges::fill(to, 0.0f);
  const int degree = products_.transport().visibility_degree;
  const int base = std::min(settings.base_degree, degree);
  const std::size_t groups =
      (selection.panel_count() + LevelGroup::kPanels - 1) / LevelGroup::kPanels;
  const auto body = [&](std::size_t g) {
    thread_local LevelGroup group;
    const std::size_t first = g * LevelGroup::kPanels;
    const std::size_t size = std::min(LevelGroup::kPanels * kSums, to.size() - first * kSums);
    const std::span<float> lights = to.subspan(first * kSums, size);
    group.load(products_, selection, gloss, first);
    for (int l = 0; l <= base; ++l) group.add_degree(products_, l);
    group.set_base();
    group.write(std::span(highlight_base_).subspan(first * kSums, size));
    for (int l = base + 1; l <= degree && group.vertex_count() > 0; ++l) {
      group.add_degree(products_, l);
      group.keep_above(settings.highlight_threshold, lights);
    }
    group.write(lights);
    group.for_each_lane(
        [&](std::size_t lane) { highlight_region_.add(first * kBatchVertices + lane); });
  };
  parallel_for(groups, std::cref(body));
}

}  // namespace rimlight
