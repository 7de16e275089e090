#include "core/transport/vertex_bake_tensors.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <span>

#include "core/base/error.h"
#include "core/transport/bake_tensors.h"

namespace rimlight {
namespace {

/// Coordinates of scene sources lie within; their squares stay floats.
constexpr float kFarthest = 1e9f;
constexpr double kMostNormalError = 1e-3;

[[noreturn]] void fail(const std::string& path, const std::string& tensor, std::size_t row,
                       const std::string& found, const std::string& expected) {
  throw Error(path + ": tensor " + quote(tensor) + ", row " + std::to_string(row), found, expected);
}

std::string text_of(const Vec3f& v) {
  return "(" + std::to_string(v.x) + ", " + std::to_string(v.y) + ", " + std::to_string(v.z) + ")";
}

std::vector<Vec3f> read_vectors(const TensorFile& file, const std::string& path,
                                const std::string& name, const std::string& expected,
                                const std::function<bool(const Vec3f&)>& is_good) {
  const auto values = file.tensor<float>(name, ElementType::f32);
  std::vector<Vec3f> result(values.size() / 3);
  for (std::size_t i = 0; i < result.size(); ++i) {
    result[i] = {values[3 * i], values[3 * i + 1], values[3 * i + 2]};
    if (!is_good(result[i])) fail(path, name, i, text_of(result[i]), expected);
  }
  return result;
}

bool is_near(const Vec3f& position) {
  return std::abs(position.x) <= kFarthest && std::abs(position.y) <= kFarthest &&
         std::abs(position.z) <= kFarthest;
}

bool is_unit(const Vec3f& normal) {
  return std::abs(length(Vec3d(normal)) - 1) <= kMostNormalError;
}

bool is_share(const Vec3f& tint) {
  const auto in_range = [](float value) { return value >= 0 && value <= 1; };
  return in_range(tint.x) && in_range(tint.y) && in_range(tint.z);
}

std::vector<std::array<std::uint32_t, 3>> read_triangles(const TensorFile& file,
                                                         const std::string& path,
                                                         std::size_t vertices) {
  const auto values = file.tensor<std::uint32_t>("triangles", ElementType::u32);
  std::vector<std::array<std::uint32_t, 3>> triangles(values.size() / 3);
  for (std::size_t i = 0; i < values.size(); ++i) {
    if (!(values[i] < vertices)) {
      fail(path, "triangles", i / 3, "vertex " + std::to_string(values[i]),
           "one of " + std::to_string(vertices));
    }
    triangles[i / 3][i % 3] = values[i];
  }
  return triangles;
}

std::vector<std::uint32_t> read_material_indices(const TensorFile& file, const std::string& path,
                                                 const VertexBakeShape& shape,
                                                 const std::vector<VertexMaterial>& materials) {
  const auto values = file.tensor<std::uint32_t>("materials", ElementType::u32);
  for (std::size_t i = 0; i < values.size(); ++i) {
    if (!(values[i] < materials.size())) {
      fail(path, "materials", i, "material " + std::to_string(values[i]),
           "one of " + std::to_string(materials.size()));
    }
    const bool has_highlight = max_component(materials[values[i]].highlight) > 0;
    if (has_highlight && i >= shape.transport.highlight_count) {
      fail(path, "materials", i, "a material with a highlight",
           "none beyond the first " + std::to_string(shape.transport.highlight_count));
    }
  }
  return {values.begin(), values.end()};
}

std::vector<std::size_t> irradiance_shape(const VertexTransportView& view) {
  return {batch_count(view.vertex_count), view.irradiance_channels,
          sh::coefficient_count(view.irradiance_degree), kBatchVertices};
}

std::vector<std::size_t> visibility_shape(const VertexTransportView& view) {
  return {batch_count(view.highlight_count), sh::coefficient_count(view.visibility_degree),
          kBatchVertices};
}

/// Rows of kBatchVertices halves, the last batch's beyond `vertices` zero.
std::span<const Half> read_halves(const TensorFile& file, const std::string& path,
                                  const std::string& name, std::size_t vertices) {
  const auto values = file.tensor<Half>(name, ElementType::f16);
  const auto bad = std::ranges::find_if_not(values, [](Half half) { return is_finite(half); });
  if (bad != values.end()) {
    fail(path, name, static_cast<std::size_t>(bad - values.begin()) / kBatchVertices,
         "a number that is not finite", "finite halves");
  }
  const std::size_t batches = batch_count(vertices);
  const std::size_t batch_values = values.size() / batches;
  for (std::size_t i = (batches - 1) * batch_values; i < values.size(); ++i) {
    const std::size_t vertex = (batches - 1) * kBatchVertices + i % kBatchVertices;
    if (vertex < vertices || (values[i] & 0x7fff) == 0) continue;
    fail(path, name, i / kBatchVertices, "a number in the padding", "zeros there");
  }
  return values;
}

}  // namespace

std::vector<TensorShape> mesh_tensors(const VertexBakeShape& shape) {
  return {{"positions", ElementType::f32, {shape.vertices, 3}},
          {"normals", ElementType::f32, {shape.vertices, 3}},
          {"tints", ElementType::f32, {shape.vertices, 3}},
          {"materials", ElementType::u32, {shape.vertices}},
          {"triangles", ElementType::u32, {shape.triangles, 3}}};
}

void write_mesh(TensorFileWriter& writer, const VertexMesh& mesh) {
  static_assert(sizeof(Vec3f) == 3 * sizeof(float));
  for (const auto* vectors : {&mesh.positions, &mesh.normals, &mesh.tints}) {
    writer.append(std::span<const Vec3f>(*vectors));
  }
  writer.append(std::span<const std::uint32_t>(mesh.materials));
  writer.append(std::span<const std::array<std::uint32_t, 3>>(mesh.triangles));
}

VertexMesh read_mesh(const TensorFile& file, const std::string& path, const VertexBakeShape& shape,
                     const std::vector<VertexMaterial>& materials) {
  for (const TensorShape& tensor : mesh_tensors(shape)) {
    expect_shape(file, path, tensor.name, tensor.shape);
  }
  VertexMesh mesh;
  mesh.positions = read_vectors(file, path, "positions", "coordinates within ±1e9", is_near);
  mesh.normals = read_vectors(file, path, "normals", "a unit vector", is_unit);
  mesh.tints = read_vectors(file, path, "tints", "numbers in [0, 1]", is_share);
  mesh.materials = read_material_indices(file, path, shape, materials);
  mesh.triangles = read_triangles(file, path, shape.vertices);
  return mesh;
}

std::vector<TensorShape> vertex_transport_tensors(const VertexBakeShape& shape) {
  std::vector<TensorShape> tensors;
  if (shape.transport.irradiance_channels > 0) {
    tensors.push_back({"irradiance", ElementType::f16, irradiance_shape(shape.transport)});
  }
  if (shape.transport.highlight_count > 0) {
    tensors.push_back({"visibility", ElementType::f16, visibility_shape(shape.transport)});
  }
  return tensors;
}

void write_vertex_transport(TensorFileWriter& writer, const VertexTransportView& transport) {
  if (transport.irradiance_channels > 0) writer.append(transport.irradiance);
  if (transport.highlight_count > 0) writer.append(transport.visibility);
}

VertexTransportView read_vertex_transport(const TensorFile& file, const std::string& path,
                                          const VertexBakeShape& shape) {
  for (const TensorShape& tensor : vertex_transport_tensors(shape)) {
    expect_shape(file, path, tensor.name, tensor.shape);
  }
  VertexTransportView view = shape.transport;
  if (view.irradiance_channels > 0) {
    view.irradiance = read_halves(file, path, "irradiance", view.vertex_count);
  }
  if (view.highlight_count > 0) {
    view.visibility = read_halves(file, path, "visibility", view.highlight_count);
  }
  return view;
}

}  // namespace rimlight
