#include "server/session/field_changes.h"

#include <algorithm>

namespace rimlight::server {
namespace {

using nlohmann::json;
using Pointer = json::json_pointer;

const json kNull;

const json& member(const json& object, const std::string& name) {
  const auto found = object.find(name);
  return found == object.end() ? kNull : *found;
}

/// Compares members that either has, `depth` objects further down.
void compare(const Pointer& at, const json& before, const json& after, int depth,
             FieldChanges& changes) {
  if (before == after) return;
  if (depth == 0) {
    changes[at.to_string()] = {before, after};
    return;
  }
  const json none = json::object();
  const json& old = before.is_object() ? before : none;
  const json& now = after.is_object() ? after : none;
  for (const auto& [name, value] : old.items()) {
    compare(at / name, value, member(now, name), depth - 1, changes);
  }
  for (const auto& [name, value] : now.items()) {
    if (!old.contains(name)) compare(at / name, kNull, value, depth - 1, changes);
  }
}

}  // namespace

bool is_field(const std::string& pointer) {
  for (std::size_t at = pointer.find('~'); at != pointer.npos; at = pointer.find('~', at + 1)) {
    if (at + 1 == pointer.size() || (pointer[at + 1] != '0' && pointer[at + 1] != '1'))
      return false;
  }
  const auto depth = std::count(pointer.begin(), pointer.end(), '/');
  if (pointer.starts_with("/material/load/")) return depth == 3;
  if (pointer.starts_with("/material/parameter/") || pointer.starts_with("/material/curve/")) {
    return depth == 4;
  }
  return pointer == "/rotation" || pointer == "/environment" || pointer == "/exposure" ||
         pointer == "/view";
}

FieldChanges changed_fields(const json& before, const json& after) {
  FieldChanges changes;
  for (const char* const field : {"rotation", "environment", "exposure", "view"}) {
    compare(Pointer() / field, member(before, field), member(after, field), 0, changes);
  }
  const json& old = member(before, "material");
  const json& now = member(after, "material");
  constexpr int kOfMaterial = 2;  // the material's name, then the field's
  for (const char* const part : {"parameter", "curve"}) {
    compare(Pointer() / "material" / part, member(old, part), member(now, part), kOfMaterial,
            changes);
  }
  compare(Pointer() / "material" / "load", member(old, "load"), member(now, "load"), 1, changes);
  return changes;
}

json field_of(const json& state, const std::string& field) {
  const Pointer at(field);
  return state.contains(at) ? state.at(at) : json();
}

void set_field(json& state, const std::string& field, const json& value) {
  const Pointer at(field);
  if (!value.is_null()) {
    state[at] = value;
    return;
  }
  if (!state.contains(at)) return;
  const Pointer parent = at.parent_pointer();
  json& holder = state.at(parent);
  holder.erase(at.back());
  constexpr std::size_t kMaterialAndField = 4;  // /material/PART/NAME/FIELD
  std::size_t depth = 0;
  for (Pointer rest = at; !rest.empty(); rest = rest.parent_pointer()) ++depth;
  if (holder.empty() && depth == kMaterialAndField) {
    state.at(parent.parent_pointer()).erase(parent.back());
  }
}

}  // namespace rimlight::server
