#include "tests/server/loopback_server.h"

#include <arpa/inet.h>
#include <gtest/gtest.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <sys/time.h>
#include <unistd.h>

#include <fstream>

#include "server/store/sqlite_store.h"
#include "tests/server/curve_sphere.h"

namespace rimlight::server::test {
namespace {

const std::filesystem::path& with_page(const std::filesystem::path& folder) {
  std::ofstream(folder / "index.html") << "<!doctype html><p>page";
  return folder;
}

std::unique_ptr<SessionStore> store_of(const LoopbackServer::Settings& settings) {
  if (settings.store.empty()) return nullptr;
  return std::make_unique<SqliteStore>(SqliteStoreSettings{
      .file = settings.store, .vfs = settings.store_vfs, .metrics = settings.network.metrics});
}

}  // namespace

LoopbackServer::LoopbackServer(const Settings& settings)
    : scenes_({sphere_scene("sphere", settings.width, settings.height, probe_),
               curve_sphere_scene("curves", 16)}),
      files_(with_page(web_.path())),
      queue_(Clock::now, settings.overload),
      store_(store_of(settings)),
      uploads_(settings.uploads.empty()
                   ? nullptr
                   : std::make_unique<EnvironmentFolder>(settings.uploads, 64 << 20)),
      sessions_(scenes_, queue_, settings.sessions, store_.get(), uploads_.get()),
      http_(settings.network, files_, sessions_),
      compute_([this](const std::stop_token& stop) { queue_.run(stop); }),
      network_([this] { http_.run(HttpServer::Signals::leave_alone); }) {}

LoopbackServer::~LoopbackServer() { stop(); }

std::chrono::milliseconds LoopbackServer::stop() {
  const auto start = std::chrono::steady_clock::now();
  if (network_.joinable()) {
    http_.stop();
    network_.join();
  }
  sessions_.close_all();
  return std::chrono::duration_cast<std::chrono::milliseconds>(std::chrono::steady_clock::now() -
                                                               start);
}

std::uint16_t LoopbackServer::port() const {
  const std::string address = http_.address();
  return static_cast<std::uint16_t>(std::stoi(address.substr(address.rfind(':') + 1)));
}

std::unique_ptr<StreamClient> LoopbackServer::open(const std::string& session) const {
  return std::make_unique<StreamClient>(StreamUrl{"127.0.0.1", std::to_string(port())},
                                        "/sessions/" + session + "/stream");
}

RawSocket::RawSocket(std::uint16_t port) : socket_(::socket(AF_INET, SOCK_STREAM, 0)) {
  const timeval timeout{30, 0};
  ::setsockopt(socket_, SOL_SOCKET, SO_RCVTIMEO, &timeout, sizeof timeout);
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_port = htons(port);
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  if (::connect(socket_, reinterpret_cast<const sockaddr*>(&address), sizeof address) != 0) {
    throw std::runtime_error("connect failed");
  }
}

RawSocket::~RawSocket() {
  if (socket_ >= 0) ::close(socket_);
}

void RawSocket::send(const std::string& bytes) {
  std::size_t sent = 0;
  while (sent < bytes.size()) {
    const ssize_t n = ::send(socket_, bytes.data() + sent, bytes.size() - sent, MSG_NOSIGNAL);
    if (n <= 0) return;  // the peer has closed: what it said is what counts
    sent += static_cast<std::size_t>(n);
  }
}

std::string RawSocket::read_some() {
  char buffer[4096];
  const ssize_t n = ::recv(socket_, buffer, sizeof buffer, 0);
  return n > 0 ? std::string(buffer, static_cast<std::size_t>(n)) : std::string();
}

std::string RawSocket::read_all() {
  std::string all;
  for (std::string some = read_some(); !some.empty(); some = read_some()) all += some;
  return all;
}

void RawSocket::reset() {
  const linger now{1, 0};
  ::setsockopt(socket_, SOL_SOCKET, SO_LINGER, &now, sizeof now);
  ::close(socket_);
  socket_ = -1;
}

std::string http(std::uint16_t port, const std::string& method, const std::string& target,
                 const std::string& more_headers) {
  RawSocket socket(port);
  socket.send(method + " " + target + " HTTP/1.1\r\nHost: 127.0.0.1:" + std::to_string(port) +
              "\r\nConnection: close\r\n" + more_headers + "\r\n");
  return socket.read_all();
}

}  // namespace rimlight::server::test
