// The part of DesignSession that decides what is drawn next, and draws it.

#include <algorithm>
#include <exception>
#include <utility>

#include "server/session/design_session.h"

namespace rimlight::server {
namespace {

/// Unfinished work goes on for so long before another session may have its turn.
constexpr std::chrono::milliseconds kSlice{20};

double milliseconds(Clock::duration duration) {
  return std::chrono::duration<double, std::milli>(duration).count();
}

}  // namespace

void DesignSession::reschedule(Clock::time_point now) {
  const bool is_shown = exact_revision_ == version_.revision.number;
  viewers_.set_editors_first(queue_.overload().stage(now) >= Overload::Stage::editors_first);
  wants_again_ = viewers_.any_lacking();
  if (closed_.load() || !viewers_.any_visible() ||
      (is_shown && unfinished_ == Unfinished::nothing && !wants_again_)) {
    moving_since_.reset();
    exact_since_.reset();
    queue_.unschedule(*this);
    return;
  }
  if (is_shown) {
    moving_since_.reset();
    exact_since_.reset();
    queue_.schedule(shared_from_this(), now);
    return;
  }
  const Clock::time_point quiet_from = last_edit_ + settings_.quiet;
  if (!exact_since_ || *exact_since_ < quiet_from) exact_since_ = std::max(now, quiet_from);
  if (moving_revision_ == version_.revision.number || !viewers_.any_ready()) {
    moving_since_.reset();
  } else if (!moving_since_) {
    moving_since_ = now;
  }
  Clock::time_point next = *exact_since_;
  if (moving_since_) next = std::min(next, *moving_since_);
  if (unfinished_ != Unfinished::nothing || wants_again_) next = std::min(next, now);
  queue_.schedule(shared_from_this(), next);
}

DesignSession::Task DesignSession::begin_task(Clock::time_point now) {
  Task task{Work::none, {version_.state, version_.revision}};
  if (closed_.load()) return task;
  if (rest_ == Rest::wanted) {
    rest_ = Rest::taken;
    task.kind = Work::rest;
    return task;
  }
  if (moving_since_) {
    task.kind = Work::moving;
    task.frame.queue_ms = milliseconds(now - *std::exchange(moving_since_, std::nullopt));
    task.frame.edit = ages_.begin(ServerMetrics::FrameKind::moving);
    // Counted as shown already now: only edits that come during the work ask for another.
    moving_revision_ = version_.revision.number;
  } else if (wants_again_ && viewers_.any_lacking()) {
    task.kind = Work::again;
  } else if (unfinished_ == Unfinished::exact_frame) {
    task.kind = Work::improve;  // the exact frame would take as long, and nobody else had a turn
  } else if (exact_since_ && now >= *exact_since_) {
    task.kind = Work::exact;
    task.frame.exact = true;
    task.frame.queue_ms = milliseconds(now - *std::exchange(exact_since_, std::nullopt));
    task.frame.edit = ages_.begin(ServerMetrics::FrameKind::exact);
  } else if (unfinished_ != Unfinished::nothing) {
    task.kind = Work::improve;
  }
  return task;
}

void DesignSession::work(Clock::time_point) noexcept {
  Task task;
  {
    const std::lock_guard lock(mutex_);
    task = begin_task(queue_.now());  // an edit may have come since the queue looked at the clock
  }
  if (task.kind != Work::none) {
    try {
      if (task.kind == Work::rest) {
        maker_.rest();
      } else if (task.kind == Work::improve) {
        improve(task.frame);
      } else if (task.kind == Work::again) {
        encode_again();
      } else {
        make_frame(task.frame);
      }
    } catch (const std::exception& failure) {
      fail(task.frame, failure.what());
    }
  }
  const std::lock_guard lock(mutex_);
  reschedule(queue_.now());
}

void DesignSession::improve(const FrameTask& task) {
  const Clock::time_point end = queue_.now() + kSlice;
  const Unfinished left = maker_.improve([&] {
    return closed_.load(std::memory_order_relaxed) || queue_.now() >= end ||
           newest_revision_.load(std::memory_order_relaxed) != task.revision.number;
  });
  const std::lock_guard lock(mutex_);
  unfinished_ = left;
}

void DesignSession::make_frame(const FrameTask& task) {
  const auto [picture, unfinished] = maker_.draw(task, [&] {
    return closed_.load(std::memory_order_relaxed) ||
           newest_revision_.load(std::memory_order_relaxed) != task.revision.number;
  });
  if (!picture) return;
  std::vector<EncodeOrder> orders;
  {
    const std::lock_guard lock(mutex_);
    unfinished_ = unfinished;
    moving_revision_ = std::max(moving_revision_, task.revision.number);
    if (task.exact) {
      if (version_.revision.number == task.revision.number) ages_.settled();
      exact_revision_ = task.revision.number;
    }
    orders = viewers_.show(*picture, queue_.now());
  }
  encode(orders);
  if (task.edit) {
    using Kind = ServerMetrics::FrameKind;
    settings_.metrics->edit_shown(task.exact ? Kind::exact : Kind::moving,
                                  queue_.now() - *task.edit);
  }
}

void DesignSession::encode_again() {
  std::vector<EncodeOrder> orders;
  {
    const std::lock_guard lock(mutex_);
    orders = viewers_.show_again(queue_.now());
  }
  encode(orders);
}

/// Each is sent before the next is made: nobody waits for another one's encode.
void DesignSession::encode(const std::vector<EncodeOrder>& orders) {
  for (const EncodeOrder& order : orders) {
    const EncodedPtr frame = maker_.encode(order);
    const std::lock_guard lock(mutex_);
    viewers_.offer(frame, queue_.now());
  }
}

void DesignSession::fail(const FrameTask& task, const std::string& reason) {
  settings_.metrics->frame_failed();
  const std::lock_guard lock(mutex_);
  // Not tried again until the next edit: it would fail again.
  moving_revision_ = std::max(moving_revision_, task.revision.number);
  exact_revision_ = std::max(exact_revision_, task.revision.number);
  viewers_.forget_newest();
  unfinished_ = Unfinished::nothing;
  for (const Viewers::Viewer& viewer : viewers_) viewer.client->send_text(write_error(reason));
}

}  // namespace rimlight::server
