#include "server/protocol/upload_target.h"

#include "core/base/error.h"
#include "server/protocol/stream_target.h"

namespace rimlight::server {
namespace {

constexpr std::string_view kPrefix = "/sessions/";
constexpr std::string_view kMiddle = "/environments/";

std::string checked_name(std::string_view name, const char* what) {
  if (!is_valid_name(name)) {
    throw Error("URL", std::string("the ") + what + " name " + quote(name),
                "1 to 64 of A-Z a-z 0-9 . _ -");
  }
  return std::string(name);
}

}  // namespace

bool is_upload_target(std::string_view target) {
  const std::string_view path = target.substr(0, target.find('?'));
  return path.starts_with(kPrefix) && path.find(kMiddle) != std::string_view::npos;
}

UploadTarget parse_upload_target(std::string_view target) {
  const std::size_t question = target.find('?');
  const std::string_view path = target.substr(0, question);
  const std::size_t middle = path.find(kMiddle);
  if (!path.starts_with(kPrefix) || middle == std::string_view::npos || middle < kPrefix.size()) {
    throw Error("URL", "another path", "/sessions/NAME/environments/NAME");
  }
  UploadTarget result{checked_name(path.substr(kPrefix.size(), middle - kPrefix.size()), "session"),
                      checked_name(path.substr(middle + kMiddle.size()), "environment")};
  if (question == std::string_view::npos) return result;
  constexpr std::string_view kScene = "scene=";
  const std::string_view query = target.substr(question + 1);
  if (!query.starts_with(kScene)) throw Error("URL", "other parameters", "scene=NAME, or none");
  result.scene = checked_name(query.substr(kScene.size()), "scene");
  return result;
}

}  // namespace rimlight::server
