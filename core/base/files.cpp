#include "core/base/files.h"

#include <fcntl.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <utility>

#include "core/base/error.h"

namespace rimlight {
namespace {

/// A file descriptor that closes itself.
class Descriptor {
 public:
  Descriptor(const std::filesystem::path& path, int flags, mode_t mode = 0)
      : value_(::open(path.c_str(), flags | O_CLOEXEC, mode)) {}
  Descriptor(const Descriptor&) = delete;
  Descriptor& operator=(const Descriptor&) = delete;
  ~Descriptor() {
    if (value_ >= 0) ::close(value_);
  }
  int get() const { return value_; }
  bool is_open() const { return value_ >= 0; }

 private:
  int value_;
};

[[noreturn]] void fail(const std::filesystem::path& path, const char* expected) {
  const int reason = errno;
  throw Error(path.string(), std::strerror(reason), expected);
}

std::size_t regular_size(const Descriptor& file, const std::filesystem::path& path,
                         std::size_t most) {
  struct stat status {};
  if (::fstat(file.get(), &status) != 0) fail(path, "a readable file");
  if (!S_ISREG(status.st_mode)) throw Error(path.string(), "no regular file", "a regular file");
  const auto size = static_cast<std::size_t>(status.st_size);
  if (size > most) {
    throw Error(path.string(), std::to_string(size) + " bytes",
                "at most " + std::to_string(most) + " bytes");
  }
  return size;
}

void write_all(const Descriptor& file, std::string_view bytes, const std::filesystem::path& path) {
  while (!bytes.empty()) {
    const ssize_t written = ::write(file.get(), bytes.data(), bytes.size());
    if (written < 0 && errno == EINTR) continue;
    if (written < 0) fail(path, "space to write to");
    bytes.remove_prefix(static_cast<std::size_t>(written));
  }
}

void write_and_flush(const std::filesystem::path& path, std::string_view bytes) {
  const Descriptor file(path, O_WRONLY | O_CREAT | O_TRUNC, 0644);
  if (!file.is_open()) fail(path, "a file that can be written");
  write_all(file, bytes, path);
  if (::fsync(file.get()) != 0) fail(path, "a disk that keeps what is written");
}

}  // namespace

MappedFile::MappedFile(const std::filesystem::path& path, std::size_t most) {
  const Descriptor file(path, O_RDONLY);
  if (!file.is_open()) fail(path, "a readable file");
  size_ = regular_size(file, path, most);
  if (size_ == 0) return;
  void* const address = ::mmap(nullptr, size_, PROT_READ, MAP_SHARED, file.get(), 0);
  if (address == MAP_FAILED) {
    size_ = 0;
    fail(path, "a file that can be mapped");
  }
  data_ = static_cast<const std::byte*>(address);
}

MappedFile::MappedFile(MappedFile&& other) noexcept
    : data_(std::exchange(other.data_, nullptr)), size_(std::exchange(other.size_, 0)) {}

MappedFile& MappedFile::operator=(MappedFile&& other) noexcept {
  std::swap(data_, other.data_);
  std::swap(size_, other.size_);
  return *this;
}

MappedFile::~MappedFile() {
  if (data_ != nullptr) ::munmap(const_cast<std::byte*>(data_), size_);
}

std::string read_file(const std::filesystem::path& path, std::size_t most) {
  const Descriptor file(path, O_RDONLY);
  if (!file.is_open()) fail(path, "a readable file");
  std::string bytes(regular_size(file, path, most), '\0');
  std::size_t done = 0;
  while (done < bytes.size()) {
    const ssize_t count = ::read(file.get(), bytes.data() + done, bytes.size() - done);
    if (count < 0 && errno == EINTR) continue;
    if (count < 0) fail(path, "a readable file");
    if (count == 0) break;
    done += static_cast<std::size_t>(count);
  }
  bytes.resize(done);
  return bytes;
}

void write_file_atomically(const std::filesystem::path& path, std::string_view bytes) {
  std::filesystem::path temporary = path;
  temporary += ".partial";
  try {
    write_and_flush(temporary, bytes);
    std::error_code error;
    std::filesystem::rename(temporary, path, error);
    if (error) throw Error(path.string(), error.message(), "a name that can be replaced");
  } catch (const Error&) {
    std::error_code ignored;  // the first error is the one to tell
    std::filesystem::remove(temporary, ignored);
    throw;
  }
  const auto folder = path.parent_path();
  flush_to_disk(folder.empty() ? std::filesystem::path(".") : folder);
}

void flush_to_disk(const std::filesystem::path& path) {
  const Descriptor file(path, O_RDONLY);
  if (!file.is_open()) fail(path, "a readable file or folder");
  if (::fsync(file.get()) != 0) fail(path, "a disk that keeps what is written");
}

}  // namespace rimlight
