#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>

#include "server/network/static_files.h"
#include "server/session/session_registry.h"

namespace rimlight::server {

struct NetworkSettings {
  std::string host = "127.0.0.1";  // a loopback address: there are no access tokens
  std::uint16_t port = 8080;       // 0: any free one
  int threads = 2;
  std::size_t most_connections = 128;
  std::chrono::seconds handshake_timeout{10};  // for one HTTP request, or the WebSocket's handshake
  std::chrono::seconds idle_timeout{30};       // a silent peer is pinged at half of it
  std::chrono::milliseconds stop_deadline{2000};  // for closing handshakes
};

/// HTTP and WebSocket on one port: the page, /healthz, /readyz, /api/scenes, /api/curves and
/// /sessions/{name}/stream. Its threads read, write and hand over, and never compute.
class HttpServer {
 public:
  /// Binds and listens. Throws Error naming the address: not a loopback address, or busy.
  /// `files` and `sessions` must outlive it.
  HttpServer(const NetworkSettings& settings, const StaticFiles& files, SessionRegistry& sessions);
  ~HttpServer();
  HttpServer(const HttpServer&) = delete;
  HttpServer& operator=(const HttpServer&) = delete;

  /// "http://127.0.0.1:8080", with the port that it really has.
  std::string address() const;

  /// Serves until stop(), or SIGINT or SIGTERM when asked to watch them. Stops accepting, closes
  /// every socket politely (WebSocket: going away), and after the deadline hard.
  enum class Signals { watch, leave_alone };
  void run(Signals signals);
  /// Any thread; at once. run() returns soon after.
  void stop();

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace rimlight::server
