#include "server/session/session_registry.h"

#include <algorithm>
#include <chrono>

#include "core/base/error.h"

namespace rimlight::server {

SessionRegistry::SessionRegistry(const SceneCatalog& scenes, RenderQueue& queue,
                                 const RegistrySettings& settings)
    : scenes_(scenes), queue_(queue), settings_(settings) {}

SessionRegistry::~SessionRegistry() { close_all(); }

std::shared_ptr<DesignSession> SessionRegistry::join(const std::string& name,
                                                     const std::string& scene,
                                                     const std::shared_ptr<Client>& client,
                                                     Clock::time_point now) {
  const ServedScene* const served = scenes_.find(scene);
  if (served == nullptr) {
    throw Error("URL", "the scene " + quote(scene), "one that /api/scenes lists");
  }
  // The client joins under the lock, so that no session is dropped between being found and used.
  const std::lock_guard lock(mutex_);
  const Key key{served->name, name};
  auto found = sessions_.find(key);
  if (found == sessions_.end()) {
    if (sessions_.size() >= settings_.most_sessions && !make_room()) return nullptr;
    auto session =
        std::make_shared<DesignSession>(name, *served, next_epoch(), settings_.session, queue_);
    found = sessions_.emplace(key, std::move(session)).first;
  }
  found->second->join(client, now);
  return found->second;
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

/// Microseconds since 1970, and always later than the last: unique over restarts too, and exact in
/// a JSON number until the year 2255.
std::int64_t SessionRegistry::next_epoch() {
  const auto since_1970 = std::chrono::system_clock::now().time_since_epoch();
  const std::int64_t now =
      std::chrono::duration_cast<std::chrono::microseconds>(since_1970).count();
  return last_epoch_ = std::max(last_epoch_ + 1, now);
}

}  // namespace rimlight::server
