#include "core/vertices/level_group.h"

#include <algorithm>
#include <bit>
#include <cmath>

namespace rimlight {
namespace {

/// Moving all coefficients costs about as much as an eighth of the next degree's products.
constexpr std::size_t kWorthPacking = 8;

}  // namespace

void LevelGroup::load(const VertexProducts& products, const VertexSelection& selection,
                      const VertexGloss& gloss, std::size_t first_panel) {
  coefficients_ = sh::coefficient_count(products.transport().visibility_degree);
  if (visibility_.size() < kPanels * panel_size()) {
    visibility_.resize(kPanels * panel_size());
    lobes_.resize(kPanels * panel_size());
  }
  state_.assign(kPanels * kStateRows * kBatchVertices, 0.0f);
  const std::size_t end = std::min(first_panel + kPanels, selection.panel_count());
  count_ = 0;
  for (std::size_t panel = first_panel; panel < end; ++panel) {
    const std::size_t at = (panel - first_panel) * panel_size();
    products.load_visibility(selection, panel, visibility_.data() + at);
    products.load_lobes(selection, panel, gloss, lobes_.data() + at);
    count_ += selection.lane_count(panel);
  }
  for (std::size_t lane = 0; lane < count_; ++lane) lanes_[lane] = static_cast<std::uint16_t>(lane);
  set_all_alive();
}

void LevelGroup::set_all_alive() {
  alive_count_ = count_;
  for (std::size_t panel = 0; panel < panel_count(); ++panel) {
    const std::size_t used = std::min(kBatchVertices, count_ - panel * kBatchVertices);
    alive_[panel] = ~std::uint64_t{0} >> (kBatchVertices - used);
  }
}

void LevelGroup::add_degree(const VertexProducts& products, int degree) {
  const ChannelMatrices matrices = products.matrices();
  const std::size_t below = sh::coefficient_count(degree - 1), end = sh::coefficient_count(degree);
  for (std::size_t panel = 0; panel < panel_count(); ++panel) {
    const float* const visibility = visibility_.data() + panel * panel_size();
    const float* const lobes = lobes_.data() + panel * panel_size();
    const std::size_t lanes = std::min(kBatchVertices, count_ - panel * kBatchVertices);
    add_bilinear_form(matrices, {{below, end}, {0, end}, lobes, visibility, lanes}, state(panel));
    if (below == 0) continue;
    add_bilinear_form(matrices, {{below, end}, {0, below}, visibility, lobes, lanes}, state(panel));
  }
}

void LevelGroup::set_base() {
  constexpr std::size_t kSums = kLightChannels * kBatchVertices;
  for (std::size_t panel = 0; panel < panel_count(); ++panel) {
    std::copy_n(state(panel), kSums, state(panel) + kSums);
  }
}

std::uint64_t LevelGroup::lanes_above(std::size_t panel, float threshold) const {
  constexpr std::size_t kSums = kLightChannels * kBatchVertices;
  std::array<float, kBatchVertices> largest{};
  for (std::size_t k = 0; k < kSums; k += kBatchVertices) {
    const float* const sum = state(panel) + k;
    for (std::size_t lane = 0; lane < kBatchVertices; ++lane) {
      largest[lane] = std::max(largest[lane], std::abs(sum[lane] - sum[kSums + lane]));
    }
  }
  std::uint64_t above = 0;
  for (std::size_t lane = 0; lane < kBatchVertices; ++lane) {
    above |= std::uint64_t{largest[lane] >= threshold} << lane;
  }
  return above;
}

std::size_t LevelGroup::keep_above(float threshold, std::span<float> to) {
  alive_count_ = 0;
  for (std::size_t panel = 0; panel < panel_count(); ++panel) {
    const std::uint64_t kept = alive_[panel] & lanes_above(panel, threshold);
    for (std::uint64_t lost = alive_[panel] & ~kept; lost != 0; lost &= lost - 1) {
      write_lane(panel * kBatchVertices + static_cast<std::size_t>(std::countr_zero(lost)), to);
    }
    alive_[panel] = kept;
    alive_count_ += static_cast<std::size_t>(std::popcount(kept));
  }
  if (alive_count_ < count_ - count_ / kWorthPacking) pack();
  return alive_count_;
}

void LevelGroup::pack() {
  const std::size_t panels = panel_count();
  std::size_t packed = 0;
  for (std::size_t panel = 0; panel < panels; ++panel) {
    const std::uint64_t kept = alive_[panel];
    const std::size_t to = packed / kBatchVertices;
    const auto move = [&](AlignedVector<float>& values, std::size_t rows) {
      const std::size_t size = rows * kBatchVertices;
      float* const target = values.data() + to * size;
      move_lanes(
          {values.data() + panel * size, kept, target, target + size, packed % kBatchVertices},
          rows);
    };
    // What is before the first dropped vertex stays where it is.
    if (packed != panel * kBatchVertices || kept != ~std::uint64_t{0}) {
      move(visibility_, coefficients_);
      move(lobes_, coefficients_);
      move(state_, kStateRows);
    }
    for (std::uint64_t lanes = kept; lanes != 0; lanes &= lanes - 1) {
      const auto lane = static_cast<std::size_t>(std::countr_zero(lanes));
      lanes_[packed++] = lanes_[panel * kBatchVertices + lane];
    }
  }
  count_ = packed;
  set_all_alive();
}

void LevelGroup::write_lane(std::size_t packed, std::span<float> to) const {
  const float* const from = state(packed / kBatchVertices) + packed % kBatchVertices;
  const std::size_t lane = lanes_[packed];
  float* const place =
      to.data() + lane / kBatchVertices * kLightChannels * kBatchVertices + lane % kBatchVertices;
  for (std::size_t c = 0; c < kLightChannels; ++c) {
    place[c * kBatchVertices] = from[c * kBatchVertices];
  }
}

void LevelGroup::write(std::span<float> to) const {
  for (std::size_t packed = 0; packed < count_; ++packed) {
    if (is_alive(packed)) write_lane(packed, to);
  }
}

}  // namespace rimlight
