#pragma once

#include <chrono>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

namespace rimlight {

/// Where a server listens: "ws://127.0.0.1:8080", or wss for TLS.
struct StreamUrl {
  std::string host;
  std::string port;
  bool secure = false;
};
/// Throws Error: another scheme, no host, a path, or a port that is no number.
StreamUrl parse_stream_url(const std::string& url);

/// How a client is let in, and lets the server be who it is.
struct StreamPass {
  std::string token;                // shown as a bearer's; empty: none
  std::filesystem::path authority;  // of the server's certificate, in PEM; empty: this machine's
};

/// A client's end of one session's WebSocket. Calls block, each with a deadline. One thread.
class StreamClient {
 public:
  using Clock = std::chrono::steady_clock;

  /// Connects and upgrades. `target` is "/sessions/NAME/stream?scene=NAME". Throws Error naming the
  /// address: nobody listens, or the server refuses (with its HTTP status and reason).
  StreamClient(const StreamUrl& url, const std::string& target, const StreamPass& pass = {},
               std::chrono::milliseconds timeout = std::chrono::seconds(10));
  ~StreamClient();
  StreamClient(const StreamClient&) = delete;
  StreamClient& operator=(const StreamClient&) = delete;

  struct Text {
    std::string text;
  };
  struct Binary {
    std::vector<std::uint8_t> bytes;
  };
  struct Nothing {};  // nothing came until the deadline
  struct Closed {     // by the server, or broken
    int code = 0;     // of the WebSocket's close frame; 0 without one
    std::string reason;
  };
  using Received = std::variant<Text, Binary, Nothing, Closed>;

  /// The next message. Reads from the socket only while it is called: a client that does not call
  /// is a slow reader.
  Received receive(Clock::time_point deadline);
  /// False when the connection is closed or takes nothing for ten seconds.
  [[nodiscard]] bool send_text(std::string_view text);
  [[nodiscard]] bool send_binary(std::string_view bytes);
  /// The closing handshake.
  void close();

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace rimlight
