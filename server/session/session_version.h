#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "server/protocol/messages.h"
#include "server/session/edit_history.h"
#include "server/store/stored_session.h"

namespace rimlight::server {

/// One who edits: by name, and by the hash of the resume token.
struct Contributor {
  Author author;
  std::string token_hash;
};

/// A kept state.
struct Snapshot {
  DesignState state;
  Revision revision;  // that it was made at
  Author author;
  std::int64_t at_ms = 0;
  std::size_t bytes = 0;  // of the state in JSON
};

/// One who has edited.
struct Editor {
  std::string name;
  std::string token_hash;
  std::int64_t last_revision = 0;
  std::shared_ptr<const EditHistory> history = std::make_shared<EditHistory>();
};

/// All that edits change of a session, at one revision. A value; copies share what is large.
struct SessionVersion {
  /// More snapshots, or of more bytes in all, are refused; of more editors those who have edited
  /// longest ago are forgotten, and what they could undo.
  static constexpr std::size_t kMostSnapshots = 32, kMostSnapshotBytes = std::size_t{4} << 20;
  static constexpr std::size_t kMostEditors = 32;

  DesignState state;
  std::shared_ptr<const nlohmann::json> json;  // the state, as state_to_json() has it
  Revision revision;
  Author author;  // of the revision
  std::map<std::int64_t, Editor> editors;
  std::map<std::string, std::shared_ptr<const Snapshot>> snapshots;

  /// For the lists of messages.
  std::vector<SnapshotLabel> labels() const;
  HistoryDepth depth_of(std::int64_t user) const;
  /// What shows an environment, in words; empty where nothing does. Steps that can be undone do not
  /// count: EditHistory::Possible.
  std::string use_of(const std::string& environment) const;
};

/// A session that nobody has edited.
SessionVersion first_version(DesignState state, const Revision& revision);
/// As it is stored. Throws Error naming `where` for what no server has written, and for a state
/// that has none of `environments`.
SessionVersion read_version(const StoredSession& stored,
                            const std::vector<std::string>& environments, const std::string& where);

/// The next revision, which the command makes. Throws Error where it cannot: a state that grows too
/// large, nothing to undo or redo, an environment that is gone, a snapshot that is not there, there
/// already, or one too many.
SessionVersion next_version(const SessionVersion& base, const Command& command,
                            const Contributor& who, const std::vector<std::string>& environments,
                            std::int64_t at_ms);

/// The wall clock's, for `at_ms`.
std::int64_t milliseconds_since_1970();

/// What is kept of it, made on `base`. The session's names and `before` are left empty.
StoredEdit stored_edit(const SessionVersion& base, const SessionVersion& next, std::int64_t at_ms);

}  // namespace rimlight::server
