// Uploads of environments: the part of HttpSession that takes a request's body.

#include <boost/asio/as_tuple.hpp>
#include <boost/asio/co_spawn.hpp>
#include <boost/asio/use_awaitable.hpp>
#include <boost/beast/core/string.hpp>
#include <boost/beast/http/parser.hpp>
#include <boost/beast/http/read.hpp>
#include <boost/beast/http/write.hpp>
#include <nlohmann/json.hpp>
#include <variant>

#include "core/base/error.h"
#include "server/network/disk_thread.h"
#include "server/network/http_session.h"
#include "server/network/request_checks.h"
#include "server/network/responses.h"
#include "server/network/upload_desk.h"
#include "server/protocol/upload_target.h"

namespace rimlight::server {
namespace {

namespace beast = boost::beast;
namespace http = beast::http;
namespace net = boost::asio;

constexpr auto kAsTuple = net::as_tuple(net::use_awaitable);
/// Bytes a second that an upload must bring on average, beside the time of a header.
constexpr std::uint64_t kSlowest = 256 * 1024;
/// For what is still on its way when an upload is refused.
constexpr std::chrono::seconds kUnreadTime{2};

using Request = HttpSession::Request;
using Response = HttpSession::Response;

/// What an Error says is answered in JSON, and is in the log.
Refusal refusal_of(http::status status, RefusalReason why, const Error& error) {
  return {status, {}, why, error.what()};
}

/// The role and the token of its header, never of the query.
std::optional<Refusal> not_admitted(const Request& request, const UploadTarget& target,
                                    const SigningKeys* keys) {
  const auto admitted = admit(request, {}, target.session, keys);
  if (const auto* const fault = std::get_if<Refusal>(&admitted)) return *fault;
  if (std::get<Access>(admitted).role < Role::editor) {
    return Refusal{http::status::forbidden, "this access token only lets you watch",
                   RefusalReason::forbidden, "of a viewer"};
  }
  return std::nullopt;
}

/// Of the length that is claimed, before anything is read.
std::optional<Refusal> fault_of_length(const boost::optional<std::uint64_t>& length) {
  if (!length)
    return Refusal{http::status::length_required, "Content-Length is needed", RefusalReason::upload,
                   "no length"};
  if (*length > kLargestUpload) {
    return Refusal{http::status::payload_too_large, "at most 32 MiB are taken",
                   RefusalReason::upload, std::to_string(*length) + " bytes"};
  }
  return std::nullopt;
}

}  // namespace

/// Known from its header alone.
std::optional<Refusal> HttpSession::fault_of_upload(
    const Request& request, const UploadTarget& target,
    const boost::optional<std::uint64_t>& length) const {
  if (site_.stopping) {
    return Refusal{http::status::service_unavailable, "the server is stopping; try again later",
                   RefusalReason::stopping};
  }
  if (auto fault = not_admitted(request, target, site_.settings.keys.get())) return fault;
  return fault_of_length(length);
}

/// Opening the session may read the disk: only those who have a place at the desk ask for that, so
/// that a flood of uploads leaves room to those who open sessions.
net::awaitable<std::variant<HttpSession::Upload, HttpSession::Response>> HttpSession::check_upload(
    const Request& request, const boost::optional<std::uint64_t>& length) const {
  if (const auto fault = origin_fault(request, site_.hosts)) co_return refuse(request, *fault);
  const beast::string_view text = request.target();
  Upload upload;
  try {
    const UploadTarget target = parse_upload_target({text.data(), text.size()});
    if (const auto fault = fault_of_upload(request, target, length)) {
      co_return refuse(request, *fault);
    }
    upload.place = site_.uploads.take_place();
    if (!upload.place) {
      co_return refuse(
          request, {http::status::service_unavailable, "too many uploads at once; try again later",
                    RefusalReason::upload});
    }
    upload.environment = target.environment;
    const auto open = [&sessions = site_.sessions, target] {
      return sessions.open(target.session, target.scene);
    };
    upload.session = co_await on_disk_thread(site_, open);
  } catch (const StoreError& error) {
    co_return refuse(
        request, refusal_of(http::status::service_unavailable, RefusalReason::store, error), error);
  } catch (const Error& error) {
    co_return refuse(request, refusal_of(http::status::not_found, RefusalReason::not_found, error),
                     error);
  }
  if (!upload.session) {
    co_return refuse(request, {http::status::service_unavailable,
                               "the server has no place for another session; try again later",
                               RefusalReason::too_many_sessions});
  }
  try {
    upload.session->environments().check_room(upload.environment);
  } catch (const Error& error) {
    co_return refuse(request, refusal_of(http::status::conflict, RefusalReason::upload, error),
                     error);
  }
  co_return upload;
}

/// Decodes on the desk's thread, and tells the session.
net::awaitable<HttpSession::Response> HttpSession::finish_upload(const Request& request,
                                                                 Upload upload, std::string bytes) {
  const auto work = [&]() -> net::awaitable<Response> {
    try {
      const EnvironmentPtr environment =
          decode_uploaded(upload.environment, bytes, site_.uploads.settings());
      site_.sessions.add_environment(*upload.session, environment);
    } catch (const Error& error) {
      co_return refuse(request,
                       refusal_of(http::status::unprocessable_entity, RefusalReason::upload, error),
                       error);
    }
    co_return json_body(request, http::status::created,
                        nlohmann::json{{"environment", upload.environment}}.dump());
  };
  Response response =
      co_await net::co_spawn(site_.uploads.pool().get_executor(), work, net::use_awaitable);
  co_return response;
}

net::awaitable<void> HttpSession::take_upload(HeaderParser& header, beast::flat_buffer& buffer) {
  Request request(header.get().base());
  request.keep_alive(false);
  auto checked = co_await check_upload(request, header.content_length());
  if (auto* const refusal = std::get_if<Response>(&checked)) {
    co_await refuse_upload(std::move(*refusal));
    co_return;
  }
  std::string bytes;
  const bool arrived = co_await read_upload(header, buffer, bytes);
  if (!arrived) co_return;
  Response finished =
      co_await finish_upload(request, std::get<Upload>(std::move(checked)), std::move(bytes));
  co_await answer(stream_, std::move(finished));
}

net::awaitable<void> HttpSession::refuse_upload(Response response) {
  co_await answer(stream_, std::move(response));
  const WaitingRoom::Seat seat(site_.waiting, shared_from_this());
  waiting_ = true;
  co_await stream_.discard(kUnreadTime);
  waiting_ = false;
}

net::awaitable<bool> HttpSession::read_upload(HeaderParser& header, beast::flat_buffer& buffer,
                                              std::string& bytes) {
  const std::uint64_t length = *header.content_length();
  stream_.next_layer().expires_after(site_.settings.handshake_timeout +
                                     std::chrono::seconds(length / kSlowest));
  if (beast::iequals(header.get()[http::field::expect], "100-continue")) {
    http::response<http::empty_body> go_on{http::status::continue_, 11};
    const auto [refused, written] = co_await http::async_write(stream_, go_on, kAsTuple);
    if (refused) co_return false;
  }
  http::request_parser<http::string_body> parser(std::move(header));
  const auto [error, size] = co_await http::async_read(stream_, buffer, parser, kAsTuple);
  bytes = std::move(parser.get().body());
  co_return !error;
}

}  // namespace rimlight::server
