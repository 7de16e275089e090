#include <algorithm>
#include <array>
#include <utility>

#include "core/base/check.h"
#include "core/scene/mesh_geometry.h"
#include "core/scene/terrace.h"

namespace rimlight::terrace {

std::uint32_t Builder::material(std::string name, const Brdf& brdf) {
  scene_->materials.push_back({std::move(name), brdf, nullptr});
  return static_cast<std::uint32_t>(scene_->materials.size() - 1);
}

std::vector<std::uint32_t> Builder::tones(const std::string& name, const Vec3f& albedo,
                                          double spread, int count) {
  std::vector<std::uint32_t> result;
  for (int i = 0; i < count; ++i) {
    const double tone = count > 1 ? 1 + spread * (2.0 * i / (count - 1) - 1) : 1;
    Brdf brdf;
    brdf.albedo = albedo * static_cast<float>(tone);
    RIMLIGHT_CHECK(max_component(brdf.albedo) <= 1);
    result.push_back(material(name + " " + std::to_string(i + 1), brdf));
  }
  return result;
}

void Builder::add(std::string name, Mesh mesh, std::uint32_t material, const Transform& transform) {
  mesh.name = std::move(name);
  mesh.material = material;
  apply(transform, mesh);
  scene_->dropped_triangles += drop_degenerate_triangles(mesh);
  scene_->meshes.push_back(std::move(mesh));
}

void Builder::add_piece(const std::string& part, const Mesh& piece, std::uint32_t material,
                        const Transform& transform) {
  const auto same = [&](const Mesh& mesh) {
    return mesh.material == material && mesh.name == part &&
           mesh.normals.empty() == piece.normals.empty();
  };
  // The latest meshes are the likeliest.
  const auto found = std::find_if(scene_->meshes.rbegin(), scene_->meshes.rend(), same);
  if (found == scene_->meshes.rend()) {
    Mesh first = piece;
    first.texture_coordinates.clear();
    add(part, std::move(first), material, transform);
    return;
  }
  Mesh moved = piece;
  apply(transform, moved);
  drop_degenerate_triangles(moved);
  const auto offset = static_cast<std::uint32_t>(found->positions.size());
  found->positions.insert(found->positions.end(), moved.positions.begin(), moved.positions.end());
  found->normals.insert(found->normals.end(), moved.normals.begin(), moved.normals.end());
  for (const auto& t : moved.triangles) {
    found->triangles.push_back({t[0] + offset, t[1] + offset, t[2] + offset});
  }
}

Mesh chamfered_box(const Vec3d& size, double chamfer) {
  const Vec3d half = size * 0.5;
  RIMLIGHT_CHECK(2 * chamfer < std::min({size.x, size.y, size.z}));
  Mesh mesh;
  // Vertex (corner, axis): the corner's point on the face of that axis.
  for (int corner = 0; corner < 8; ++corner) {
    for (int axis = 0; axis < 3; ++axis) {
      Vec3d p;
      for (int k = 0; k < 3; ++k) {
        const double sign = (corner >> k & 1) != 0 ? 1 : -1;
        p[k] = sign * (half[k] - (k == axis ? 0 : chamfer));
      }
      mesh.positions.push_back(Vec3f(p));
    }
  }
  const auto vertex = [](int corner, int axis) {
    return static_cast<std::uint32_t>(3 * corner + axis);
  };
  const auto quad = [&mesh](const std::array<std::uint32_t, 4>& v) {
    mesh.triangles.push_back({v[0], v[1], v[2]});
    mesh.triangles.push_back({v[0], v[2], v[3]});
  };
  for (int axis = 0; axis < 3; ++axis) {
    const int next = 1 << (axis + 1) % 3;
    const int last = 1 << (axis + 2) % 3;
    for (const int side : {0, 1 << axis}) {  // faces
      quad({vertex(side, axis), vertex(side | next, axis), vertex(side | next | last, axis),
            vertex(side | last, axis)});
    }
    for (const int edge : {0, next, last, next | last}) {  // chamfers along the axis
      const int a = (axis + 1) % 3;
      const int b = (axis + 2) % 3;
      quad({vertex(edge, a), vertex(edge | 1 << axis, a), vertex(edge | 1 << axis, b),
            vertex(edge, b)});
    }
  }
  for (int corner = 0; corner < 8; ++corner) {
    mesh.triangles.push_back({vertex(corner, 0), vertex(corner, 1), vertex(corner, 2)});
  }
  return mesh;
}

}  // namespace rimlight::terrace
