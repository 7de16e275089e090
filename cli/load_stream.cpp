#include "cli/load_stream.h"

#include <algorithm>
#include <boost/asio/connect.hpp>
#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/ssl/host_name_verification.hpp>
#include <boost/beast/core/flat_buffer.hpp>
#include <boost/beast/core/tcp_stream.hpp>
#include <boost/beast/http/string_body.hpp>
#include <boost/beast/websocket/rfc6455.hpp>
#include <boost/beast/websocket/stream.hpp>
#include <optional>
#include <utility>

#include "core/base/error.h"
#include "server/network/tls_context.h"
#include "server/network/transport.h"

namespace rimlight {
namespace {

namespace beast = boost::beast;
namespace net = boost::asio;
namespace websocket = beast::websocket;

constexpr std::chrono::seconds kSendTimeout{10};
/// A lossless frame of 16k × 16k would be larger, but no bake is.
constexpr std::size_t kLargestFrame = std::size_t{256} << 20;

}  // namespace

StreamUrl parse_stream_url(const std::string& url) {
  std::string_view rest = url;
  const auto fail = [&] { throw Error("--url", quote(url), "ws://HOST:PORT or wss://HOST:PORT"); };
  const bool is_secure = rest.starts_with("wss://");
  if (!is_secure && !rest.starts_with("ws://")) fail();
  rest.remove_prefix(rest.find("//") + 2);
  if (rest.ends_with('/')) rest.remove_suffix(1);
  const std::size_t colon = rest.rfind(':');
  const bool has_port = colon != std::string_view::npos && !rest.ends_with(']');
  StreamUrl result{std::string(rest.substr(0, has_port ? colon : rest.size())),
                   has_port    ? std::string(rest.substr(colon + 1))
                   : is_secure ? "443"
                               : "80",
                   is_secure};
  if (result.host.starts_with('[') && result.host.ends_with(']')) {
    result.host = result.host.substr(1, result.host.size() - 2);
  }
  const bool is_number = !result.port.empty() && result.port.size() <= 5 &&
                         std::all_of(result.port.begin(), result.port.end(),
                                     [](char c) { return c >= '0' && c <= '9'; });
  if (result.host.empty() || result.host.find_first_of("/?#@") != std::string::npos || !is_number) {
    fail();
  }
  return result;
}

struct StreamClient::State {
  State(const StreamUrl& url, const StreamPass& pass)
      : tls(url.secure ? server::client_tls(pass.authority) : nullptr),
        socket(tls ? server::Transport(beast::tcp_stream(context), *tls)
                   : server::Transport(beast::tcp_stream(context))) {}

  net::io_context context{1};
  std::shared_ptr<net::ssl::context> tls;
  websocket::stream<server::Transport, false> socket;
  beast::flat_buffer buffer;
  bool reading = false;  // a read is under way, over several calls of receive()
  std::optional<beast::error_code> read_result;
  bool closed = false;

  /// Runs handlers until `done` or the deadline.
  template <typename Done>
  bool run_until(Clock::time_point deadline, const Done& done) {
    context.restart();
    while (!done()) {
      if (context.run_one_until(deadline) == 0) {
        if (Clock::now() >= deadline) return done();
        context.restart();
      }
    }
    return true;
  }
  bool send(std::string_view bytes, bool is_text);
  void connect(const StreamUrl& url, const std::string& target, const StreamPass& pass,
               Clock::time_point deadline);
  beast::error_code handshake(const StreamUrl& url);
  [[noreturn]] void refuse(const std::string& where, const beast::error_code& error,
                           const websocket::response_type& response);
};

void StreamClient::State::refuse(const std::string& where, const beast::error_code& error,
                                 const websocket::response_type& response) {
  std::string found = error.message();
  if (error == websocket::error::upgrade_declined) {
    found = "HTTP status " + std::to_string(response.result_int());
    if (!response.body().empty()) found += ", " + quote(response.body());
  }
  throw Error(where, found, "a Rimlight server that takes the connection");
}

/// Of TLS: the certificate must be good, and of that host.
beast::error_code StreamClient::State::handshake(const StreamUrl& url) {
  server::Transport::Secure* const secure = socket.next_layer().secure();
  if (secure == nullptr) return {};
  SSL_set_tlsext_host_name(secure->native_handle(), url.host.c_str());
  std::optional<beast::error_code> result;
  secure->set_verify_callback(net::ssl::host_name_verification(url.host));
  secure->async_handshake(net::ssl::stream_base::client,
                          [&](beast::error_code error) { result = error; });
  run_until(Clock::time_point::max(), [&] { return result.has_value(); });
  return *result;
}

void StreamClient::State::connect(const StreamUrl& url, const std::string& target,
                                  const StreamPass& pass, Clock::time_point deadline) {
  const std::string authority = url.host + ":" + url.port;
  const std::string where = (url.secure ? "wss://" : "ws://") + authority + target;
  net::ip::tcp::resolver resolver(context);
  websocket::response_type response;
  std::optional<beast::error_code> result;
  const auto done = [&] { return result.has_value(); };
  const auto finish = [&](beast::error_code error) { result = error; };
  beast::error_code failure;
  const auto endpoints = resolver.resolve(url.host, url.port, failure);
  if (failure) refuse(where, failure, response);
  beast::tcp_stream& plain = beast::get_lowest_layer(socket);
  plain.expires_at(deadline);
  plain.async_connect(endpoints, [&](beast::error_code error, const auto&) { finish(error); });
  run_until(Clock::time_point::max(), done);
  if (*result) refuse(where, *result, response);
  beast::error_code ignored;
  plain.socket().set_option(net::ip::tcp::no_delay(true), ignored);
  if (const beast::error_code refused = handshake(url)) refuse(where, refused, response);
  if (!pass.token.empty()) {
    socket.set_option(websocket::stream_base::decorator([&](websocket::request_type& request) {
      request.set(beast::http::field::authorization, "Bearer " + pass.token);
    }));
  }
  socket.auto_fragment(false);
  socket.read_message_max(kLargestFrame);
  result.reset();
  socket.async_handshake(response, authority, target, finish);
  run_until(Clock::time_point::max(), done);
  if (*result) refuse(where, *result, response);
  plain.expires_never();
}

bool StreamClient::State::send(std::string_view bytes, bool is_text) {
  if (closed) return false;
  std::optional<beast::error_code> result;
  socket.text(is_text);
  socket.async_write(net::buffer(bytes.data(), bytes.size()),
                     [&](beast::error_code error, std::size_t) { result = error; });
  const auto done = [&] { return result.has_value(); };
  if (!run_until(Clock::now() + kSendTimeout, done)) {
    beast::get_lowest_layer(socket).close();  // ends the write, whose buffer must not outlive this
    run_until(Clock::time_point::max(), done);
  }
  if (*result) closed = true;
  return !closed;
}

StreamClient::StreamClient(const StreamUrl& url, const std::string& target, const StreamPass& pass,
                           std::chrono::milliseconds timeout)
    : state_(std::make_unique<State>(url, pass)) {
  state_->connect(url, target, pass, Clock::now() + timeout);
}

StreamClient::~StreamClient() = default;

StreamClient::Received StreamClient::receive(Clock::time_point deadline) {
  State& s = *state_;
  if (!s.reading && !s.closed) {
    s.reading = true;
    s.read_result.reset();
    s.buffer.clear();
    s.socket.async_read(s.buffer,
                        [&s](beast::error_code error, std::size_t) { s.read_result = error; });
  }
  if (s.reading && !s.run_until(deadline, [&s] { return s.read_result.has_value(); })) {
    return Nothing{};
  }
  s.reading = false;
  if (s.closed || *s.read_result) {
    s.closed = true;
    const websocket::close_reason& why = s.socket.reason();
    return Closed{why.code, why.code != 0   ? std::string(why.reason.c_str())
                            : s.read_result ? s.read_result->message()
                                            : std::string("closed")};
  }
  const auto bytes = s.buffer.cdata();
  const auto* const first = static_cast<const std::uint8_t*>(bytes.data());
  if (s.socket.got_text()) return Text{std::string(first, first + bytes.size())};
  return Binary{{first, first + bytes.size()}};
}

bool StreamClient::send_text(std::string_view text) { return state_->send(text, true); }

bool StreamClient::send_binary(std::string_view bytes) { return state_->send(bytes, false); }

void StreamClient::close() {
  State& s = *state_;
  if (s.closed) return;
  bool done = false;
  s.socket.async_close(websocket::close_code::normal, [&](beast::error_code) { done = true; });
  if (!s.run_until(Clock::now() + std::chrono::seconds(2), [&] { return done; })) {
    beast::get_lowest_layer(s.socket).close();
    s.run_until(Clock::now() + std::chrono::seconds(1), [&] { return done; });
  }
  s.closed = true;
}

}  // namespace rimlight
