#pragma once

#include <openssl/evp.h>
#include <openssl/hmac.h>

#include <algorithm>
#include <cstdint>
#include <string>
#include <string_view>

namespace rimlight::test {

inline std::string base64url(std::string_view bytes) {
  constexpr const char* kLetters =
      "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789-_";
  std::string text;
  std::uint32_t bits = 0;
  int count = 0;
  for (const char c : bytes) {
    bits = (bits << 8 | static_cast<unsigned char>(c)) & 0xffff;
    for (count += 8; count >= 6; count -= 6) text += kLetters[bits >> (count - 6) & 63];
  }
  if (count > 0) text += kLetters[bits << (6 - count) & 63];
  return text;
}

/// A JSON web token by the letter of RFC 7515, whatever its header and claims say: to compare with,
/// and to make what the server never would.
inline std::string signed_token(std::string_view header, std::string_view claims,
                                std::string_view secret, const EVP_MD* hash = EVP_sha256()) {
  const std::string signed_part = base64url(header) + "." + base64url(claims);
  unsigned char code[EVP_MAX_MD_SIZE];
  unsigned size = 0;
  HMAC(hash, secret.data(), static_cast<int>(secret.size()),
       reinterpret_cast<const unsigned char*>(signed_part.data()), signed_part.size(), code, &size);
  return signed_part + "." + base64url({reinterpret_cast<const char*>(code), size});
}

}  // namespace rimlight::test
