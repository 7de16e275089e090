#include "server/protocol/stream_target.h"

#include <algorithm>
#include <charconv>

#include "core/base/error.h"
#include "server/access/resume_token.h"

namespace rimlight::server {
namespace {

constexpr std::size_t kLongestName = 64;
constexpr std::string_view kPrefix = "/sessions/";
constexpr std::string_view kStream = "/stream";
constexpr std::string_view kState = "/state";
/// Of a revision's number: it is exact in JSON.
constexpr std::size_t kMostDigits = 15;

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

/// Nothing for what is no number, or too large for a revision's.
std::optional<std::int64_t> read_number(std::string_view text) {
  std::int64_t number = 0;
  const auto [end, failure] = std::from_chars(text.data(), text.data() + text.size(), number);
  const bool is_whole = failure == std::errc() && end == text.data() + text.size() && number >= 0;
  return is_whole && text.size() <= kMostDigits ? std::optional(number) : std::nullopt;
}

/// Each at most once, in any order.
void read_parameters(std::string_view query, StreamTarget& result) {
  const Error wrong(
      "URL", "other parameters",
      "scene=NAME, token=TOKEN, resume=TOKEN, seen=NUMBER and parts=1, any of them, once");
  while (!query.empty()) {
    const std::size_t end = std::min(query.find('&'), query.size());
    const std::string_view part = query.substr(0, end);
    query.remove_prefix(std::min(end + 1, query.size()));
    constexpr std::string_view kScene = "scene=";
    constexpr std::string_view kToken = "token=";
    constexpr std::string_view kResume = "resume=";
    constexpr std::string_view kSeen = "seen=";
    if (part.starts_with(kScene) && result.scene.empty()) {
      result.scene = checked_name(part.substr(kScene.size()), "scene");
    } else if (part.starts_with(kToken) && result.token.empty()) {
      result.token = part.substr(kToken.size());
    } else if (part.starts_with(kResume) && result.resume.empty() &&
               is_resume_token(part.substr(kResume.size()))) {
      result.resume = part.substr(kResume.size());
    } else if (part == "parts=1" && !result.parts) {
      result.parts = true;
    } else if (part.starts_with(kSeen) && !result.seen) {
      result.seen = read_number(part.substr(kSeen.size()));
      if (!result.seen) throw wrong;
    } else {
      throw wrong;
    }
  }
}

/// /sessions/NAME, then `suffix` and perhaps a query.
StreamTarget parse_target(std::string_view target, std::string_view suffix) {
  const std::size_t question = target.find('?');
  const std::string_view path = target.substr(0, question);
  if (!path.starts_with(kPrefix) || !path.ends_with(suffix) ||
      path.size() <= kPrefix.size() + suffix.size()) {
    throw Error("URL", quote(path), "/sessions/NAME" + std::string(suffix));
  }
  StreamTarget result;
  result.session = checked_name(
      path.substr(kPrefix.size(), path.size() - kPrefix.size() - suffix.size()), "session");
  if (question == std::string_view::npos) return result;
  read_parameters(target.substr(question + 1), result);
  return result;
}

}  // namespace

bool is_valid_name(std::string_view name) {
  return !name.empty() && name.size() <= kLongestName &&
         std::all_of(name.begin(), name.end(), is_name_character);
}

StreamTarget parse_stream_target(std::string_view target) { return parse_target(target, kStream); }

bool is_state_target(std::string_view target) {
  const std::string_view path = target.substr(0, target.find('?'));
  return path.starts_with(kPrefix) && path.ends_with(kState);
}

StreamTarget parse_state_target(std::string_view target) { return parse_target(target, kState); }

}  // namespace rimlight::server
