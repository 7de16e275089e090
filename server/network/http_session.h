#pragma once

// Includes Beast: for the network layer's own .cpp files only.

#include <atomic>
#include <boost/asio/any_io_executor.hpp>
#include <boost/asio/awaitable.hpp>
#include <boost/asio/thread_pool.hpp>
#include <boost/beast/core/flat_buffer.hpp>
#include <boost/beast/core/tcp_stream.hpp>
#include <boost/beast/http/empty_body.hpp>
#include <boost/beast/http/message.hpp>
#include <boost/beast/http/parser.hpp>
#include <boost/beast/http/string_body.hpp>
#include <boost/optional/optional.hpp>
#include <cstdint>
#include <memory>
#include <string>
#include <string_view>
#include <variant>

#include "server/access/host_policy.h"
#include "server/network/connection.h"
#include "server/network/http_server.h"
#include "server/network/request_checks.h"
#include "server/network/stop_gate.h"
#include "server/network/transport.h"
#include "server/network/upload_desk.h"
#include "server/network/waiting_room.h"
#include "server/protocol/upload_target.h"

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
  UploadDesk& uploads;
  WaitingRoom& waiting;
};

/// One accepted socket: answers HTTP requests until it is closed or becomes a WebSocket.
/// On its strand; any thread may call stop().
class HttpSession final : public Stoppable,
                          public Guest,
                          public std::enable_shared_from_this<HttpSession> {
 public:
  using Request = boost::beast::http::request<boost::beast::http::empty_body>;
  using Response = boost::beast::http::response<boost::beast::http::string_body>;

  /// `id` is in the log, with what happens to the socket.
  HttpSession(Transport stream, const Site& site, std::int64_t id);
  ~HttpSession() override;

  boost::asio::awaitable<void> run();
  /// Before run(): every request is answered with 503, since too many sockets are open.
  void refuse_all() { refusing_ = true; }
  void stop() override;
  void make_way() override;

 private:
  using HeaderParser = boost::beast::http::request_parser<boost::beast::http::empty_body>;

  boost::asio::awaitable<void> serve();
  boost::asio::awaitable<boost::beast::error_code> read_header(HeaderParser& parser,
                                                               boost::beast::flat_buffer& buffer);
  boost::asio::awaitable<bool> shake_hands();
  boost::asio::awaitable<void> refuse_upload(Response response);
  Body body_of(const HeaderParser& parser) const;
  boost::asio::awaitable<bool> answer_body(HeaderParser& header, boost::beast::flat_buffer& buffer);
  boost::asio::awaitable<void> upgrade(Request request);
  boost::asio::awaitable<void> connect(Request request, const StreamTarget& target,
                                       const Access& access);
  boost::asio::awaitable<bool> answer(Transport& stream, Response response);
  boost::asio::awaitable<Response> respond_with_state(const Request& request);

  // http_changes.cpp
  struct StateImport {
    StreamTarget target;
    Access access;
    UploadDesk::Place place;
  };
  /// A whole state: with 64 curves drawn of 256 points each.
  static constexpr std::uint64_t kLargestState = std::uint64_t{4} << 20;
  std::variant<Access, Refusal> admit_change(const Request& request, const std::string& session,
                                             Role least) const;
  boost::asio::awaitable<Response> respond_to_removal(const Request& request);
  std::variant<StateImport, Response> check_state(
      const Request& request, const boost::optional<std::uint64_t>& length) const;
  boost::asio::awaitable<void> take_state(HeaderParser& header, boost::beast::flat_buffer& buffer);
  Response import_state(const Request& request, const StateImport& import,
                        const std::string& bytes) const;
  void delete_session(const std::shared_ptr<DesignSession>& session, const Author& by,
                      const std::string& id) const;

  Response respond(const Request& request) const;
  Response respond_to(const Request& request, std::string_view path, std::string_view query) const;
  void count(const Refusal& refusal) const;
  Response refuse(const Request& request, const Refusal& refusal) const;
  Response refuse(const Request& request, const Refusal& refusal, const Error& error) const;
  Response readiness(const Request& request) const;

  /// An upload that may begin.
  struct Upload {
    std::string environment;
    std::shared_ptr<DesignSession> session;
    UploadDesk::Place place;
  };
  boost::asio::awaitable<std::variant<Upload, Response>> check_upload(
      const Request& request, const boost::optional<std::uint64_t>& length) const;
  std::optional<Refusal> fault_of_upload(const Request& request, const UploadTarget& target,
                                         const boost::optional<std::uint64_t>& length) const;
  boost::asio::awaitable<void> take_upload(HeaderParser& header, boost::beast::flat_buffer& buffer);
  boost::asio::awaitable<bool> read_upload(HeaderParser& header, boost::beast::flat_buffer& buffer,
                                           std::string& bytes);
  boost::asio::awaitable<Response> finish_upload(const Request& request, Upload upload,
                                                 std::string bytes);

  const Site& site_;
  const std::int64_t id_;
  const std::shared_ptr<ServerMetrics> metrics_;  // may outlive the site
  Transport stream_;                              // moves into the connection
  const boost::asio::any_io_executor strand_;
  std::shared_ptr<Connection> connection_;  // once it is a WebSocket
  bool waiting_ = false;                    // has a seat in the waiting room
  bool refusing_ = false;
  bool stopping_ = false;
};

}  // namespace rimlight::server
