#include "server/protocol/stream_target.h"

#include <algorithm>

#include "core/base/error.h"

namespace rimlight::server {
namespace {

constexpr std::size_t kLongestName = 64;
constexpr std::string_view kPrefix = "/sessions/";
constexpr std::string_view kSuffix = "/stream";

bool is_name_character(char c) {
  return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '.' ||
         c == '_' || c == '-';
}

std::string checked_name(std::string_view name, const char* what) {
  if (!is_valid_name(name)) {
    throw Error("URL", std::string("the ") + what + " name " + quote(name),
                "1 to 64 of A-Z a-z 0-9 . _ -");
  }
  return std::string(name);
}

/// scene=NAME and token=TOKEN, each at most once, in any order.
void read_parameters(std::string_view query, StreamTarget& result) {
  const Error wrong("URL", "other parameters", "scene=NAME, token=TOKEN, both or none");
  while (!query.empty()) {
    const std::size_t end = std::min(query.find('&'), query.size());
    const std::string_view part = query.substr(0, end);
    query.remove_prefix(std::min(end + 1, query.size()));
    constexpr std::string_view kScene = "scene=";
    constexpr std::string_view kToken = "token=";
    if (part.starts_with(kScene) && result.scene.empty()) {
      result.scene = checked_name(part.substr(kScene.size()), "scene");
    } else if (part.starts_with(kToken) && result.token.empty()) {
      result.token = part.substr(kToken.size());
    } else {
      throw wrong;
    }
  }
}

}  // namespace

bool is_valid_name(std::string_view name) {
  return !name.empty() && name.size() <= kLongestName &&
         std::all_of(name.begin(), name.end(), is_name_character);
}

StreamTarget parse_stream_target(std::string_view target) {
  const std::size_t question = target.find('?');
  const std::string_view path = target.substr(0, question);
  if (!path.starts_with(kPrefix) || !path.ends_with(kSuffix) ||
      path.size() <= kPrefix.size() + kSuffix.size()) {
    throw Error("URL", quote(path), "/sessions/NAME/stream");
  }
  StreamTarget result;
  result.session = checked_name(
      path.substr(kPrefix.size(), path.size() - kPrefix.size() - kSuffix.size()), "session");
  if (question == std::string_view::npos) return result;

  read_parameters(target.substr(question + 1), result);
  return result;
}

}  // namespace rimlight::server
