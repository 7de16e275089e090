#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace rimlight::server {

/// Which names a request may call this server by, and which pages may open a WebSocket to it.
///
/// A page of another site can give its own name the address of this server (DNS rebinding); its
/// requests then look like the server's own, but for the name in Host. So names must be known; an
/// address in digits cannot be made to mean another machine. Immutable; any thread.
class HostPolicy {
 public:
  enum class Reach { loopback, network };
  /// On loopback: localhost and loopback addresses; else: any address in digits, and localhost.
  /// `names` are allowed besides, without port ("design.example.com"); `origins` besides the
  /// server's own, whole ("https://design.example.com"). Throws Error for anything else in them.
  HostPolicy(Reach reach, std::vector<std::string> names, std::vector<std::string> origins);

  /// `host` as in the header: a name or an address, in brackets when it is of IPv6, perhaps a port.
  bool allows_host(std::string_view host) const;
  /// `origin` as in the header; the own one is that of Host, whether by http or, behind a proxy,
  /// https.
  bool allows_origin(std::string_view origin, std::string_view host) const;

 private:
  Reach reach_;
  std::vector<std::string> names_;    // in lower case
  std::vector<std::string> origins_;  // in lower case
};

}  // namespace rimlight::server
