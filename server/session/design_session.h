#pragma once

#include <atomic>
#include <cstdint>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "server/metrics/edit_ages.h"
#include "server/protocol/messages.h"
#include "server/schedule/render_queue.h"
#include "server/session/client.h"
#include "server/session/frame_maker.h"
#include "server/session/scene_catalog.h"
#include "server/session/session_environments.h"
#include "server/session/session_users.h"
#include "server/session/session_version.h"
#include "server/session/viewers.h"
#include "server/session/waiting_edits.h"

namespace rimlight::server {

struct SessionSettings {
  std::chrono::milliseconds quiet{50};  // without an edit, before the exact frame
  int jpeg_quality = 80;
  std::shared_ptr<ServerMetrics> metrics = unread_metrics();
};

/// Where edits of a session are kept, and what is there already.
struct KeptSession {
  SessionStore* store = nullptr;  // must outlive the session; without one it lives in memory
  std::optional<SessionVersion> version = {};     // none: the store has none
  std::vector<EnvironmentPtr> environments = {};  // that were uploaded to it
};

/// Shared state that clients edit, and the frames that show it. Edits apply in order, each a new
/// revision; with a store each applies when it is durable, and not before. Frames: while edits
/// come, the approximate image as each client takes it (Viewers), as soon as one can, so that a
/// burst of edits costs one frame and frames are dropped before they are made; after `quiet` the
/// exact image, once, as PNG; then nothing, and nothing at all while nobody looks. When no frame is
/// due, what the source has left unfinished goes on in slices of 20 ms, behind all other
/// sessions. Any thread, but work() is the compute thread's.
class DesignSession final : public RenderJob, public std::enable_shared_from_this<DesignSession> {
 public:
  /// `scene` and `queue` must outlive it. Goes on from what is kept of it, in a new epoch.
  DesignSession(std::string name, const ServedScene& scene, std::int64_t epoch,
                const SessionSettings& settings, RenderQueue& queue, const KeptSession& kept = {});
  ~DesignSession() override;

  const std::string& name() const { return name_; }
  const ServedScene& scene() const { return scene_; }
  /// What edits may name.
  const KnownMaterials& materials() const { return materials_; }
  const SessionEnvironments& environments() const { return environments_; }

  /// Sends the welcome and, when there is one, the current exact frame; tells the others.
  void join(const std::shared_ptr<Client>& client, Clock::time_point now,
            const Visitor& visitor = {});
  void leave(const Client& client, Clock::time_point now);
  /// Makes the next revision, sends the ack to `client` and the state to the others: at once, or
  /// with a store when it is durable; if it is refused, the client gets the error. Throws Error,
  /// and changes nothing, where next_version() and SessionStore::append() do.
  void apply(const Client& client, const Command& command, Clock::time_point now);
  /// Edits may name it from now on; all clients are told. Throws Error as SessionEnvironments does.
  void add_environment(const EnvironmentPtr& environment);
  /// An uploaded one is no more; all clients are told. Throws Error where it is in use
  /// (SessionVersion::use_of()), or not there.
  void remove_environment(const std::string& name);
  /// No more edits: the session is about to be deleted. The author of the client that asks. Throws
  /// Error when it is being deleted already.
  Author begin_deletion(const Client& client);
  /// It was not deleted after all.
  void cancel_deletion();
  /// It was: all clients are told by whom, and leave.
  void end(const Author& by);
  bool is_deleted() const { return deleted_.load(); }
  [[nodiscard]] AckResult acknowledge(const Client& client, std::int64_t frame,
                                      Clock::time_point now);
  /// What the client can show, from now on.
  void set_display(const Client& client, const Display& display, Clock::time_point now);

  /// The state as a file has it: write_export().
  std::string export_state() const;
  /// Since when nobody has it open; nothing when somebody has, or an edit is not durable yet.
  std::optional<Clock::time_point> idle_since() const;
  /// From now on clients' edits are not to be handed over: the last state is shown, and that is
  /// all.
  void finish() { finishing_.store(true); }
  bool finishing() const { return finishing_.load(std::memory_order_relaxed); }
  /// Whether every edit is answered, and all who watch have acknowledged the exact frame.
  bool settled() const;
  /// Where nobody has had it open for so long, what it draws with is given back until somebody has.
  void rest(Clock::time_point now, std::chrono::milliseconds after);
  /// No more work: a render that runs is abandoned where it can be.
  void close();

  void work(Clock::time_point now) noexcept override;

 private:
  enum class Work { none, moving, again, improve, exact, rest };
  struct Task {
    Work kind = Work::none;
    FrameTask frame;
  };
  static constexpr std::int64_t kNone = -1;

  // All of these are called with the mutex held.
  void enter(const std::shared_ptr<Client>& client, Clock::time_point now, const Visitor& visitor);
  void reschedule(Clock::time_point now);
  void show(WaitingEdit edit, Clock::time_point arrived, Clock::time_point now);
  Welcome welcome_for(const SessionUsers::Entered& entered, const Visitor& visitor) const;
  void tell_presence(const Client* except);
  void check_not_deleting() const;
  Task begin_task(Clock::time_point now);

  /// What the store says of the oldest edit that waits.
  void settle(const std::optional<StoreError>& refusal, Clock::time_point arrived);

  // Called on the compute thread, without the mutex.
  void improve(const FrameTask& task);
  void make_frame(const FrameTask& task);
  void encode_again();
  void encode(const std::vector<EncodeOrder>& orders);
  void fail(const FrameTask& task, const std::string& reason);

  const std::string name_;
  const ServedScene& scene_;
  const KnownMaterials materials_;
  SessionEnvironments environments_;
  const SessionSettings settings_;
  RenderQueue& queue_;

  mutable std::mutex mutex_;
  SessionVersion version_;
  SessionUsers users_;
  std::string presence_;  // as it was told last
  Clock::time_point last_edit_;
  std::int64_t moving_revision_ = 0;     // newest revision that a frame shows, or need not
  std::int64_t exact_revision_ = kNone;  // newest revision that an exact frame shows
  // Since when each kind of frame is wanted and could be made: the place in the fair queue.
  std::optional<Clock::time_point> moving_since_;
  std::optional<Clock::time_point> exact_since_;
  EditAges ages_;
  bool wants_again_ = false;  // the newest picture, for clients whose turn is now
  Unfinished unfinished_ = Unfinished::nothing;  // of what the source showed last
  Viewers viewers_;
  std::optional<WaitingEdits> waiting_;  // with a store
  std::optional<Clock::time_point> idle_since_;
  enum class Rest { none, wanted, taken };
  Rest rest_ = Rest::none;
  bool deleting_ = false;

  std::atomic<std::int64_t> newest_revision_{
      0};  // version_.revision.number, to be asked between tiles
  std::atomic<bool> closed_{false};
  std::atomic<bool> deleted_{false};
  std::atomic<bool> finishing_{false};

  FrameMaker maker_;  // the compute thread's own
};

}  // namespace rimlight::server
