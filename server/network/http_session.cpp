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
#include <vector>

#include "core/base/error.h"
#include "server/log/event_log.h"
#include "server/network/disk_thread.h"
#include "server/network/readiness.h"
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

Response serve_file(const Request& request, const StaticFiles::File& file) {
  const bool known = view(request[http::field::if_none_match]) == file.etag;
  Response response =
      make_response(known ? http::status::not_modified : http::status::ok, request.version(),
                    request.keep_alive(), file.content_type, known ? std::string() : file.bytes);
  response.set(http::field::etag, file.etag);
  return response;
}

Response serve_curves(const Request& request, const SceneCatalog& scenes, std::string_view query) {
  try {
    return json_body(request, http::status::ok, scenes.curves(query));
  } catch (const Error& error) {
    return json_body(request, http::status::not_found, write_error(error, std::nullopt));
  }
}

/// As against a socket that ended.
bool is_malformed(const beast::error_code& error) {
  return error.category() == http::make_error_code(http::error::bad_value).category() &&
         error != http::error::end_of_stream && error != http::error::partial_message;
}

/// Why a session cannot be opened or read.
Refusal refusal_of(const Error& error) {
  if (dynamic_cast<const StoreError*>(&error) != nullptr) {
    return {http::status::service_unavailable, error.what(), RefusalReason::store, error.what()};
  }
  return {http::status::not_found, error.what(), RefusalReason::not_found, error.what()};
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
  const bool speaks = co_await stream_.accept();
  waiting_ = false;
  co_return speaks;
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
  if (!refusing_ && request.method() == http::verb::post &&
      is_upload_target(view(request.target()))) {
    return Body::upload;
  }
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
      co_await answer(stream_, refuse(request, {http::status::bad_request, error.message(),
                                                RefusalReason::malformed}));
    }
    co_return false;
  }
  co_return co_await answer(
      stream_, make_response(http::status::ok, request.version(), parser.get().keep_alive(),
                             "application/octet-stream", std::move(parser.get().body())));
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
  const Visitor visitor{access.name, access.role, target.resume, target.seen};
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
    co_await connection_->run(std::move(request), std::move(session));
  } else {
    co_await answer(connection_->transport(), refuse(request, *refusal));
    co_await connection_->transport().finish(kGoodbye);
  }
}

/// A session's state, for who may open it.
net::awaitable<Response> HttpSession::respond_with_state(const Request& request) {
  std::optional<Refusal> refusal;
  try {
    const StreamTarget target = parse_state_target(view(request.target()));
    const auto admitted = admit(request, target.token, target.session, site_.settings.keys.get());
    if (const auto* const fault = std::get_if<Refusal>(&admitted)) {
      co_return refuse(request, *fault);
    }
    if (request.method() != http::verb::get) {
      co_return refuse(request,
                       {http::status::method_not_allowed, "GET only", RefusalReason::method});
    }
    const auto read = [&sessions = site_.sessions, target] {
      return sessions.export_state(target.session, target.scene);
    };
    const std::optional<std::string> state = co_await on_disk_thread(site_, read);
    if (state) co_return json_body(request, http::status::ok, *state);
    refusal = {http::status::not_found, "there is no such session", RefusalReason::not_found};
  } catch (const Error& error) {
    refusal = refusal_of(error);
  }
  co_return refuse(request, *refusal);
}

Response HttpSession::respond(const Request& request) const {
  if (refusing_) {
    Response response =
        refuse(request, {http::status::service_unavailable, "too many connections; try again later",
                         RefusalReason::too_many_sockets});
    response.keep_alive(false);
    return response;
  }
  const bool is_head = request.method() == http::verb::head;
  if (!is_head && request.method() != http::verb::get) {
    Response response = refuse(
        request, {http::status::method_not_allowed, "GET and HEAD only", RefusalReason::method});
    response.set(http::field::allow, "GET, HEAD");
    return response;
  }
  const std::string_view target = view(request.target());
  const std::size_t question = target.find('?');
  const std::string_view path = target.substr(0, question);
  Response response =
      respond_to(request, path, question < target.size() ? target.substr(question + 1) : "");
  if (is_head) response.body().clear();  // Content-Length stays
  return response;
}

Response HttpSession::respond_to(const Request& request, std::string_view path,
                                 std::string_view query) const {
  if (path.starts_with("/api/") || path == "/metrics") {
    const auto admitted = path == "/metrics" ? admit_operator(request, site_.settings.keys.get())
                                             : admit(request, {}, {}, site_.settings.keys.get());
    if (const auto* const fault = std::get_if<Refusal>(&admitted)) return refuse(request, *fault);
  }
  if (path == "/healthz") return plain(request, http::status::ok, "ok");
  if (path == "/readyz") return readiness(request);
  if (path == "/metrics") {
    const Overload& overload = site_.sessions.overload();
    metrics_->overload(static_cast<int>(overload.stage(Clock::now())),
                       overload.budget_share(Clock::now()), overload.mean_lateness_ms());
    return make_response(http::status::ok, request.version(), request.keep_alive(),
                         "text/plain; version=0.0.4; charset=utf-8", metrics_->to_text());
  }
  if (path == "/api/scenes") {
    return json_body(request, http::status::ok, site_.sessions.scenes().to_json());
  }
  if (path == "/api/curves") return serve_curves(request, site_.sessions.scenes(), query);
  if (const StaticFiles::File* const file = site_.files.find(path)) {
    return serve_file(request, *file);
  }
  return refuse(request, {http::status::not_found, "nothing is here", RefusalReason::not_found});
}

/// Counted and logged here, and nowhere else. Neither what is wrong with a token nor whether a
/// session exists is a stranger's business; what a stranger sent is not in the log, since it may be
/// a token in the wrong place.
Response HttpSession::refuse(const Request& request, const Refusal& refusal) const {
  count(refusal);
  Response response = plain(request, refusal.status, refusal.reason);
  if (refusal.status == http::status::unauthorized) {
    response.set(http::field::www_authenticate, "Bearer");
  } else if (refusal.status == http::status::service_unavailable) {
    response.set(http::field::retry_after, "5");
  }
  return response;
}

/// The same, and says why in JSON.
Response HttpSession::refuse(const Request& request, const Refusal& refusal,
                             const Error& error) const {
  count(refusal);
  return json_body(request, refusal.status, write_error(error, std::nullopt));
}

void HttpSession::count(const Refusal& refusal) const {
  metrics_->refused(refusal.why);
  log_event(Severity::warning, "refused",
            {{"connection", id_},
             {"reason", to_string(refusal.why)},
             {"status", static_cast<std::int64_t>(refusal.status)},
             {"detail", refusal.detail}});
}

Response HttpSession::readiness(const Request& request) const {
  std::vector<std::string> reasons;
  if (site_.stopping) reasons.emplace_back("the server is stopping");
  if (auto trouble = site_.sessions.store_trouble()) reasons.push_back(std::move(*trouble));
  const auto status = reasons.empty() ? http::status::ok : http::status::service_unavailable;
  return json_body(request, status, write_readiness(reasons));
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
