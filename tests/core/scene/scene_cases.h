#pragma once

#include <cmath>
#include <memory>
#include <numbers>

#include "core/math/random.h"
#include "core/math/sampling.h"
#include "core/scene/scene.h"

namespace rimlight {

inline void add_triangle(Mesh& mesh, const Vec3f& a, const Vec3f& b, const Vec3f& c) {
  const auto first = static_cast<std::uint32_t>(mesh.positions.size());
  mesh.positions.insert(mesh.positions.end(), {a, b, c});
  mesh.triangles.push_back({first, first + 1, first + 2});
}

/// A scene of given meshes with one grey material.
inline std::shared_ptr<Scene> scene_of(std::vector<Mesh> meshes) {
  auto scene = std::make_shared<Scene>();
  scene->name = "test";
  scene->materials.push_back({"grey", Brdf{}, nullptr});
  scene->meshes = std::move(meshes);
  scene->bake.vertex.longest_edge = 0;  // vertices as they are given
  return scene;
}

/// Triangles of sides about 0.4 with middles in [−1, 1]³, with random vertex normals near their
/// own.
inline Mesh triangle_soup(int count, std::uint64_t seed) {
  Random random(seed);
  Mesh mesh;
  for (int i = 0; i < count; ++i) {
    const Vec3d middle(random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1));
    Vec3d corner[3];
    for (Vec3d& p : corner) p = middle + uniform_sphere(random_sample(random)) * 0.25;
    add_triangle(mesh, Vec3f(corner[0]), Vec3f(corner[1]), Vec3f(corner[2]));
    const Vec3d normal = normalized(cross(corner[1] - corner[0], corner[2] - corner[0]));
    for (int k = 0; k < 3; ++k) {
      const Vec3d bent = normal + uniform_sphere(random_sample(random)) * 0.5;
      mesh.normals.push_back(Vec3f(normalized(bent)));
    }
  }
  return mesh;
}

/// A convex sphere of latitudes and longitudes with shared vertices.
inline Mesh test_sphere(const Vec3f& centre, float radius, int rings) {
  Mesh mesh;
  const int columns = 2 * rings;
  for (int row = 0; row <= rings; ++row) {
    for (int column = 0; column < columns; ++column) {
      const double theta = std::numbers::pi * row / rings;
      const double phi = 2 * std::numbers::pi * column / columns;
      const Vec3d p(std::sin(theta) * std::cos(phi), std::cos(theta),
                    std::sin(theta) * std::sin(phi));
      mesh.positions.push_back(centre + Vec3f(p * static_cast<double>(radius)));
    }
  }
  const auto at = [columns](int row, int column) {
    return static_cast<std::uint32_t>(row * columns + column % columns);
  };
  for (int row = 0; row < rings; ++row) {
    for (int column = 0; column < columns; ++column) {
      if (row > 0)
        mesh.triangles.push_back({at(row, column), at(row + 1, column), at(row, column + 1)});
      if (row < rings - 1) {
        mesh.triangles.push_back(
            {at(row, column + 1), at(row + 1, column), at(row + 1, column + 1)});
      }
    }
  }
  return mesh;
}

}  // namespace rimlight
