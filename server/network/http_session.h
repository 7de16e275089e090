#pragma once

// Includes Beast: for the network layer's own .cpp files only.

#include <atomic>
#include <boost/asio/any_io_executor.hpp>
#include <boost/asio/awaitable.hpp>
#include <boost/asio/thread_pool.hpp>
#include <boost/beast/core/tcp_stream.hpp>
#include <boost/beast/http/empty_body.hpp>
#include <boost/beast/http/message.hpp>
#include <boost/beast/http/string_body.hpp>
#include <cstdint>
#include <memory>
#include <string_view>

#include "server/access/host_policy.h"
#include "server/network/connection.h"
#include "server/network/http_server.h"
#include "server/network/request_checks.h"
#include "server/network/stop_gate.h"

namespace rimlight::server {

/// What all sockets of a server share.
struct Site {
  const NetworkSettings& settings;
  const HostPolicy& hosts;
  const StaticFiles& files;
  SessionRegistry& sessions;
  StopGate& gate;
  const std::atomic<bool>& stopping;  // no new sessions, and /readyz says so
  boost::asio::thread_pool& disk;     // one thread, for what waits for a disk
  std::atomic<std::size_t>& opening;  // requests that wait for it
};

/// One accepted socket: answers HTTP requests until it is closed or becomes a WebSocket.
/// On its strand; any thread may call stop().
class HttpSession final : public Stoppable, public std::enable_shared_from_this<HttpSession> {
 public:
  using Request = boost::beast::http::request<boost::beast::http::empty_body>;
  using Response = boost::beast::http::response<boost::beast::http::string_body>;

  /// `id` is in the log, with what happens to the socket.
  HttpSession(boost::beast::tcp_stream stream, const Site& site, std::int64_t id);
  ~HttpSession() override;

  boost::asio::awaitable<void> run();
  /// Before run(): every request is answered with 503, since too many sockets are open.
  void refuse_all() { refusing_ = true; }
  void stop() override;

 private:
  boost::asio::awaitable<void> upgrade(Request request);
  boost::asio::awaitable<void> connect(Request request, const StreamTarget& target,
                                       const Access& access);
  boost::asio::awaitable<bool> answer(boost::beast::tcp_stream& stream, Response response);
  boost::asio::awaitable<Response> respond_with_state(const Request& request);
  Response respond(const Request& request) const;
  Response respond_to(const Request& request, std::string_view path, std::string_view query) const;
  Response refuse(const Request& request, const Refusal& refusal) const;
  Response readiness(const Request& request) const;

  const Site& site_;
  const std::int64_t id_;
  const std::shared_ptr<ServerMetrics> metrics_;  // may outlive the site
  boost::beast::tcp_stream stream_;               // moves into the connection
  const boost::asio::any_io_executor strand_;
  std::shared_ptr<Connection> connection_;  // once it is a WebSocket
  bool refusing_ = false;
  bool stopping_ = false;
};

}  // namespace rimlight::server
