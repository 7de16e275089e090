#pragma once

#include <string>
#include <vector>

#include "core/transport/tensor_file.h"
#include "core/transport/vertex_bake_manifest.h"

namespace rimlight {

// The tensors of a bake of vertices (docs/formats/vertex_bake.md), written, and read and checked.
// `path` is for errors; they name it and the tensor.

std::vector<TensorShape> mesh_tensors(const VertexBakeShape& shape);
void write_mesh(TensorFileWriter& writer, const VertexMesh& mesh);
/// Finite positions, unit normals, tints in [0, 1], indices in range; and no highlight on vertices
/// beyond the shape's highlight_count.
VertexMesh read_mesh(const TensorFile& file, const std::string& path, const VertexBakeShape& shape,
                     const std::vector<VertexMaterial>& materials);

/// Without "visibility" where no vertex has a highlight, and "irradiance" where it has no channel.
std::vector<TensorShape> vertex_transport_tensors(const VertexBakeShape& shape);
void write_vertex_transport(TensorFileWriter& writer, const VertexTransportView& transport);
/// A view of the file's memory: finite, and zero in the last batch's padding.
VertexTransportView read_vertex_transport(const TensorFile& file, const std::string& path,
                                          const VertexBakeShape& shape);

}  // namespace rimlight
