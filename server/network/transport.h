#pragma once

// Includes Beast: for the network layer's own .cpp files, and `rimlight load`'s.

#include <boost/asio/awaitable.hpp>
#include <boost/asio/ssl/context.hpp>
#include <boost/beast/core/tcp_stream.hpp>
#include <boost/beast/ssl/ssl_stream.hpp>
#include <boost/beast/websocket/ssl.hpp>
#include <chrono>
#include <utility>
#include <variant>

namespace rimlight::server {

/// One socket's bytes, in the clear or under TLS: what HTTP and WebSocket read and write, so that
/// both have one class whichever it is. Which one costs a branch for each operation; in the clear
/// nothing is copied. A model of Beast's AsyncStream; deadlines are those of next_layer(). On its
/// socket's strand.
class Transport {
 public:
  using Plain = boost::beast::tcp_stream;
  using Secure = boost::beast::ssl_stream<Plain>;
  using next_layer_type = Plain;
  using executor_type = Plain::executor_type;

  explicit Transport(Plain stream) : stream_(std::move(stream)) {}
  Transport(Plain stream, boost::asio::ssl::context& context)
      : stream_(std::in_place_type<Secure>, std::move(stream), context) {}

  executor_type get_executor() noexcept { return next_layer().get_executor(); }
  Plain& next_layer() noexcept {
    Secure* const layered = secure();
    return layered == nullptr ? *std::get_if<Plain>(&stream_) : layered->next_layer();
  }
  const Plain& next_layer() const noexcept { return const_cast<Transport*>(this)->next_layer(); }
  /// Null in the clear.
  Secure* secure() noexcept { return std::get_if<Secure>(&stream_); }

  /// The server's side of TLS' handshake, within the deadline of next_layer(); at once in the
  /// clear. An error when the peer speaks something else, or not in time.
  boost::asio::awaitable<boost::beast::error_code> accept();
  /// Says goodbye, within that time; the socket is closed by its destructor.
  boost::asio::awaitable<void> finish(std::chrono::steady_clock::duration most);

  /// Reads what still comes and forgets it, for that long at most: a socket that is closed on
  /// unread bytes resets, and the peer may lose what it was told.
  boost::asio::awaitable<void> discard(std::chrono::steady_clock::duration most);

  template <typename Buffers, typename Handler>
  auto async_read_some(const Buffers& buffers, Handler&& handler) {
    Secure* const layered = secure();
    if (layered != nullptr) {
      return layered->async_read_some(buffers, std::forward<Handler>(handler));
    }
    return std::get_if<Plain>(&stream_)->async_read_some(buffers, std::forward<Handler>(handler));
  }
  template <typename Buffers, typename Handler>
  auto async_write_some(const Buffers& buffers, Handler&& handler) {
    Secure* const layered = secure();
    if (layered != nullptr) {
      return layered->async_write_some(buffers, std::forward<Handler>(handler));
    }
    return std::get_if<Plain>(&stream_)->async_write_some(buffers, std::forward<Handler>(handler));
  }

 private:
  std::variant<Plain, Secure> stream_;
};

/// What Beast calls, by its argument's type, at the end of a WebSocket.
template <typename Handler>
void async_teardown(boost::beast::role_type role, Transport& stream, Handler&& handler) {
  using boost::beast::async_teardown;
  using boost::beast::websocket::async_teardown;
  if (Transport::Secure* const layered = stream.secure()) {
    async_teardown(role, *layered, std::forward<Handler>(handler));
  } else {
    async_teardown(role, stream.next_layer(), std::forward<Handler>(handler));
  }
}

}  // namespace rimlight::server
