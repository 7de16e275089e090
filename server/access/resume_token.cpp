#include "server/access/resume_token.h"

#include <openssl/rand.h>
#include <openssl/sha.h>

#include <algorithm>
#include <array>
#include <span>

#include "core/base/error.h"

namespace rimlight::server {
namespace {

constexpr std::string_view kDigits = "0123456789abcdef";

std::string in_base_16(std::span<const unsigned char> bytes) {
  std::string text;
  for (const unsigned char byte : bytes) {
    text += kDigits[byte >> 4];
    text += kDigits[byte & 15];
  }
  return text;
}

}  // namespace

bool is_resume_token(std::string_view text) {
  return text.size() == kResumeTokenDigits && text.find_first_not_of(kDigits) == text.npos;
}

std::string make_resume_token() {
  std::array<unsigned char, kResumeTokenDigits / 2> bytes;
  if (RAND_bytes(bytes.data(), static_cast<int>(bytes.size())) != 1) {
    throw Error("resume token", "no random numbers", "a generator that works");
  }
  return in_base_16(bytes);
}

std::string resume_token_hash(std::string_view token) {
  std::array<unsigned char, SHA256_DIGEST_LENGTH> hash;
  SHA256(reinterpret_cast<const unsigned char*>(token.data()), token.size(), hash.data());
  return in_base_16(hash);
}

}  // namespace rimlight::server
