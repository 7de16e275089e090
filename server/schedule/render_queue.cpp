#include "server/schedule/render_queue.h"

#include <algorithm>

#include "core/base/parallel.h"

namespace rimlight::server {

void RenderQueue::schedule(const std::shared_ptr<RenderJob>& job, Clock::time_point due) {
  {
    const std::lock_guard lock(mutex_);
    const auto [found, is_new] = jobs_.try_emplace(job.get());
    if (!is_new) by_due_.erase({found->second.due, found->second.place, job.get()});
    found->second = {due, ++scheduled_, job};
    by_due_.insert({due, scheduled_, job.get()});
  }
  changed_.notify_one();
}

void RenderQueue::unschedule(const RenderJob& job) {
  const std::lock_guard lock(mutex_);
  const auto found = jobs_.find(&job);
  if (found == jobs_.end()) return;
  by_due_.erase({found->second.due, found->second.place, &job});
  jobs_.erase(found);
}

bool RenderQueue::run_one(Clock::time_point now) {
  Scheduled next;
  {
    const std::lock_guard lock(mutex_);
    if (by_due_.empty() || std::get<0>(*by_due_.begin()) > now) return false;
    const auto found = jobs_.find(std::get<2>(*by_due_.begin()));
    by_due_.erase(by_due_.begin());
    next = std::move(found->second);
    jobs_.erase(found);
  }
  const std::shared_ptr<RenderJob> job = next.job.lock();
  if (!job) return true;
  // What a job waits for itself is not for want of a turn.
  overload_.begin(job.get() == last_job_ ? std::max(next.due, last_end_) : next.due, now);
  job->work(now);  // outside the lock: it schedules itself again
  last_job_ = job.get();
  last_end_ = this->now();
  return true;
}

Clock::time_point RenderQueue::next_due() const {
  const std::lock_guard lock(mutex_);
  return by_due_.empty() ? Clock::time_point::max() : std::get<0>(*by_due_.begin());
}

void RenderQueue::run(const std::stop_token& stop) {
  flush_denormals();
  while (!stop.stop_requested()) {
    if (run_one(now())) continue;
    std::unique_lock lock(mutex_);
    const auto due_now = [&] { return !by_due_.empty() && std::get<0>(*by_due_.begin()) <= now(); };
    // A due time that moves is a change too: the wait starts again with the new one.
    if (by_due_.empty()) {
      changed_.wait(lock, stop, [&] { return !by_due_.empty(); });
    } else if (!due_now()) {
      const Clock::time_point due = std::get<0>(*by_due_.begin());
      changed_.wait_until(lock, stop, due,
                          [&] { return by_due_.empty() || std::get<0>(*by_due_.begin()) < due; });
    }
  }
}

}  // namespace rimlight::server
