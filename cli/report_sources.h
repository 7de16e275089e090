#pragma once

#include <CLI/CLI.hpp>
#include <memory>
#include <string>
#include <vector>

#include "core/light/environment.h"
#include "core/report/lit_mesh.h"
#include "core/scene/scene.h"
#include "core/transport/bake_folder.h"

namespace rimlight {

/// Adds --mesh and --light; what stands in the lists already is the default.
void add_source_options(CLI::App& command, std::vector<std::string>& meshes,
                        std::vector<std::string>& lights);

// What they name. Throw Error naming the option.

/// The parts of the default scene of a name, or a file.
NamedMesh find_mesh(const std::string& name, const Scene& builtin);
/// A built-in environment, or a file.
std::shared_ptr<const Environment> find_light(const std::string& name);
/// The same, or before them an environment of the bake.
std::shared_ptr<const Environment> find_light(const Bake& bake, const std::string& name);

}  // namespace rimlight
