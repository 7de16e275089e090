#pragma once

#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <deque>
#include <memory>
#include <mutex>
#include <optional>
#include <stop_token>
#include <string>
#include <thread>
#include <vector>

#include "server/store/session_store.h"
#include "server/store/session_tables.h"

namespace rimlight::server {

/// Sessions in a SQLite file. One thread writes: edits that come while a commit is in progress go
/// into the next, so that many cost one flush of the disk. A commit is kept whole or not at all;
/// when it fails, its edits are refused. Where it is not sure that it failed (the disk took the
/// pages, but not the flush), a commit of nothing is written in its place first, again and again;
/// until that is done its edits have no answer, and new ones are refused.
class SqliteStore final : public SessionStore {
 public:
  /// Opens or creates the file. Throws StoreError naming it, as SessionTables does.
  explicit SqliteStore(const SqliteStoreSettings& settings);
  /// Commits what waits, if the disk lets it.
  ~SqliteStore() override;

  std::optional<StoredSession> load(const std::string& scene, const std::string& session) override;
  void append(StoredEdit edit, Answer answer) override;
  void remove(const std::string& scene, const std::string& session, Answer answer) override;
  [[nodiscard]] bool drain(std::chrono::milliseconds most) override;
  /// The last commit failed, a few seconds ago at most; or one takes seconds.
  std::optional<std::string> trouble() const override;

  /// How many commits have kept edits.
  std::int64_t commits() const;

 private:
  using Clock = std::chrono::steady_clock;
  /// Why an edit is not kept; null: it is. Shared, so that where memory is short it can be told
  /// without any.
  using Refusal = std::shared_ptr<const std::optional<StoreError>>;
  struct Waiting {
    StoredEdit edit;
    Answer answer;
    std::size_t bytes = 0;
    Clock::time_point came = Clock::now();
    Refusal refusal = {};
    bool deletes = false;  // the whole session
  };
  using Batch = std::deque<Waiting>;
  enum class Commit { kept, failed, in_doubt };

  void run(const std::stop_token& stop);
  void take(Waiting waiting);
  Commit write(Batch& batch);
  Commit refuse(Batch& batch, const Refusal& refusal, Commit result);
  bool resolve_doubt(const std::stop_token& stop);
  void count(const Batch& batch, Commit result, Clock::time_point began);
  void answer(const Batch& batch);
  void forget(const Batch& batch);

  const std::size_t most_waiting_, most_waiting_bytes_;
  const std::string file_;
  const std::shared_ptr<ServerMetrics> metrics_;
  const Refusal no_memory_;
  std::mutex tables_mutex_;  // before the other one, where both are held
  SessionTables tables_;
  bool failing_ = false;  // the last commit failed

  mutable std::mutex mutex_;
  std::condition_variable_any changed_;
  Batch queue_;
  std::size_t waiting_ = 0, waiting_bytes_ = 0;  // queued and in the commit in progress
  std::int64_t commits_ = 0;
  std::optional<Clock::time_point> committing_since_, failed_;
  Refusal doubt_;  // why the disk does not answer; null when it does
  Batch batch_;    // the writer's own: of the commit in progress
  std::jthread writer_;
};

}  // namespace rimlight::server
