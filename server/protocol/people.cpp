#include "server/protocol/people.h"

#include <algorithm>

namespace rimlight::server {
namespace {

using nlohmann::json;

std::string dump(const json& value) {
  return value.dump(-1, ' ', false, json::error_handler_t::replace);
}

}  // namespace

json author_to_json(const Author& author) {
  if (author.number == 0) return nullptr;
  return {{"id", author.number}, {"name", author.name}};
}

json present_to_json(const Present& present) {
  json text = author_to_json(present.user);
  text["role"] = to_string(present.role);
  return text;
}

void add_presence(const std::vector<Present>& present, json& message) {
  const std::size_t named = std::min(present.size(), kMostPresent);
  message["present"] = json::array();
  for (std::size_t i = 0; i < named; ++i) {
    message["present"].push_back(present_to_json(present[i]));
  }
  message["more"] = present.size() - named;
}

std::string write_presence(const std::vector<Present>& present) {
  json message{{"type", "presence"}};
  add_presence(present, message);
  return dump(message);
}

json labels_to_json(const std::vector<SnapshotLabel>& snapshots) {
  json list = json::array();
  for (const SnapshotLabel& label : snapshots) {
    list.push_back({{"name", label.name},
                    {"by", author_to_json(label.author)},
                    {"at", label.at_ms},
                    {"revision", label.revision}});
  }
  return list;
}

std::string write_snapshots(const std::vector<SnapshotLabel>& snapshots) {
  return dump({{"type", "snapshots"}, {"snapshots", labels_to_json(snapshots)}});
}

json depth_to_json(const HistoryDepth& depth) {
  return {{"undo", depth.undo}, {"redo", depth.redo}};
}

}  // namespace rimlight::server
