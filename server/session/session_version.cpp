#include "server/session/session_version.h"

#include <algorithm>
#include <chrono>
#include <utility>

#include "core/base/error.h"
#include "core/base/json_reader.h"

namespace rimlight::server {
namespace {

using nlohmann::json;

/// Sets the state, and adds the step that leads to it to the history.
void set_state(const SessionVersion& base, DesignState state, const std::string& gesture,
               SessionVersion& next, EditHistory& history) {
  next.state = std::move(state);
  next.json = std::make_shared<json>(state_to_json(next.state));
  history.record(changed_fields(*base.json, *next.json), gesture);
}

void check_environment(const DesignState& state, const std::vector<std::string>& environments) {
  if (std::ranges::find(environments, state.environment) != environments.end()) return;
  throw Error("session: /environment", quote(state.environment), "one that the scene still has");
}

void travel(const Travel& command, const SessionVersion& base,
            const std::vector<std::string>& environments, SessionVersion& next,
            EditHistory& history) {
  const bool back = command.direction == Travel::Direction::undo;
  json state = *base.json;
  const auto possible = [&](const std::string& field, const json& value) {
    return field != "/environment" ||
           std::ranges::any_of(environments, [&](const std::string& one) { return value == one; });
  };
  if (!(back ? history.undo(state, possible) : history.redo(state, possible))) {
    throw Error("message: /type", back ? "an undo" : "a redo",
                back ? "a step of yours of which something still stands"
                     : "a step that you undid and nobody has replaced");
  }
  next.state = read_state(JsonReader(state, "session"));
  next.json = std::make_shared<json>(std::move(state));
  check_environment(next.state, environments);
}

void make_snapshot(const SnapshotCommand& command, const SessionVersion& base, const Author& author,
                   std::int64_t at_ms, SessionVersion& next) {
  const char* const where = "message: /name";
  std::size_t bytes = base.json->dump().size();
  auto snapshot =
      std::make_shared<Snapshot>(Snapshot{base.state, base.revision, author, at_ms, bytes});
  for (const auto& [name, kept] : base.snapshots) bytes += kept->bytes;
  if (base.snapshots.contains(command.name)) {
    throw Error(where, "the snapshot " + quote(command.name), "a name that is not there yet");
  }
  if (base.snapshots.size() >= SessionVersion::kMostSnapshots ||
      bytes > SessionVersion::kMostSnapshotBytes) {
    throw Error(where, std::to_string(base.snapshots.size()) + " snapshots already",
                "room for another: delete one");
  }
  next.snapshots.emplace(command.name, std::move(snapshot));
}

void use_snapshot(const SnapshotCommand& command, const SessionVersion& base,
                  const Contributor& who, const std::vector<std::string>& environments,
                  std::int64_t at_ms, SessionVersion& next, EditHistory& history) {
  if (command.action == SnapshotCommand::Action::make) {
    make_snapshot(command, base, who.author, at_ms, next);
    return;
  }
  const auto found = base.snapshots.find(command.name);
  if (found == base.snapshots.end()) {
    throw Error("message: /name", "no snapshot " + quote(command.name), "one of the session's");
  }
  if (command.action == SnapshotCommand::Action::remove) {
    next.snapshots.erase(command.name);
    return;
  }
  check_environment(found->second->state, environments);
  set_state(base, found->second->state, "", next, history);
}

/// Those who have edited longest ago, but never the one who does now.
void drop_editors(std::map<std::int64_t, Editor>& editors) {
  while (editors.size() > SessionVersion::kMostEditors) {
    editors.erase(std::ranges::min_element(
        editors, {}, [](const auto& entry) { return entry.second.last_revision; }));
  }
}

std::vector<StoredStep> rows_of(std::int64_t user, const EditHistory& history) {
  std::vector<StoredStep> rows;
  for (const EditStepPtr& step : history.done()) rows.push_back({user, step->ordinal, false, {}});
  for (const EditStepPtr& step : history.undone()) rows.push_back({user, step->ordinal, true, {}});
  return rows;
}

/// Adds what differs of one user's steps. Steps are never changed, only replaced.
void compare_steps(std::int64_t user, const EditHistory& base, const EditHistory& next,
                   StoredRows& rows) {
  const auto contains = [](const std::vector<EditStepPtr>& steps, const EditStepPtr& step) {
    return std::ranges::find(steps, step) != steps.end();
  };
  for (const auto list : {&EditHistory::done, &EditHistory::undone}) {
    for (const EditStepPtr& step : (next.*list)()) {
      if (contains((base.*list)(), step)) continue;
      rows.steps.push_back({user, step->ordinal, list == &EditHistory::undone, write_step(*step)});
    }
  }
  const std::vector<StoredStep> kept = rows_of(user, next);
  for (const StoredStep& row : rows_of(user, base)) {
    const auto is_same = [&](const StoredStep& other) { return other.ordinal == row.ordinal; };
    if (std::ranges::none_of(kept, is_same)) rows.forgotten_steps.emplace_back(user, row.ordinal);
  }
}

StoredSnapshot stored(const std::string& name, const Snapshot& snapshot) {
  return {name, snapshot.author, snapshot.at_ms, snapshot.revision,
          state_to_json(snapshot.state).dump()};
}

StoredRows rows_between(const SessionVersion& base, const SessionVersion& next) {
  StoredRows rows;
  for (const auto& [number, editor] : base.editors) {
    if (!next.editors.contains(number)) rows.forgotten_users.push_back(number);
  }
  for (const auto& [number, editor] : next.editors) {
    const auto old = base.editors.find(number);
    const bool is_new = old == base.editors.end();
    if (!is_new && old->second.last_revision == editor.last_revision) continue;
    rows.users.push_back({number, editor.name, editor.token_hash, editor.last_revision});
    compare_steps(number, is_new ? EditHistory() : *old->second.history, *editor.history, rows);
  }
  for (const auto& [name, snapshot] : base.snapshots) {
    if (!next.snapshots.contains(name)) rows.forgotten_snapshots.push_back(name);
  }
  for (const auto& [name, snapshot] : next.snapshots) {
    if (!base.snapshots.contains(name)) rows.snapshots.push_back(stored(name, *snapshot));
  }
  return rows;
}

DesignState read_stored_state(const std::string& text, const std::string& where) {
  const json document = parse_json(text, where);
  return read_state(JsonReader(document, where));
}

void check_revision(const Revision& revision, const std::string& where) {
  if (revision.number >= 0 && revision.number <= kLargestWhole && revision.epoch >= 0 &&
      revision.epoch <= kLargestWhole) {
    return;
  }
  throw Error(where, "revision " + std::to_string(revision.number), "a whole store");
}

void read_editors(const StoredSession& stored, const std::string& where, SessionVersion& version) {
  std::map<std::int64_t, std::pair<std::vector<EditStepPtr>, std::vector<EditStepPtr>>> steps;
  for (const StoredStep& row : stored.steps) {
    auto& [done, undone] = steps[row.user];
    (row.undone ? undone : done).push_back(read_step(row.step, row.ordinal, where));
  }
  for (const StoredUser& user : stored.users) {
    auto& [done, undone] = steps[user.number];
    version.editors[user.number] = {
        user.name, user.token_hash, user.last_revision,
        std::make_shared<EditHistory>(std::move(done), std::move(undone))};
  }
}

}  // namespace

std::vector<SnapshotLabel> SessionVersion::labels() const {
  std::vector<SnapshotLabel> labels;
  for (const auto& [name, snapshot] : snapshots) {
    labels.push_back({name, snapshot->author, snapshot->at_ms, snapshot->revision.number});
  }
  return labels;
}

std::string SessionVersion::use_of(const std::string& environment) const {
  if (state.environment == environment) return "the session shows";
  for (const auto& [name, snapshot] : snapshots) {
    if (snapshot->state.environment == environment) return "the snapshot " + quote(name) + " shows";
  }
  return {};
}

HistoryDepth SessionVersion::depth_of(std::int64_t user) const {
  const auto found = editors.find(user);
  if (found == editors.end()) return {};
  const EditHistory& history = *found->second.history;
  return {history.done().size(), history.undone().size()};
}

SessionVersion first_version(DesignState state, const Revision& revision) {
  auto text = std::make_shared<json>(state_to_json(state));
  return {std::move(state), std::move(text), revision, {}, {}, {}};
}

SessionVersion read_version(const StoredSession& stored,
                            const std::vector<std::string>& environments,
                            const std::string& where) {
  check_revision(stored.revision, where);
  if (stored.revision.number < 1) throw Error(where, "revision 0", "a whole store");
  const json document = parse_json(stored.state, where);
  const JsonReader state(document, where);
  (void)state.member("environment").one_of(environments);
  SessionVersion version = first_version(read_state(state), stored.revision);
  version.author = stored.author;
  read_editors(stored, where, version);
  for (const StoredSnapshot& row : stored.snapshots) {
    check_revision(row.revision, where);
    version.snapshots[row.name] = std::make_shared<Snapshot>(
        Snapshot{read_stored_state(row.state, where + ": snapshot " + quote(row.name)),
                 row.revision, row.author, row.at_ms, row.state.size()});
  }
  return version;
}

SessionVersion next_version(const SessionVersion& base, const Command& command,
                            const Contributor& who, const std::vector<std::string>& environments,
                            std::int64_t at_ms) {
  SessionVersion next = base;
  ++next.revision.number;
  next.author = who.author;
  Editor& editor = next.editors[who.author.number];
  EditHistory history = *editor.history;
  if (const auto* const edit = std::get_if<Edit>(&command)) {
    DesignState state = base.state;
    apply_edit(*edit, state);
    check_environment(state, environments);  // it may have been deleted since the edit was read
    set_state(base, std::move(state), edit->gesture, next, history);
  } else if (const auto* const there = std::get_if<Travel>(&command)) {
    travel(*there, base, environments, next, history);
  } else if (const auto* const snapshot = std::get_if<SnapshotCommand>(&command)) {
    use_snapshot(*snapshot, base, who, environments, at_ms, next, history);
  } else {
    check_environment(std::get<Import>(command).state, environments);
    set_state(base, std::get<Import>(command).state, "", next, history);
  }
  editor = {who.author.name, who.token_hash, next.revision.number,
            std::make_shared<EditHistory>(std::move(history))};
  drop_editors(next.editors);
  return next;
}

std::int64_t milliseconds_since_1970() {
  const auto since_1970 = std::chrono::system_clock::now().time_since_epoch();
  return std::chrono::duration_cast<std::chrono::milliseconds>(since_1970).count();
}

StoredEdit stored_edit(const SessionVersion& base, const SessionVersion& next, std::int64_t at_ms) {
  StoredEdit edit;
  edit.revision = next.revision;
  edit.state = next.json->dump();
  edit.change = json::diff(*base.json, *next.json).dump();
  edit.author = next.author.name;
  edit.user = next.author.number;
  edit.at_ms = at_ms;
  edit.rows = rows_between(base, next);
  return edit;
}

}  // namespace rimlight::server
