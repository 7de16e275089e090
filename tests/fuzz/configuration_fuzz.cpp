// The file of `rimlight serve --config`, from a file in memory.

#include <sys/mman.h>
#include <unistd.h>

#include <cstdlib>
#include <string>

#include "cli/serve_config.h"
#include "tests/fuzz/fuzz_target.h"

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace rimlight;
  const int file = ::memfd_create("config", MFD_CLOEXEC);
  if (file < 0 || ::write(file, data, size) != static_cast<ssize_t>(size)) std::abort();
  const int result = fuzz::expect_result_or_error([&] {
    const ServeConfig config = read_serve_config("/proc/self/fd/" + std::to_string(file));
    if (config.network.threads < 1 || config.network.most_connections < 1) std::abort();
  });
  ::close(file);
  return result;
}
