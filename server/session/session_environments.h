#pragma once

#include <memory>
#include <mutex>
#include <string>
#include <vector>

#include "core/light/environment.h"

namespace rimlight::server {

using EnvironmentPtr = std::shared_ptr<const Environment>;

/// A session has at most so many environments besides its scene's.
inline constexpr std::size_t kMostUploads = 16;

/// What a session may show: its scene's environments, and those that were uploaded to it. Any
/// thread.
class SessionEnvironments {
 public:
  /// `uploaded` are of an earlier life of the session; what cannot be added is left out.
  SessionEnvironments(std::vector<std::string> of_scene,
                      const std::vector<EnvironmentPtr>& uploaded);

  /// The scene's, then the others in the order of their uploads.
  std::vector<std::string> names() const;
  /// Null for the scene's own, and where there is none of that name.
  EnvironmentPtr find_uploaded(const std::string& name) const;
  /// Throws Error where one of that name could not be added: it is there, or there are too many.
  void check_room(const std::string& name) const;
  /// Throws Error as check_room() does.
  void add(EnvironmentPtr environment);
  /// Of an uploaded one; whether it was there.
  bool remove(const std::string& name);

 private:
  const std::vector<std::string> of_scene_;
  mutable std::mutex mutex_;
  std::vector<EnvironmentPtr> uploaded_;
};

}  // namespace rimlight::server
