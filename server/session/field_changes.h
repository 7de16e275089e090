#pragma once

#include <map>
#include <nlohmann/json.hpp>
#include <string>

namespace rimlight::server {

// A state's fields, as state_to_json() has them, each by its JSON Pointer (RFC 6901): /rotation,
// /environment, /exposure, /view, and of each material /material/parameter/NAME/PARAMETER,
// /material/curve/NAME/AXIS and /material/load/NAME. A field that is not there is null.

/// What a field was, and what it became.
struct FieldChange {
  nlohmann::json before, after;

  friend bool operator==(const FieldChange&, const FieldChange&) = default;
};
using FieldChanges = std::map<std::string, FieldChange>;

/// Whether it points to one of those.
bool is_field(const std::string& pointer);

/// The fields in which two states differ.
FieldChanges changed_fields(const nlohmann::json& before, const nlohmann::json& after);

/// Null where it is not there.
nlohmann::json field_of(const nlohmann::json& state, const std::string& field);
/// Null takes the field away, and a material of which nothing is left.
void set_field(nlohmann::json& state, const std::string& field, const nlohmann::json& value);

}  // namespace rimlight::server
