#pragma once

#include <filesystem>
#include <functional>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "cli/serve_config.h"
#include "core/base/json_reader.h"

namespace rimlight {

/// One thing that `rimlight serve` can be told: a field of its file, the variable RIMLIGHT_ and the
/// name in capitals, and often an option. docs/protocol/schema/server_config.schema.json says the
/// same of each.
struct ServeField {
  enum class Form { text, number, flag, texts, path, paths };

  std::string name;
  Form form;
  /// Sets it. Relative paths are relative to `folder`. Throws Error naming the value's place.
  std::function<void(const JsonReader& value, const std::filesystem::path& folder, ServeConfig&)>
      read;
  /// Its value, as a file would have it; null where there is none.
  std::function<nlohmann::json(const ServeConfig&)> show;

  /// "RIMLIGHT_MOST_SESSIONS" of "most_sessions".
  std::string variable() const;
};

/// All of them, in the order in which people want to read them.
const std::vector<ServeField>& serve_fields();

}  // namespace rimlight
