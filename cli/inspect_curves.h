#pragma once

#include <nlohmann/json.hpp>

#include "core/transport/bake_folder.h"

namespace rimlight {

/// What `rimlight inspect` tells of a bake's editable materials, and how it prints it.
nlohmann::json describe_curves(const CurveReceivers& curves);
void print_curves(const nlohmann::json& curves);

}  // namespace rimlight
