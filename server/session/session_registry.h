#pragma once

#include <cstddef>
#include <map>
#include <memory>
#include <mutex>
#include <string>

#include "server/session/design_session.h"

namespace rimlight::server {

struct RegistrySettings {
  SessionSettings session;
  std::size_t most_sessions = 64;
  std::chrono::seconds idle{600};  // a session that nobody has open is kept so long
};

/// The design sessions by name: created on first use, shared by all who open the same name and
/// scene, in memory. Any thread.
class SessionRegistry {
 public:
  /// `scenes` and `queue` must outlive it.
  SessionRegistry(const SceneCatalog& scenes, RenderQueue& queue, const RegistrySettings& settings);
  ~SessionRegistry();

  const SceneCatalog& scenes() const { return scenes_; }

  /// Finds or creates the session and lets the client join it. Null when all places are taken by
  /// sessions in use: the one refusal that a client may retry. Throws Error for an unknown scene.
  [[nodiscard]] std::shared_ptr<DesignSession> join(const std::string& name,
                                                    const std::string& scene,
                                                    const std::shared_ptr<Client>& client,
                                                    Clock::time_point now);
  /// Forgets sessions that have been idle for too long.
  void drop_idle(Clock::time_point now);
  /// Ends all work; sessions stay readable until they are dropped.
  void close_all();
  std::size_t size() const;

 private:
  using Key = std::pair<std::string, std::string>;  // scene, session

  bool make_room();
  std::int64_t next_epoch();

  const SceneCatalog& scenes_;
  RenderQueue& queue_;
  const RegistrySettings settings_;
  mutable std::mutex mutex_;
  std::map<Key, std::shared_ptr<DesignSession>> sessions_;
  std::int64_t last_epoch_ = 0;
};

}  // namespace rimlight::server
