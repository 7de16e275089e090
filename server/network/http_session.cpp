#include "server/network/http_session.h"

#include <boost/asio/as_tuple.hpp>
#include <boost/asio/post.hpp>
#include <boost/asio/use_awaitable.hpp>
#include <boost/beast/core/flat_buffer.hpp>
#include <boost/beast/http/error.hpp>
#include <boost/beast/http/read.hpp>
#include <boost/beast/http/write.hpp>
#include <boost/beast/websocket/rfc6455.hpp>
#include <optional>
#include <utility>
#include <variant>

#include "core/base/error.h"
#include "server/log/event_log.h"
#include "server/network/disk_thread.h"
#include "server/network/request_checks.h"
#include "server/network/responses.h"
#include "server/protocol/upload_target.h"

namespace rimlight::server {
namespace {

namespace beast = boost::beast;
namespace http = beast::http;
namespace net = boost::asio;

constexpr auto kAsTuple = net::as_tuple(net::use_awaitable);
constexpr std::uint32_t kLargestHeader = 16 * 1024;
constexpr std::chrono::seconds kGoodbye{2};  // for the end of TLS
constexpr std::uint64_t kLargestEchoedBody = 64 * 1024;
constexpr std::string_view kEchoPath = "/selftest/echo";

using Request = HttpSession::Request;
using Response = HttpSession::Response;

std::string_view view(beast::string_view text) { return {text.data(), text.size()}; }

/// As against a socket that ended.
bool is_malformed(const beast::error_code& error) {
  return error.category() == http::make_error_code(http::error::bad_value).category() &&
         error != http::error::end_of_stream && error != http::error::partial_message;
}

}  // namespace

HttpSession::HttpSession(Transport stream, const Site& site, std::int64_t id)
    : site_(site),
      id_(id),
      metrics_(site.settings.metrics),
      stream_(std::move(stream)),
      strand_(stream_.get_executor()) {
  metrics_->socket_opened();
}

HttpSession::~HttpSession() { metrics_->socket_closed(); }

/// The handshake of TLS and the first header have one deadline together.
net::awaitable<void> HttpSession::run() {
  stream_.next_layer().expires_after(site_.settings.handshake_timeout);
  const bool speaks = co_await shake_hands();
  if (!speaks) co_return;
  co_await serve();
  if (!connection_) co_await stream_.finish(kGoodbye);
}

net::awaitable<bool> HttpSession::shake_hands() {
  const WaitingRoom::Seat seat(site_.waiting, shared_from_this());
  waiting_ = true;
  const beast::error_code error = co_await stream_.accept();
  waiting_ = false;
  if (error && !stopping_) {  // else the server has closed it, and counted why
    constexpr RefusalReason kReason = RefusalReason::tls;
    metrics_->refused(kReason);
    log_event(Severity::warning, "handshake_failed",
              {{"connection", id_}, {"reason", to_string(kReason)}, {"detail", error.message()}});
  }
  co_return !error;
}

net::awaitable<beast::error_code> HttpSession::read_header(HeaderParser& parser,
                                                           beast::flat_buffer& buffer) {
  const WaitingRoom::Seat seat(site_.waiting, shared_from_this());
  waiting_ = true;
  const auto [error, size] = co_await http::async_read_header(stream_, buffer, parser, kAsTuple);
  waiting_ = false;
  co_return error;
}

void HttpSession::make_way() {
  net::post(strand_, [self = shared_from_this()] {
    if (!self->waiting_ || self->connection_) return;
    self->stopping_ = true;
    self->count({beast::http::status::service_unavailable,
                 {},
                 RefusalReason::too_many_sockets,
                 "made way while it had asked for nothing"});
    self->stream_.next_layer().close();
  });
}

net::awaitable<void> HttpSession::serve() {
  beast::flat_buffer buffer(kLargestHeader);
  for (bool first = true; !stopping_; first = false) {
    HeaderParser parser;
    parser.header_limit(kLargestHeader);
    parser.body_limit(boost::none);  // who takes a body looks at its length
    if (!first) stream_.next_layer().expires_after(site_.settings.handshake_timeout);
    const beast::error_code error = co_await read_header(parser, buffer);
    if (error) {
      if (is_malformed(error)) {
        Request malformed;
        malformed.keep_alive(false);
        const Refusal refusal{http::status::bad_request, error.message(), RefusalReason::malformed};
        co_await answer(stream_, refuse(malformed, refusal));
      }
      break;
    }
    const Body body = body_of(parser);
    if (const auto fault = request_fault(parser.get(), body, site_.hosts)) {
      parser.get().keep_alive(false);  // whatever follows is no request
      co_await answer(stream_, refuse(parser.get(), *fault));
      break;
    }
    if (body == Body::upload && parser.get().method() == http::verb::put) {
      co_await take_state(parser, buffer);
      break;
    }
    if (body == Body::upload) {
      co_await take_upload(parser, buffer);
      break;
    }
    if (body == Body::echoed) {
      const bool more = co_await answer_body(parser, buffer);
      if (!more) break;
      continue;
    }
    Request request = parser.release();
    if (!refusing_ && beast::websocket::is_upgrade(request)) {
      co_await upgrade(std::move(request));
      co_return;
    }
    Response response;
    if (!refusing_ && is_state_target(view(request.target()))) {
      response = co_await respond_with_state(request);
    } else if (!refusing_ && request.method() == http::verb::delete_ &&
               is_upload_target(view(request.target()))) {
      response = co_await respond_to_removal(request);
    } else {
      response = respond(request);
    }
    const bool keep_alive = co_await answer(stream_, std::move(response));
    if (!keep_alive) break;
  }
}

Body HttpSession::body_of(const HeaderParser& parser) const {
  if (parser.is_done()) return Body::none;
  const Request& request = parser.get();
  const auto target = view(request.target());
  const bool is_upload = request.method() == http::verb::post && is_upload_target(target);
  const bool is_import = request.method() == http::verb::put && is_state_target(target);
  if (!refusing_ && (is_upload || is_import)) return Body::upload;
  return site_.settings.selftest_echo ? Body::echoed : Body::unwanted;
}

/// Of a conformance suite: its body comes back. True when another request may follow.
net::awaitable<bool> HttpSession::answer_body(HeaderParser& header, beast::flat_buffer& buffer) {
  const std::uint64_t length = header.content_length().value_or(0);
  http::request_parser<http::string_body> parser(std::move(header));
  parser.body_limit(kLargestEchoedBody);  // of chunks
  if (length > kLargestEchoedBody) co_return false;
  const auto [error, size] = co_await http::async_read(stream_, buffer, parser, kAsTuple);
  Request request(parser.get().base());
  if (error) {
    request.keep_alive(false);
    if (is_malformed(error)) {
      // Named: GCC 12 destroys a braced temporary twice when it is part of a co_await.
      const Refusal refusal{http::status::bad_request, error.message(), RefusalReason::malformed};
      co_await answer(stream_, refuse(request, refusal));
    }
    co_return false;
  }
  Response response = make_response(http::status::ok, request.version(), parser.get().keep_alive(),
                                    "application/octet-stream", std::move(parser.get().body()));
  const bool keep_alive = co_await answer(stream_, std::move(response));
  co_return keep_alive;
}

/// True when another request may follow.
net::awaitable<bool> HttpSession::answer(Transport& stream, Response response) {
  stream.next_layer().expires_after(site_.settings.handshake_timeout);
  const auto [error, size] = co_await http::async_write(stream, response, kAsTuple);
  if (error) co_return false;
  co_return response.keep_alive();
}

/// Who asks is known before anything is said about what is asked for.
net::awaitable<void> HttpSession::upgrade(Request request) {
  request.keep_alive(false);  // after a refusal
  std::optional<Response> refusal;
  StreamTarget target;
  std::variant<Access, Refusal> admitted;
  if (const auto fault = origin_fault(request, site_.hosts)) {
    refusal = refuse(request, *fault);
  } else if (site_.stopping) {
    refusal = refuse(request, {http::status::service_unavailable,
                               "the server is stopping; try again later", RefusalReason::stopping});
  } else if (site_.settings.selftest_echo && view(request.target()) == kEchoPath) {
    connection_ = std::make_shared<Connection>(std::move(stream_), site_.settings, Access{}, id_);
    co_await connection_->echo(std::move(request));
    co_return;
  } else {
    try {
      target = parse_stream_target(view(request.target()));
      admitted = admit(request, target.token, target.session, site_.settings.keys.get());
      if (const auto* const fault_of_token = std::get_if<Refusal>(&admitted)) {
        refusal = refuse(request, *fault_of_token);
      }
    } catch (const Error& error) {
      refusal = refuse(request, {http::status::not_found, error.what(), RefusalReason::not_found});
    }
  }
  if (refusal) {
    co_await answer(stream_, std::move(*refusal));
  } else {
    co_await connect(std::move(request), target, std::get<Access>(admitted));
  }
}

net::awaitable<void> HttpSession::connect(Request request, const StreamTarget& target,
                                          const Access& access) {
  connection_ = std::make_shared<Connection>(std::move(stream_), site_.settings, access, id_);
  const Visitor visitor{access.name, access.role, target.resume, target.seen, target.parts};
  std::shared_ptr<DesignSession> session =
      site_.sessions.join_open(target.session, target.scene, connection_, Clock::now(), visitor);
  std::optional<Refusal> refusal;
  if (!session) {
    const auto open = [&sessions = site_.sessions, target, visitor, client = connection_] {
      return sessions.join(target.session, target.scene, client, Clock::now(), visitor);
    };
    try {
      session = co_await on_disk_thread(site_, open);
      refusal = {http::status::service_unavailable,
                 "this server has no room for another session; try again later",
                 RefusalReason::too_many_sessions};
    } catch (const Error& error) {
      refusal = refusal_of(error);
    }
  }
  if (session) {
    connection_->delete_by(
        [self = this](const std::shared_ptr<DesignSession>& which, const Author& by,
                      const std::string& id) { self->delete_session(which, by, id); });
    co_await connection_->run(std::move(request), std::move(session));
  } else {
    co_await answer(connection_->transport(), refuse(request, *refusal));
    co_await connection_->transport().finish(kGoodbye);
  }
}

void HttpSession::stop() {
  net::post(strand_, [self = shared_from_this()] {
    self->stopping_ = true;
    if (self->connection_) {
      self->connection_->stop();
    } else {
      self->stream_.next_layer().close();
    }
  });
}

}  // namespace rimlight::server
