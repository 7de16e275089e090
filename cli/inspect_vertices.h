#pragma once

#include <nlohmann/json.hpp>

#include "core/transport/vertex_bake.h"

namespace rimlight {

/// What `rimlight inspect` tells of a bake of vertices, and how it prints it.
nlohmann::json describe_vertex_bake(const VertexBake& bake);
void print_vertex_bake(const nlohmann::json& bake, bool verified);

}  // namespace rimlight
