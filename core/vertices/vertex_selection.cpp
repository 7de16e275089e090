#include "core/vertices/vertex_selection.h"

#include <algorithm>

#include "core/base/check.h"

namespace rimlight {

void VertexSelection::select_vertices(std::span<const std::uint32_t> vertices) {
  count_ = 0;
  pieces_.clear();
  first_piece_.clear();
  std::size_t i = 0;
  while (i < vertices.size()) {
    RIMLIGHT_CHECK(i == 0 || vertices[i - 1] < vertices[i]);
    const auto batch = static_cast<std::uint32_t>(vertices[i] / kBatchVertices);
    std::uint64_t lanes = 0;
    for (; i < vertices.size() && vertices[i] / kBatchVertices == batch; ++i) {
      const std::uint64_t lane = std::uint64_t{1} << (vertices[i] % kBatchVertices);
      RIMLIGHT_CHECK(lanes < lane);
      lanes |= lane;
    }
    add(batch, lanes);
  }
}

void VertexSelection::add(std::uint32_t batch, std::uint64_t lanes) {
  const auto number = static_cast<std::uint32_t>(pieces_.size());
  pieces_.push_back({batch, static_cast<std::uint32_t>(count_), lanes});
  count_ += static_cast<std::size_t>(std::popcount(lanes));
  while (first_piece_.size() < panel_count()) first_piece_.push_back(number);
}

std::size_t VertexSelection::panel_count() const { return batch_count(count_); }

std::size_t VertexSelection::lane_count(std::size_t panel) const {
  return std::min(kBatchVertices, count_ - panel * kBatchVertices);
}

std::size_t VertexSelection::vertex_end() const {
  if (pieces_.empty()) return 0;
  const Piece& last = pieces_.back();
  return last.batch * kBatchVertices + static_cast<std::size_t>(std::bit_width(last.lanes));
}

}  // namespace rimlight
