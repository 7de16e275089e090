#pragma once

#include <cstddef>

namespace rimlight::server {

/// What this process uses now, as the kernel counts it.
struct ProcessUse {
  std::size_t resident_bytes = 0;
  double cpu_seconds = 0;  // of all its threads
  std::size_t open_files = 0;
  double started = 0;  // seconds since 1970
};

/// From /proc/self; what cannot be read there is 0.
ProcessUse process_use();

}  // namespace rimlight::server
