#pragma once

#include <nlohmann/json.hpp>

#include "core/base/json_reader.h"
#include "core/transport/vertex_bake.h"

namespace rimlight {

/// The sizes that a manifest states: a VertexTransportView without its tensors.
struct VertexBakeShape {
  std::size_t vertices = 0;
  std::size_t triangles = 0;
  VertexTransportView transport;
};

/// The manifest as it stands in manifest.json, and back. Reading throws Error at the first field
/// that is missing, unknown (but "files" and "environments") or out of range.
nlohmann::json to_json(const VertexBakeManifest& manifest, const VertexBakeShape& shape);
VertexBakeManifest read_vertex_manifest(const JsonReader& json);
VertexBakeShape read_vertex_shape(const JsonReader& json);

}  // namespace rimlight
