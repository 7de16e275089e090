#include "server/access/signing_keys.h"

#include <fcntl.h>
#include <openssl/evp.h>
#include <openssl/rand.h>
#include <unistd.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <optional>

#include "core/base/error.h"
#include "core/base/json_reader.h"
#include "server/access/private_file.h"
#include "server/protocol/stream_target.h"

namespace rimlight::server {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kLargestFile = 64 * 1024;
constexpr const char* kFile = "a file of signing keys";
constexpr const char* kExpectedFile =
    "a JWK set, {\"keys\": [{\"kty\": \"oct\", \"alg\": \"HS256\", \"kid\": NAME, \"k\": SECRET}]}";

bool is_base64url(char c) {
  return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '-' ||
         c == '_';
}

/// The bytes of unpadded base64url; nothing when the text is none.
std::optional<std::string> from_base64url(std::string text) {
  if (text.size() % 4 == 1 || !std::ranges::all_of(text, is_base64url)) return std::nullopt;
  std::ranges::replace(text, '-', '+');
  std::ranges::replace(text, '_', '/');
  const std::size_t padding = (4 - text.size() % 4) % 4;
  text.append(padding, '=');
  std::string bytes(text.size() / 4 * 3, '\0');
  const int size = EVP_DecodeBlock(reinterpret_cast<unsigned char*>(bytes.data()),
                                   reinterpret_cast<const unsigned char*>(text.data()),
                                   static_cast<int>(text.size()));
  if (size < 0) return std::nullopt;
  bytes.resize(static_cast<std::size_t>(size) - padding);
  return bytes;
}

std::string to_base64url(const std::string& bytes) {
  std::string text((bytes.size() + 2) / 3 * 4 + 1, '\0');  // and the 0 that OpenSSL adds
  const int size = EVP_EncodeBlock(reinterpret_cast<unsigned char*>(text.data()),
                                   reinterpret_cast<const unsigned char*>(bytes.data()),
                                   static_cast<int>(bytes.size()));
  text.resize(static_cast<std::size_t>(size));
  while (text.ends_with('=')) text.pop_back();
  std::ranges::replace(text, '+', '-');
  std::ranges::replace(text, '/', '_');
  return text;
}

SigningKey parse_key(const JsonReader& reader) {
  reader.allow_only({"kty", "alg", "kid", "k", "use"});
  reader.member("kty").one_of({"oct"});
  if (const auto algorithm = reader.optional_member("alg")) algorithm->one_of({"HS256"});
  SigningKey key;
  key.id = reader.member("kid").string();
  const JsonReader secret = reader.member("k");
  // Not by the reader's own functions, whose errors show the value.
  const auto bytes = secret.is_string() ? from_base64url(secret.value().get<std::string>())
                                        : std::optional<std::string>();
  if (!bytes) throw Error(secret.where(), "something else", "a secret in base64url");
  key.secret = *bytes;
  return key;
}

void check_id(const std::string& where, const std::string& id) {
  if (!is_valid_name(id)) {
    throw Error(where, "the key id " + quote(id), "1 to 64 of A-Z a-z 0-9 . _ -");
  }
}

}  // namespace

SigningKeys::SigningKeys(std::vector<SigningKey> keys) : keys_(std::move(keys)) {
  if (keys_.empty() || keys_.size() > kMostKeys) {
    throw Error("signing keys", std::to_string(keys_.size()) + " keys",
                "1 to " + std::to_string(kMostKeys));
  }
  for (const SigningKey& key : keys_) {
    check_id("signing keys", key.id);
    if (find(key.id) != &key) throw Error("signing keys", quote(key.id) + " twice", "it once");
    if (key.secret.size() < kShortestSecret || key.secret.size() > kLongestSecret) {
      throw Error("signing key " + quote(key.id), std::to_string(key.secret.size()) + " bytes",
                  "a secret of 32 to 1024 bytes");
    }
  }
}

const SigningKey* SigningKeys::find(std::string_view id) const {
  const auto found = std::ranges::find(keys_, id, &SigningKey::id);
  return found == keys_.end() ? nullptr : &*found;
}

SigningKeys read_signing_keys(const fs::path& file) {
  const std::string text = read_private_file(file, kLargestFile, kFile);
  nlohmann::json document;
  try {
    document = parse_json(text, file.string());
  } catch (const Error&) {  // which may show a part of a secret
    throw Error(file.string(), "no JSON", kExpectedFile);
  }
  const JsonReader reader(document, file.string());
  if (!document.is_object() || !reader.has("keys")) {
    throw Error(file.string(), "something else", kExpectedFile);
  }
  reader.allow_only({"keys"});
  std::vector<SigningKey> keys;
  for (const JsonReader& key : reader.member("keys").elements(1, kMostKeys)) {
    if (!key.value().is_object()) throw Error(key.where(), "something else", kExpectedFile);
    keys.push_back(parse_key(key));
  }
  return SigningKeys(std::move(keys));
}

void make_key_file(const fs::path& file, const std::string& id) {
  check_id(file.string(), id);
  std::string secret(kShortestSecret, '\0');
  if (RAND_bytes(reinterpret_cast<unsigned char*>(secret.data()),
                 static_cast<int>(secret.size())) != 1) {
    throw Error(file.string(), "no random numbers", "the system's generator");
  }
  const nlohmann::json key{
      {"kty", "oct"}, {"alg", "HS256"}, {"kid", id}, {"k", to_base64url(secret)}};
  const std::string text = nlohmann::json{{"keys", {key}}}.dump(2) + "\n";
  const Descriptor descriptor(file, O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, kFile);
  const ssize_t written = ::write(descriptor.number(), text.data(), text.size());
  if (written != static_cast<ssize_t>(text.size()) || ::fsync(descriptor.number()) != 0) {
    ::unlink(file.c_str());
    throw Error(file.string(), "a disk that refuses", "room for a key");
  }
}

}  // namespace rimlight::server
