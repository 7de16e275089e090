#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "core/transport/vertex_transport.h"

namespace rimlight {

/// Which vertices are calculated: those that a view shows. They are packed, in
/// rising order, into *panels* of kBatchVertices lanes, so that hidden neighbours cost nothing; the
/// last panel is padded. Reused from frame to frame: it stops allocating.
class VertexSelection {
 public:
  /// The chosen lanes of one batch, and the packed lane of the first of them.
  struct Piece {
    std::uint32_t batch = 0;
    std::uint32_t first = 0;
    std::uint64_t lanes = 0;
  };

  /// Single vertices, rising. CheckFailure for another order.
  void select_vertices(std::span<const std::uint32_t> vertices);

  std::size_t vertex_count() const { return count_; }
  std::size_t panel_count() const;
  /// Lanes of a panel that are vertices.
  std::size_t lane_count(std::size_t panel) const;

  const std::vector<Piece>& pieces() const { return pieces_; }
  /// Calls visit(batch, lanes, to) for the parts of a panel, in order: chosen lanes of a batch, as
  /// bits, and the panel's lane that they start at.
  template <typename Visit>
  void for_each_part(std::size_t panel, const Visit& visit) const;
  /// Calls visit(vertex, lane) for a panel's vertices.
  template <typename Visit>
  void for_each_vertex(std::size_t panel, const Visit& visit) const;
  /// One past the last vertex that was chosen; 0 when none is.
  std::size_t vertex_end() const;
  std::uint32_t batch_end() const { return pieces_.empty() ? 0 : pieces_.back().batch + 1; }

 private:
  void add(std::uint32_t batch, std::uint64_t lanes);

  std::size_t count_ = 0;
  std::vector<Piece> pieces_;
  std::vector<std::uint32_t> first_piece_;  // [panel]
};

template <typename Visit>
void VertexSelection::for_each_part(std::size_t panel, const Visit& visit) const {
  const std::size_t begin = panel * kBatchVertices, end = begin + kBatchVertices;
  for (std::size_t p = first_piece_[panel]; p < pieces_.size() && pieces_[p].first < end; ++p) {
    std::uint64_t lanes = pieces_[p].lanes;
    std::size_t first = pieces_[p].first;
    for (; first < begin; ++first) lanes &= lanes - 1;  // those of the panel before
    const std::size_t room = end - first;
    std::uint64_t rest = lanes;
    for (std::size_t i = 0; i < room; ++i) rest &= rest - 1;
    visit(pieces_[p].batch, lanes & ~rest, first - begin);
  }
}

template <typename Visit>
void VertexSelection::for_each_vertex(std::size_t panel, const Visit& visit) const {
  for_each_part(panel, [&](std::uint32_t batch, std::uint64_t lanes, std::size_t to) {
    for (; lanes != 0; lanes &= lanes - 1, ++to) {
      const auto lane = static_cast<std::size_t>(std::countr_zero(lanes));
      visit(batch * kBatchVertices + lane, to);
    }
  });
}

}  // namespace rimlight
