#pragma once

#include <cstddef>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <string>

#include "server/session/design_session.h"
#include "server/store/environment_folder.h"

namespace rimlight::server {

struct RegistrySettings {
  SessionSettings session;
  std::size_t most_sessions = 64;
  std::chrono::seconds idle{600};  // a session that nobody has open is kept so long,
  std::chrono::seconds rest{30};   // and what it draws with so long
};

/// The design sessions by name: created on first use, shared by all who open the same name and
/// scene. Without a store they live in memory; with one they go on from what it has, and are only
/// forgotten here. Any thread.
class SessionRegistry {
 public:
  /// `scenes`, `queue`, `store` and `uploads` (of environments; null: kept in memory) must outlive
  /// it.
  SessionRegistry(const SceneCatalog& scenes, RenderQueue& queue, const RegistrySettings& settings,
                  SessionStore* store = nullptr, EnvironmentFolder* uploads = nullptr);
  ~SessionRegistry();

  const SceneCatalog& scenes() const { return scenes_; }

  /// Finds or creates the session and lets the client join it. Null when all places are taken by
  /// sessions in use: a refusal that a client may retry. Throws StoreError when the store cannot
  /// be read, which it may retry too, and Error for an unknown scene, or a session that the scene
  /// cannot show any more.
  /// Reads the store, where the session is not open, without holding up others that are.
  [[nodiscard]] std::shared_ptr<DesignSession> join(const std::string& name,
                                                    const std::string& scene,
                                                    const std::shared_ptr<Client>& client,
                                                    Clock::time_point now,
                                                    const Visitor& visitor = {});
  /// The same for a session that is open; null, and nothing is done, when it is not. Never reads
  /// the store.
  [[nodiscard]] std::shared_ptr<DesignSession> join_open(const std::string& name,
                                                         const std::string& scene,
                                                         const std::shared_ptr<Client>& client,
                                                         Clock::time_point now,
                                                         const Visitor& visitor = {});
  /// The session's state, as write_export() has it, from the store when it is not open; nothing
  /// when there is no such session. Throws as join() does.
  std::optional<std::string> export_state(const std::string& name, const std::string& scene);
  /// Finds or creates it as join() does, for what needs no client.
  [[nodiscard]] std::shared_ptr<DesignSession> open(const std::string& name,
                                                    const std::string& scene);
  /// Keeps an uploaded environment, and shows it from now on. Throws Error as
  /// EnvironmentFolder::add() and DesignSession::add_environment() do. Writes to the disk.
  void add_environment(DesignSession& session, const EnvironmentPtr& environment);
  /// An uploaded one is no more. Throws Error where it is in use or not there, and where the disk
  /// refuses. Writes to the disk.
  void remove_environment(DesignSession& session, const std::string& name);
  /// Deletes a session that began_deletion(), with its uploads, in the store too; its clients are
  /// told by whom, and leave. Throws StoreError, and it stays, when the store refuses. Waits for
  /// the disk.
  void remove(DesignSession& session, const Author& by);
  /// Forgets sessions that have been idle for too long; others rest.
  void drop_idle(Clock::time_point now);
  /// Sessions take no more edits, later ones too: DesignSession::finish().
  void finish();
  /// Whether all are settled.
  bool finished() const;
  /// Ends all work; sessions stay readable until they are dropped.
  void close_all();
  std::size_t size() const;
  const Overload& overload() const { return queue_.overload(); }
  /// Why edits are not likely to be kept now: SessionStore::trouble().
  std::optional<std::string> store_trouble() const;

 private:
  using Key = std::pair<std::string, std::string>;  // scene, session

  std::shared_ptr<DesignSession> find(const Key& key) const;
  std::map<Key, std::shared_ptr<DesignSession>>::iterator longest_idle();
  const ServedScene& find_scene(const std::string& name, const std::string& scene);
  std::shared_ptr<DesignSession> obtain(const std::string& name, const ServedScene& served,
                                        Clock::time_point now,
                                        const std::function<void(DesignSession&)>& use);
  bool make_room();
  void erase_stored(const Key& key);
  KeptSession load(const ServedScene& scene, const std::string& name);
  std::int64_t next_epoch(std::int64_t stored);

  const SceneCatalog& scenes_;
  RenderQueue& queue_;
  const RegistrySettings settings_;
  SessionStore* const store_;
  EnvironmentFolder* const uploads_;
  mutable std::mutex mutex_;
  std::map<Key, std::shared_ptr<DesignSession>> sessions_;
  std::int64_t last_epoch_ = 0;
  bool finishing_ = false;
  std::int64_t drops_ = 0;  // of sessions: what was read of the store before may be old
};

}  // namespace rimlight::server
