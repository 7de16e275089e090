#include "server/access/address_limit.h"

#include <arpa/inet.h>

namespace rimlight::server {

std::size_t AddressLimit::enter(const std::string& address) {
  const std::lock_guard lock(mutex_);
  return ++open_[address];
}

void AddressLimit::leave(const std::string& address) {
  const std::lock_guard lock(mutex_);
  const auto found = open_.find(address);
  if (found != open_.end() && --found->second == 0) open_.erase(found);
}

std::size_t AddressLimit::size() const {
  const std::lock_guard lock(mutex_);
  return open_.size();
}

std::string counted_address(const std::string& address) {
  in6_addr v6{};
  if (::inet_pton(AF_INET6, address.c_str(), &v6) != 1) return address;
  char text[INET6_ADDRSTRLEN];
  if (IN6_IS_ADDR_V4MAPPED(&v6)) {
    return ::inet_ntop(AF_INET, &v6.s6_addr[12], text, sizeof text);
  }
  for (std::size_t i = 8; i < 16; ++i) v6.s6_addr[i] = 0;
  return ::inet_ntop(AF_INET6, &v6, text, sizeof text) + std::string("/64");
}

}  // namespace rimlight::server
