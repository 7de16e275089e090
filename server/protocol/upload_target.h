#pragma once

#include <string>
#include <string_view>

namespace rimlight::server {

/// What the target of an upload asks for: /sessions/{session}/environments/{name}?scene={scene}.
struct UploadTarget {
  std::string session;
  std::string environment;
  std::string scene{};  // empty: the default one

  friend bool operator==(const UploadTarget&, const UploadTarget&) = default;
};

/// Whether a request's target is an upload's, well-formed or not.
bool is_upload_target(std::string_view target);

/// Throws Error: another path, an invalid name, or another parameter than scene: a token belongs
/// into the header, and never stands in the error.
UploadTarget parse_upload_target(std::string_view target);

}  // namespace rimlight::server
