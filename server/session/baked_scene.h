#pragma once

#include <filesystem>
#include <memory>
#include <string>

#include "server/session/scene_catalog.h"

namespace rimlight::server {

/// The name that a bake is served by: its folder's without the ending ("terrace.bake/" is
/// "terrace").
std::string scene_name(const std::filesystem::path& bake_folder);

/// The scene of an opened bake. Throws Error when its name does not fit a URL or it has no
/// environment.
ServedScene serve_bake(std::shared_ptr<const Bake> bake, const RelightSettings& settings);

}  // namespace rimlight::server
