#include "server/network/request_checks.h"

#include <boost/beast/core/string.hpp>
#include <boost/beast/http/field.hpp>

#include "core/base/error.h"
#include "server/store/session_store.h"

namespace rimlight::server {
namespace {

namespace beast = boost::beast;
namespace http = beast::http;

std::string_view view(beast::string_view text) { return {text.data(), text.size()}; }

/// Of the one Authorization header; empty when there is none, or none of the scheme Bearer.
std::string bearer_token(const EmptyRequest& request) {
  constexpr std::string_view kScheme = "Bearer ";
  if (request.count(http::field::authorization) != 1) return {};
  const beast::string_view value = request[http::field::authorization];
  if (!beast::iequals(value.substr(0, kScheme.size()), {kScheme.data(), kScheme.size()})) return {};
  return std::string(view(value.substr(kScheme.size())));
}

}  // namespace

Refusal refusal_of(const Error& error) {
  if (dynamic_cast<const StoreError*>(&error) != nullptr) {
    return {http::status::service_unavailable, error.what(), RefusalReason::store, error.what()};
  }
  return {http::status::not_found, error.what(), RefusalReason::not_found, error.what()};
}

std::optional<Refusal> request_fault(const EmptyRequest& request, Body body,
                                     const HostPolicy& hosts) {
  if (request.count(http::field::host) != 1) {
    return Refusal{http::status::bad_request, "exactly one Host header is needed",
                   RefusalReason::host};
  }
  if (!hosts.allows_host(view(request[http::field::host]))) {
    return Refusal{http::status::misdirected_request, "this server has another name",
                   RefusalReason::host};
  }
  // Who does not know a coding cannot know where the request ends (RFC 9112, 6.1).
  const auto coding = request.find(http::field::transfer_encoding);
  if (coding != request.end() && !beast::iequals(coding->value(), "chunked")) {
    return Refusal{http::status::bad_request, "an unknown transfer coding",
                   RefusalReason::malformed};
  }
  if (body == Body::unwanted) {
    return Refusal{http::status::bad_request, "a body is not taken", RefusalReason::body};
  }
  return std::nullopt;
}

std::optional<Refusal> origin_fault(const EmptyRequest& request, const HostPolicy& hosts) {
  const std::size_t count = request.count(http::field::origin);
  if (count == 0) return std::nullopt;
  if (count == 1 &&
      hosts.allows_origin(view(request[http::field::origin]), view(request[http::field::host]))) {
    return std::nullopt;
  }
  return Refusal{http::status::forbidden, "the page comes from another origin",
                 RefusalReason::origin};
}

std::variant<Access, Refusal> admit(const EmptyRequest& request, const std::string& token,
                                    std::string_view session, const SigningKeys* keys) {
  if (keys == nullptr) {
    return Access{Role::owner, std::string(Access::kAnySession), {}, WallClock::time_point::max()};
  }
  const std::string shown =
      request.count(http::field::authorization) > 0 ? bearer_token(request) : token;
  const auto unknown = [](const char* detail) {
    return Refusal{http::status::unauthorized, "a valid access token is needed",
                   RefusalReason::token, detail};
  };
  if (shown.empty()) return unknown("missing");
  auto checked = check_token(shown, *keys, WallClock::now());
  if (const auto* const fault = std::get_if<TokenFault>(&checked)) {
    return unknown(to_string(*fault));
  }
  Access& access = std::get<Access>(checked);
  if (!session.empty() && !access.opens(session)) {
    return Refusal{http::status::forbidden, "the access token is not for this",
                   RefusalReason::forbidden, "of another session"};
  }
  return std::move(access);
}

std::variant<Access, Refusal> admit_operator(const EmptyRequest& request, const SigningKeys* keys) {
  auto admitted = admit(request, {}, {}, keys);
  if (const auto* const access = std::get_if<Access>(&admitted)) {
    if (access->role < Role::owner || access->session != Access::kAnySession) {
      return Refusal{http::status::forbidden, "the access token is not for this",
                     RefusalReason::forbidden, "not of an owner of all sessions"};
    }
  }
  return admitted;
}

}  // namespace rimlight::server
