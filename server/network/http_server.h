#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "server/access/signing_keys.h"
#include "server/metrics/server_metrics.h"
#include "server/network/static_files.h"
#include "server/network/tls_context.h"
#include "server/session/session_registry.h"
#include "server/upload/decoded_environment.h"

namespace rimlight::server {

struct NetworkSettings {
  std::string host = "127.0.0.1";  // without keys a loopback address
  std::uint16_t port = 8080;       // 0: any free one
  int threads = 2;
  std::size_t most_connections = 128;
  std::chrono::seconds handshake_timeout{10};  // for one HTTP request, or the WebSocket's handshake
  std::chrono::seconds idle_timeout{30};       // a silent peer is pinged at half of it
  std::chrono::milliseconds drain_notice{500};      // /readyz says so, before the port is closed
  std::chrono::milliseconds finish_deadline{1500};  // for the last frames, notice included
  std::chrono::milliseconds stop_deadline{2000};    // for closing handshakes
  /// Of the tokens that clients must show; null: everyone is an owner.
  std::shared_ptr<const SigningKeys> keys{};
  std::vector<std::string> host_names{};  // besides addresses and localhost: access/host_policy.h
  std::vector<std::string> origins{};     // of pages, besides the server's own
  /// Unset: no bound of its own on loopback, where a proxy has one address for all, else 16.
  std::optional<std::size_t> most_connections_per_address{};
  double messages_per_second = 1000;  // of one client: access/edit_allowance.h
  std::shared_ptr<ServerMetrics> metrics = unread_metrics();
  DecoderSettings decoder{};   // of uploads
  TlsFiles tls{};              // empty: in the clear
  bool selftest_echo = false;  // /selftest/echo, for conformance suites; on loopback only
};

/// Throws what HttpServer would, but for an address that is taken: nothing listens. The files of
/// TLS are read.
void check_network(const NetworkSettings& settings);

/// HTTP and WebSocket on one port: the page, /healthz, /readyz, /metrics, /api/scenes, /api/curves
/// and /sessions/{name}/stream, /state and /environments. Its threads read, write and hand over,
/// and never compute.
class HttpServer {
 public:
  /// Binds and listens. Throws Error naming the address: beyond loopback without keys, or busy;
  /// or the host name or origin that is none, or the file of TLS that cannot be used.
  /// `files` and `sessions` must outlive it.
  HttpServer(const NetworkSettings& settings, const StaticFiles& files, SessionRegistry& sessions);
  ~HttpServer();
  HttpServer(const HttpServer&) = delete;
  HttpServer& operator=(const HttpServer&) = delete;

  /// "http://127.0.0.1:8080", or https, with the port that it really has.
  std::string address() const;

  /// Serves until stop(), or drains at SIGINT or SIGTERM when asked to watch them; at the second of
  /// these it ends at once. SIGHUP, when watched, reads the files of TLS again; where they are
  /// wrong the old ones stay.
  enum class Signals { watch, leave_alone };
  void run(Signals signals);
  /// Takes no new session and no edit, and says so at /readyz, while what was edited last is shown
  /// exactly to those who wait for it, until the deadline or the end of the notice, whichever is
  /// later; then stop(). Any thread; at once.
  void drain();
  /// Stops accepting, closes every socket politely (WebSocket: going away), and after the deadline
  /// hard. Any thread; at once. run() returns soon after.
  void stop();

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace rimlight::server
