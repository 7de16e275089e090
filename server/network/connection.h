#pragma once

// Includes Beast: for the network layer's own .cpp files only.

#include <boost/asio/awaitable.hpp>
#include <boost/asio/steady_timer.hpp>
#include <boost/beast/core/flat_buffer.hpp>
#include <boost/beast/http/empty_body.hpp>
#include <boost/beast/http/message.hpp>
#include <boost/beast/websocket/stream.hpp>
#include <cstdint>
#include <deque>
#include <exception>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <string_view>

#include "server/access/access_token.h"
#include "server/access/edit_allowance.h"
#include "server/network/http_server.h"
#include "server/network/stop_gate.h"
#include "server/network/transport.h"
#include "server/protocol/stream_target.h"

namespace rimlight::server {

/// One client's WebSocket. Members are touched on its strand only; any thread may call the Client
/// functions and stop(). What waits to be written is bounded: some text replies (while they are at
/// their bound, with the edits that have no answer yet, nothing more is read), the newest
/// state, presence and list of snapshots, one frame.
class Connection final : public Client,
                         public Stoppable,
                         public std::enable_shared_from_this<Connection> {
 public:
  using Request = boost::beast::http::request<boost::beast::http::empty_body>;

  /// `id` is in the log, with what happens to the connection.
  Connection(Transport stream, const NetworkSettings& settings, Access access, std::int64_t id);

  /// Completes the upgrade and serves until either side ends it. The client has joined `session`
  /// already, and leaves it here.
  boost::asio::awaitable<void> run(Request request, std::shared_ptr<DesignSession> session);
  /// Completes the upgrade and sends every message back, for conformance suites: the same socket
  /// with the same limits, but for messages of up to kLargestEcho.
  boost::asio::awaitable<void> echo(Request request);
  static constexpr std::size_t kLargestEcho = std::size_t{16} << 20;
  /// The stream below again, to refuse the upgrade on.
  Transport& transport() { return socket_.next_layer(); }

  void send_text(std::string text) override;
  void send_answer(std::string text) override;
  void send_state(std::string text) override;
  void send_presence(std::string text) override;
  void send_snapshots(std::string text) override;
  void send_off(std::string text) override;
  void send_frame(FramePtr frame) override;
  void stop() override;

  /// Deletes the session for one of its owners, away from the network's threads; what goes wrong is
  /// the answer to the message of that id.
  using Deleter = std::function<void(const std::shared_ptr<DesignSession>& session,
                                     const Author& by, const std::string& id)>;
  /// Before run().
  void delete_by(Deleter deleter) { delete_ = std::move(deleter); }

 private:
  /// Text replies that may wait; at this bound reading pauses.
  static constexpr std::size_t kMostTexts = 64;
  /// What a session itself may add to a client that does not read, before it is closed.
  static constexpr std::size_t kTooManyTexts = 4 * kMostTexts;

  void configure();
  boost::asio::awaitable<bool> accept(const Request& request);
  bool is_whole(const boost::beast::flat_buffer& buffer);
  boost::asio::awaitable<void> read_messages(DesignSession& session);
  boost::asio::awaitable<bool> wait_for_room();
  void receive(DesignSession& session, std::string_view text);
  void handle(DesignSession& session, std::string_view text, Clock::time_point now);
  void replace(std::optional<std::string> Connection::*waiting, std::string text);
  std::optional<std::string> next_text();
  void write_soon();
  boost::asio::awaitable<void> write_waiting();
  boost::asio::awaitable<bool> write_text(std::string_view text);
  boost::asio::awaitable<bool> write_frame(const FrameMessage& frame);
  void end_with_token();
  void close(CloseReason reason);
  void abort(CloseReason reason);
  void end_by(const boost::beast::error_code& error);
  void opened(const DesignSession& session);
  void ended(const DesignSession& session);

  const NetworkSettings& settings_;
  const Access access_;
  const std::int64_t id_;
  boost::beast::websocket::stream<Transport, false> socket_;
  boost::asio::steady_timer room_;    // cancelled when texts_ has room again
  boost::asio::steady_timer expiry_;  // of the token
  EditAllowance allowance_;
  std::deque<std::string> texts_;
  std::size_t unanswered_ = 0;                               // edits that the session has taken
  std::optional<std::string> state_, presence_, snapshots_;  // the newest of each
  FramePtr frame_;
  Deleter delete_;
  bool is_sent_off_ = false;  // closes when its texts are written
  bool open_ = false;
  bool writing_ = false;
  bool ending_ = false;
  std::optional<CloseReason> reason_;  // the first that was known
};

}  // namespace rimlight::server
