#include "server/network/connection.h"

#include <boost/asio/as_tuple.hpp>
#include <boost/asio/post.hpp>
#include <boost/asio/use_awaitable.hpp>
#include <boost/beast/core/flat_buffer.hpp>
#include <boost/beast/websocket/rfc6455.hpp>
#include <cmath>
#include <string>
#include <utility>
#include <variant>

#include "server/log/event_log.h"

namespace rimlight::server {
namespace {

namespace beast = boost::beast;
namespace net = boost::asio;
namespace websocket = beast::websocket;

constexpr auto kAsTuple = net::as_tuple(net::use_awaitable);

/// What the client is told when the server closes.
websocket::close_reason told(CloseReason reason) {
  switch (reason) {
    case CloseReason::server_stopped:
      return {websocket::close_code::going_away, "the server is stopping"};
    case CloseReason::token_expired:
      return {websocket::close_code::policy_error, "the token has expired"};
    case CloseReason::too_many_messages:
      return {websocket::close_code::policy_error, "too many messages"};
    case CloseReason::session_deleted:
      return {websocket::close_code::normal, "the session was deleted"};
    case CloseReason::not_utf8:
      return {websocket::close_code::bad_payload, "no UTF-8"};
    default:
      return {websocket::close_code::policy_error};
  }
}

/// Of text that is UTF-8 but perhaps for its end: whether its last character lacks bytes.
bool ends_within_character(std::string_view text) {
  std::size_t following = 0;  // bytes at the end that continue a character
  for (; following < 3 && following < text.size(); ++following) {
    const auto byte = static_cast<unsigned char>(text[text.size() - 1 - following]);
    if ((byte & 0xc0) == 0x80) continue;
    const std::size_t needed = byte >= 0xf0 ? 3 : byte >= 0xe0 ? 2 : byte >= 0xc0 ? 1 : 0;
    return following < needed;
  }
  return false;
}

}  // namespace

Connection::Connection(Transport stream, const NetworkSettings& settings, Access access,
                       std::int64_t id)
    : settings_(settings),
      access_(std::move(access)),
      id_(id),
      socket_(std::move(stream)),
      room_(socket_.get_executor()),
      expiry_(socket_.get_executor()),
      allowance_(settings.messages_per_second, Clock::now()) {
  configure();
}

void Connection::configure() {
  websocket::stream_base::timeout timeout{};
  timeout.handshake_timeout = settings_.handshake_timeout;
  timeout.idle_timeout = settings_.idle_timeout;
  timeout.keep_alive_pings = true;
  socket_.set_option(timeout);
  socket_.auto_fragment(false);  // LIMITS: ten times the messages a second of 4 KiB fragments
  socket_.read_message_max(kLargestMessage);
}

net::awaitable<void> Connection::run(Request request, std::shared_ptr<DesignSession> session) {
  // Leaves however this coroutine ends: destroyed with its context, too.
  const auto leave = [this](DesignSession* joined) {
    ending_ = true;
    room_.cancel();
    expiry_.cancel();
    joined->leave(*this, Clock::now());
    ended(*joined);
  };
  const std::unique_ptr<DesignSession, decltype(leave)> joined(session.get(), leave);
  const bool accepted = co_await accept(request);
  if (accepted) {
    opened(*session);
    end_with_token();
    write_soon();
    co_await read_messages(*session);
  }
}

net::awaitable<bool> Connection::accept(const Request& request) {
  beast::get_lowest_layer(socket_).expires_never();  // from here on the WebSocket's own timeouts
  const auto [error] = co_await socket_.async_accept(request, kAsTuple);
  open_ = !error;
  co_return open_;
}

net::awaitable<void> Connection::echo(Request request) {
  socket_.read_message_max(kLargestEcho);
  bool going = co_await accept(request);
  beast::flat_buffer buffer;
  while (going) {
    const auto [error, size] = co_await socket_.async_read(buffer, kAsTuple);
    if (error || ending_) break;
    if (!is_whole(buffer)) break;
    socket_.text(socket_.got_text());
    const auto [failure, written] = co_await socket_.async_write(buffer.cdata(), kAsTuple);
    going = !failure;
    buffer.clear();
  }
  ending_ = true;
}

/// Beast does not look at the end of a text whose last fragment is empty: one that ends within a
/// character closes the connection.
bool Connection::is_whole(const beast::flat_buffer& buffer) {
  const auto bytes = buffer.cdata();
  const std::string_view text(static_cast<const char*>(bytes.data()), bytes.size());
  if (!socket_.got_text() || !ends_within_character(text)) return true;
  close(CloseReason::not_utf8);
  return false;
}

net::awaitable<void> Connection::read_messages(DesignSession& session) {
  beast::flat_buffer buffer;
  for (;;) {
    const bool has_room = co_await wait_for_room();
    if (!has_room) {
      abort(unanswered_ > 0 ? CloseReason::edits_unstored : CloseReason::not_reading);
      co_return;
    }
    const auto [error, size] = co_await socket_.async_read(buffer, kAsTuple);
    if (error) {
      end_by(error);
      co_return;
    }
    if (!is_whole(buffer)) co_return;
    settings_.metrics->received(size);
    const auto bytes = buffer.cdata();
    if (socket_.got_text()) {
      receive(session, {static_cast<const char*>(bytes.data()), bytes.size()});
    } else {
      send_text(write_error(
          Error("message", "a binary message of " + std::to_string(size) + " bytes", "text"), {}));
    }
    buffer.consume(buffer.size());
  }
}

/// Waits while too many replies wait, or are still to come; false when that takes longer than the
/// idle timeout.
net::awaitable<bool> Connection::wait_for_room() {
  const Clock::time_point deadline = Clock::now() + settings_.idle_timeout;
  while (texts_.size() + unanswered_ >= kMostTexts && !ending_) {
    if (Clock::now() >= deadline) co_return false;
    room_.expires_at(deadline);
    co_await room_.async_wait(kAsTuple);
  }
  co_return true;
}

/// Handles a message that the client's allowance pays for.
void Connection::receive(DesignSession& session, std::string_view text) {
  if (ending_) return;  // what is still on its way changes nothing
  const Clock::time_point now = Clock::now();
  switch (allowance_.spend(EditAllowance::cost(text.size()), now)) {
    case EditAllowance::Verdict::granted:
      handle(session, text, now);
      break;
    case EditAllowance::Verdict::refused: {
      settings_.metrics->refused(RefusalReason::rate);
      const std::string most = std::to_string(std::lround(settings_.messages_per_second));
      send_text(write_error(Error("message", "too many", "at most " + most + " a second"),
                            find_message_id(text)));
      break;
    }
    case EditAllowance::Verdict::hopeless:
      close(CloseReason::too_many_messages);
  }
}

void Connection::handle(DesignSession& session, std::string_view text, Clock::time_point now) {
  try {
    const ClientMessage message =
        parse_client_message(text, session.environments().names(), session.materials());
    if (const auto command = command_of(message)) {
      if (session.finishing()) {
        throw Error("server", "about to stop", "one that stays: connect again and send it again");
      }
      check_role(*command, access_.role);
      session.apply(*this, *command, now);
      ++unanswered_;
    } else if (const auto* const ack = std::get_if<FrameAck>(&message)) {
      if (session.acknowledge(*this, ack->frame, now) == AckResult::not_in_flight) {
        throw Error("message: /frame", std::to_string(ack->frame),
                    "the frame that was sent last, once");
      }
      allowance_.refund(EditAllowance::cost(text.size()));  // as many as frames, and no more
    } else if (const auto* const deletion = std::get_if<DeleteSession>(&message)) {
      check_role(*deletion, access_.role);
      const Author by = session.begin_deletion(*this);
      delete_(session.shared_from_this(), by, deletion->id);
    } else if (const auto* const display = std::get_if<Display>(&message)) {
      session.set_display(*this, *display, now);
    } else {
      send_text(write_pong(std::get<Ping>(message).id));
    }
  } catch (const StoreError& error) {
    settings_.metrics->refused(RefusalReason::store);
    send_text(write_error(error, find_message_id(text)));
  } catch (const Error& error) {
    settings_.metrics->refused(RefusalReason::message);
    send_text(write_error(error, find_message_id(text)));
  }
}

void Connection::stop() {
  net::post(socket_.get_executor(),
            [self = shared_from_this()] { self->close(CloseReason::server_stopped); });
}

/// Closes when the token expires. The timer does not keep the connection alive.
void Connection::end_with_token() {
  if (!settings_.keys) return;
  const auto left = access_.expires + kClockSkew - WallClock::now();
  expiry_.expires_after(std::chrono::duration_cast<Clock::duration>(left));
  expiry_.async_wait([weak = weak_from_this()](beast::error_code error) {
    const auto self = weak.lock();
    if (!error && self) self->close(CloseReason::token_expired);
  });
}

/// On the strand; politely.
void Connection::close(CloseReason reason) {
  if (std::exchange(ending_, true)) return;
  reason_ = reason;
  room_.cancel();
  if (!open_) {
    transport().next_layer().close();
    return;
  }
  socket_.async_close(told(reason), [self = shared_from_this()](beast::error_code) {});
}

/// Ends a client that breaks the rules, without waiting for it.
void Connection::abort(CloseReason reason) {
  if (std::exchange(ending_, true)) return;
  reason_ = reason;
  room_.cancel();
  transport().next_layer().close();
}

/// What a failed read says of the end, unless the server itself ends it.
void Connection::end_by(const beast::error_code& error) {
  if (reason_) return;
  if (error == websocket::error::closed) {
    reason_ = CloseReason::client_closed;
  } else if (error == beast::error::timeout) {
    reason_ = CloseReason::silent;
  } else if (error == websocket::error::message_too_big) {
    reason_ = CloseReason::message_too_large;
  } else if (error == websocket::error::bad_frame_payload) {
    reason_ = CloseReason::not_utf8;
  } else {
    reason_ = CloseReason::client_lost;
  }
}

void Connection::opened(const DesignSession& session) {
  settings_.metrics->connection_opened();
  log_event(Severity::info, "connection_opened",
            {{"connection", id_},
             {"session", session.name()},
             {"scene", session.scene().name},
             {"role", to_string(access_.role)}});
}

/// Once for each connection.
void Connection::ended(const DesignSession& session) {
  const CloseReason reason =
      !open_ ? CloseReason::handshake_failed : reason_.value_or(CloseReason::client_lost);
  settings_.metrics->connection_closed(reason);
  const bool is_usual =
      reason == CloseReason::client_closed || reason == CloseReason::client_lost ||
      reason == CloseReason::server_stopped || reason == CloseReason::session_deleted;
  log_event(is_usual ? Severity::info : Severity::warning, "connection_closed",
            {{"connection", id_}, {"session", session.name()}, {"reason", to_string(reason)}});
}

}  // namespace rimlight::server
