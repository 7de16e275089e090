#include "core/vertices/interest_region.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "core/base/check.h"
#include "core/vertices/vertex_product_kernel.h"

namespace rimlight {
namespace {

constexpr std::size_t kSums = kLightChannels * kBatchVertices;

/// Where the first channel of a packed vertex is; the others follow at kBatchVertices.
std::size_t place(std::size_t packed) {
  return packed / kBatchVertices * kSums + packed % kBatchVertices;
}

}  // namespace

void InterestRegion::reset(const VertexSelection& selection) {
  vertices_.clear();
  packed_.assign(selection.vertex_end(), -1);
  for (std::size_t panel = 0; panel < selection.panel_count(); ++panel) {
    selection.for_each_vertex(panel, [&](std::size_t vertex, std::size_t) {
      packed_[vertex] = static_cast<std::int32_t>(vertices_.size());
      vertices_.push_back(static_cast<std::uint32_t>(vertex));
    });
  }
  inside_.assign(vertices_.size(), 0);
}

void InterestRegion::find_next(const VertexGraph& graph, std::span<const std::uint32_t> from,
                               std::vector<std::uint32_t>& next) {
  next.clear();
  for (const std::uint32_t packed : from) {
    for (const std::uint32_t vertex : graph.neighbours(vertices_[packed])) {
      if (vertex >= packed_.size() || packed_[vertex] < 0) continue;
      const auto neighbour = static_cast<std::uint32_t>(packed_[vertex]);
      if (inside_[neighbour] != 0 || mark_[neighbour] != 0) continue;
      mark_[neighbour] = 1;
      next.push_back(neighbour);
    }
  }
  std::ranges::sort(next);
}

void InterestRegion::refine(const VertexGraph& graph, float threshold, const Calculate& calculate,
                            const FilteredLight& filtered) {
  mark_.assign(vertices_.size(), 0);
  frontier_.clear();
  for (std::uint32_t p = 0; p < inside_.size(); ++p) {
    if (inside_[p] != 0) frontier_.push_back(p);
  }
  for (;;) {
    find_next(graph, frontier_, next_);
    if (next_.empty()) return;
    chosen_.clear();
    for (const std::uint32_t packed : next_) chosen_.push_back(vertices_[packed]);
    selection_.select_vertices(chosen_);
    calculated_.resize(selection_.panel_count() * kSums);
    calculate(selection_, calculated_);
    frontier_.clear();
    for (std::size_t i = 0; i < next_.size(); ++i) {
      const std::size_t to = place(next_[i]), from = place(i);
      float largest = 0;
      for (std::size_t c = 0; c < kSums; c += kBatchVertices) {
        largest = std::max(largest, std::abs(calculated_[from + c] - filtered.base[to + c]));
      }
      if (!(largest >= threshold)) continue;
      inside_[next_[i]] = 1;
      frontier_.push_back(next_[i]);
      for (std::size_t c = 0; c < kSums; c += kBatchVertices) {
        filtered.light[to + c] = calculated_[from + c];
      }
    }
  }
}

void InterestRegion::blend_tier(const VertexGraph& graph, std::span<const std::uint32_t> tier,
                                std::uint8_t source, const FilteredLight& filtered) {
  const float weight = source == 0 ? 2.0f / 3 : 1.0f / 3;
  blended_.resize(tier.size() * kLightChannels);
  for (std::size_t i = 0; i < tier.size(); ++i) {
    std::array<float, kLightChannels> sum{};
    float count = 0;
    for (const std::uint32_t vertex : graph.neighbours(vertices_[tier[i]])) {
      if (vertex >= packed_.size() || packed_[vertex] < 0) continue;
      const auto neighbour = static_cast<std::size_t>(packed_[vertex]);
      if (source == 0 ? inside_[neighbour] == 0 : mark_[neighbour] != source) continue;
      for (std::size_t c = 0; c < kLightChannels; ++c) {
        const std::size_t at = place(neighbour) + c * kBatchVertices;
        sum[c] += filtered.light[at] - filtered.base[at];
      }
      count += 1;
    }
    RIMLIGHT_CHECK(count > 0);
    for (std::size_t c = 0; c < kLightChannels; ++c) {
      const std::size_t at = place(tier[i]) + c * kBatchVertices;
      const float own = filtered.light[at] - filtered.base[at];
      blended_[i * kLightChannels + c] = filtered.base[at] + own + weight * (sum[c] / count - own);
    }
  }
  for (std::size_t i = 0; i < tier.size(); ++i) {
    for (std::size_t c = 0; c < kLightChannels; ++c) {
      filtered.light[place(tier[i]) + c * kBatchVertices] = blended_[i * kLightChannels + c];
    }
  }
}

void InterestRegion::smooth(const VertexGraph& graph, const FilteredLight& filtered) {
  mark_.assign(vertices_.size(), 0);
  frontier_.clear();
  for (std::uint32_t p = 0; p < inside_.size(); ++p) {
    if (inside_[p] != 0) frontier_.push_back(p);
  }
  find_next(graph, frontier_, next_);
  blend_tier(graph, next_, 0, filtered);
  find_next(graph, next_, frontier_);
  for (const std::uint32_t packed : frontier_) mark_[packed] = 2;
  blend_tier(graph, frontier_, 1, filtered);
}

double InterestRegion::outside() const {
  if (inside_.empty()) return 0;
  const auto in = static_cast<double>(std::ranges::count(inside_, 1));
  return 1 - in / static_cast<double>(inside_.size());
}

}  // namespace rimlight
