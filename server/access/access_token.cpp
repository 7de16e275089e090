#include "server/access/access_token.h"

#include <jwt.h>

#include <algorithm>
#include <cstdlib>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>

#include "core/base/error.h"
#include "core/base/json_reader.h"
#include "server/protocol/stream_target.h"

namespace rimlight::server {
namespace {

using Token = std::unique_ptr<jwt_t, decltype(&jwt_free)>;
using CText = std::unique_ptr<char, decltype(&std::free)>;
using std::chrono::duration_cast;
using std::chrono::seconds;

constexpr std::int64_t kLatestSecond =
    9'000'000'000;  // in 2255: nanoseconds since 1970 end in 2262

const unsigned char* bytes_of(const SigningKey& key) {
  return reinterpret_cast<const unsigned char*>(key.secret.data());
}

/// Null when libjwt refuses; without a key the signature is not looked at.
Token decode(const std::string& token, const SigningKey* key) {
  jwt_t* decoded = nullptr;
  const int failure = jwt_decode(&decoded, token.c_str(), key ? bytes_of(*key) : nullptr,
                                 key ? static_cast<int>(key->secret.size()) : 0);
  return {failure == 0 ? decoded : nullptr, &jwt_free};
}

/// Empty when there is none; keys' ids never are.
std::string_view header_of(jwt_t& token, const char* name) {
  const char* const text = jwt_get_header(&token, name);
  return text == nullptr ? std::string_view() : text;
}

/// Three parts of base64url, as RFC 7515 has them: libjwt takes more than that.
bool has_token_form(std::string_view token) {
  const auto is_expected = [](char c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '-' ||
           c == '_' || c == '.';
  };
  return token.size() <= kLongestToken && std::ranges::all_of(token, is_expected) &&
         std::ranges::count(token, '.') == 2 && !token.starts_with('.') && !token.ends_with('.') &&
         token.find("..") == std::string_view::npos;
}

bool is_person_name(std::string_view name) {
  const auto is_control = [](char c) { return static_cast<unsigned char>(c) < 0x20 || c == 0x7f; };
  return name.size() <= kLongestPersonName && std::ranges::none_of(name, is_control);
}

bool is_session(std::string_view session) {
  return session == Access::kAnySession || is_valid_name(session);
}

WallClock::time_point time_of(const JsonReader& claim) {
  return WallClock::time_point(seconds(claim.integer(0, kLatestSecond)));
}

struct Claims {
  Access access;
  WallClock::time_point issued;
};

/// Throws Error when a claim is missing, unknown or malformed.
Claims parse_claims(const std::string& text) {
  const nlohmann::json document = parse_json(text, "token");
  const JsonReader reader(document, "token");
  reader.allow_only({"role", "session", "name", "exp", "iat"});
  Claims claims;
  claims.access.role = parse_role(reader.member("role").string(), "token");
  claims.access.session = reader.member("session").string();
  if (const auto name = reader.optional_member("name")) claims.access.name = name->string();
  if (!is_session(claims.access.session) || !is_person_name(claims.access.name)) {
    throw Error("token", "a name", "a valid one");
  }
  claims.access.expires = time_of(reader.member("exp"));
  claims.issued = time_of(reader.member("iat"));
  return claims;
}

std::optional<Claims> claims_of(jwt_t& token) {
  const CText text(jwt_get_grants_json(&token, nullptr), &std::free);
  if (!text) return std::nullopt;
  try {
    return parse_claims(text.get());
  } catch (const Error&) {
    return std::nullopt;
  }
}

void check(bool done) {
  if (!done) throw Error("token", "a library that refuses", "memory for a token");
}

void check_issuable(const Access& access, WallClock::time_point now) {
  if (!is_session(access.session)) {
    throw Error("token", "the session " + quote(access.session),
                "* for any, or 1 to 64 of A-Z a-z 0-9 . _ -");
  }
  if (!is_person_name(access.name)) {
    throw Error("token", "the name " + quote(access.name),
                "at most 64 bytes without control characters");
  }
  if (!(access.expires > now) || access.expires - now > kLongestLife) {
    throw Error("token", "its expiry", "one after now, and within 366 days");
  }
}

long seconds_of(WallClock::time_point time) {
  return static_cast<long>(duration_cast<seconds>(time.time_since_epoch()).count());
}

}  // namespace

const char* to_string(Role role) {
  constexpr const char* kNames[] = {"viewer", "editor", "owner"};
  return kNames[static_cast<int>(role)];
}

Role parse_role(std::string_view text, const std::string& where) {
  for (const Role role : {Role::viewer, Role::editor, Role::owner}) {
    if (text == to_string(role)) return role;
  }
  throw Error(where, "the role " + quote(text), "viewer, editor or owner");
}

const char* to_string(TokenFault fault) {
  constexpr const char* kNames[] = {"malformed",         "of an unknown key", "forged",
                                    "with other claims", "expired",           "from the future"};
  return kNames[static_cast<int>(fault)];
}

std::string issue_token(const Access& access, const SigningKeys& keys, WallClock::time_point now) {
  check_issuable(access, now);
  const SigningKey& key = keys.newest();
  jwt_t* made = nullptr;
  check(jwt_new(&made) == 0);
  const Token token(made, &jwt_free);
  check(jwt_set_alg(made, JWT_ALG_HS256, bytes_of(key), static_cast<int>(key.secret.size())) == 0);
  check(jwt_add_header(made, "kid", key.id.c_str()) == 0);
  check(jwt_add_grant(made, "role", to_string(access.role)) == 0);
  check(jwt_add_grant(made, "session", access.session.c_str()) == 0);
  if (!access.name.empty()) check(jwt_add_grant(made, "name", access.name.c_str()) == 0);
  check(jwt_add_grant_int(made, "exp", seconds_of(access.expires)) == 0);
  check(jwt_add_grant_int(made, "iat", seconds_of(now)) == 0);
  const CText text(jwt_encode_str(made), &std::free);
  check(text != nullptr);
  std::string issued = text.get();
  check(std::holds_alternative<Access>(check_token(issued, keys, now)));
  return issued;
}

std::variant<Access, TokenFault> check_token(const std::string& token, const SigningKeys& keys,
                                             WallClock::time_point now) {
  if (!has_token_form(token)) return TokenFault::malformed;
  const Token unverified = decode(token, nullptr);  // only to know which key
  if (!unverified || header_of(*unverified, "alg") != "HS256") return TokenFault::malformed;
  const SigningKey* const key = keys.find(header_of(*unverified, "kid"));
  if (key == nullptr) return TokenFault::unknown_key;
  const Token verified = decode(token, key);
  if (!verified || jwt_get_alg(verified.get()) != JWT_ALG_HS256) return TokenFault::forged;
  const std::optional<Claims> claims = claims_of(*verified);
  if (!claims) return TokenFault::bad_claims;
  if (claims->issued > now + kClockSkew) return TokenFault::from_the_future;
  if (!(now < claims->access.expires + kClockSkew)) return TokenFault::expired;
  return claims->access;
}

}  // namespace rimlight::server
