#include "core/bake/vertex_mesh.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <tuple>

#include "core/bake/mesh_refinement.h"
#include "core/bake/vertex_material.h"
#include "core/base/error.h"
#include "core/scene/mesh_geometry.h"
#include "core/scene/texture.h"

namespace rimlight {
namespace {

using Triangle = std::array<std::uint32_t, 3>;

/// A vertex on its way, with what it is sorted by.
struct Corner {
  bool without_highlight = false;
  std::uint64_t morton = 0;
  std::uint32_t material = 0;
  Vec3f position, normal, tint;
  bool computed_normal = false;
};

auto key(const Corner& c) {
  return std::tuple(c.without_highlight, c.morton, c.material, c.position.x, c.position.y,
                    c.position.z, c.normal.x, c.normal.y, c.normal.z, c.tint.x, c.tint.y, c.tint.z);
}

/// Puts two zeros between the lowest 21 bits.
std::uint64_t spread_bits(std::uint64_t x) {
  x = (x | x << 32) & 0x1f'0000'0000'ffff;
  x = (x | x << 16) & 0x1f'0000'ff00'00ff;
  x = (x | x << 8) & 0x100f'00f0'0f00'f00f;
  x = (x | x << 4) & 0x10c3'0c30'c30c'30c3;
  x = (x | x << 2) & 0x1249'2492'4924'9249;
  return x;
}

/// The place of a point on a Morton curve through a cube around the scene.
std::uint64_t morton_code(const Vec3f& point, const Bounds& bounds, double side) {
  constexpr double kCells = (1 << 21) - 1;
  std::uint64_t code = 0;
  for (int axis = 0; axis < 3; ++axis) {
    const double share = side > 0 ? (point[axis] - bounds.low[axis]) / side : 0;
    code |= spread_bits(static_cast<std::uint64_t>(std::clamp(share, 0.0, 1.0) * kCells)) << axis;
  }
  return code;
}

bool is_direction(const Vec3f& v) {
  const float squared = dot(v, v);
  return squared > 1e-12f && squared < 1e12f;
}

/// Unit normals for all used vertices: the mesh's own, else smooth ones, else that of a triangle
/// (where those around a vertex cancel out). Tells which are not the mesh's own.
std::vector<bool> complete_normals(Mesh& mesh, const std::vector<bool>& used) {
  std::vector<Vec3f> own(mesh.normals);
  own.resize(mesh.positions.size());
  std::vector<bool> missing(own.size());
  for (std::size_t i = 0; i < own.size(); ++i) missing[i] = used[i] && !is_direction(own[i]);
  if (std::ranges::find(missing, true) != missing.end()) smooth_normals(mesh);
  for (const Triangle& t : mesh.triangles) {
    for (const std::uint32_t i : t) {
      if (is_direction(own[i])) continue;
      const Vec3d a(mesh.positions[t[0]]);
      const Vec3d across = cross(Vec3d(mesh.positions[t[1]]) - a, Vec3d(mesh.positions[t[2]]) - a);
      own[i] = is_direction(mesh.normals[i]) ? mesh.normals[i] : Vec3f(normalized(across));
    }
  }
  for (std::size_t i = 0; i < own.size(); ++i) {
    if (used[i]) own[i] = Vec3f(normalized(Vec3d(own[i])));
  }
  mesh.normals = std::move(own);
  return missing;
}

Vec3f tint_at(const Mesh& mesh, const Material& material, std::size_t vertex) {
  if (!material.albedo_texture || mesh.texture_coordinates.empty()) return {1, 1, 1};
  Vec3f tint = texture_at(*material.albedo_texture, mesh.texture_coordinates[vertex]);
  for (int c = 0; c < 3; ++c) tint[c] = std::clamp(tint[c], 0.0f, 1.0f);
  return tint;
}

/// −0 counts as 0.
Vec3f without_signed_zero(const Vec3f& v) { return v + Vec3f(); }

/// Joins meshes, one after the other, and sorts them in the end.
class Joiner {
 public:
  Joiner(const Scene& scene, PreparedVertices& result) : scene_(scene), result_(result) {
    const Bounds bounds = bounds_of(scene.meshes);
    bounds_ = bounds;
    side_ = max_component(bounds.high - bounds.low);
  }

  void add(Mesh mesh) {
    result_.dropped_triangles += drop_degenerate_triangles(mesh);
    std::vector<bool> used(mesh.positions.size());
    for (const Triangle& t : mesh.triangles) {
      for (const std::uint32_t i : t) used[i] = true;
    }
    std::vector<bool> computed = complete_normals(mesh, used);
    refine_edges(mesh);
    used.resize(mesh.positions.size(), true);
    computed.resize(mesh.positions.size(), false);
    const bool has_highlight = max_component(result_.materials[mesh.material].highlight) > 0;
    std::vector<std::uint32_t> place(mesh.positions.size());
    for (std::size_t i = 0; i < place.size(); ++i) {
      if (!used[i]) {
        ++result_.unused_vertices;
        continue;
      }
      place[i] = static_cast<std::uint32_t>(corners_.size());
      corners_.push_back({!has_highlight, morton_code(mesh.positions[i], bounds_, side_),
                          mesh.material, without_signed_zero(mesh.positions[i]),
                          without_signed_zero(mesh.normals[i]),
                          tint_at(mesh, scene_.materials[mesh.material], i), computed[i]});
    }
    for (const Triangle& t : mesh.triangles) {
      triangles_.push_back({place[t[0]], place[t[1]], place[t[2]]});
    }
  }

  void finish() {
    std::vector<std::uint32_t> order(corners_.size());
    std::iota(order.begin(), order.end(), 0u);
    std::sort(order.begin(), order.end(), [this](std::uint32_t a, std::uint32_t b) {
      return std::tuple(key(corners_[a]), a) < std::tuple(key(corners_[b]), b);
    });
    std::vector<std::uint32_t> place(order.size());
    for (std::size_t i = 0; i < order.size(); ++i) {
      const Corner& corner = corners_[order[i]];
      if (i == 0 || key(corner) != key(corners_[order[i - 1]])) {
        append(corner);
      } else {
        ++result_.joined_vertices;
      }
      place[order[i]] = static_cast<std::uint32_t>(result_.mesh.positions.size() - 1);
    }
    auto& triangles = result_.mesh.triangles;
    for (const Triangle& t : triangles_) {
      triangles.push_back({place[t[0]], place[t[1]], place[t[2]]});
    }
    std::stable_sort(triangles.begin(), triangles.end(), [](const Triangle& a, const Triangle& b) {
      return *std::min_element(a.begin(), a.end()) < *std::min_element(b.begin(), b.end());
    });
  }

 private:
  void refine_edges(Mesh& mesh) {
    const double share = scene_.bake.vertex.longest_edge;
    if (!(share > 0)) return;
    const std::size_t before = mesh.positions.size();
    if (!refine(mesh, share * side_, kMostAddedVertices - result_.added_vertices)) {
      throw Error(scene_.name,
                  "longest_edge " + std::to_string(share) + ", which takes more than " +
                      std::to_string(kMostAddedVertices) + " new vertices",
                  "a larger one, or 0 to leave meshes as they are");
    }
    result_.added_vertices += mesh.positions.size() - before;
  }

  void append(const Corner& corner) {
    VertexMesh& mesh = result_.mesh;
    mesh.positions.push_back(corner.position);
    mesh.normals.push_back(corner.normal);
    mesh.materials.push_back(corner.material);
    mesh.tints.push_back(corner.tint);
    if (!corner.without_highlight) ++result_.highlight_count;
    if (corner.computed_normal) ++result_.computed_normals;
  }

  const Scene& scene_;
  PreparedVertices& result_;
  Bounds bounds_;
  double side_ = 0;
  std::vector<Corner> corners_;
  std::vector<Triangle> triangles_;
};

}  // namespace

PreparedVertices prepare_vertices(const Scene& scene) {
  PreparedVertices result;
  for (const Material& material : scene.materials) {
    result.materials.push_back(vertex_material(material));
  }
  Joiner joiner(scene, result);
  for (const Mesh& mesh : scene.meshes) joiner.add(mesh);
  joiner.finish();
  if (result.mesh.triangles.empty()) throw Error(scene.name, "no triangles", "a surface to bake");
  return result;
}

RayScene ray_scene_of(const VertexMesh& mesh) {
  auto scene = std::make_shared<Scene>();
  scene->name = "vertices";
  scene->materials.emplace_back();
  scene->meshes.emplace_back();
  scene->meshes.back().positions = mesh.positions;
  scene->meshes.back().triangles = mesh.triangles;
  return RayScene(std::move(scene));
}

std::vector<double> vertex_areas(const VertexMesh& mesh) {
  std::vector<double> areas(mesh.positions.size());
  for (const Triangle& t : mesh.triangles) {
    const Vec3d a(mesh.positions[t[0]]);
    const double twice =
        length(cross(Vec3d(mesh.positions[t[1]]) - a, Vec3d(mesh.positions[t[2]]) - a));
    for (const std::uint32_t i : t) areas[i] += twice / 6;
  }
  return areas;
}

}  // namespace rimlight
