#include "core/transport/vertex_bake.h"

#include "core/base/check.h"
#include "core/transport/vertex_bake_manifest.h"
#include "core/transport/vertex_bake_tensors.h"

namespace rimlight {
namespace {

void check_sizes(const VertexBakeManifest& manifest, const VertexMesh& mesh,
                 const VertexTransportView& transport) {
  const std::size_t vertices = transport.vertex_count;
  RIMLIGHT_CHECK(!manifest.materials.empty() && vertices > 0);
  RIMLIGHT_CHECK_EQ(mesh.positions.size(), vertices);
  RIMLIGHT_CHECK_EQ(mesh.normals.size(), vertices);
  RIMLIGHT_CHECK_EQ(mesh.tints.size(), vertices);
  RIMLIGHT_CHECK_EQ(mesh.materials.size(), vertices);
  RIMLIGHT_CHECK(transport.highlight_count <= vertices);
}

}  // namespace

void commit_vertex_bake(BakeWriter& writer, const VertexBakeManifest& manifest,
                        const VertexMesh& mesh, const VertexTransportView& transport) {
  check_sizes(manifest, mesh, transport);
  const VertexBakeShape shape{transport.vertex_count, mesh.triangles.size(), transport};
  const auto mesh_writer = writer.create(kMeshFile, mesh_tensors(shape));
  write_mesh(*mesh_writer, mesh);
  writer.add_file(kMeshFile, mesh_writer->finish());
  const auto transport_writer = writer.create(kTransportFile, vertex_transport_tensors(shape));
  write_vertex_transport(*transport_writer, transport);
  writer.add_file(kTransportFile, transport_writer->finish());
  writer.commit(to_json(manifest, shape), {kMeshFile, kTransportFile});
}

VertexBake::VertexBake(const std::filesystem::path& folder)
    : files_(folder), manifest_(read_vertex_manifest(files_.manifest())) {
  const VertexBakeShape shape = read_vertex_shape(files_.manifest());
  mesh_ = read_mesh(files_.file(kMeshFile), files_.path(kMeshFile), shape, manifest_.materials);
  transport_ =
      read_vertex_transport(files_.file(kTransportFile), files_.path(kTransportFile), shape);
  transport_.normals = mesh_.normals;
  environments_ = files_.read_environments();
}

}  // namespace rimlight
