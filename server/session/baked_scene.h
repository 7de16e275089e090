#pragma once

#include <filesystem>
#include <memory>
#include <string>

#include "core/vertices/vertex_renderer.h"
#include "server/session/scene_catalog.h"

namespace rimlight::server {

/// The name that a bake is served by: its folder's without the ending ("terrace.bake/" is
/// "terrace").
std::string scene_name(const std::filesystem::path& bake_folder);

/// The scene of an opened bake. Throws Error when its name does not fit a URL or it has no
/// environment.
ServedScene serve_bake(std::shared_ptr<const Bake> bake, const RelightSettings& settings);

/// The scene of vertices, seen from anywhere, its materials edited. Throws Error when it cannot be
/// shown (check_vertex_scene), or its name does not fit a URL.
ServedScene serve_vertices(std::shared_ptr<const VertexScene> vertices,
                           const VertexSettings& settings);

}  // namespace rimlight::server
