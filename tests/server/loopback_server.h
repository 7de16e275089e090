#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <thread>

#include "cli/load_stream.h"
#include "server/network/http_server.h"
#include "server/store/session_store.h"
#include "tests/server/sphere_source.h"
#include "tests/support/temporary_folder.h"

namespace rimlight::server::test {

/// A whole server on a free port of 127.0.0.1, with its network and compute threads, serving scenes
/// "sphere" and "curves" of closed-form sources. Stops when it goes out of scope.
class LoopbackServer {
 public:
  struct Settings {
    int width = 64;
    int height = 48;
    NetworkSettings network{.port = 0};
    RegistrySettings sessions = {};
    Overload::Settings overload = {};
    std::filesystem::path store = {};    // of sessions; without one they live in memory
    std::string store_vfs = {};          // SqliteStoreSettings::vfs
    std::filesystem::path uploads = {};  // of environments; without it they live in memory
  };
  explicit LoopbackServer(const Settings& settings);
  LoopbackServer() : LoopbackServer(Settings{}) {}
  ~LoopbackServer();

  SphereProbe& probe() { return *probe_; }
  std::uint16_t port() const;
  std::unique_ptr<StreamClient> open(const std::string& session) const;
  /// Asks it to stop, and waits until its network threads have ended; returns how long that took.
  std::chrono::milliseconds stop();

 private:
  rimlight::test::TemporaryFolder web_;
  std::shared_ptr<SphereProbe> probe_ = std::make_shared<SphereProbe>();
  SceneCatalog scenes_;
  StaticFiles files_;
  RenderQueue queue_;
  std::unique_ptr<SessionStore> store_;
  std::unique_ptr<EnvironmentFolder> uploads_;
  SessionRegistry sessions_;
  HttpServer http_;
  std::jthread compute_;
  std::jthread network_;
};

/// A plain TCP connection to 127.0.0.1, for what no well-behaved client sends. Blocking, with a
/// timeout of thirty seconds.
class RawSocket {
 public:
  explicit RawSocket(std::uint16_t port);
  RawSocket(const RawSocket&) = delete;
  RawSocket& operator=(const RawSocket&) = delete;
  ~RawSocket();

  void send(const std::string& bytes);
  /// Everything until the peer closes, or the timeout.
  std::string read_all();
  /// At least one byte; empty when the peer has closed or at the timeout.
  std::string read_some();
  /// Closes with a reset instead of a goodbye.
  void reset();

 private:
  int socket_ = -1;
};

/// One HTTP/1.1 request with Connection: close; the whole response.
std::string http(std::uint16_t port, const std::string& method, const std::string& target,
                 const std::string& more_headers = "");

}  // namespace rimlight::server::test
