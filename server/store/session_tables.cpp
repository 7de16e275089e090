#include "server/store/session_tables.h"

#include "core/base/error.h"

namespace rimlight::server {
namespace {

constexpr std::int64_t kVersion = 2;
/// "RmLt", in the file's header: what `file` and other programs know it by.
constexpr std::int64_t kApplication = 0x526d4c74;
/// The log is compacted at every so many edits of a session.
constexpr std::int64_t kCompactEvery = 64;

/// Of version 1: newer ones change them, one after the other.
constexpr const char* kTables = R"(
CREATE TABLE sessions (
  id INTEGER PRIMARY KEY, scene TEXT NOT NULL, name TEXT NOT NULL,
  epoch INTEGER NOT NULL, revision INTEGER NOT NULL,
  state TEXT NOT NULL, changed_ms INTEGER NOT NULL, UNIQUE (scene, name)) STRICT;
CREATE TABLE edits (
  session INTEGER NOT NULL REFERENCES sessions (id), revision INTEGER NOT NULL,
  epoch INTEGER NOT NULL, author TEXT NOT NULL, at_ms INTEGER NOT NULL, change TEXT NOT NULL,
  PRIMARY KEY (session, revision)) STRICT, WITHOUT ROWID;
CREATE TABLE failed_commits (overwritten INTEGER NOT NULL) STRICT;
INSERT INTO failed_commits VALUES (0);
)";

/// From version 1 to 2: who has edited, what each can undo, snapshots.
constexpr const char* kUsers = R"(
ALTER TABLE edits ADD COLUMN user INTEGER NOT NULL DEFAULT 0;
CREATE TABLE users (
  session INTEGER NOT NULL REFERENCES sessions (id) ON DELETE CASCADE, number INTEGER NOT NULL,
  name TEXT NOT NULL, token_hash TEXT NOT NULL, last_revision INTEGER NOT NULL,
  PRIMARY KEY (session, number)) STRICT, WITHOUT ROWID;
CREATE TABLE steps (
  session INTEGER NOT NULL, user INTEGER NOT NULL, ordinal INTEGER NOT NULL,
  undone INTEGER NOT NULL, step TEXT NOT NULL, PRIMARY KEY (session, user, ordinal),
  FOREIGN KEY (session, user) REFERENCES users (session, number) ON DELETE CASCADE) STRICT;
CREATE TABLE snapshots (
  session INTEGER NOT NULL REFERENCES sessions (id) ON DELETE CASCADE, name TEXT NOT NULL,
  author TEXT NOT NULL, user INTEGER NOT NULL, at_ms INTEGER NOT NULL, epoch INTEGER NOT NULL,
  revision INTEGER NOT NULL, state TEXT NOT NULL, PRIMARY KEY (session, name)) STRICT;
)";

/// The version of the file's tables; 0 when it is new. Throws for what is no store, or a newer one.
std::int64_t version_of(SqliteDatabase& database) {
  const std::int64_t application = database.integer_of("PRAGMA application_id");
  const std::int64_t version = database.integer_of("PRAGMA user_version");
  const bool has_tables = database.integer_of("SELECT count(*) FROM sqlite_schema") > 0;
  if (application == 0 && version == 0 && !has_tables) return 0;
  if (application != kApplication) {
    throw StoreError(database.file(), "a database of another program", "a store of sessions");
  }
  if (version < 1 || version > kVersion) {
    throw StoreError(database.file(), "version " + std::to_string(version) + " of the store",
                     "version 1 to " + std::to_string(kVersion));
  }
  return version;
}

}  // namespace

SessionTables::Opened::Opened(SqliteDatabase& database, const SqliteStoreSettings& settings) {
  // One server has it: a second gets an error at its start, and no shared memory is needed.
  database.execute("PRAGMA locking_mode = EXCLUSIVE; PRAGMA trusted_schema = OFF;");
  const std::int64_t version = version_of(database);
  if (database.text_of("PRAGMA journal_mode = WAL") != "wal") {
    throw StoreError(database.file(), "a disk without write-ahead logs", "one that can have them");
  }
  database.execute("PRAGMA synchronous = FULL; PRAGMA foreign_keys = ON;");
  if (settings.most_pages > 0) {
    database.execute("PRAGMA max_page_count = " + std::to_string(settings.most_pages));
  }
  database.execute("BEGIN IMMEDIATE");  // locks, also where there is nothing to make
  if (version < 1) {
    database.execute(kTables);
    database.execute("PRAGMA application_id = " + std::to_string(kApplication));
  }
  if (version < kVersion) {
    database.execute(kUsers);
    database.execute("PRAGMA user_version = " + std::to_string(kVersion));
  }
  database.execute("COMMIT");
  if (const std::string fault = database.text_of("PRAGMA quick_check(1)"); fault != "ok") {
    throw StoreError(database.file(), quote(fault), "a whole store of sessions");
  }
}

SessionTables::SessionTables(const SqliteStoreSettings& settings)
    : kept_edits_(settings.kept_edits),
      database_(settings.file, settings.vfs),
      opened_(database_, settings),
      load_(database_,
            "SELECT s.epoch, s.revision, s.state, s.id, coalesce(e.user, 0), "
            "coalesce(e.author, '') FROM sessions s LEFT JOIN edits e "
            "ON e.session = s.id AND e.revision = s.revision WHERE s.scene = ? AND s.name = ?"),
      insert_(database_,
              "INSERT INTO sessions (scene, name, epoch, revision, state, changed_ms) "
              "VALUES (?, ?, ?, ?, ?, ?) ON CONFLICT DO NOTHING RETURNING id"),
      update_(database_,
              "UPDATE sessions SET epoch = ?, revision = ?, state = ?, changed_ms = ? "
              "WHERE scene = ? AND name = ? AND epoch = ? AND revision = ? RETURNING id"),
      log_(database_,
           "INSERT INTO edits (session, revision, epoch, author, user, at_ms, change) "
           "VALUES (?, ?, ?, ?, ?, ?, ?)"),
      compact_(database_, "DELETE FROM edits WHERE session = ? AND revision <= ?"),
      begin_(database_, "BEGIN IMMEDIATE"),
      commit_(database_, "COMMIT"),
      overwrite_(database_, "UPDATE failed_commits SET overwritten = overwritten + 1"),
      load_users_(database_,
                  "SELECT number, name, token_hash, last_revision FROM users WHERE session = ? "
                  "ORDER BY number"),
      load_steps_(database_,
                  "SELECT user, ordinal, undone, step FROM steps WHERE session = ? "
                  "ORDER BY user, ordinal"),
      load_snapshots_(database_,
                      "SELECT name, author, user, at_ms, epoch, revision, state FROM snapshots "
                      "WHERE session = ? ORDER BY name"),
      put_user_(database_,
                "INSERT INTO users (session, number, name, token_hash, last_revision) "
                "VALUES (?, ?, ?, ?, ?) ON CONFLICT DO UPDATE SET name = excluded.name, "
                "token_hash = excluded.token_hash, last_revision = excluded.last_revision"),
      put_step_(database_,
                "INSERT INTO steps (session, user, ordinal, undone, step) VALUES (?, ?, ?, ?, ?) "
                "ON CONFLICT DO UPDATE SET undone = excluded.undone, step = excluded.step"),
      put_snapshot_(database_,
                    "INSERT OR REPLACE INTO snapshots (session, name, author, user, at_ms, epoch, "
                    "revision, state) VALUES (?, ?, ?, ?, ?, ?, ?, ?)"),
      drop_user_(database_, "DELETE FROM users WHERE session = ? AND number = ?"),
      drop_step_(database_, "DELETE FROM steps WHERE session = ? AND user = ? AND ordinal = ?"),
      drop_snapshot_(database_, "DELETE FROM snapshots WHERE session = ? AND name = ?") {}

std::optional<StoredSession> SessionTables::load(const std::string& scene,
                                                 const std::string& session) {
  const SqliteUse row(load_);
  row->bind(scene).bind(session);
  if (!row->step()) return std::nullopt;
  StoredSession result{{row->integer(0), row->integer(1)}, row->text(2)};
  const std::int64_t id = row->integer(3);
  result.author = {row->integer(4), row->text(5)};
  const SqliteUse user(load_users_);
  for (user->bind(id); user->step();) {
    result.users.push_back({user->integer(0), user->text(1), user->text(2), user->integer(3)});
  }
  const SqliteUse step(load_steps_);
  for (step->bind(id); step->step();) {
    result.steps.push_back(
        {step->integer(0), step->integer(1), step->integer(2) != 0, step->text(3)});
  }
  const SqliteUse snapshot(load_snapshots_);
  for (snapshot->bind(id); snapshot->step();) {
    result.snapshots.push_back({snapshot->text(0),
                                {snapshot->integer(2), snapshot->text(1)},
                                snapshot->integer(3),
                                {snapshot->integer(4), snapshot->integer(5)},
                                snapshot->text(6)});
  }
  return result;
}

std::vector<ListedSession> SessionTables::list() {
  SqliteStatement row(database_,
                      "SELECT scene, name, revision, changed_ms, (SELECT count(*) FROM snapshots "
                      "WHERE session = id) FROM sessions ORDER BY scene, name");
  std::vector<ListedSession> sessions;
  while (row.step()) {
    sessions.push_back({row.text(0), row.text(1), row.integer(2), row.integer(3), row.integer(4)});
  }
  return sessions;
}

bool SessionTables::remove(const std::string& scene, const std::string& session) {
  begin();
  try {
    const bool was_there = erase(scene, session);
    commit();
    return was_there;
  } catch (const SqliteError&) {
    roll_back();
    throw;
  }
}

bool SessionTables::erase(const std::string& scene, const std::string& session) {
  SqliteStatement log(database_,
                      "DELETE FROM edits WHERE session IN "
                      "(SELECT id FROM sessions WHERE scene = ? AND name = ?)");
  log.bind(scene).bind(session).step();
  SqliteStatement row(database_, "DELETE FROM sessions WHERE scene = ? AND name = ? RETURNING id");
  return row.bind(scene).bind(session).step();
}

void SessionTables::begin() { SqliteUse(begin_)->step(); }

void SessionTables::commit() { SqliteUse(commit_)->step(); }

void SessionTables::overwrite_failed_commit() { SqliteUse(overwrite_)->step(); }

/// The row's id, advanced from `before`; nothing when it is not there.
std::optional<std::int64_t> SessionTables::advance(const StoredEdit& edit) {
  const bool is_first = edit.before.number == 0;
  const SqliteUse row(is_first ? insert_ : update_);
  if (is_first) row->bind(edit.scene).bind(edit.session);
  row->bind(edit.revision.epoch).bind(edit.revision.number).bind(edit.state).bind(edit.at_ms);
  if (!is_first) {
    row->bind(edit.scene).bind(edit.session).bind(edit.before.epoch).bind(edit.before.number);
  }
  if (!row->step()) return std::nullopt;
  const std::int64_t id = row->integer(0);
  row->step();
  return id;
}

void SessionTables::keep_rows(std::int64_t session, const StoredRows& rows) {
  for (const std::int64_t number : rows.forgotten_users) {
    SqliteUse(drop_user_)->bind(session).bind(number).step();
  }
  for (const StoredUser& user : rows.users) {
    const SqliteUse row(put_user_);
    row->bind(session).bind(user.number).bind(user.name).bind(user.token_hash);
    row->bind(user.last_revision).step();
  }
  for (const auto& [user, ordinal] : rows.forgotten_steps) {
    SqliteUse(drop_step_)->bind(session).bind(user).bind(ordinal).step();
  }
  for (const StoredStep& step : rows.steps) {
    const SqliteUse row(put_step_);
    row->bind(session).bind(step.user).bind(step.ordinal);
    row->bind(std::int64_t{step.undone}).bind(step.step).step();
  }
  for (const std::string& name : rows.forgotten_snapshots) {
    SqliteUse(drop_snapshot_)->bind(session).bind(name).step();
  }
  for (const StoredSnapshot& snapshot : rows.snapshots) {
    const SqliteUse row(put_snapshot_);
    row->bind(session).bind(snapshot.name).bind(snapshot.author.name);
    row->bind(snapshot.author.number).bind(snapshot.at_ms).bind(snapshot.revision.epoch);
    row->bind(snapshot.revision.number).bind(snapshot.state).step();
  }
}

bool SessionTables::append(const StoredEdit& edit) {
  const std::optional<std::int64_t> id = advance(edit);
  if (!id) return false;
  const SqliteUse row(log_);
  row->bind(*id).bind(edit.revision.number).bind(edit.revision.epoch);
  row->bind(edit.author).bind(edit.user).bind(edit.at_ms).bind(edit.change).step();
  keep_rows(*id, edit.rows);
  if (edit.revision.number % kCompactEvery == 0) {
    const SqliteUse old(compact_);
    old->bind(*id).bind(edit.revision.number - kept_edits_).step();
  }
  return true;
}

}  // namespace rimlight::server
