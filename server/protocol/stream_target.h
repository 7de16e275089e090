#pragma once

#include <string>
#include <string_view>

namespace rimlight::server {

/// Sessions and scenes have names of 1 to 64 of [A-Za-z0-9._-].
bool is_valid_name(std::string_view name);

/// What the target of a WebSocket request asks for:
/// /sessions/{session}/stream?scene={scene}&token={token}.
struct StreamTarget {
  std::string session;
  std::string scene{};  // empty: the default one
  std::string token{};  // as it was given; empty without one

  friend bool operator==(const StreamTarget&, const StreamTarget&) = default;
};

/// Throws Error: another path, an invalid name, or an unknown parameter; it never contains what was
/// found in the parameters, which may be a secret. Names and tokens never need percent-encoding, so
/// that '%' is refused in names like any other character outside the set.
StreamTarget parse_stream_target(std::string_view target);

}  // namespace rimlight::server
