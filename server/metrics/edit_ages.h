#pragma once

#include <algorithm>
#include <chrono>
#include <optional>
#include <utility>

#include "server/metrics/server_metrics.h"

namespace rimlight::server {

/// How long edits wait for frames that show them: of those in motion the oldest edit counts that no
/// frame showed before, of exact frames the newest. One thread at a time.
class EditAges {
 public:
  using Time = std::chrono::steady_clock::time_point;

  void edited(Time arrived) {
    oldest_ = std::min(oldest_.value_or(arrived), arrived);
    newest_ = arrived;
  }
  /// Nobody waits for a frame any more.
  void forget() { *this = {}; }
  /// The edit that counts for a frame of the present state, whose work begins now.
  std::optional<Time> begin(ServerMetrics::FrameKind kind) {
    if (kind == ServerMetrics::FrameKind::exact) return newest_;
    return std::exchange(oldest_, std::nullopt);
  }
  /// An exact frame of the present state is there.
  void settled() { forget(); }

 private:
  std::optional<Time> oldest_;  // that no frame shows
  std::optional<Time> newest_;  // that no exact frame shows
};

}  // namespace rimlight::server
