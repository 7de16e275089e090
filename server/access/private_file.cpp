#include "server/access/private_file.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>

#include "core/base/error.h"

namespace rimlight::server {
namespace {

namespace fs = std::filesystem;

/// Of the open file, so that it cannot be exchanged between the check and the reading.
void check_private(const Descriptor& descriptor, const fs::path& file, const char* expected) {
  struct stat status {};
  if (::fstat(descriptor.number(), &status) != 0 || !S_ISREG(status.st_mode)) {
    throw Error(file.string(), "no regular file", expected);
  }
  const std::string wanted = expected;
  if (status.st_uid != ::geteuid() && status.st_uid != 0) {
    throw Error(file.string(), "another user's file", wanted + " of this user or of root");
  }
  if ((status.st_mode & (S_IRWXG | S_IRWXO)) != 0) {
    throw Error(file.string(), "a file that others than its owner may use",
                wanted + " for one user alone: chmod 600");
  }
}

}  // namespace

Descriptor::Descriptor(const fs::path& file, int flags, const char* expected)
    : number_(::open(file.c_str(), flags, 0600)) {
  if (number_ < 0) throw Error(file.string(), std::strerror(errno), expected);
}

Descriptor::~Descriptor() { ::close(number_); }

std::string read_private_file(const fs::path& file, std::size_t most, const char* expected) {
  // A pipe must not block.
  const Descriptor descriptor(file, O_RDONLY | O_CLOEXEC | O_NONBLOCK, expected);
  check_private(descriptor, file, expected);
  std::string bytes(most + 1, '\0');
  std::size_t size = 0;
  while (size < bytes.size()) {
    const ssize_t n = ::read(descriptor.number(), bytes.data() + size, bytes.size() - size);
    if (n < 0 && errno == EINTR) continue;
    if (n < 0) throw Error(file.string(), std::strerror(errno), expected);
    if (n == 0) break;
    size += static_cast<std::size_t>(n);
  }
  if (size > most) {
    throw Error(file.string(), "more than " + std::to_string(most / 1024) + " KiB", expected);
  }
  bytes.resize(size);
  return bytes;
}

}  // namespace rimlight::server
