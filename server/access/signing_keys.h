#pragma once

#include <cstddef>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

namespace rimlight::server {

/// Whoever has the secret can make tokens that the server believes.
struct SigningKey {
  std::string id;      // a valid name; a token says by it which key signed it
  std::string secret;  // bytes, kShortestSecret to kLongestSecret
};

/// RFC 7518, 3.2: a key of HS256 has at least as many bits as the hash.
constexpr std::size_t kShortestSecret = 32;
constexpr std::size_t kLongestSecret = 1024;
constexpr std::size_t kMostKeys = 16;

/// The keys that tokens may be signed with. The first signs new ones; the others are still
/// believed, so that keys can be replaced without a break. Immutable; any thread.
class SigningKeys {
 public:
  /// Throws Error: no key, more than kMostKeys, an id that is no name or is there twice, a secret
  /// that is too short or too long. Errors never contain a secret.
  explicit SigningKeys(std::vector<SigningKey> keys);

  const SigningKey& newest() const { return keys_.front(); }
  /// Null when there is none of that id.
  const SigningKey* find(std::string_view id) const;

 private:
  std::vector<SigningKey> keys_;
};

/// Reads a JWK set (RFC 7517, 5) of symmetric keys:
///   {"keys": [{"kty": "oct", "alg": "HS256", "kid": "2026-11", "k": "BASE64URL"}]}
/// Throws Error naming the file: not a regular file, another's than this user's or root's, one that
/// group or others may read or write, malformed, or keys that SigningKeys refuses.
SigningKeys read_signing_keys(const std::filesystem::path& file);

/// Writes a JWK set of one new random key that only this user may read. Throws Error when the file
/// is there already, the id is no valid name, or the disk refuses.
void make_key_file(const std::filesystem::path& file, const std::string& id);

}  // namespace rimlight::server
