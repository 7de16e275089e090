#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "core/relight/frame_renderer.h"
#include "server/network/http_server.h"
#include "server/session/baked_scene.h"
#include "server/session/session_registry.h"

namespace rimlight {

enum class LogFormat { text, json };

/// What `rimlight serve` can be told (docs/protocol/configuration.md): by a file, the environment
/// or options; serve_fields.h has each by its name.
struct ServeConfig {
  std::vector<std::filesystem::path> bakes;  // the first is the default scene
  std::filesystem::path web;                 // empty: beside the program
  std::filesystem::path key_file;            // of signing keys; empty: clients need no tokens
  // Near enough to exact that nobody sees it, in the time of half a frame at 60 a second.
  server::DrawSettings draw{{{PolicyKind::benefit}, {FrameBudget::Unit::milliseconds, 8}}, {}};
  server::NetworkSettings network;
  server::RegistrySettings sessions;
  std::filesystem::path store;  // of sessions; empty: they live in memory
  LogFormat log = LogFormat::text;
};

/// Reads a configuration file alone; relative paths in it are relative to its folder. Throws Error
/// naming file and field.
ServeConfig read_serve_config(const std::filesystem::path& file);

/// The page's folder of a build tree or an installation, found from the program's own place:
/// web/ beside it or up to three folders above, or share/rimlight/web. Throws Error when there is
/// none.
std::filesystem::path find_web_folder();

}  // namespace rimlight
