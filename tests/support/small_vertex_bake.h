#pragma once

#include <filesystem>

#include "core/base/aligned_vector.h"
#include "core/transport/vertex_bake.h"

namespace rimlight::test {

/// A bake of vertices with random transport: no rays, made in milliseconds. A strip of triangles
/// with two materials: the first `highlights` vertices have a highlight.
struct SmallVertexBake {
  std::size_t vertices = 150;  // three batches, the last one padded
  std::size_t highlights = 70;
  int irradiance_degree = 4;
  int visibility_degree = 3;
  std::size_t channels = 3;
  std::uint64_t seed = 1;
};

/// What such a bake is made of; `view` is of the vectors.
struct VertexBakeParts {
  VertexBakeManifest manifest;
  VertexMesh mesh;
  AlignedVector<Half> irradiance, visibility;
  VertexTransportView view;
};

VertexBakeParts small_vertex_parts(const SmallVertexBake& settings);
/// With the environments of small_bake.h.
void write_vertex_bake(const std::filesystem::path& folder, const VertexBakeParts& parts);

}  // namespace rimlight::test
