#include "core/scene/mesh_geometry.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <tuple>
#include <vector>

namespace rimlight {
namespace {

constexpr double kFlattest = 1e-6;

using Triangle = std::array<std::uint32_t, 3>;

bool is_degenerate(const Mesh& mesh, const Triangle& t) {
  if (t[0] == t[1] || t[1] == t[2] || t[2] == t[0]) return true;
  const Vec3d a(mesh.positions[t[0]]);
  const Vec3d b(mesh.positions[t[1]]);
  const Vec3d c(mesh.positions[t[2]]);
  const double longest = std::max({dot(b - a, b - a), dot(c - b, c - b), dot(a - c, a - c)});
  // |cross| = longest side × height; written so that NaN is degenerate.
  return !(length(cross(b - a, c - a)) > kFlattest * longest);
}

/// For each vertex the first one at the same position.
std::vector<std::uint32_t> first_at_position(const Mesh& mesh) {
  std::vector<std::uint32_t> order(mesh.positions.size());
  std::iota(order.begin(), order.end(), 0u);
  const auto key = [&mesh](std::uint32_t i) {
    const Vec3f& p = mesh.positions[i];
    return std::tuple(p.x, p.y, p.z);
  };
  std::sort(order.begin(), order.end(), [&key](std::uint32_t a, std::uint32_t b) {
    return std::tuple(key(a), a) < std::tuple(key(b), b);
  });
  std::vector<std::uint32_t> first(order.size());
  for (std::size_t i = 0; i < order.size(); ++i) {
    const bool same = i > 0 && mesh.positions[order[i]] == mesh.positions[order[i - 1]];
    first[order[i]] = same ? first[order[i - 1]] : order[i];
  }
  return first;
}

double angle_between(const Vec3d& a, const Vec3d& b) {
  return std::atan2(length(cross(a, b)), dot(a, b));
}

}  // namespace

std::size_t drop_degenerate_triangles(Mesh& mesh) {
  return std::erase_if(mesh.triangles,
                       [&mesh](const Triangle& t) { return is_degenerate(mesh, t); });
}

void smooth_normals(Mesh& mesh) {
  const std::vector<std::uint32_t> first = first_at_position(mesh);
  std::vector<Vec3d> sums(mesh.positions.size());
  for (const Triangle& t : mesh.triangles) {
    for (std::size_t k = 0; k < 3; ++k) {
      const Vec3d corner(mesh.positions[t[k]]);
      const Vec3d next = Vec3d(mesh.positions[t[(k + 1) % 3]]) - corner;
      const Vec3d last = Vec3d(mesh.positions[t[(k + 2) % 3]]) - corner;
      const Vec3d normal = cross(next, last);
      const double size = length(normal);
      if (size > 0) sums[first[t[k]]] += normal * (angle_between(next, last) / size);
    }
  }
  mesh.normals.resize(mesh.positions.size());
  for (std::size_t i = 0; i < sums.size(); ++i) {
    const Vec3d& sum = sums[first[i]];
    const double size = length(sum);
    mesh.normals[i] = size > 0 ? Vec3f(sum / size) : Vec3f();
  }
}

Bounds bounds_of(std::span<const Mesh> meshes) {
  Bounds bounds;
  for (const Mesh& mesh : meshes) {
    for (const Triangle& t : mesh.triangles) {
      for (const std::uint32_t vertex : t) {
        for (int axis = 0; axis < 3; ++axis) {
          const double x = mesh.positions[vertex][axis];
          bounds.low[axis] = std::min(bounds.low[axis], x);
          bounds.high[axis] = std::max(bounds.high[axis], x);
        }
      }
    }
  }
  return bounds;
}

}  // namespace rimlight
