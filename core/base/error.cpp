#include "core/base/error.h"

#include <cstdio>
#include <utility>

namespace rimlight {

Error::Error(std::string where, std::string found, std::string expected)
    : std::runtime_error(where + ": found " + found + ", expected " + expected),
      where_(std::move(where)),
      found_(std::move(found)),
      expected_(std::move(expected)) {}

std::string quote(std::string_view text) {
  constexpr std::size_t kLongest = 80;
  std::string result = "\"";
  for (const char c : text.substr(0, kLongest)) {
    const auto byte = static_cast<unsigned char>(c);
    if (c == '"' || c == '\\') {
      result += '\\';
      result += c;
    } else if (byte < 0x20 || byte == 0x7f) {
      char escaped[8];
      std::snprintf(escaped, sizeof escaped, "\\x%02x", byte);
      result += escaped;
    } else {
      result += c;
    }
  }
  if (text.size() > kLongest) result += "…";
  return result + "\"";
}

}  // namespace rimlight
