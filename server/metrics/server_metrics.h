#pragma once

#include <chrono>
#include <cstddef>
#include <memory>
#include <string>

#include "server/metrics/outcomes.h"
#include "server/protocol/frame_message.h"

namespace rimlight::server {

/// What a server counts of itself, for /metrics (docs/protocol/metrics.md has each name). Any
/// thread: all metrics are there from the start, so that counting looks nothing up and allocates
/// nothing. A counter is an atomic; a histogram has a lock of its own, which only the one thread
/// that makes frames, or that writes the store, shares with who reads /metrics. No label holds
/// anything that a client chose.
class ServerMetrics {
 public:
  ServerMetrics();
  ~ServerMetrics();
  ServerMetrics(const ServerMetrics&) = delete;
  ServerMetrics& operator=(const ServerMetrics&) = delete;

  using Duration = std::chrono::steady_clock::duration;

  /// A picture was drawn: its times are those of its header.
  void frame_drawn(const FrameHeader& header);
  /// It was encoded once, as the header says.
  void frame_made(const FrameHeader& header);
  /// An edit's way to the first frame that shows it: for a frame in motion that of the oldest edit
  /// that no frame showed before, for an exact frame that of the newest.
  enum class FrameKind { moving, exact };
  void edit_shown(FrameKind kind, Duration since_edit);
  void frame_failed();

  void session_opened();
  void session_closed();
  void edit_applied();
  /// By the store: those that were refused before are refusals of messages.
  void edit_refused();

  void socket_opened();
  void socket_closed();
  void connection_opened();
  void connection_closed(CloseReason reason);
  void refused(RefusalReason reason);
  enum class Content { frame, text };
  void sent(Content content, std::size_t bytes);
  void received(std::size_t bytes);

  void edits_waiting(std::size_t edits, std::size_t bytes);
  /// A commit took so long, and the oldest of its edits came `oldest` ago.
  void committed(Duration commit, Duration oldest);
  void commit_failed();

  /// What holds for the server's whole life; limits that a gauge is compared with.
  struct Limits {
    std::size_t scenes = 0;
    std::size_t most_sockets = 0;
    std::size_t most_sessions = 0;
    /// Of a frame in motion, in one of: columns, bytes, seconds; the others are 0.
    double budget_columns = 0;
    double budget_bytes = 0;
    double budget_seconds = 0;
  };
  void serve(const Limits& limits);
  void stopping();
  /// What Overload says now.
  void overload(int stage, double budget_share, double lateness_ms);

  /// The body of /metrics: the text format, version 0.0.4. Reads what the process uses now.
  std::string to_text() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

/// Counts for nobody: where no metrics are given.
const std::shared_ptr<ServerMetrics>& unread_metrics();

}  // namespace rimlight::server
