#pragma once

#include <filesystem>
#include <map>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "cli/serve_config.h"

namespace rimlight {

/// The variables whose names begin with RIMLIGHT_, with their values.
using Variables = std::map<std::string, std::string>;
Variables rimlight_variables();

/// Where a field's value comes from; each overrules those before it.
enum class ValueSource { built_in, file, environment, option };
const char* to_string(ValueSource source);

struct LayeredConfig {
  ServeConfig config;
  std::map<std::string, ValueSource> sources;  // of every field
  std::vector<std::string> unknown_variables;  // that no field has
};

/// What options say, by the names of fields. Lists of texts add to what is there, others replace
/// it.
using OptionValues = std::map<std::string, nlohmann::json>;

/// Options over environment over file; `file` may be empty, for none. Lists in the environment are
/// separated by commas. Paths are relative to the file's folder, or else to the working folder.
/// Throws Error naming file and field, variable, or option.
LayeredConfig layer_config(const std::filesystem::path& file, const Variables& environment,
                           const OptionValues& options);

}  // namespace rimlight
