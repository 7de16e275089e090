#include "server/network/responses.h"

namespace rimlight::server {
namespace {

namespace http = boost::beast::http;

/// Everything comes from here: no other origin is asked for anything.
constexpr const char* kContentPolicy =
    "default-src 'self'; img-src 'self' blob:; object-src 'none'; base-uri 'none'; "
    "frame-ancestors 'none'; form-action 'none'";

}  // namespace

Response make_response(http::status status, unsigned version, bool keep_alive,
                       const std::string& content_type, std::string body) {
  Response response{status, version};
  response.set(http::field::content_type, content_type);
  response.set(http::field::cache_control, "no-cache");
  response.set("X-Content-Type-Options", "nosniff");
  response.set("Referrer-Policy", "no-referrer");
  response.set("Content-Security-Policy", kContentPolicy);
  response.keep_alive(keep_alive);
  response.body() = std::move(body);
  response.prepare_payload();
  return response;
}

Response plain(const EmptyRequest& request, http::status status, std::string_view text) {
  return make_response(status, request.version(), request.keep_alive(), "text/plain; charset=utf-8",
                       std::string(text) + "\n");
}

Response json_body(const EmptyRequest& request, http::status status, std::string body) {
  return make_response(status, request.version(), request.keep_alive(), "application/json",
                       std::move(body));
}

}  // namespace rimlight::server
