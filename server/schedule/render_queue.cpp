#include "server/schedule/render_queue.h"

#include "core/base/parallel.h"

namespace rimlight::server {

void RenderQueue::schedule(const std::shared_ptr<RenderJob>& job, Clock::time_point due) {
  {
    const std::lock_guard lock(mutex_);
    const auto [found, is_new] = jobs_.try_emplace(job.get());
    if (!is_new) by_due_.erase({found->second.due, job.get()});
    found->second = {due, job};
    by_due_.insert({due, job.get()});
  }
  changed_.notify_one();
}

void RenderQueue::unschedule(const RenderJob& job) {
  const std::lock_guard lock(mutex_);
  const auto found = jobs_.find(&job);
  if (found == jobs_.end()) return;
  by_due_.erase({found->second.due, &job});
  jobs_.erase(found);
}

bool RenderQueue::run_one(Clock::time_point now) {
  std::shared_ptr<RenderJob> job;
  {
    const std::lock_guard lock(mutex_);
    if (by_due_.empty() || by_due_.begin()->first > now) return false;
    const auto found = jobs_.find(by_due_.begin()->second);
    by_due_.erase(by_due_.begin());
    job = found->second.job.lock();
    jobs_.erase(found);
  }
  if (job) job->work(now);  // outside the lock: it schedules itself again
  return true;
}

Clock::time_point RenderQueue::next_due() const {
  const std::lock_guard lock(mutex_);
  return by_due_.empty() ? Clock::time_point::max() : by_due_.begin()->first;
}

void RenderQueue::run(const std::stop_token& stop) {
  flush_denormals();
  while (!stop.stop_requested()) {
    if (run_one(now())) continue;
    std::unique_lock lock(mutex_);
    const auto due_now = [&] { return !by_due_.empty() && by_due_.begin()->first <= now(); };
    // A due time that moves is a change too: the wait starts again with the new one.
    if (by_due_.empty()) {
      changed_.wait(lock, stop, [&] { return !by_due_.empty(); });
    } else if (!due_now()) {
      const Clock::time_point due = by_due_.begin()->first;
      changed_.wait_until(lock, stop, due,
                          [&] { return by_due_.empty() || by_due_.begin()->first < due; });
    }
  }
}

}  // namespace rimlight::server
