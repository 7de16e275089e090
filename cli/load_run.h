#pragma once

#include <string>
#include <vector>

#include "cli/load_client.h"

namespace rimlight {

/// Clients that play one script against one server.
struct LoadRun {
  StreamUrl url;
  StreamPass pass = {};
  std::string scene = {};  // empty: the server's default
  LoadScript script = {};
  double seconds = 5;
  int clients = 1;
  /// All in one session, in which they take turns, so that it sees the script once; else each in
  /// its own.
  bool shared_session = false;
  LoadCodec codec = LoadCodec::jpeg;
  double slow_kBps = 0;  // the last client only watches, and takes so much; 0: none does
};

/// Plays it, in sessions of new names: one that was edited before would start elsewhere. A record a
/// client. Throws Error when the server cannot be reached.
std::vector<LoadRecord> play_run(const LoadRun& run);

}  // namespace rimlight
