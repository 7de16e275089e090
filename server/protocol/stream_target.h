#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

namespace rimlight::server {

/// Sessions and scenes have names of 1 to 64 of [A-Za-z0-9._-].
bool is_valid_name(std::string_view name);

/// What the target of a WebSocket request asks for:
/// /sessions/{session}/stream?scene={scene}&token={token}&resume={resume}&seen={revision}&parts=1.
struct StreamTarget {
  std::string session;
  std::string scene{};                 // empty: the default one
  std::string token{};                 // as it was given; empty without one
  std::string resume{};                // a resume token; empty without one
  std::optional<std::int64_t> seen{};  // the number of the last revision that the client has
  bool parts = false;                  // it takes its first lossless frame in parts, too

  friend bool operator==(const StreamTarget&, const StreamTarget&) = default;
};

/// Throws Error: another path, an invalid name, or an unknown parameter; it never contains what was
/// found in the parameters, which may be a secret. Names and tokens never need percent-encoding, so
/// that '%' is refused in names like any other character outside the set.
StreamTarget parse_stream_target(std::string_view target);

/// Whether the path is one that parse_state_target() is for.
bool is_state_target(std::string_view target);
/// The same of the HTTP request for a session's state: /sessions/{session}/state?scene={scene}.
StreamTarget parse_state_target(std::string_view target);

}  // namespace rimlight::server
