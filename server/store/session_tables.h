#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "server/metrics/server_metrics.h"
#include "server/store/session_store.h"
#include "server/store/sqlite_database.h"

namespace rimlight::server {

struct SqliteStoreSettings {
  std::filesystem::path file;
  std::size_t most_waiting = 4096;  // edits that are not durable yet
  std::size_t most_waiting_bytes = std::size_t{64} << 20;
  std::int64_t kept_edits = 1000;  // of each session's log, and up to 64 more
  std::int64_t most_pages = 0;     // of 4 KiB, of the file; 0: as the disk has
  std::string vfs = {};            // SQLite's own way to the disk without one
  std::shared_ptr<ServerMetrics> metrics = unread_metrics();
};

/// A session in a list.
struct ListedSession {
  std::string scene, name;
  std::int64_t revision = 0;
  std::int64_t changed_ms = 0;  // milliseconds since 1970
  std::int64_t snapshots = 0;
};

/// The tables of a store, in one SQLite file that one server has open at a time (WAL,
/// synchronous=FULL). One thread at a time. All throw SqliteError or StoreError naming the file.
///   sessions  scene, name, epoch, revision, state, changed_ms: a row each, as it is now
///   edits     session, epoch, revision, author, user, at_ms, change: the log of the last ones
///   users     session, number, name, token_hash, last_revision: who has edited
///   steps     session, user, ordinal, undone, step: what each can undo and redo
///   snapshots session, name, state, revision, author, user, at_ms
class SessionTables {
 public:
  /// Makes them in a file that is new. Throws also for a file that is damaged, of something else
  /// or of a newer version, and leaves it as it was.
  explicit SessionTables(const SqliteStoreSettings& settings);

  std::optional<StoredSession> load(const std::string& scene, const std::string& session);
  /// All sessions, by scene and name.
  std::vector<ListedSession> list();
  /// With all that belongs to it; false when there is none. Durable when it returns.
  [[nodiscard]] bool remove(const std::string& scene, const std::string& session);
  void begin();
  /// remove(), within what begin() began.
  bool erase(const std::string& scene, const std::string& session);
  /// False, and nothing is changed, when the session is not at `edit.before`.
  [[nodiscard]] bool append(const StoredEdit& edit);
  void commit();
  void roll_back() noexcept { database_.roll_back(); }
  /// A commit that changes nothing that is kept. After a commit that failed, its pages may lie in
  /// the log whole: this one takes their place, so that no restart finds them.
  void overwrite_failed_commit();

 private:
  /// Settings of the connection, the tables where there are none.
  struct Opened {
    explicit Opened(SqliteDatabase& database, const SqliteStoreSettings& settings);
  };

  std::optional<std::int64_t> advance(const StoredEdit& edit);
  void keep_rows(std::int64_t session, const StoredRows& rows);

  const std::int64_t kept_edits_;
  SqliteDatabase database_;
  Opened opened_;
  SqliteStatement load_, insert_, update_, log_, compact_, begin_, commit_, overwrite_;
  SqliteStatement load_users_, load_steps_, load_snapshots_;
  SqliteStatement put_user_, put_step_, put_snapshot_, drop_user_, drop_step_, drop_snapshot_;
};

}  // namespace rimlight::server
