#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "core/transport/vertex_transport.h"

namespace rimlight {

/// Which vertices are neighbours on the surface: joined by an edge of a triangle, where vertices at
/// one and the same position count as one (a mesh is split there for the sake of normals or
/// materials). Immutable; any thread.
class VertexGraph {
 public:
  /// No vertex has a neighbour.
  VertexGraph() = default;
  /// CheckFailure when a triangle names a vertex that is not there.
  explicit VertexGraph(const VertexMesh& mesh);

  /// Rising, without the vertex itself; none for a vertex beyond the graph.
  std::span<const std::uint32_t> neighbours(std::size_t vertex) const;

 private:
  std::vector<std::uint32_t> first_;  // [vertex + 1]
  std::vector<std::uint32_t> neighbours_;
};

}  // namespace rimlight
