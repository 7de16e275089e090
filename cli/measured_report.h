#pragma once

#include <nlohmann/json.hpp>

#include "core/scene/scene.h"

namespace rimlight {

/// What `rimlight bake` says of a scene's measured BRDFs: how far each fit is off, what part of all
/// angles has samples, and the largest share of its light that the fit reflects.
nlohmann::json describe_measured(const Scene& scene);
/// The same to standard error, a line each, and a warning of those that reflect more than they get.
void print_measured(const nlohmann::json& measured);

}  // namespace rimlight
