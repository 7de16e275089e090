#include "server/network/transport.h"

#include <boost/asio/as_tuple.hpp>
#include <boost/asio/use_awaitable.hpp>
#include <vector>

namespace rimlight::server {
namespace {

namespace beast = boost::beast;
namespace net = boost::asio;

constexpr auto kAsTuple = net::as_tuple(net::use_awaitable);

}  // namespace

net::awaitable<beast::error_code> Transport::accept() {
  Secure* const layered = secure();
  if (layered == nullptr) co_return beast::error_code();
  const auto [error] = co_await layered->async_handshake(net::ssl::stream_base::server, kAsTuple);
  co_return error;
}

net::awaitable<void> Transport::finish(std::chrono::steady_clock::duration most) {
  beast::error_code ignored;
  if (Secure* const layered = secure()) {
    next_layer().expires_after(most);
    co_await layered->async_shutdown(kAsTuple);
  }
  next_layer().socket().shutdown(net::ip::tcp::socket::shutdown_send, ignored);
}

net::awaitable<void> Transport::discard(std::chrono::steady_clock::duration most) {
  constexpr std::size_t kMost = std::size_t{64} << 20;
  std::vector<char> buffer(65536);
  beast::error_code ignored;
  next_layer().expires_after(most);
  if (secure() == nullptr) {
    next_layer().socket().shutdown(net::ip::tcp::socket::shutdown_send, ignored);
  }
  for (std::size_t read = 0; read < kMost;) {
    const auto [error, size] = co_await async_read_some(net::buffer(buffer), kAsTuple);
    if (error) break;
    read += size;
  }
}

}  // namespace rimlight::server
