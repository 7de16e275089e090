#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <string_view>

namespace rimlight::server {

/// The page's files, read once at start: what is not in the list cannot be asked for, so that no
/// path of a request ever reaches the file system. Immutable; any thread.
class StaticFiles {
 public:
  struct File {
    std::string content_type;
    std::string etag;  // quoted, of the bytes
    std::string bytes;
  };

  /// Reads every file below `folder` whose ending has a content type; hidden files and links are
  /// left out. Throws Error when there is no index.html, or more than 16 MiB in all.
  explicit StaticFiles(const std::filesystem::path& folder);

  /// By the request's path without its query: "/" is "/index.html". Null when there is none.
  const File* find(std::string_view path) const;
  std::size_t size() const { return files_.size(); }

 private:
  std::map<std::string, File, std::less<>> files_;
};

}  // namespace rimlight::server
