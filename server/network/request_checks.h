#pragma once

// Includes Beast: for the network layer's own .cpp files only.

#include <boost/beast/http/empty_body.hpp>
#include <boost/beast/http/message.hpp>
#include <boost/beast/http/status.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <variant>

#include "core/base/error.h"
#include "server/access/access_token.h"
#include "server/access/host_policy.h"
#include "server/metrics/outcomes.h"

namespace rimlight::server {

using EmptyRequest = boost::beast::http::request<boost::beast::http::empty_body>;

/// Why a request is not answered, in words that tell a stranger nothing.
struct Refusal {
  boost::beast::http::status status;
  std::string reason;
  RefusalReason why;
  std::string detail = {};  // for the log: what a stranger is not told
};

/// Why a session cannot be opened or read.
Refusal refusal_of(const Error& error);

/// Whether a body follows a request's header, and what for.
enum class Body { none, upload, echoed, unwanted };

/// What is wrong with a request whatever it asks for, known from its header alone: no Host or more
/// than one (400), one that is not this server's (421), a transfer coding other than chunked (400),
/// or a body that is unwanted (400).
std::optional<Refusal> request_fault(const EmptyRequest& request, Body body,
                                     const HostPolicy& hosts);

/// 403 for a WebSocket from a page of another origin. Other programs than browsers send none.
std::optional<Refusal> origin_fault(const EmptyRequest& request, const HostPolicy& hosts);

/// What the request may do: an owner's everything when `keys` is null; else what its token says, of
/// `Authorization: Bearer` or else `token`, of the query. 401 for a token that is missing or not
/// believed, 403 for one of another session than `session`, when that is not empty.
std::variant<Access, Refusal> admit(const EmptyRequest& request, const std::string& token,
                                    std::string_view session, const SigningKeys* keys);

/// Who may read what the server says of itself as a whole: as admit(), and 403 for any but an owner
/// of all sessions.
std::variant<Access, Refusal> admit_operator(const EmptyRequest& request, const SigningKeys* keys);

}  // namespace rimlight::server
