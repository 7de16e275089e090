#include "server/session/session_registry.h"

#include <algorithm>
#include <chrono>

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

/// With the mutex held. Null when all places are taken.
std::shared_ptr<DesignSession> SessionRegistry::find_or_make(const std::string& name,
                                                             const ServedScene& served) {
  const Key key{served.name, name};
  auto found = sessions_.find(key);
  if (found == sessions_.end()) {
    if (queue_.overload().stage(queue_.now()) >= Overload::Stage::no_new_sessions) return nullptr;
    if (sessions_.size() >= settings_.most_sessions && !make_room()) return nullptr;
    const KeptSession kept = load(served, name);
    auto session = std::make_shared<DesignSession>(name, served, next_epoch(kept.revision.epoch),
                                                   settings_.session, queue_, kept);
    found = sessions_.emplace(key, std::move(session)).first;
  }
  return found->second;
}

std::shared_ptr<DesignSession> SessionRegistry::join(const std::string& name,
                                                     const std::string& scene,
                                                     const std::shared_ptr<Client>& client,
                                                     Clock::time_point now) {
  const ServedScene& served = find_scene(name, scene);
  // The client joins under the lock, so that no session is dropped between being found and used.
  const std::lock_guard lock(mutex_);
  const std::shared_ptr<DesignSession> session = find_or_make(name, served);
  if (session) session->join(client, now);
  return session;
}

std::shared_ptr<DesignSession> SessionRegistry::open(const std::string& name,
                                                     const std::string& scene) {
  const ServedScene& served = find_scene(name, scene);
  const std::lock_guard lock(mutex_);
  return find_or_make(name, served);
}

void SessionRegistry::add_environment(DesignSession& session, const EnvironmentPtr& environment) {
  session.environments().check_room(environment->name());
  if (uploads_ != nullptr) uploads_->add(session.scene().name, session.name(), *environment);
  session.add_environment(environment);
}

void SessionRegistry::drop_idle(Clock::time_point now) {
  const std::lock_guard lock(mutex_);
  std::erase_if(sessions_, [&](const auto& entry) {
    const auto since = entry.second->idle_since();
    return since && now - *since >= settings_.idle;
  });
}

void SessionRegistry::close_all() {
  const std::lock_guard lock(mutex_);
  for (const auto& [key, session] : sessions_) session->close();
}

std::size_t SessionRegistry::size() const {
  const std::lock_guard lock(mutex_);
  return sessions_.size();
}

/// Drops the session that has been idle longest; false when all are in use.
bool SessionRegistry::make_room() {
  auto oldest = sessions_.end();
  Clock::time_point oldest_since = Clock::time_point::max();
  for (auto entry = sessions_.begin(); entry != sessions_.end(); ++entry) {
    const auto since = entry->second->idle_since();
    if (since && *since < oldest_since) {
      oldest = entry;
      oldest_since = *since;
    }
  }
  if (oldest == sessions_.end()) return false;
  sessions_.erase(oldest);
  return true;
}

/// The session as the store has it. What stands there is checked like anything from a file.
KeptSession SessionRegistry::load(const ServedScene& scene, const std::string& name) {
  if (store_ == nullptr) return {};
  const std::optional<StoredSession> stored = store_->load(scene.name, name);
  KeptSession kept{store_};
  if (uploads_ != nullptr) kept.environments = uploads_->load(scene.name, name);
  if (!stored) return kept;
  const std::string where = "session " + quote(name);
  if (stored->revision.number < 1 || stored->revision.number > kLargestWhole ||
      stored->revision.epoch < 0 || stored->revision.epoch > kLargestWhole) {
    throw Error(where, "revision " + std::to_string(stored->revision.number), "a whole store");
  }
  const nlohmann::json document = parse_json(stored->state, where);
  const JsonReader state(document, where);
  const SessionEnvironments shown(scene.environments, kept.environments);
  (void)state.member("environment").one_of(shown.names());
  kept.revision = stored->revision;
  kept.state = read_state(state);
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
