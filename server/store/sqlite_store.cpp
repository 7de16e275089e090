#include "server/store/sqlite_store.h"

#include <spdlog/spdlog.h>

#include <exception>
#include <new>
#include <utility>

namespace rimlight::server {
namespace {

/// Between attempts at a disk that did not take a commit.
constexpr std::chrono::milliseconds kRetry{50};
/// A commit that takes longer is trouble, and so is one that failed less than this ago.
constexpr std::chrono::seconds kTrouble{5};

std::size_t bytes_of(const StoredEdit& edit) {
  std::size_t bytes = sizeof edit + edit.state.size() + edit.change.size();
  for (const StoredStep& step : edit.rows.steps) bytes += sizeof step + step.step.size();
  for (const StoredSnapshot& snapshot : edit.rows.snapshots) bytes += snapshot.state.size();
  return bytes;
}

}  // namespace

SqliteStore::SqliteStore(const SqliteStoreSettings& settings)
    : most_waiting_(settings.most_waiting),
      most_waiting_bytes_(settings.most_waiting_bytes),
      file_(settings.file.string()),
      metrics_(settings.metrics),
      no_memory_(std::make_shared<const std::optional<StoreError>>(
          StoreError(file_, "no memory for an edit", "some: send it again later"))),
      tables_(settings),
      writer_([this](const std::stop_token& stop) { run(stop); }) {}

SqliteStore::~SqliteStore() {
  writer_.request_stop();
  writer_.join();
}

std::optional<StoredSession> SqliteStore::load(const std::string& scene,
                                               const std::string& session) {
  const std::lock_guard lock(tables_mutex_);
  return tables_.load(scene, session);
}

void SqliteStore::append(StoredEdit edit, Answer answer) {
  const std::size_t bytes = bytes_of(edit);
  take({std::move(edit), std::move(answer), bytes});
}

void SqliteStore::remove(const std::string& scene, const std::string& session, Answer answer) {
  StoredEdit whole;
  whole.scene = scene;
  whole.session = session;
  Waiting waiting{std::move(whole), std::move(answer), sizeof(StoredEdit)};
  waiting.deletes = true;
  take(std::move(waiting));
}

void SqliteStore::take(Waiting waiting) {
  {
    const std::lock_guard lock(mutex_);
    if (doubt_) throw StoreError(**doubt_);
    const std::size_t bytes = waiting.bytes;
    if (waiting_ >= most_waiting_ || waiting_bytes_ + bytes > most_waiting_bytes_) {
      throw StoreError(file_, std::to_string(waiting_) + " edits that wait for the disk",
                       "fewer: send it again later");
    }
    queue_.push_back(std::move(waiting));  // first: it may find no memory
    ++waiting_;
    waiting_bytes_ += bytes;
    metrics_->edits_waiting(waiting_, waiting_bytes_);
  }
  changed_.notify_all();
}

bool SqliteStore::drain(std::chrono::milliseconds most) {
  std::unique_lock lock(mutex_);
  return changed_.wait_for(lock, most, [this] { return waiting_ == 0; });
}

std::int64_t SqliteStore::commits() const {
  const std::lock_guard lock(mutex_);
  return commits_;
}

/// Nothing here may throw: where there is no memory, edits are refused.
void SqliteStore::run(const std::stop_token& stop) {
  for (;;) {
    {
      std::unique_lock lock(mutex_);
      changed_.wait(lock, stop, [this] { return !queue_.empty(); });
      if (queue_.empty()) return;  // only when stopped
      batch_.swap(queue_);
      committing_since_ = Clock::now();
    }
    const Clock::time_point began = Clock::now();
    const Commit result = write(batch_);
    count(batch_, result, began);
    if (result != Commit::in_doubt || resolve_doubt(stop)) answer(batch_);
    forget(batch_);
    batch_.clear();
  }
}

/// Fills in the refusals.
SqliteStore::Commit SqliteStore::write(Batch& batch) {
  const std::lock_guard lock(tables_mutex_);
  bool committing = false;
  try {
    tables_.begin();
    for (Waiting& waiting : batch) {
      if (waiting.deletes) {
        (void)tables_.erase(waiting.edit.scene, waiting.edit.session);
        continue;
      }
      if (tables_.append(waiting.edit)) continue;
      waiting.refusal = std::make_shared<const std::optional<StoreError>>(
          StoreError(file_, "an edit of a revision that is not the session's",
                     "the edit before it to be kept: send it again"));
    }
    committing = true;
    tables_.commit();
  } catch (const SqliteError& error) {
    const bool surely = !committing || error.is_full();
    Refusal refusal = no_memory_;
    try {
      refusal = std::make_shared<const std::optional<StoreError>>(error);
    } catch (const std::bad_alloc&) {  // then that is the reason to tell
    }
    return refuse(batch, refusal, surely ? Commit::failed : Commit::in_doubt);
  } catch (const std::bad_alloc&) {
    return refuse(batch, no_memory_, committing ? Commit::in_doubt : Commit::failed);
  }
  if (std::exchange(failing_, false)) spdlog::info("{}: edits are stored again", file_);
  const std::lock_guard counted(mutex_);
  ++commits_;
  return Commit::kept;
}

SqliteStore::Commit SqliteStore::refuse(Batch& batch, const Refusal& refusal, Commit result) {
  tables_.roll_back();
  if (!std::exchange(failing_, true)) spdlog::error("{}: edits are refused", (*refusal)->what());
  for (Waiting& waiting : batch) waiting.refusal = refusal;
  if (result == Commit::in_doubt) {
    const std::lock_guard doubt(mutex_);
    doubt_ = refusal;
  }
  return result;
}

/// Of the commit that began then and has ended now.
void SqliteStore::count(const Batch& batch, Commit result, Clock::time_point began) {
  const Clock::time_point now = Clock::now();
  if (result == Commit::kept) {
    metrics_->committed(now - began, now - batch.front().came);
  } else {
    metrics_->commit_failed();
  }
  const std::lock_guard lock(mutex_);
  committing_since_.reset();
  failed_ = result == Commit::kept ? std::nullopt : std::optional(now);
}

std::optional<std::string> SqliteStore::trouble() const {
  const std::lock_guard lock(mutex_);
  const Clock::time_point now = Clock::now();
  if (doubt_ || (committing_since_ && now - *committing_since_ > kTrouble)) {
    return "the store does not answer";
  }
  if (failed_ && now - *failed_ < kTrouble) return "edits are not stored";
  return std::nullopt;
}

/// Until the failed commit cannot be found by a restart; false when stopped before.
bool SqliteStore::resolve_doubt(const std::stop_token& stop) {
  for (;;) {
    try {
      const std::lock_guard lock(tables_mutex_);
      tables_.overwrite_failed_commit();
      break;
    } catch (const SqliteError&) {
      tables_.roll_back();
    } catch (const std::bad_alloc&) {
      tables_.roll_back();
    }
    std::unique_lock lock(mutex_);
    if (stop.stop_requested()) return false;
    changed_.wait_for(lock, stop, kRetry, [] { return false; });
  }
  const std::lock_guard lock(mutex_);
  doubt_.reset();
  return true;
}

void SqliteStore::answer(const Batch& batch) {
  static const std::optional<StoreError> kKept;
  for (const Waiting& waiting : batch) {
    try {
      waiting.answer(waiting.refusal ? *waiting.refusal : kKept);
    } catch (const std::exception& error) {  // others wait for theirs
      spdlog::error("{}: an answer was lost: {}", file_, error.what());
    }
  }
}

void SqliteStore::forget(const Batch& batch) {
  {
    const std::lock_guard lock(mutex_);
    waiting_ -= batch.size();
    for (const Waiting& waiting : batch) waiting_bytes_ -= waiting.bytes;
    metrics_->edits_waiting(waiting_, waiting_bytes_);
  }
  changed_.notify_all();
}

}  // namespace rimlight::server
