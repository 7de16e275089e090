#include "tests/support/small_vertex_bake.h"

#include "core/math/random.h"
#include "core/math/sampling.h"
#include "tests/support/small_bake.h"

namespace rimlight::test {
namespace {

/// [batch][rows][kBatchVertices], zero beyond `vertices`.
AlignedVector<Half> random_rows(std::size_t vertices, std::size_t rows, Random& random) {
  AlignedVector<Half> halves(batch_count(vertices) * rows * kBatchVertices);
  for (std::size_t vertex = 0; vertex < vertices; ++vertex) {
    const std::size_t batch = vertex / kBatchVertices, lane = vertex % kBatchVertices;
    for (std::size_t row = 0; row < rows; ++row) {
      halves[(batch * rows + row) * kBatchVertices + lane] =
          to_half(static_cast<float>(random.uniform(-1, 1)));
    }
  }
  return halves;
}

VertexMesh strip(const SmallVertexBake& settings, Random& random) {
  VertexMesh mesh;
  for (std::size_t i = 0; i < settings.vertices; ++i) {
    const auto along = static_cast<double>(i / 2);
    mesh.positions.push_back(Vec3f(Vec3d(along, i % 2 == 0 ? 0 : 1, random.uniform(0, 0.2))));
    mesh.normals.push_back(Vec3f(uniform_sphere(random_sample(random))));
    mesh.tints.push_back({random.uniform_float(), random.uniform_float(), random.uniform_float()});
    mesh.materials.push_back(i < settings.highlights ? 1 : 0);
    if (i < 2) continue;
    const auto at = static_cast<std::uint32_t>(i);
    mesh.triangles.push_back({at - 2, at - 1, at});
  }
  return mesh;
}

}  // namespace

VertexBakeParts small_vertex_parts(const SmallVertexBake& settings) {
  Random random(settings.seed);
  VertexBakeParts parts;
  parts.manifest = {.scene = "strip",
                    .width = 320,
                    .height = 200,
                    .camera = {},
                    .materials = {{"chalk", {0.8f, 0.7f, 0.6f}, {0, 0, 0}, 50},
                                  {"varnish", {0.3f, 0.2f, 0.1f}, {0.2f, 0.3f, 0.4f}, 80}},
                    .settings = {{"degree", 10}},
                    .measured = {{"rays", 123}},
                    .left_out = {{"bands", 6}}};
  parts.manifest.camera.position = {1, 2, 6};
  parts.mesh = strip(settings, random);
  parts.irradiance =
      random_rows(settings.vertices,
                  settings.channels * sh::coefficient_count(settings.irradiance_degree), random);
  parts.visibility =
      random_rows(settings.highlights, sh::coefficient_count(settings.visibility_degree), random);
  parts.view = {.vertex_count = settings.vertices,
                .highlight_count = settings.highlights,
                .irradiance_degree = settings.irradiance_degree,
                .visibility_degree = settings.visibility_degree,
                .irradiance_channels = settings.channels,
                .irradiance = parts.irradiance,
                .visibility = parts.visibility};
  return parts;
}

void write_vertex_bake(const std::filesystem::path& folder, const VertexBakeParts& parts) {
  BakeWriter writer(folder);
  for (const BakedEnvironment& environment : small_environments()) {
    writer.add_environment(environment);
  }
  commit_vertex_bake(writer, parts.manifest, parts.mesh, parts.view);
}

}  // namespace rimlight::test
