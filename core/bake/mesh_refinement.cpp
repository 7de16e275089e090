#include "core/bake/mesh_refinement.h"

#include <algorithm>
#include <unordered_map>

#include "core/math/vec.h"

namespace rimlight {
namespace {

using Triangle = std::array<std::uint32_t, 3>;

/// Instead of a middle's index: the edge stays whole.
constexpr std::uint32_t kWhole = 0xffff'ffff;

/// The longest part of an edge that is split, as a share of it: a half, but for rounding.
constexpr double kLongestPart = 0.75;

/// One round: every edge of the mesh as it is, split or not.
class Round {
 public:
  Round(Mesh& mesh, double longest_edge, std::size_t most_vertices)
      : mesh_(mesh), longest_edge_(longest_edge), most_vertices_(most_vertices) {}

  /// False when there would be too many vertices.
  bool run() {
    std::vector<Triangle> old;
    old.swap(mesh_.triangles);
    mesh_.triangles.reserve(old.size());
    for (const Triangle& t : old) {
      split(t, {middle_of(t[0], t[1]), middle_of(t[1], t[2]), middle_of(t[2], t[0])});
      if (mesh_.positions.size() > most_vertices_) return false;
    }
    return true;
  }

  bool has_split() const { return !middles_.empty(); }

 private:
  static double distance_squared(const Vec3f& p, const Vec3f& q) {
    const Vec3d side = Vec3d(p) - Vec3d(q);
    return dot(side, side);
  }
  double distance_squared(std::uint32_t a, std::uint32_t b) const {
    return distance_squared(mesh_.positions[a], mesh_.positions[b]);
  }

  /// Not where floats are too far apart for a middle.
  static bool is_between(const Vec3f& middle, const Vec3f& p, const Vec3f& q) {
    const double part = std::max(distance_squared(middle, p), distance_squared(middle, q));
    return part <= kLongestPart * kLongestPart * distance_squared(p, q);
  }

  /// The vertex in the middle of an edge, made where it is not yet, or kWhole.
  std::uint32_t middle_of(std::uint32_t a, std::uint32_t b) {
    if (!(distance_squared(a, b) > longest_edge_ * longest_edge_)) return kWhole;
    const Vec3f& p = mesh_.positions[a];
    const Vec3f& q = mesh_.positions[b];
    const Vec3f middle((Vec3d(p) + Vec3d(q)) * 0.5);  // the same for (b, a)
    if (!is_between(middle, p, q)) return kWhole;
    const std::uint64_t key = static_cast<std::uint64_t>(std::min(a, b)) << 32 | std::max(a, b);
    const auto [found, is_new] =
        middles_.try_emplace(key, static_cast<std::uint32_t>(mesh_.positions.size()));
    if (is_new) add_vertex(middle, a, b);
    return found->second;
  }

  void add_vertex(const Vec3f& position, std::uint32_t a, std::uint32_t b) {
    const Vec3d first(mesh_.normals[a]);
    const Vec3d sum = first + Vec3d(mesh_.normals[b]);
    // Opposite normals have no middle: then that of the first in order, whichever way we came.
    const bool cancels = !(dot(sum, sum) > 1e-12);
    const Vec3f normal = cancels ? mesh_.normals[std::min(a, b)] : Vec3f(normalized(sum));
    mesh_.positions.push_back(position);
    mesh_.normals.push_back(normal);
    if (mesh_.texture_coordinates.empty()) return;
    const auto s = mesh_.texture_coordinates[a], t = mesh_.texture_coordinates[b];
    mesh_.texture_coordinates.push_back({s.u / 2 + t.u / 2, s.v / 2 + t.v / 2});
  }

  /// `middles`: of the edges from each corner to the next.
  void split(const Triangle& t, const Triangle& middles) {
    auto& triangles = mesh_.triangles;
    const auto whole = std::ranges::count(middles, kWhole);
    if (whole == 3) {
      triangles.push_back(t);
    } else if (whole == 0) {
      for (std::size_t k = 0; k < 3; ++k) {
        triangles.push_back({t[k], middles[k], middles[(k + 2) % 3]});
      }
      triangles.push_back(middles);
    } else if (whole == 2) {
      const std::size_t k = middles[0] != kWhole ? 0 : middles[1] != kWhole ? 1 : 2;
      triangles.push_back({t[k], middles[k], t[(k + 2) % 3]});
      triangles.push_back({middles[k], t[(k + 1) % 3], t[(k + 2) % 3]});
    } else {
      const std::size_t k = middles[0] == kWhole ? 1 : middles[1] == kWhole ? 2 : 0;
      split_in_three({t[k], t[(k + 1) % 3], t[(k + 2) % 3]}, middles[k], middles[(k + 1) % 3]);
    }
  }

  /// The first two edges have middles. Of the two ways to split what is left of the triangle, the
  /// shorter diagonal: its square is at most a quarter of the longest edge's and half of the whole
  /// one's together (Apollonius), so rounds come to an end for any triangle.
  void split_in_three(const Triangle& t, std::uint32_t first, std::uint32_t second) {
    auto& triangles = mesh_.triangles;
    triangles.push_back({first, t[1], second});
    if (distance_squared(t[0], second) <= distance_squared(first, t[2])) {
      triangles.push_back({t[0], first, second});
      triangles.push_back({t[0], second, t[2]});
    } else {
      triangles.push_back({t[0], first, t[2]});
      triangles.push_back({first, second, t[2]});
    }
  }

  Mesh& mesh_;
  double longest_edge_;
  std::size_t most_vertices_;
  std::unordered_map<std::uint64_t, std::uint32_t> middles_;
};

}  // namespace

bool refine(Mesh& mesh, double longest_edge, std::size_t most_added) {
  const std::size_t most_vertices = mesh.positions.size() + most_added;
  while (true) {
    Round round(mesh, longest_edge, most_vertices);
    if (!round.run()) return false;
    if (!round.has_split()) return true;
  }
}

}  // namespace rimlight
