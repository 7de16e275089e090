#pragma once

#include <chrono>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "cli/load_frames.h"
#include "cli/load_script.h"
#include "cli/load_stream.h"
#include "core/relight/design_state.h"
#include "server/protocol/frame_message.h"

namespace rimlight {

/// What one scripted client saw.
struct LoadRecord {
  std::int64_t frames = 0;           // in motion, with a new revision and other pixels
  std::int64_t unchanged = 0;        // in motion, but the same pixels or revision again
  std::int64_t skipped = 0;          // frames of the session that this client did not get
  std::int64_t bytes = 0;            // of the counted frames
  std::vector<double> latencies_ms;  // of each edit, to the first frame that shows it or a later
  std::int64_t edits_sent = 0;
  std::int64_t edits_acknowledged = 0;
  double motion_seconds = 0;          // from the first edit to the end of the script
  std::vector<std::string> failures;  // what was against the protocol, in words
  bool revisions_ascend = true;
  bool is_slow = false;       // its link was made narrow
  RungCounts rungs;           // of frames in motion
  double exact_after_ms = 0;  // the last exact frame, after the last edit was sent

  std::optional<server::FrameHeader> last_header;
  std::vector<std::uint8_t> last_payload;
  std::string scene;
  server::Revision state_revision;  // the newest that the server told of,
  DesignState state;                // and the state it has
};

struct LoadClientSettings {
  StreamUrl url;
  StreamPass pass = {};
  std::string session;
  std::string scene;                            // empty: the default
  std::chrono::steady_clock::time_point start;  // of the script
  double seconds = 5;
  double settle_seconds = 10;  // at most, to wait for the exact frame at the end
  LoadCodec codec = LoadCodec::jpeg;
  double slow_kBps = 0;  // it takes messages no faster than that; 0: as fast as they come
};

/// Plays the script's edits against a server and records what comes back. Returns when the last,
/// exact frame has come, or the time to settle is over. Throws Error when the server cannot be
/// reached. One thread.
LoadRecord play(const LoadClientSettings& settings, const LoadScript& script);

}  // namespace rimlight
