#pragma once

#include <memory>
#include <string>

#include "core/light/environment.h"
#include "core/report/lit_mesh.h"
#include "core/scene/scene.h"

namespace rimlight {

// What --mesh and --light of a report name. Throw Error naming the option.

/// The parts of the default scene of a name, or a file.
NamedMesh find_mesh(const std::string& name, const Scene& builtin);
/// A built-in environment, or a file.
std::shared_ptr<const Environment> find_light(const std::string& name);

}  // namespace rimlight
