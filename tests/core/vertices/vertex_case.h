#pragma once

#include <cmath>
#include <memory>
#include <string>

#include "core/vertices/vertex_renderer.h"
#include "tests/core/scene/scene_cases.h"
#include "tests/core/vertices/random_vertices.h"

namespace rimlight::test {

/// Small maps: projecting costs by their texels.
inline constexpr int kLightSize = 16;
inline const VertexSettings kVertexSettings{
    .background_size = 16, .light_size = kLightSize, .window = LightWindow::none, .view_ms = 1e9};

/// A sphere of two glossy materials over a matt floor, with transport of random numbers; vertices
/// with a highlight first.
struct VertexCase {
  struct Shape {
    int rings = 12;
    int floor_side = 9;  // vertices
    int irradiance_degree = 4, visibility_degree = 5;
    std::size_t channels = 1;
    int width = 100, height = 70;
  };
  explicit VertexCase(const Shape& shape);
  VertexCase() : VertexCase(Shape{}) {}

  VertexScene scene;
};

/// A lat-long environment of a smooth gradient and a bright patch; never black.
inline std::shared_ptr<const Environment> sky(const std::string& name, float scale = 1) {
  RgbImage image(64, 32);
  for (int y = 0; y < 32; ++y) {
    for (int x = 0; x < 64; ++x) {
      const float patch = x > 40 && x < 46 && y > 8 && y < 12 ? 20.0f : 0.0f;
      const float wave = 0.3f * std::sin(static_cast<float>(x) * 0.3f);
      image.at(x, y) = Vec3f(0.5f + wave + patch, 0.8f + 0.02f * static_cast<float>(y),
                             1.2f - 0.03f * static_cast<float>(y) + 0.5f * patch) *
                       scale;
    }
  }
  return std::make_shared<const Environment>(name, std::move(image));
}

inline void add_floor(VertexMesh& mesh, int side) {
  const auto first = static_cast<std::uint32_t>(mesh.positions.size());
  const auto at = [&](int row, int column) {
    return first + static_cast<std::uint32_t>(row * side + column);
  };
  const float last = static_cast<float>(side - 1);
  for (int row = 0; row < side; ++row) {
    for (int column = 0; column < side; ++column) {
      const float x = static_cast<float>(column) / last, z = static_cast<float>(row) / last;
      mesh.positions.push_back({4 * x - 2, -1, 4 * z - 2});
      mesh.normals.push_back({0, 1, 0});
      mesh.materials.push_back(2);
      mesh.tints.push_back({0.4f + 0.5f * x, 0.7f, 0.9f - 0.5f * z});
      if (row == 0 || column == 0) continue;
      mesh.triangles.push_back({at(row - 1, column - 1), at(row, column - 1), at(row, column)});
      mesh.triangles.push_back({at(row - 1, column - 1), at(row, column), at(row - 1, column)});
    }
  }
}

inline VertexMesh sphere_on_floor(int rings, int floor_side) {
  VertexMesh mesh;
  const std::uint32_t kinds = 2;
  for (std::uint32_t kind = 0; kind < kinds; ++kind) {
    const Vec3f centre{kind == 0 ? -0.6f : 0.7f, 0, 0};
    const Mesh sphere = test_sphere(centre, 0.6f, rings);
    const auto first = static_cast<std::uint32_t>(mesh.positions.size());
    for (const Vec3f& position : sphere.positions) {
      mesh.positions.push_back(position);
      mesh.normals.push_back(normalized(position - centre));
      mesh.materials.push_back(kind);
      mesh.tints.push_back({1, 0.9f, 0.8f});
    }
    for (const auto& t : sphere.triangles) {
      mesh.triangles.push_back({t[0] + first, t[1] + first, t[2] + first});
    }
  }
  add_floor(mesh, floor_side);
  return mesh;
}

/// Random transport under which no vertex is dark: the mean of the light outweighs the rest. Lanes
/// of padding are zero, as in bakes.
struct LitVertices {
  RandomVertices random;
  AlignedVector<Half> irradiance, visibility;

  explicit LitVertices(const RandomVertices::Shape& shape) : random(shape) {
    const VertexTransportView given = random.view();
    const std::size_t of_irradiance =
        shape.channels * sh::coefficient_count(shape.irradiance_degree);
    irradiance = padded(given.irradiance, shape.vertices, of_irradiance);
    visibility =
        padded(given.visibility, shape.highlights, sh::coefficient_count(shape.visibility_degree));
    const std::size_t channel = of_irradiance / shape.channels * kBatchVertices;
    for (std::size_t i = 0; i < irradiance.size(); ++i) {
      const std::size_t batch = i / (channel * shape.channels);
      const bool is_vertex = batch * kBatchVertices + i % kBatchVertices < shape.vertices;
      if (i % channel < kBatchVertices && is_vertex) irradiance[i] = to_half(3);
    }
  }
  VertexTransportView view() const {
    VertexTransportView result = random.view();
    result.irradiance = irradiance;
    result.visibility = visibility;
    return result;
  }

 private:
  static AlignedVector<Half> padded(std::span<const Half> given, std::size_t vertices,
                                    std::size_t rows) {
    AlignedVector<Half> result(given.begin(), given.end());
    for (std::size_t i = 0; i < result.size(); ++i) {
      const std::size_t batch = i / (rows * kBatchVertices);
      if (batch * kBatchVertices + i % kBatchVertices >= vertices) result[i] = 0;
    }
    return result;
  }
};

inline VertexCase::VertexCase(const Shape& shape) {
  auto mesh = std::make_shared<VertexMesh>(sphere_on_floor(shape.rings, shape.floor_side));
  const std::size_t count = mesh->positions.size();
  const auto floor = static_cast<std::size_t>(shape.floor_side * shape.floor_side);
  const auto vertices = std::make_shared<LitVertices>(RandomVertices::Shape{
      count, count - floor, shape.irradiance_degree, shape.visibility_degree, shape.channels});
  scene.name = "case";
  scene.mesh = std::move(mesh);
  scene.materials = {{"brass", {0.6f, 0.4f, 0.1f}, {0.4f, 0.3f, 0.2f}, 12},
                     {"enamel", {0.1f, 0.2f, 0.7f}, {0.5f, 0.5f, 0.5f}, 40},
                     {"floor", {0.5f, 0.6f, 0.5f}, {0, 0, 0}, 1}};
  scene.transport = vertices->view();
  scene.camera.position = {0.5, 1.2, 3.5};
  scene.camera.target = {0, -0.2, 0};
  scene.width = shape.width;
  scene.height = shape.height;
  scene.environments = {{sky("sky"), 0.7}, {sky("dim", 0.25f), 1.5}};
  scene.memory = vertices;
}

inline std::shared_ptr<const VertexScene> scene_of(const VertexCase::Shape& shape = {}) {
  return std::make_shared<const VertexScene>(VertexCase(shape).scene);
}

}  // namespace rimlight::test
