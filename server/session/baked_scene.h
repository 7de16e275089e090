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

/// The scene of vertices, seen from anywhere, its materials edited, under a name. Throws Error when
/// it cannot be shown (check_vertex_scene), or the name does not fit a URL.
ServedScene serve_vertices(const std::string& name, std::shared_ptr<const VertexScene> vertices,
                           const VertexSettings& settings);

/// How bakes of each kind are drawn, all within the budget of `relight`.
struct DrawSettings {
  RelightSettings relight;
  VertexSettings vertices;
};

/// Opens a bake of any kind, and projects its environments now: else the first frame of each would
/// wait for it. Throws Error as the bake and the two above do.
ServedScene open_scene(const std::filesystem::path& bake_folder, const DrawSettings& settings);

}  // namespace rimlight::server
