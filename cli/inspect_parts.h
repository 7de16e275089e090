#pragma once

#include <cstdint>
#include <nlohmann/json.hpp>
#include <string>
#include <utility>
#include <vector>

#include "core/transport/bake_files.h"

namespace rimlight {

// What `rimlight inspect` tells of bakes of every kind.

/// Sets "files" and the sum of their "bytes".
void describe_files(const std::vector<std::pair<std::string, std::uint64_t>>& files,
                    nlohmann::json& result);
/// Sets "environments".
void describe_environments(const std::vector<BakedEnvironment>& environments,
                           nlohmann::json& result);

/// Files, environments, what is left out, what was measured, settings, from the bake's description.
void print_common(const nlohmann::json& bake);

double mebibytes(const nlohmann::json& bytes);

/// "0.500 0.250 0.125" of an array of three.
std::string three_numbers(const nlohmann::json& numbers);

/// A name as JSON escapes it, without the quotes: nothing in it moves the cursor.
std::string printable(const std::string& name);

}  // namespace rimlight
