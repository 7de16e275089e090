#pragma once

#include <cstddef>
#include <map>
#include <mutex>
#include <string>

namespace rimlight::server {

/// Counts the open sockets of each address. Any thread.
class AddressLimit {
 public:
  /// How many there are now, this one among them. Each enter() wants one leave().
  std::size_t enter(const std::string& address);
  void leave(const std::string& address);
  /// Of addresses with at least one socket: nothing is kept of the others.
  std::size_t size() const;

 private:
  mutable std::mutex mutex_;
  std::map<std::string, std::size_t> open_;
};

/// Whom to count together: an IPv4 address alone, however it is written, or the network of 64 bits
/// that an IPv6 address lies in, since one subscriber has all of it. Anything else is its own.
std::string counted_address(const std::string& address);

}  // namespace rimlight::server
