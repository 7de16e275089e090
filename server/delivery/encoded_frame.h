#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>

#include "server/delivery/shared_stream.h"
#include "server/protocol/frame_message.h"

namespace rimlight::server {

/// A picture that was drawn, before it is encoded.
struct DrawnPicture {
  std::int64_t frame = 0;  // its number
  Revision revision;
  bool is_exact = false;
};

/// How a picture is to be encoded, once for all who want it so. An exact picture on a rung is a
/// preview: what a client on a narrow link sees of it first, and no exact frame.
struct EncodeOrder {
  std::optional<std::size_t> rung;    // of kRungs; none: losslessly
  std::optional<StreamFrame> stream;  // of VP8's rungs
};

/// An encoded picture. Immutable, shared by all who are sent it.
struct EncodedFrame {
  EncodeOrder order;
  FrameHeader header;  // all but what it says to one client alone
  bool is_preview = false;
  Payload payload;
  std::chrono::steady_clock::time_point made;
};
using EncodedPtr = std::shared_ptr<const EncodedFrame>;

}  // namespace rimlight::server
