#pragma once

#include <chrono>
#include <cstddef>
#include <string>
#include <string_view>
#include <variant>

#include "server/access/signing_keys.h"

namespace rimlight::server {

enum class Role { viewer, editor, owner };  // each may do what those before it may

const char* to_string(Role role);
/// Throws Error naming `where`.
Role parse_role(std::string_view text, const std::string& where);

using WallClock = std::chrono::system_clock;

/// What a token allows.
struct Access {
  Role role = Role::viewer;
  std::string session;  // its name, or kAnySession
  std::string name;     // of the person, for attribution; may be empty
  WallClock::time_point expires;

  bool opens(std::string_view other) const { return session == kAnySession || session == other; }
  static constexpr std::string_view kAnySession = "*";
};

/// Why a token is not believed: for the operator's log, never for who showed it.
enum class TokenFault { malformed, unknown_key, forged, bad_claims, expired, from_the_future };
const char* to_string(TokenFault fault);

constexpr std::size_t kLongestToken = 1024;
constexpr std::size_t kLongestPersonName = 64;  // bytes of UTF-8
/// How far the clocks of who signs and who checks may differ.
constexpr std::chrono::seconds kClockSkew{60};
constexpr std::chrono::hours kLongestLife{24 * 366};

/// A JSON web token (RFC 7519) with HS256, signed by the newest key. Claims: role, session, exp,
/// iat and, when there is one, name. Throws Error: an invalid session or person's name, or an
/// expiry that is not after `now` or further than kLongestLife.
std::string issue_token(const Access& access, const SigningKeys& keys, WallClock::time_point now);

/// Checks size and alphabet before anything is parsed, and that the algorithm is HS256 and no
/// other; the signature is compared in constant time. exp and iat may be off by kClockSkew. Every
/// byte of a token counts. Any thread; never throws for what a token contains.
std::variant<Access, TokenFault> check_token(const std::string& token, const SigningKeys& keys,
                                             WallClock::time_point now);

}  // namespace rimlight::server
