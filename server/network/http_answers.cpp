// The part of HttpSession that answers requests without a body.

#include <boost/beast/core/string.hpp>
#include <optional>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "core/base/error.h"
#include "server/log/event_log.h"
#include "server/network/disk_thread.h"
#include "server/network/http_session.h"
#include "server/network/readiness.h"
#include "server/network/request_checks.h"
#include "server/network/responses.h"

namespace rimlight::server {
namespace {

namespace beast = boost::beast;
namespace http = beast::http;
namespace net = boost::asio;

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

}  // namespace

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

}  // namespace rimlight::server
