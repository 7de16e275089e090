// The part of Connection that writes.

#include <array>
#include <boost/asio/as_tuple.hpp>
#include <boost/asio/co_spawn.hpp>
#include <boost/asio/dispatch.hpp>
#include <boost/asio/post.hpp>
#include <boost/asio/use_awaitable.hpp>
#include <string>
#include <utility>

#include "server/network/connection.h"

namespace rimlight::server {
namespace {

namespace net = boost::asio;

constexpr auto kAsTuple = net::as_tuple(net::use_awaitable);

}  // namespace

// Runs at once when called on the strand, so that a reply counts before the next read.
void Connection::send_text(std::string text) {
  net::dispatch(socket_.get_executor(),
                [self = shared_from_this(), text = std::move(text)]() mutable {
                  if (self->ending_) return;
                  if (self->texts_.size() >= kTooManyTexts) {
                    self->abort(CloseReason::not_reading);
                    return;
                  }
                  self->texts_.push_back(std::move(text));
                  self->write_soon();
                });
}

// Posted, so that an edit is counted before its answer is, however soon that comes.
void Connection::send_answer(std::string text) {
  net::post(socket_.get_executor(), [self = shared_from_this(), text = std::move(text)]() mutable {
    --self->unanswered_;
    self->send_text(std::move(text));
  });
}

void Connection::send_state(std::string text) { replace(&Connection::state_, std::move(text)); }

void Connection::send_presence(std::string text) {
  replace(&Connection::presence_, std::move(text));
}

void Connection::send_snapshots(std::string text) {
  replace(&Connection::snapshots_, std::move(text));
}

void Connection::replace(std::optional<std::string> Connection::*waiting, std::string text) {
  net::dispatch(socket_.get_executor(),
                [self = shared_from_this(), waiting, text = std::move(text)]() mutable {
                  (*self).*waiting = std::move(text);
                  self->write_soon();
                });
}

void Connection::send_off(std::string text) {
  net::dispatch(socket_.get_executor(),
                [self = shared_from_this(), text = std::move(text)]() mutable {
                  if (self->ending_) return;
                  self->texts_.push_back(std::move(text));
                  self->is_sent_off_ = true;
                  self->write_soon();
                });
}

void Connection::send_frame(FramePtr frame) {
  net::dispatch(socket_.get_executor(),
                [self = shared_from_this(), frame = std::move(frame)]() mutable {
                  self->frame_ = std::move(frame);
                  self->write_soon();
                });
}

/// Posted: the sender may hold its session's lock, and must not be the one to write.
void Connection::write_soon() {
  if (!open_ || ending_ || std::exchange(writing_, true)) return;
  net::post(socket_.get_executor(), [self = shared_from_this()] {
    net::co_spawn(self->socket_.get_executor(), self->write_waiting(),
                  [self](const std::exception_ptr&) {});
  });
}

/// Replies, then the newest of the rest.
std::optional<std::string> Connection::next_text() {
  if (!texts_.empty()) {
    std::string text = std::move(texts_.front());
    texts_.pop_front();
    if (texts_.size() + unanswered_ < kMostTexts) room_.cancel();
    return text;
  }
  for (const auto waiting :
       {&Connection::state_, &Connection::presence_, &Connection::snapshots_}) {
    if (this->*waiting) return std::exchange(this->*waiting, std::nullopt);
  }
  return std::nullopt;
}

/// Writes what waits: replies, then the state, then the frame. After a failed write `writing_`
/// stays set: nothing more goes to a broken socket.
net::awaitable<void> Connection::write_waiting() {
  while (!ending_) {
    bool written = false;
    if (const std::optional<std::string> text = next_text()) {
      written = co_await write_text(*text);
    } else if (is_sent_off_) {
      close(CloseReason::session_deleted);
      break;
    } else if (const FramePtr frame = std::exchange(frame_, nullptr)) {
      written = co_await write_frame(*frame);
    } else {
      break;
    }
    if (!written) co_return;
  }
  writing_ = false;
}

net::awaitable<bool> Connection::write_text(std::string_view text) {
  socket_.text(true);
  const auto [error, size] = co_await socket_.async_write(net::buffer(text), kAsTuple);
  if (error) co_return false;
  settings_.metrics->sent(ServerMetrics::Content::text, size);
  co_return true;
}

/// Header and image from where they are: the image is shared.
net::awaitable<bool> Connection::write_frame(const FrameMessage& frame) {
  socket_.text(false);
  const auto body = frame.body();
  const std::array<net::const_buffer, 2> bytes{net::buffer(frame.head),
                                               net::buffer(body.data(), body.size())};
  const auto [error, size] = co_await socket_.async_write(bytes, kAsTuple);
  if (error) co_return false;
  settings_.metrics->sent(ServerMetrics::Content::frame, size);
  co_return true;
}

}  // namespace rimlight::server
