#pragma once

#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "server/protocol/messages.h"
#include "server/protocol/people.h"

namespace rimlight::server {

/// One who has edited, as the store has it.
struct StoredUser {
  std::int64_t number = 0;
  std::string name;
  std::string token_hash;          // resume_token_hash()
  std::int64_t last_revision = 0;  // number of the last one that it made

  friend bool operator==(const StoredUser&, const StoredUser&) = default;
};

/// One step of a user's, done or undone.
struct StoredStep {
  std::int64_t user = 0, ordinal = 0;
  bool undone = false;
  std::string step;  // JSON: write_step()

  friend bool operator==(const StoredStep&, const StoredStep&) = default;
};

struct StoredSnapshot {
  std::string name;
  Author author;
  std::int64_t at_ms = 0;  // milliseconds since 1970
  Revision revision;       // that it was made at
  std::string state;       // JSON: state_to_json()

  friend bool operator==(const StoredSnapshot&, const StoredSnapshot&) = default;
};

/// A design session as the store has it.
struct StoredSession {
  Revision revision;
  std::string state;                           // JSON: state_to_json()
  Author author = {};                          // of the revision
  std::vector<StoredUser> users = {};          // by number
  std::vector<StoredStep> steps = {};          // by user and ordinal
  std::vector<StoredSnapshot> snapshots = {};  // by name
};

/// What an edit changes beside the state.
struct StoredRows {
  std::vector<std::int64_t> forgotten_users;  // and their steps
  std::vector<StoredUser> users;              // new, or in the place of the old
  std::vector<std::pair<std::int64_t, std::int64_t>> forgotten_steps;  // user, ordinal
  std::vector<StoredStep> steps;
  std::vector<std::string> forgotten_snapshots;
  std::vector<StoredSnapshot> snapshots;
};

/// An edit to keep: the state after it, and what the log says of it.
struct StoredEdit {
  std::string scene, session;
  Revision before;  // what it was made on, as it is stored; number 0: never stored
  Revision revision;
  std::string state;       // JSON after it: state_to_json()
  std::string change;      // JSON Patch (RFC 6902) from the state before it
  std::string author;      // who
  std::int64_t at_ms = 0;  // when: milliseconds since 1970
  std::int64_t user = 0;   // the author's number
  StoredRows rows = {};
};

}  // namespace rimlight::server
