#include "server/store/session_tables.h"

#include "core/base/error.h"

namespace rimlight::server {
namespace {

constexpr std::int64_t kVersion = 1;
/// "RmLt", in the file's header: what `file` and other programs know it by.
constexpr std::int64_t kApplication = 0x526d4c74;
/// The log is compacted at every so many edits of a session.
constexpr std::int64_t kCompactEvery = 64;

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

/// Throws unless the file is new or a store of this version; true when it is new.
bool is_new(SqliteDatabase& database) {
  const std::int64_t application = database.integer_of("PRAGMA application_id");
  const std::int64_t version = database.integer_of("PRAGMA user_version");
  const bool has_tables = database.integer_of("SELECT count(*) FROM sqlite_schema") > 0;
  if (application == 0 && version == 0 && !has_tables) return true;
  if (application != kApplication) {
    throw StoreError(database.file(), "a database of another program", "a store of sessions");
  }
  if (version != kVersion) {
    throw StoreError(database.file(), "version " + std::to_string(version) + " of the store",
                     "version " + std::to_string(kVersion));
  }
  return false;
}

}  // namespace

SessionTables::Opened::Opened(SqliteDatabase& database, const SqliteStoreSettings& settings) {
  // One server has it: a second gets an error at its start, and no shared memory is needed.
  database.execute("PRAGMA locking_mode = EXCLUSIVE; PRAGMA trusted_schema = OFF;");
  const bool make = is_new(database);
  if (database.text_of("PRAGMA journal_mode = WAL") != "wal") {
    throw StoreError(database.file(), "a disk without write-ahead logs", "one that can have them");
  }
  database.execute("PRAGMA synchronous = FULL; PRAGMA foreign_keys = ON;");
  if (settings.most_pages > 0) {
    database.execute("PRAGMA max_page_count = " + std::to_string(settings.most_pages));
  }
  database.execute("BEGIN IMMEDIATE");  // locks, also where there is nothing to make
  if (make) {
    database.execute(kTables);
    database.execute("PRAGMA application_id = " + std::to_string(kApplication));
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
      load_(database_, "SELECT epoch, revision, state FROM sessions WHERE scene = ? AND name = ?"),
      insert_(database_,
              "INSERT INTO sessions (scene, name, epoch, revision, state, changed_ms) "
              "VALUES (?, ?, ?, ?, ?, ?) ON CONFLICT DO NOTHING RETURNING id"),
      update_(database_,
              "UPDATE sessions SET epoch = ?, revision = ?, state = ?, changed_ms = ? "
              "WHERE scene = ? AND name = ? AND epoch = ? AND revision = ? RETURNING id"),
      log_(database_,
           "INSERT INTO edits (session, revision, epoch, author, at_ms, change) "
           "VALUES (?, ?, ?, ?, ?, ?)"),
      compact_(database_, "DELETE FROM edits WHERE session = ? AND revision <= ?"),
      begin_(database_, "BEGIN IMMEDIATE"),
      commit_(database_, "COMMIT"),
      overwrite_(database_, "UPDATE failed_commits SET overwritten = overwritten + 1") {}

std::optional<StoredSession> SessionTables::load(const std::string& scene,
                                                 const std::string& session) {
  const SqliteUse row(load_);
  row->bind(scene).bind(session);
  if (!row->step()) return std::nullopt;
  return StoredSession{{row->integer(0), row->integer(1)}, row->text(2)};
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

bool SessionTables::append(const StoredEdit& edit) {
  const std::optional<std::int64_t> id = advance(edit);
  if (!id) return false;
  const SqliteUse row(log_);
  row->bind(*id).bind(edit.revision.number).bind(edit.revision.epoch);
  row->bind(edit.author).bind(edit.at_ms).bind(edit.change).step();
  if (edit.revision.number % kCompactEvery == 0) {
    const SqliteUse old(compact_);
    old->bind(*id).bind(edit.revision.number - kept_edits_).step();
  }
  return true;
}

}  // namespace rimlight::server
