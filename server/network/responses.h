#pragma once

// Includes Beast: for the network layer's own .cpp files only.

#include <boost/beast/http/message.hpp>
#include <boost/beast/http/status.hpp>
#include <boost/beast/http/string_body.hpp>
#include <string>
#include <string_view>

#include "server/network/request_checks.h"

namespace rimlight::server {

using Response = boost::beast::http::response<boost::beast::http::string_body>;

/// A response with the headers that all have: what a browser may do with it.
Response make_response(boost::beast::http::status status, unsigned version, bool keep_alive,
                       const std::string& content_type, std::string body);
/// One line of text.
Response plain(const EmptyRequest& request, boost::beast::http::status status,
               std::string_view text);
/// 503, with Retry-After.
Response try_later(const EmptyRequest& request, std::string_view reason);
Response json_body(const EmptyRequest& request, boost::beast::http::status status,
                   std::string body);
/// Neither what is wrong with a token nor whether a session exists is a stranger's business.
Response refuse(const EmptyRequest& request, const Refusal& refusal);

}  // namespace rimlight::server
