#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "tests/server/loopback_server.h"

namespace rimlight::server::test {

/// Opcodes of RFC 6455, 5.2.
enum class Opcode : std::uint8_t { continuation = 0, text, binary, close = 8, ping, pong };

/// One frame as it is on the wire, whether a peer may send it or not.
struct WireFrame {
  Opcode opcode = Opcode::text;
  std::string payload;
  bool final = true;
  unsigned reserved = 0;  // the three bits RSV1 to RSV3, as a number
  bool masked = true;

  friend bool operator==(const WireFrame&, const WireFrame&) = default;
};

/// A frame's bytes with the shortest length field; the mask is fixed.
std::string bytes_of(const WireFrame& frame);
/// The payload of a close frame: big-endian code, then the reason.
std::string close_payload(unsigned code, std::string_view reason = "");

/// A WebSocket by hand, after its handshake: what it sends may break every rule.
class RawWebSocket {
 public:
  explicit RawWebSocket(std::uint16_t port, const std::string& target = "/selftest/echo");

  /// In pieces of that many bytes, each its own write; 0: at once.
  void send(const std::string& bytes, std::size_t piece = 0);
  void send(const WireFrame& frame) { send(bytes_of(frame)); }
  /// The next frame; nothing when the peer has closed the socket, or after five seconds.
  std::optional<WireFrame> receive();
  /// Reads to the end of the socket: the code of the first close frame, 1005 for one without a
  /// code, 0 when none came. Frames before it go to `before`, when that is there.
  unsigned close_code(std::string* before = nullptr);

 private:
  bool fill(std::size_t size);

  RawSocket socket_;
  std::string received_;
  std::size_t read_ = 0;  // of received_
};

}  // namespace rimlight::server::test
