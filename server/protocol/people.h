#pragma once

#include <cstddef>
#include <cstdint>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "server/access/access_token.h"

namespace rimlight::server {

/// Who made a revision. Number 0: nobody, or somebody that the store does not tell.
struct Author {
  std::int64_t number = 0;  // of the session's users, from 1
  std::string name;

  friend bool operator==(const Author&, const Author&) = default;
};

/// One who has the session open.
struct Present {
  Author user;
  Role role = Role::viewer;

  friend bool operator==(const Present&, const Present&) = default;
};

/// A message names so many of those who are there, and counts the others.
inline constexpr std::size_t kMostPresent = 64;

/// {"id", "name"}; null for number 0.
nlohmann::json author_to_json(const Author& author);
/// {"id", "name", "role"}
nlohmann::json present_to_json(const Present& present);
/// Adds "present", an array of kMostPresent, and "more", how many others there are.
void add_presence(const std::vector<Present>& present, nlohmann::json& message);
std::string write_presence(const std::vector<Present>& present);

/// A snapshot, as lists have it.
struct SnapshotLabel {
  std::string name;
  Author author;
  std::int64_t at_ms = 0;     // milliseconds since 1970
  std::int64_t revision = 0;  // that it was made at
};

/// [{"name", "by", "at", "revision"}]
nlohmann::json labels_to_json(const std::vector<SnapshotLabel>& snapshots);
std::string write_snapshots(const std::vector<SnapshotLabel>& snapshots);

/// How many steps a user has to undo and to redo.
struct HistoryDepth {
  std::size_t undo = 0, redo = 0;
};
/// {"undo", "redo"}
nlohmann::json depth_to_json(const HistoryDepth& depth);

}  // namespace rimlight::server
