#pragma once

#include <string>
#include <utility>

#include "server/protocol/frame_message.h"

namespace rimlight::server {

/// The way back to one client, as a session sees it. Any thread; no call waits, blocks or computes:
/// each only hands over what its socket's own strand will write.
class Client {
 public:
  virtual ~Client() = default;

  /// A reply that must arrive, in order. The implementation bounds how many may wait, and closes a
  /// client that does not read them.
  virtual void send_text(std::string text) = 0;
  /// The answer to one of its edits, ack or error, which may come later than other replies.
  virtual void send_answer(std::string text) { send_text(std::move(text)); }
  /// The newest state that another client set: replaces one that still waits.
  virtual void send_state(std::string text) = 0;
  /// Who is there, and the list of snapshots: each replaces one of its own that still waits.
  virtual void send_presence(std::string text) { send_text(std::move(text)); }
  /// Its session is no more: the last that it is told, and then its connection ends.
  virtual void send_off(std::string text) { send_text(std::move(text)); }
  virtual void send_snapshots(std::string text) { send_text(std::move(text)); }
  /// At most one frame is on its way: the session sends the next after the client's frame_ack.
  virtual void send_frame(FramePtr frame) = 0;
};

}  // namespace rimlight::server
