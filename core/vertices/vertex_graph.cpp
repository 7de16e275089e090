#include "core/vertices/vertex_graph.h"

#include <algorithm>
#include <numeric>
#include <tuple>
#include <utility>

#include "core/base/check.h"

namespace rimlight {
namespace {

using Edge = std::pair<std::uint32_t, std::uint32_t>;

/// For each vertex the lowest of those at its position.
std::vector<std::uint32_t> welded(std::span<const Vec3f> positions) {
  const auto key = [&](std::uint32_t v) {
    return std::tuple(positions[v].x, positions[v].y, positions[v].z);
  };
  std::vector<std::uint32_t> order(positions.size());
  std::iota(order.begin(), order.end(), 0u);
  std::ranges::sort(order, [&](std::uint32_t a, std::uint32_t b) {
    return std::tuple_cat(key(a), std::tuple(a)) < std::tuple_cat(key(b), std::tuple(b));
  });
  std::vector<std::uint32_t> lowest(positions.size());
  for (std::size_t i = 0; i < order.size(); ++i) {
    const bool same = i > 0 && key(order[i]) == key(order[i - 1]);
    lowest[order[i]] = same ? lowest[order[i - 1]] : order[i];
  }
  return lowest;
}

void sort_out(std::vector<Edge>& edges) {
  std::ranges::sort(edges);
  edges.erase(std::unique(edges.begin(), edges.end()), edges.end());
}

/// Edges between the lowest vertices, both ways.
std::vector<Edge> welded_edges(const VertexMesh& mesh, std::span<const std::uint32_t> lowest) {
  std::vector<Edge> edges;
  for (const auto& corners : mesh.triangles) {
    for (std::size_t k = 0; k < 3; ++k) {
      RIMLIGHT_CHECK(corners[k] < lowest.size());
      RIMLIGHT_CHECK(corners[(k + 1) % 3] < lowest.size());
      const std::uint32_t a = lowest[corners[k]], b = lowest[corners[(k + 1) % 3]];
      if (a == b) continue;
      edges.emplace_back(a, b);
      edges.emplace_back(b, a);
    }
  }
  sort_out(edges);
  return edges;
}

}  // namespace

VertexGraph::VertexGraph(const VertexMesh& mesh) {
  const std::size_t count = mesh.positions.size();
  const std::vector<std::uint32_t> lowest = welded(mesh.positions);
  std::vector<std::vector<std::uint32_t>> copies(count);  // of the lowest, in rising order
  for (std::uint32_t v = 0; v < count; ++v) copies[lowest[v]].push_back(v);
  std::vector<Edge> edges;
  for (const auto& [a, b] : welded_edges(mesh, lowest)) {
    for (const std::uint32_t from : copies[a]) {
      for (const std::uint32_t to : copies[b]) edges.emplace_back(from, to);
    }
  }
  sort_out(edges);
  first_.assign(count + 1, 0);
  for (const auto& [from, to] : edges) {
    ++first_[from + 1];
    neighbours_.push_back(to);
  }
  std::partial_sum(first_.begin(), first_.end(), first_.begin());
}

std::span<const std::uint32_t> VertexGraph::neighbours(std::size_t vertex) const {
  if (vertex + 1 >= first_.size()) return {};
  return std::span(neighbours_).subspan(first_[vertex], first_[vertex + 1] - first_[vertex]);
}

}  // namespace rimlight
