#include "server/session/design_session.h"

#include <utility>

namespace rimlight::server {
namespace {

/// In the epoch of this life of the session.
SessionVersion version_in(std::int64_t epoch, const ServedScene& scene, const KeptSession& kept) {
  DesignState state;
  state.environment = scene.environments.front();
  SessionVersion version = kept.version ? *kept.version : first_version(std::move(state), {});
  version.revision.epoch = epoch;
  return version;
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
      version_(version_in(epoch, scene, kept)),
      users_(version_),
      viewers_(scene.width, scene.height),
      maker_(scene, environments_, settings.jpeg_quality, queue, settings.metrics) {
  if (kept.store != nullptr) {
    waiting_.emplace(*kept.store, scene.name, name_,
                     kept.version ? kept.version->revision : Revision{});
  }
  moving_revision_ = version_.revision.number;  // the first frame is the exact one
  newest_revision_ = version_.revision.number;
  viewers_.expect(version_.revision);
  idle_since_ = queue.now();
  last_edit_ = *idle_since_ - settings.quiet;  // the first frame need not wait for quiet
  settings_.metrics->session_opened();
}

DesignSession::~DesignSession() { settings_.metrics->session_closed(); }

// Messages are handed over under the mutex, so that every client sees revisions in order; the calls
// only post to the client's strand.

void DesignSession::join(const std::shared_ptr<Client>& client, Clock::time_point now,
                         const Visitor& visitor) {
  const std::lock_guard lock(mutex_);
  try {
    enter(client, now, visitor);
  } catch (...) {
    viewers_.leave(*client);
    users_.leave(*client);
    if (viewers_.empty() && (!waiting_ || waiting_->empty())) idle_since_ = now;
    throw;
  }
}

void DesignSession::enter(const std::shared_ptr<Client>& client, Clock::time_point now,
                          const Visitor& visitor) {
  const SessionUsers::Entered entered = users_.enter(*client, visitor);
  idle_since_.reset();
  rest_ = Rest::none;
  using Part = Viewers::Part;
  viewers_.join(client, visitor.role < Role::editor ? Part::watches : Part::edits,
                {.parts = visitor.parts});
  client->send_text(write_welcome(welcome_for(entered, visitor)));
  tell_presence(client.get());
  if (exact_revision_ == version_.revision.number) {
    if (viewers_.has_exact()) {
      viewers_.offer_newest(*client, now);
    } else {
      exact_revision_ = kNone;  // it failed: tried again for who comes new
    }
  }
  reschedule(now);
}

Welcome DesignSession::welcome_for(const SessionUsers::Entered& entered,
                                   const Visitor& visitor) const {
  Welcome welcome{name_,           scene_.name,         environments_.names(), scene_.width,
                  scene_.height,   scene_.camera,       scene_.any_view,       scene_.materials,
                  scene_.editable, materials_.measured, version_.state,        version_.revision};
  welcome.author = version_.author;
  welcome.you = {entered.user.author, visitor.role};
  welcome.resume = entered.resume;
  welcome.resumed = entered.resumed;
  if (entered.resumed && visitor.seen) welcome.missed = version_.revision.number - *visitor.seen;
  welcome.history = version_.depth_of(entered.user.author.number);
  welcome.snapshots = version_.labels();
  welcome.present = users_.present();
  return welcome;
}

void DesignSession::tell_presence(const Client* except) {
  std::string text = write_presence(users_.present());
  if (text == presence_) return;
  presence_ = std::move(text);
  for (const Viewers::Viewer& viewer : viewers_) {
    if (viewer.client.get() != except) viewer.client->send_presence(presence_);
  }
}

void DesignSession::add_environment(const EnvironmentPtr& environment) {
  const std::lock_guard lock(mutex_);
  environments_.add(environment);
  const std::string text = write_environments(environments_.names());
  for (const Viewers::Viewer& viewer : viewers_) viewer.client->send_text(text);
}

void DesignSession::remove_environment(const std::string& name) {
  const std::lock_guard lock(mutex_);
  // Of edits on their way, too: they are in the order of the store before whatever comes later.
  const SessionVersion& newest = waiting_ ? waiting_->newest(version_) : version_;
  std::string use = newest.use_of(name);
  if (use.empty()) use = version_.use_of(name);
  if (!use.empty()) {
    throw Error("URL", "the environment " + quote(name) + ", which " + use, "one not in use");
  }
  if (!environments_.remove(name)) {
    throw Error("URL", "the environment " + quote(name), "one that was uploaded to the session");
  }
  const std::string text = write_environments(environments_.names());
  for (const Viewers::Viewer& viewer : viewers_) viewer.client->send_text(text);
}

Author DesignSession::begin_deletion(const Client& client) {
  const std::lock_guard lock(mutex_);
  check_not_deleting();
  deleting_ = true;
  return users_.of(client).author;
}

void DesignSession::check_not_deleting() const {
  if (deleting_) throw Error("session " + quote(name_), "one that is being deleted", "another");
}

void DesignSession::cancel_deletion() {
  const std::lock_guard lock(mutex_);
  deleting_ = false;
}

void DesignSession::end(const Author& by) {
  const std::lock_guard lock(mutex_);
  deleted_.store(true);
  const std::string text = write_deleted(by);
  for (const Viewers::Viewer& viewer : viewers_) viewer.client->send_off(text);
}

void DesignSession::leave(const Client& client, Clock::time_point now) {
  const std::lock_guard lock(mutex_);
  viewers_.leave(client);
  users_.leave(client);
  tell_presence(nullptr);
  if (viewers_.empty()) ages_.forget();
  if (viewers_.empty() && (!waiting_ || waiting_->empty())) idle_since_ = now;
  reschedule(now);
}

void DesignSession::apply(const Client& client, const Command& command, Clock::time_point now) {
  const std::lock_guard lock(mutex_);
  check_not_deleting();
  const Viewers::Viewer* const viewer = viewers_.find(client);
  const std::shared_ptr<Client> sender = viewer == nullptr ? nullptr : viewer->client;
  const std::int64_t at_ms = milliseconds_since_1970();
  const SessionVersion& base = waiting_ ? waiting_->newest(version_) : version_;
  WaitingEdit edit{sender, id_of(command),
                   next_version(base, command, users_.of(client), environments_.names(), at_ms)};
  if (!waiting_) {
    show(std::move(edit), now, now);
    return;
  }
  waiting_->add(std::move(edit), base, at_ms,
                [self = shared_from_this(), now](const std::optional<StoreError>& refusal) {
                  self->settle(refusal, now);
                });
}

void DesignSession::settle(const std::optional<StoreError>& refusal, Clock::time_point arrived) {
  const std::lock_guard lock(mutex_);
  const auto outcome = refusal ? WaitingEdits::Outcome::refused : WaitingEdits::Outcome::durable;
  WaitingEdit edit = waiting_->take(outcome);
  const Clock::time_point now = queue_.now();
  if (viewers_.empty() && waiting_->empty()) idle_since_ = now;
  if (!refusal) {
    show(std::move(edit), arrived, now);
    return;
  }
  settings_.metrics->edit_refused();
  if (const auto client = edit.client.lock()) {
    const auto id = edit.id.empty() ? std::nullopt : std::optional(edit.id);
    client->send_answer(write_error(*refusal, id));
  }
}

/// The version is taken first and without memory: where there is none to tell of it, the session is
/// still the one that is stored.
void DesignSession::show(WaitingEdit edit, Clock::time_point arrived, Clock::time_point now) {
  const bool has_other_snapshots = version_.snapshots != edit.version.snapshots;
  version_ = std::move(edit.version);
  settings_.metrics->edit_applied();
  if (!viewers_.empty()) ages_.edited(arrived);
  newest_revision_.store(version_.revision.number, std::memory_order_relaxed);
  viewers_.expect(version_.revision);
  last_edit_ = now;
  const std::shared_ptr<Client> sender = edit.client.lock();
  std::string state;  // written when there is somebody else to tell
  for (const Viewers::Viewer& viewer : viewers_) {
    if (viewer.client == sender) {
      viewer.client->send_answer(write_ack(edit.id, version_.revision, version_.state,
                                           version_.author,
                                           version_.depth_of(version_.author.number)));
    } else {
      if (state.empty()) {
        state = write_state(version_.revision, version_.state, version_.author);
      }
      viewer.client->send_state(state);
    }
    if (has_other_snapshots) viewer.client->send_snapshots(write_snapshots(version_.labels()));
  }
  reschedule(now);
}

std::string DesignSession::export_state() const {
  const std::lock_guard lock(mutex_);
  return write_export(scene_.name, name_, version_.revision, version_.state);
}

AckResult DesignSession::acknowledge(const Client& client, std::int64_t frame,
                                     Clock::time_point now) {
  const std::lock_guard lock(mutex_);
  const AckResult result = viewers_.acknowledge(client, frame, now);
  if (result == AckResult::taken) reschedule(now);
  return result;
}

void DesignSession::set_display(const Client& client, const Display& display,
                                Clock::time_point now) {
  const std::lock_guard lock(mutex_);
  viewers_.set_display(client, display, now);
  reschedule(now);
}

std::optional<Clock::time_point> DesignSession::idle_since() const {
  const std::lock_guard lock(mutex_);
  return idle_since_;
}

bool DesignSession::settled() const {
  const std::lock_guard lock(mutex_);
  if (waiting_ && !waiting_->empty()) return false;
  return viewers_.empty() || (exact_revision_ == version_.revision.number && viewers_.all_shown());
}

void DesignSession::rest(Clock::time_point now, std::chrono::milliseconds after) {
  const std::lock_guard lock(mutex_);
  const bool is_idle = idle_since_ && viewers_.empty() && now - *idle_since_ >= after;
  if (!is_idle || rest_ != Rest::none || closed_.load()) return;
  rest_ = Rest::wanted;
  unfinished_ = Unfinished::nothing;
  viewers_.forget_newest();
  exact_revision_ = kNone;
  queue_.schedule(shared_from_this(), now);
}

void DesignSession::close() {
  closed_.store(true);
  queue_.unschedule(*this);
}

}  // namespace rimlight::server
