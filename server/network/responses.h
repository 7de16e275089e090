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
Response json_body(const EmptyRequest& request, boost::beast::http::status status,
                   std::string body);

}  // namespace rimlight::server
