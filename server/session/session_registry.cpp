#include "server/session/session_registry.h"

#include <algorithm>
#include <chrono>
#include <future>

#include "core/base/error.h"
#include "core/base/json_reader.h"

namespace rimlight::server {

SessionRegistry::SessionRegistry(const SceneCatalog& scenes, RenderQueue& queue,
                                 const RegistrySettings& settings, SessionStore* store,
                                 EnvironmentFolder* uploads)
    : scenes_(scenes), queue_(queue), settings_(settings), store_(store), uploads_(uploads) {}

SessionRegistry::~SessionRegistry() { close_all(); }

const ServedScene& SessionRegistry::find_scene(const std::string& name, const std::string& scene) {
  const ServedScene* const served = scenes_.find(scene);
  if (served != nullptr) return *served;
  if (store_ != nullptr && store_->load(scene, name)) {
    throw Error("session " + quote(name), "a session of the scene " + quote(scene),
                "a scene that is served still: /api/scenes lists them");
  }
  throw Error("URL", "the scene " + quote(scene), "one that /api/scenes lists");
}

/// Finds or makes the session, and hands it to `use` under the lock, so that it is not dropped
/// between being found and used. Null when all places are taken.
std::shared_ptr<DesignSession> SessionRegistry::obtain(
    const std::string& name, const ServedScene& served, Clock::time_point now,
    const std::function<void(DesignSession&)>& use) {
  const Key key{served.name, name};
  for (;;) {
    std::int64_t drops = 0;
    {
      const std::lock_guard lock(mutex_);
      if (const auto session = find(key)) {
        use(*session);
        return session;
      }
      if (queue_.overload().stage(now) >= Overload::Stage::no_new_sessions) return nullptr;
      if (sessions_.size() >= settings_.most_sessions && longest_idle() == sessions_.end()) {
        return nullptr;
      }
      drops = drops_;
    }
    const KeptSession kept = load(served, name);
    const std::lock_guard lock(mutex_);
    std::shared_ptr<DesignSession> session = find(key);
    if (!session) {
      if (drops != drops_) continue;  // it may have been opened, edited and dropped meanwhile
      if (sessions_.size() >= settings_.most_sessions && !make_room()) return nullptr;
      const std::int64_t epoch = next_epoch(kept.version ? kept.version->revision.epoch : 0);
      session =
          std::make_shared<DesignSession>(name, served, epoch, settings_.session, queue_, kept);
      if (finishing_) session->finish();
      sessions_.emplace(key, session);
    }
    use(*session);
    return session;
  }
}

std::shared_ptr<DesignSession> SessionRegistry::join(const std::string& name,
                                                     const std::string& scene,
                                                     const std::shared_ptr<Client>& client,
                                                     Clock::time_point now,
                                                     const Visitor& visitor) {
  return obtain(name, find_scene(name, scene), now,
                [&](DesignSession& session) { session.join(client, now, visitor); });
}

std::shared_ptr<DesignSession> SessionRegistry::open(const std::string& name,
                                                     const std::string& scene) {
  return obtain(name, find_scene(name, scene), queue_.now(), [](DesignSession&) {});
}

/// The session may have been dropped meanwhile, and opened again: what is open is told.
void SessionRegistry::add_environment(DesignSession& session, const EnvironmentPtr& environment) {
  session.environments().check_room(environment->name());
  if (session.is_deleted()) throw Error("session", "one that was deleted", "another");
  const std::string& scene = session.scene().name;
  if (uploads_ != nullptr) uploads_->add(scene, session.name(), *environment);
  const std::lock_guard lock(mutex_);
  ++drops_;  // who has read the folder before reads it again
  const auto opened = find({scene, session.name()});
  DesignSession& current = opened ? *opened : session;
  if (!current.environments().find_uploaded(environment->name())) {
    current.add_environment(environment);
  }
}

/// First where edits could name it, then on the disk: after a crash in between it is there again.
void SessionRegistry::remove_environment(DesignSession& session, const std::string& name) {
  const Key key{session.scene().name, session.name()};
  std::shared_ptr<DesignSession> opened;  // it may have been dropped meanwhile, and opened again
  {
    const std::lock_guard lock(mutex_);
    opened = find(key);
  }
  DesignSession& current = opened ? *opened : session;
  const EnvironmentPtr removed = current.environments().find_uploaded(name);
  current.remove_environment(name);
  if (uploads_ == nullptr) return;
  try {
    uploads_->remove(key.first, key.second, name);
  } catch (const Error&) {
    current.add_environment(removed);
    throw;
  }
  const std::lock_guard lock(mutex_);
  ++drops_;  // who has read the folder before reads it again
}

void SessionRegistry::remove(DesignSession& session, const Author& by) {
  const Key key{session.scene().name, session.name()};
  try {
    if (store_ != nullptr) erase_stored(key);
  } catch (const Error&) {
    session.cancel_deletion();
    throw;
  }
  {
    const std::lock_guard lock(mutex_);
    if (find(key).get() == &session) sessions_.erase(key);
    ++drops_;
  }
  session.end(by);
  session.close();
  if (uploads_ != nullptr) uploads_->remove_all(key.first, key.second);
}

void SessionRegistry::erase_stored(const Key& key) {
  constexpr std::chrono::seconds kPatience{10};
  const auto answered = std::make_shared<std::promise<std::optional<StoreError>>>();
  auto answer = answered->get_future();
  store_->remove(key.first, key.second, [answered](const std::optional<StoreError>& refusal) {
    answered->set_value(refusal);
  });
  if (answer.wait_for(kPatience) != std::future_status::ready) {
    throw StoreError("session " + quote(key.second), "a store that does not answer", "a disk");
  }
  if (const std::optional<StoreError> refusal = answer.get()) throw StoreError(*refusal);
}

std::shared_ptr<DesignSession> SessionRegistry::join_open(const std::string& name,
                                                          const std::string& scene,
                                                          const std::shared_ptr<Client>& client,
                                                          Clock::time_point now,
                                                          const Visitor& visitor) {
  const ServedScene* const served = scenes_.find(scene);
  if (served == nullptr) return nullptr;
  const std::lock_guard lock(mutex_);
  auto session = find({served->name, name});
  if (session) session->join(client, now, visitor);
  return session;
}

std::optional<std::string> SessionRegistry::export_state(const std::string& name,
                                                         const std::string& scene) {
  const ServedScene* const served = scenes_.find(scene);
  if (served == nullptr) return std::nullopt;
  {
    const std::lock_guard lock(mutex_);
    if (const auto session = find({served->name, name})) return session->export_state();
  }
  const KeptSession kept = load(*served, name);
  if (!kept.version) return std::nullopt;
  return write_export(served->name, name, kept.version->revision, kept.version->state);
}

void SessionRegistry::drop_idle(Clock::time_point now) {
  const std::lock_guard lock(mutex_);
  drops_ += static_cast<std::int64_t>(std::erase_if(sessions_, [&](const auto& entry) {
    const auto since = entry.second->idle_since();
    return since && now - *since >= settings_.idle;
  }));
  for (const auto& [key, session] : sessions_) session->rest(now, settings_.rest);
}

void SessionRegistry::finish() {
  const std::lock_guard lock(mutex_);
  finishing_ = true;
  for (const auto& [key, session] : sessions_) session->finish();
}

bool SessionRegistry::finished() const {
  const std::lock_guard lock(mutex_);
  return std::all_of(sessions_.begin(), sessions_.end(),
                     [](const auto& entry) { return entry.second->settled(); });
}

void SessionRegistry::close_all() {
  const std::lock_guard lock(mutex_);
  for (const auto& [key, session] : sessions_) session->close();
}

std::size_t SessionRegistry::size() const {
  const std::lock_guard lock(mutex_);
  return sessions_.size();
}

std::optional<std::string> SessionRegistry::store_trouble() const {
  return store_ == nullptr ? std::nullopt : store_->trouble();
}

/// Null when it is not open.
std::shared_ptr<DesignSession> SessionRegistry::find(const Key& key) const {
  const auto found = sessions_.find(key);
  return found == sessions_.end() ? nullptr : found->second;
}

/// The end when all are in use.
auto SessionRegistry::longest_idle() -> std::map<Key, std::shared_ptr<DesignSession>>::iterator {
  auto oldest = sessions_.end();
  Clock::time_point oldest_since = Clock::time_point::max();
  for (auto entry = sessions_.begin(); entry != sessions_.end(); ++entry) {
    const auto since = entry->second->idle_since();
    if (since && *since < oldest_since) {
      oldest = entry;
      oldest_since = *since;
    }
  }
  return oldest;
}

/// Drops the session that has been idle longest; false when all are in use.
bool SessionRegistry::make_room() {
  const auto oldest = longest_idle();
  if (oldest == sessions_.end()) return false;
  sessions_.erase(oldest);
  ++drops_;
  return true;
}

/// The session as the store has it. What stands there is checked like anything from a file.
KeptSession SessionRegistry::load(const ServedScene& scene, const std::string& name) {
  if (store_ == nullptr) return {};
  const std::optional<StoredSession> stored = store_->load(scene.name, name);
  KeptSession kept{store_};
  if (uploads_ != nullptr) kept.environments = uploads_->load(scene.name, name);
  if (!stored) return kept;
  const SessionEnvironments shown(scene.environments, kept.environments);
  kept.version = read_version(*stored, shown.names(), "session " + quote(name));
  return kept;
}

/// Microseconds since 1970, and always later than the last and than the stored one: unique over
/// restarts too, and exact in a JSON number until the year 2255. A new one for each life of a
/// session: a store that was copied back may lack revisions that were seen.
std::int64_t SessionRegistry::next_epoch(std::int64_t stored) {
  const auto since_1970 = std::chrono::system_clock::now().time_since_epoch();
  const std::int64_t now =
      std::chrono::duration_cast<std::chrono::microseconds>(since_1970).count();
  return last_epoch_ = std::max({last_epoch_ + 1, stored + 1, now});
}

}  // namespace rimlight::server
