#include "server/access/host_policy.h"

#include <arpa/inet.h>

#include <algorithm>
#include <optional>
#include <utility>

#include "core/base/error.h"

namespace rimlight::server {
namespace {

constexpr std::size_t kLongestHost = 253 + 6;  // of a name in DNS, and a port

bool is_digit(char c) { return c >= '0' && c <= '9'; }

std::string lower(std::string_view text) {
  std::string result(text);
  for (char& c : result) {
    if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
  }
  return result;
}

bool is_name(std::string_view text) {
  return !text.empty() && text.size() <= kLongestHost && std::ranges::all_of(text, [](char c) {
    return (c >= 'a' && c <= 'z') || is_digit(c) || c == '.' || c == '-' || c == '_';
  });
}

/// The host without its port, in lower case and without brackets; nothing when it is malformed.
struct HostParts {
  std::string name;
  bool is_bracketed = false;
};
std::optional<HostParts> split(std::string_view host) {
  if (host.empty() || host.size() > kLongestHost) return std::nullopt;
  HostParts parts;
  parts.is_bracketed = host.front() == '[';
  const std::size_t end = parts.is_bracketed ? host.find(']') : host.find(':');
  if (parts.is_bracketed && end == std::string_view::npos) return std::nullopt;
  const std::size_t first = parts.is_bracketed ? 1 : 0;
  parts.name = lower(host.substr(first, end == std::string_view::npos ? end : end - first));
  const std::size_t port = parts.is_bracketed ? end + 1 : std::min(end, host.size());
  if (port < host.size()) {
    const std::string_view digits = host.substr(port + 1);
    if (host[port] != ':' || digits.size() > 5 || !std::ranges::all_of(digits, is_digit)) {
      return std::nullopt;
    }
  }
  return parts;
}

/// In digits, of the family that the brackets say.
bool is_address(const HostParts& host, HostPolicy::Reach reach) {
  const bool any = reach == HostPolicy::Reach::network;
  if (host.is_bracketed) {
    in6_addr address{};
    return ::inet_pton(AF_INET6, host.name.c_str(), &address) == 1 &&
           (any || IN6_IS_ADDR_LOOPBACK(&address));
  }
  in_addr address{};
  return ::inet_pton(AF_INET, host.name.c_str(), &address) == 1 &&
         (any || ntohl(address.s_addr) >> 24 == 127);
}

std::string_view after_scheme(std::string_view origin) {
  for (const std::string_view scheme : {"http://", "https://"}) {
    if (origin.starts_with(scheme)) return origin.substr(scheme.size());
  }
  return {};
}

}  // namespace

HostPolicy::HostPolicy(Reach reach, std::vector<std::string> names,
                       std::vector<std::string> origins)
    : reach_(reach), names_(std::move(names)), origins_(std::move(origins)) {
  for (std::string& name : names_) {
    const std::string given = std::exchange(name, lower(name));
    if (!is_name(name)) {
      throw Error("host name", quote(given), "a name without port, as design.example.com");
    }
  }
  for (std::string& origin : origins_) {
    const std::string given = std::exchange(origin, lower(origin));
    const auto parts = split(after_scheme(origin));
    if (!parts ||
        (parts->is_bracketed ? !is_address(*parts, Reach::network) : !is_name(parts->name))) {
      throw Error("origin", quote(given), "scheme and host, as https://design.example.com");
    }
  }
}

bool HostPolicy::allows_host(std::string_view host) const {
  const auto parts = split(host);
  if (!parts) return false;
  if (is_address(*parts, reach_)) return true;
  if (parts->is_bracketed) return false;
  return parts->name == "localhost" || std::ranges::find(names_, parts->name) != names_.end();
}

bool HostPolicy::allows_origin(std::string_view origin, std::string_view host) const {
  const std::string given = lower(origin);
  const std::string_view own = after_scheme(given);
  return (!own.empty() && own == lower(host)) ||
         std::ranges::find(origins_, given) != origins_.end();
}

}  // namespace rimlight::server
