#include "server/metrics/process_use.h"

#include <sys/resource.h>
#include <unistd.h>

#include <chrono>
#include <ctime>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <sstream>
#include <string>
#include <system_error>

namespace rimlight::server {
namespace {

double seconds(const timeval& time) {
  return static_cast<double>(time.tv_sec) + 1e-6 * static_cast<double>(time.tv_usec);
}

/// In ticks since the machine started: field 22 of /proc/self/stat. The second, the program's name
/// in parentheses, may have spaces.
double start_ticks() {
  constexpr int kFieldsBetween = 19;  // 3 to 21
  std::ifstream stat("/proc/self/stat");
  std::string line;
  std::getline(stat, line);
  const std::size_t name_end = line.rfind(')');
  if (name_end == std::string::npos) return 0;
  std::istringstream fields(line.substr(name_end + 1));
  std::string skipped;
  for (int i = 0; i < kFieldsBetween; ++i) fields >> skipped;
  double ticks = 0;
  fields >> ticks;
  return ticks;
}

double read_start() {
  timespec since_boot{};
  ::clock_gettime(CLOCK_BOOTTIME, &since_boot);
  const double up =
      static_cast<double>(since_boot.tv_sec) + 1e-9 * static_cast<double>(since_boot.tv_nsec);
  const double now =
      std::chrono::duration<double>(std::chrono::system_clock::now().time_since_epoch()).count();
  return now - up + start_ticks() / static_cast<double>(::sysconf(_SC_CLK_TCK));
}

}  // namespace

ProcessUse process_use() {
  static const double started = read_start();
  ProcessUse use;
  std::size_t pages = 0, resident = 0;
  std::ifstream("/proc/self/statm") >> pages >> resident;
  use.resident_bytes = resident * static_cast<std::size_t>(::sysconf(_SC_PAGESIZE));
  rusage spent{};
  if (::getrusage(RUSAGE_SELF, &spent) == 0) {
    use.cpu_seconds = seconds(spent.ru_utime) + seconds(spent.ru_stime);
  }
  std::error_code failure;
  const std::filesystem::directory_iterator files("/proc/self/fd", failure);
  if (!failure) {
    const auto count = std::distance(begin(files), end(files));
    use.open_files = static_cast<std::size_t>(count > 0 ? count - 1 : 0);  // but this listing's own
  }
  use.started = started;
  return use;
}

}  // namespace rimlight::server
