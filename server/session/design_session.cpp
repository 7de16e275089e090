#include "server/session/design_session.h"

#include <algorithm>
#include <exception>
#include <utility>

namespace rimlight::server {
namespace {

/// Unfinished work goes on for so long before another session may have its turn.
constexpr std::chrono::milliseconds kSlice{20};

double milliseconds(Clock::duration duration) {
  return std::chrono::duration<double, std::milli>(duration).count();
}

}  // namespace

DesignSession::DesignSession(std::string name, const ServedScene& scene, std::int64_t epoch,
                             const SessionSettings& settings, RenderQueue& queue,
                             const KeptSession& kept)
    : name_(std::move(name)),
      scene_(scene),
      materials_(known_materials(scene)),
      environments_(scene.environments, kept.environments),
      settings_(settings),
      queue_(queue),
      maker_(scene, environments_, settings.jpeg_quality, queue) {
  if (kept.store != nullptr) waiting_.emplace(*kept.store, scene.name, name_, kept.revision);
  state_ = kept.state;
  if (kept.revision.number == 0) state_.environment = scene.environments.front();
  revision_ = {epoch, kept.revision.number};
  moving_revision_ = revision_.number;  // the first frame is the exact one
  newest_revision_ = revision_.number;
  idle_since_ = queue.now();
  last_edit_ = *idle_since_ - settings.quiet;  // the first frame need not wait for quiet
}

// Messages are handed over under the mutex, so that every client sees revisions in order; the calls
// only post to the client's strand.

void DesignSession::join(const std::shared_ptr<Client>& client, Clock::time_point now) {
  const std::lock_guard lock(mutex_);
  idle_since_.reset();
  viewers_.join(client);
  client->send_text(write_welcome({name_, scene_.name, environments_.names(), scene_.width,
                                   scene_.height, scene_.camera, scene_.any_view, scene_.materials,
                                   scene_.editable, materials_.measured, state_, revision_}));
  if (exact_revision_ == revision_.number) {
    if (exact_frame_) {
      viewers_.offer(*client, exact_frame_);
    } else {
      exact_revision_ = kNone;  // it failed: tried again for who comes new
    }
  }
  reschedule(now);
}

void DesignSession::add_environment(const EnvironmentPtr& environment) {
  const std::lock_guard lock(mutex_);
  environments_.add(environment);
  const std::string text = write_environments(environments_.names());
  for (const Viewers::Viewer& viewer : viewers_) viewer.client->send_text(text);
}

void DesignSession::leave(const Client& client, Clock::time_point now) {
  const std::lock_guard lock(mutex_);
  viewers_.leave(client);
  if (viewers_.empty() && (!waiting_ || waiting_->empty())) idle_since_ = now;
  reschedule(now);
}

void DesignSession::apply(const Client& client, const Edit& edit, Clock::time_point now) {
  const std::lock_guard lock(mutex_);
  const Viewers::Viewer* const viewer = viewers_.find(client);
  const std::shared_ptr<Client> sender = viewer == nullptr ? nullptr : viewer->client;
  if (waiting_) {
    const std::string author = "client " + std::to_string(viewer == nullptr ? 0 : viewer->number);
    waiting_->add(edit, sender, author, state_, revision_,
                  [self = shared_from_this()](const std::optional<StoreError>& refusal) {
                    self->settle(refusal);
                  });
    return;
  }
  WaitingEdit applied{sender, edit.id, {revision_.epoch, revision_.number + 1}, state_};
  apply_edit(edit, applied.state);
  show(applied, now);
}

void DesignSession::settle(const std::optional<StoreError>& refusal) {
  const std::lock_guard lock(mutex_);
  const auto outcome = refusal ? WaitingEdits::Outcome::refused : WaitingEdits::Outcome::durable;
  const WaitingEdit edit = waiting_->take(outcome);
  const Clock::time_point now = queue_.now();
  if (viewers_.empty() && waiting_->empty()) idle_since_ = now;
  if (!refusal) {
    show(edit, now);
  } else if (const auto client = edit.client.lock()) {
    const auto id = edit.id.empty() ? std::nullopt : std::optional(edit.id);
    client->send_answer(write_error(*refusal, id));
  }
}

void DesignSession::show(const WaitingEdit& edit, Clock::time_point now) {
  state_ = edit.state;
  revision_ = edit.revision;
  newest_revision_.store(revision_.number, std::memory_order_relaxed);
  last_edit_ = now;
  const std::shared_ptr<Client> sender = edit.client.lock();
  for (const Viewers::Viewer& viewer : viewers_) {
    if (viewer.client == sender) {
      viewer.client->send_answer(write_ack(edit.id, revision_, state_));
    } else {
      viewer.client->send_state(write_state(revision_, state_));
    }
  }
  reschedule(now);
}

AckResult DesignSession::acknowledge(const Client& client, std::int64_t frame,
                                     Clock::time_point now) {
  const std::lock_guard lock(mutex_);
  const AckResult result = viewers_.acknowledge(client, frame);
  if (result == AckResult::taken) reschedule(now);
  return result;
}

std::optional<Clock::time_point> DesignSession::idle_since() const {
  const std::lock_guard lock(mutex_);
  return idle_since_;
}

void DesignSession::close() {
  closed_.store(true);
  queue_.unschedule(*this);
}

void DesignSession::reschedule(Clock::time_point now) {
  const bool is_shown = exact_revision_ == revision_.number;
  if (closed_.load() || viewers_.empty() || (is_shown && unfinished_ == Unfinished::nothing)) {
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
  if (moving_revision_ == revision_.number || !viewers_.any_ready()) {
    moving_since_.reset();
  } else if (!moving_since_) {
    moving_since_ = now;
  }
  Clock::time_point next = *exact_since_;
  if (moving_since_) next = std::min(next, *moving_since_);
  if (unfinished_ != Unfinished::nothing) next = std::min(next, now);
  queue_.schedule(shared_from_this(), next);
}

DesignSession::Task DesignSession::begin_task(Clock::time_point now) {
  Task task{Work::none, {state_, revision_}};
  if (closed_.load()) return task;
  if (moving_since_) {
    task.kind = Work::moving;
    task.frame.queue_ms = milliseconds(now - *std::exchange(moving_since_, std::nullopt));
    // Counted as shown already now: only edits that come during the work ask for another.
    moving_revision_ = revision_.number;
  } else if (unfinished_ == Unfinished::exact_frame) {
    task.kind = Work::improve;  // the exact frame would take as long, and nobody else had a turn
  } else if (exact_since_ && now >= *exact_since_) {
    task.kind = Work::exact;
    task.frame.exact = true;
    task.frame.queue_ms = milliseconds(now - *std::exchange(exact_since_, std::nullopt));
  } else if (unfinished_ != Unfinished::nothing) {
    task.kind = Work::improve;
  }
  return task;
}

void DesignSession::work(Clock::time_point now) noexcept {
  Task task;
  {
    const std::lock_guard lock(mutex_);
    task = begin_task(now);
  }
  if (task.kind != Work::none) {
    try {
      if (task.kind == Work::improve) {
        improve(task.frame);
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
  const auto [frame, unfinished] = maker_.make(task, [&] {
    return closed_.load(std::memory_order_relaxed) ||
           newest_revision_.load(std::memory_order_relaxed) != task.revision.number;
  });
  if (!frame) return;
  const std::lock_guard lock(mutex_);
  unfinished_ = unfinished;
  moving_revision_ = std::max(moving_revision_, task.revision.number);
  if (task.exact) {
    exact_revision_ = task.revision.number;
    exact_frame_ = frame;
  }
  viewers_.offer(frame);
}

void DesignSession::fail(const FrameTask& task, const std::string& reason) {
  const std::lock_guard lock(mutex_);
  // Not tried again until the next edit: it would fail again.
  moving_revision_ = std::max(moving_revision_, task.revision.number);
  exact_revision_ = std::max(exact_revision_, task.revision.number);
  exact_frame_ = nullptr;
  unfinished_ = Unfinished::nothing;
  for (const Viewers::Viewer& viewer : viewers_) viewer.client->send_text(write_error(reason));
}

}  // namespace rimlight::server
