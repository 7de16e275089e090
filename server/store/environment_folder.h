#pragma once

#include <cstdint>
#include <filesystem>
#include <mutex>
#include <string>
#include <vector>

#include "server/session/session_environments.h"

namespace rimlight::server {

/// Uploaded environments beyond the life of the server, in a folder: HASH.exr is a cube map (6×1),
/// named by the SHA-256 of its radiance and kept once however many sessions have it;
/// SCENE@SESSION.json lists a session's names and hashes. Any thread.
class EnvironmentFolder {
 public:
  /// Makes the folder. It takes no more than `most_bytes`. Throws Error naming it.
  EnvironmentFolder(std::filesystem::path folder, std::uint64_t most_bytes);

  /// Those of a session, in the order of their uploads. What is damaged is left out, with a warning
  /// in the log.
  std::vector<EnvironmentPtr> load(const std::string& scene, const std::string& session) const;
  /// On the disk when it returns. Throws Error, and changes nothing, when the disk refuses or the
  /// folder is full.
  void add(const std::string& scene, const std::string& session, const Environment& environment);
  /// One of a session's, or all; what no session lists any more is deleted with it. Nothing happens
  /// where there is none. Throws Error, and changes nothing, when the disk refuses.
  void remove(const std::string& scene, const std::string& session, const std::string& name);
  void remove_all(const std::string& scene, const std::string& session);
  /// Deletes what no session lists: of a server that ended in the middle. How many files.
  std::size_t collect();

 private:
  std::size_t collect_locked();
  std::filesystem::path list_of(const std::string& scene, const std::string& session) const;
  std::uint64_t bytes() const;

  const std::filesystem::path folder_;
  const std::uint64_t most_bytes_;
  mutable std::mutex mutex_;
};

}  // namespace rimlight::server
