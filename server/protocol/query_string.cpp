#include "server/protocol/query_string.h"

#include <algorithm>
#include <charconv>

#include "core/base/error.h"

namespace rimlight::server {
namespace {

std::string percent_decoded(std::string_view text) {
  std::string result;
  for (std::size_t i = 0; i < text.size(); ++i) {
    if (text[i] != '%') {
      result += text[i] == '+' ? ' ' : text[i];
      continue;
    }
    const std::string_view digits = text.substr(i + 1, 2);
    unsigned value = 0;
    const char* const end = digits.data() + digits.size();
    const auto [stop, error] = std::from_chars(digits.data(), end, value, 16);
    if (digits.size() != 2 || error != std::errc() || stop != end) {
      throw Error("URL", quote(text.substr(i, 3)), "% and two hexadecimal digits");
    }
    result += static_cast<char>(value);
    i += 2;
  }
  return result;
}

std::string listed(std::initializer_list<std::string_view> known) {
  std::string result;
  for (const std::string_view name : known) result += " " + std::string(name) + "=";
  return result;
}

}  // namespace

std::map<std::string, std::string> parse_query(std::string_view query,
                                               std::initializer_list<std::string_view> known) {
  std::map<std::string, std::string> parameters;
  while (!query.empty()) {
    const std::size_t end = std::min(query.find('&'), query.size());
    const std::string_view part = query.substr(0, end);
    query.remove_prefix(std::min(end + 1, query.size()));
    const std::size_t equals = part.find('=');
    const std::string_view name = part.substr(0, equals);
    if (equals == std::string_view::npos || std::ranges::find(known, name) == known.end()) {
      throw Error("URL", "the parameter " + quote(part), "one of" + listed(known));
    }
    if (!parameters.emplace(name, percent_decoded(part.substr(equals + 1))).second) {
      throw Error("URL", "the parameter " + quote(name) + " twice", "it once");
    }
  }
  return parameters;
}

}  // namespace rimlight::server
