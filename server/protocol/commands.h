#pragma once

#include <cstdint>
#include <string>

#include "core/relight/design_state.h"

namespace rimlight::server {

// What clients ask for besides edits that set fields. Each becomes a revision too.

/// Longest name of a snapshot, in bytes.
inline constexpr std::size_t kLongestSnapshotName = 64;

/// Takes the newest of the user's own steps back, or the one that was undone last forth.
struct Travel {
  enum class Direction { undo, redo };
  std::string id;
  Direction direction = Direction::undo;

  friend bool operator==(const Travel&, const Travel&) = default;
};

/// Keeps the state under a name, sets the state to a kept one, or forgets one.
struct SnapshotCommand {
  enum class Action { make, restore, remove };
  std::string id;
  Action action = Action::make;
  std::string name;

  friend bool operator==(const SnapshotCommand&, const SnapshotCommand&) = default;
};

/// Deletes the session for good. Of the client's messages the one that makes no revision.
struct DeleteSession {
  std::string id;

  friend bool operator==(const DeleteSession&, const DeleteSession&) = default;
};

/// Sets the whole state.
struct Import {
  std::string id;
  DesignState state;

  friend bool operator==(const Import&, const Import&) = default;
};

}  // namespace rimlight::server
