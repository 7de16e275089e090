#include "cli/serve_config.h"

#include <system_error>

#include "core/base/error.h"

namespace rimlight {
namespace {

namespace fs = std::filesystem;

}  // namespace

fs::path find_web_folder() {
  constexpr int kLevels = 4;  // beside the program, and up to three folders above
  std::error_code failure;
  const fs::path program = fs::read_symlink("/proc/self/exe", failure);
  fs::path folder = program.parent_path();
  for (int level = 0; level < kLevels && !failure; ++level, folder = folder.parent_path()) {
    for (const char* const place : {"web", "share/rimlight/web"}) {
      std::error_code ignored;
      if (fs::is_regular_file(folder / place / "index.html", ignored)) return folder / place;
    }
  }
  throw Error(program.string(), "no folder web/ near it", "the page's folder: give it with --web");
}

}  // namespace rimlight
