#include "server/network/static_files.h"

#include <array>
#include <cstdint>
#include <cstdio>
#include <system_error>

#include "core/base/error.h"
#include "core/base/files.h"

namespace rimlight::server {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kMostBytes = std::size_t{16} << 20;

struct ContentType {
  std::string_view ending;
  const char* type;
};
constexpr std::array<ContentType, 7> kContentTypes{{
    {".html", "text/html; charset=utf-8"},
    {".css", "text/css; charset=utf-8"},
    {".js", "text/javascript; charset=utf-8"},
    {".json", "application/json"},
    {".svg", "image/svg+xml"},
    {".png", "image/png"},
    {".ico", "image/x-icon"},
}};

const char* content_type(const fs::path& path) {
  for (const ContentType& known : kContentTypes) {
    if (path.extension() == known.ending) return known.type;
  }
  return nullptr;
}

/// FNV-1a: tells versions of a file apart, no more.
std::string etag_of(std::string_view bytes) {
  std::uint64_t hash = 0xcbf29ce484222325ULL;
  for (const char c : bytes) {
    hash = (hash ^ static_cast<unsigned char>(c)) * 0x100000001b3ULL;
  }
  char text[24];
  std::snprintf(text, sizeof text, "\"%016llx\"", static_cast<unsigned long long>(hash));
  return text;
}

}  // namespace

StaticFiles::StaticFiles(const fs::path& folder) {
  std::error_code failure;
  std::size_t left = kMostBytes;
  for (auto entry = fs::recursive_directory_iterator(folder, failure);
       !failure && entry != fs::recursive_directory_iterator(); entry.increment(failure)) {
    const fs::path& path = entry->path();
    if (path.filename().string().starts_with('.')) {
      entry.disable_recursion_pending();
      continue;
    }
    const char* const type = content_type(path);
    if (type == nullptr || entry->is_symlink() || !entry->is_regular_file()) continue;
    File file{type, "", read_file(path, left)};
    file.etag = etag_of(file.bytes);
    left -= file.bytes.size();
    files_.emplace("/" + path.lexically_relative(folder).generic_string(), std::move(file));
  }
  if (failure) throw Error(folder.string(), failure.message(), "the folder of the page");
  if (!files_.contains("/index.html")) {
    throw Error(folder.string(), "no index.html", "the folder of the page");
  }
}

const StaticFiles::File* StaticFiles::find(std::string_view path) const {
  const auto found = files_.find(path == "/" ? std::string_view("/index.html") : path);
  return found == files_.end() ? nullptr : &found->second;
}

}  // namespace rimlight::server
