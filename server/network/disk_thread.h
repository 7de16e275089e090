#pragma once

// Includes Asio: for the network layer's own .cpp files only.

#include <atomic>
#include <boost/asio/awaitable.hpp>
#include <boost/asio/co_spawn.hpp>
#include <boost/asio/use_awaitable.hpp>
#include <memory>
#include <type_traits>
#include <utility>

#include "server/network/http_session.h"

namespace rimlight::server {

/// Requests that may wait for the disk.
inline constexpr std::size_t kMostOpening = 32;

/// Runs work that may wait for a disk, away from the network's threads. Throws what it throws, and
/// StoreError when too much waits already.
template <typename Work>
boost::asio::awaitable<std::invoke_result_t<Work>> on_disk_thread(const Site& site, Work work) {
  using Result = std::invoke_result_t<Work>;
  const auto leave = [](std::atomic<std::size_t>* opening) { --*opening; };
  const std::unique_ptr<std::atomic<std::size_t>, decltype(leave)> place(&site.opening, leave);
  if (++site.opening > kMostOpening) {
    throw StoreError("server", "too many sessions that are being opened", "fewer; try again later");
  }
  // Named: GCC 12 destroys a temporary with captures twice when it is part of a co_await.
  auto run = [work = std::move(work)]() -> boost::asio::awaitable<Result> { co_return work(); };
  boost::asio::awaitable<Result> result =
      boost::asio::co_spawn(site.disk, std::move(run), boost::asio::use_awaitable);
  co_return co_await std::move(result);
}

}  // namespace rimlight::server
