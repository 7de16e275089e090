#include "core/base/error.h"

#include <algorithm>
#include <cstdio>
#include <utility>

namespace rimlight {

Error::Error(std::string where, std::string found, std::string expected)
    : std::runtime_error(where + ": found " + found + ", expected " + expected),
      where_(std::move(where)),
      found_(std::move(found)),
      expected_(std::move(expected)) {}

namespace {

/// The bytes of the well-formed UTF-8 character that `text` begins with (RFC 3629); 0 for none.
std::size_t utf8_length(std::string_view text) {
  const auto byte = [&](std::size_t i) { return static_cast<unsigned char>(text[i]); };
  const unsigned first = byte(0);
  const std::size_t length = first < 0x80                    ? 1
                             : first >= 0xc2 && first < 0xe0 ? 2
                             : first >= 0xe0 && first < 0xf0 ? 3
                             : first >= 0xf0 && first < 0xf5 ? 4
                                                             : 0;
  if (length == 0 || length > text.size()) return 0;
  unsigned code = length == 1 ? first : first & (0x7fu >> length);
  for (std::size_t i = 1; i < length; ++i) {
    if ((byte(i) & 0xc0) != 0x80) return 0;
    code = code << 6 | (byte(i) & 0x3f);
  }
  const bool overlong = (length == 3 && code < 0x800) || (length == 4 && code < 0x10000);
  const bool surrogate = code >= 0xd800 && code < 0xe000;
  return overlong || surrogate || code > 0x10ffff ? 0 : length;
}

}  // namespace

std::string quote(std::string_view text) {
  constexpr std::size_t kLongest = 80;
  std::string result = "\"";
  std::size_t at = 0;
  while (at < text.size()) {
    const std::size_t length = utf8_length(text.substr(at));
    if (at + std::max<std::size_t>(length, 1) > kLongest) break;
    const auto byte = static_cast<unsigned char>(text[at]);
    if (length == 0 || byte < 0x20 || byte == 0x7f) {
      char escaped[8];
      std::snprintf(escaped, sizeof escaped, "\\x%02x", byte);
      result += escaped;
      ++at;
      continue;
    }
    if (byte == '"' || byte == '\\') result += '\\';
    result += text.substr(at, length);
    at += length;
  }
  if (at < text.size()) result += "…";
  return result + "\"";
}

}  // namespace rimlight
