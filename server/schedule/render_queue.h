#pragma once

#include <condition_variable>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <set>
#include <stop_token>
#include <tuple>
#include <utility>

#include "server/schedule/overload.h"

namespace rimlight::server {

/// Something that wants the compute thread from time to time: a design session.
class RenderJob {
 public:
  virtual ~RenderJob() = default;
  /// Does the work that is due at `now`, on the compute thread. Throws nothing.
  virtual void work(Clock::time_point now) noexcept = 0;
};

/// The fair queue: of all jobs that are due, the one that has been due longest is next, and of
/// equals the one that was scheduled first. A job stands in it at most once, so it is bounded by
/// the number of sessions. Any thread may schedule; one compute thread runs (its work uses all
/// cores by itself).
class RenderQueue {
 public:
  using TimeSource = std::function<Clock::time_point()>;
  explicit RenderQueue(TimeSource now = Clock::now, const Overload::Settings& overload = {})
      : now_(std::move(now)), overload_(overload) {}

  Clock::time_point now() const { return now_(); }
  /// How late its jobs are, for other jobs' sake.
  const Overload& overload() const { return overload_; }

  /// From now on `job` is due at `due`: replaces what was scheduled for it. A job that is gone by
  /// then is passed over.
  void schedule(const std::shared_ptr<RenderJob>& job, Clock::time_point due);
  void unschedule(const RenderJob& job);

  /// Runs jobs as they become due, until stopped.
  void run(const std::stop_token& stop);
  /// Runs the next job if one is due at `now`; false when none is. What run() does, without
  /// waiting.
  bool run_one(Clock::time_point now);
  /// When the next job is due; the end of time when none is scheduled.
  Clock::time_point next_due() const;

 private:
  using Entry = std::tuple<Clock::time_point, std::uint64_t, const RenderJob*>;
  struct Scheduled {
    Clock::time_point due;
    std::uint64_t place = 0;  // counts what was scheduled
    std::weak_ptr<RenderJob> job;
  };

  const TimeSource now_;
  Overload overload_;
  mutable std::mutex mutex_;
  std::condition_variable_any changed_;
  std::set<Entry> by_due_;
  std::map<const RenderJob*, Scheduled> jobs_;
  std::uint64_t scheduled_ = 0;
  // The compute thread's own: which job ran last, and until when.
  const RenderJob* last_job_ = nullptr;
  Clock::time_point last_end_;
};

}  // namespace rimlight::server
