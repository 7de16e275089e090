// A library for LD_PRELOAD that counts what a program does to the files below one folder, and kills
// it (SIGKILL) at one of these operations: before it, in the middle of a write, or after it. See
// killed_program.h, which says what the variables mean. A program without them is left alone.
#include <dlfcn.h>
#include <fcntl.h>
#include <signal.h>  // NOLINT: raise() of SIGKILL is POSIX
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <sys/uio.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstdarg>
#include <cstdio>
#include <cstdlib>
#include <map>
#include <mutex>
#include <string>
#include <string_view>

namespace {

/// The function of that name that the program would have called.
template <typename Function>
Function* next(const char* name) {
  return reinterpret_cast<Function*>(::dlsym(RTLD_NEXT, name));
}

std::string variable(const char* name) {
  const char* const value = std::getenv(name);
  return value == nullptr ? "" : value;
}

struct State {
  std::recursive_mutex mutex;
  const std::string folder = variable("RIMLIGHT_FAULT_FOLDER");
  const std::string report = variable("RIMLIGHT_FAULT_REPORT");
  const std::string kind = variable("RIMLIGHT_FAULT_KIND");  // empty: all are counted
  const std::string phase = variable("RIMLIGHT_FAULT_PHASE");
  const long at = variable("RIMLIGHT_FAULT_AT").empty()
                      ? -1
                      : std::strtol(variable("RIMLIGHT_FAULT_AT").c_str(), nullptr, 10);
  const bool loses = !variable("RIMLIGHT_FAULT_LOSES").empty();
  long done = 0;
  std::map<ino_t, int> unflushed;  // descriptors of our own, by file
};
State& state() {
  static State* const made = new State;  // never destroyed: files are closed after main()
  return *made;
}

std::string path_of(int file) {
  std::array<char, 4096> path{};
  const std::string link = "/proc/self/fd/" + std::to_string(file);
  const ssize_t size = ::readlink(link.c_str(), path.data(), path.size());
  return size < 0 ? "" : std::string(path.data(), static_cast<std::size_t>(size));
}
std::string path_at(int folder, const char* name) {
  return folder == AT_FDCWD || name[0] == '/' ? name : path_of(folder) + "/" + name;
}
bool is_watched(const std::string& path) {
  return !state().folder.empty() && path.starts_with(state().folder);
}

/// What was written to the file is not on the disk yet.
void written(int file) {
  struct stat status {};
  if (!state().loses || ::fstat(file, &status) != 0) return;
  int& kept = state().unflushed[status.st_ino];
  if (kept == 0) kept = ::dup(file);
}
void flushed(int file) {
  struct stat status {};
  if (::fstat(file, &status) == 0) state().unflushed.erase(status.st_ino);
}

/// Without the program's own hands: it may be in the middle of anything.
void tell(const std::string& line) {
  const int file = static_cast<int>(::syscall(SYS_openat, AT_FDCWD, state().report.c_str(),
                                              O_WRONLY | O_CREAT | O_APPEND | O_CLOEXEC, 0644));
  if (file < 0) return;
  ::syscall(SYS_write, file, line.data(), line.size());
  ::close(file);
}

[[noreturn]] void die() {
  // As after a loss of power: of what was not flushed, nothing is there.
  for (const auto& [inode, file] : state().unflushed) {
    if (::syscall(SYS_ftruncate, file, 0) != 0) break;
  }
  ::raise(SIGKILL);
  ::_exit(1);
}

template <typename Work, typename Half>
auto operation(std::string_view kind, const std::string& path, const Work& work, const Half& half) {
  State& now = state();
  const std::lock_guard lock(now.mutex);
  if (!now.kind.empty() && now.kind != kind) return work();
  const long number = now.done++;
  const bool is_last = number == now.at;
  if (now.at < 0 || is_last) {
    const std::string name = path.substr(std::min(path.size(), now.folder.size()));
    tell(std::string(kind) + " " + name + "\n");
  }
  if (!is_last) return work();
  if (now.phase == "half") half();
  if (now.phase == "after") work();
  die();
}
template <typename Work>
auto operation(std::string_view kind, const std::string& path, const Work& work) {
  return operation(kind, path, work, [] {});
}

/// `half` writes about half of what `whole` does.
template <typename Whole, typename Half>
ssize_t write_operation(int file, const Whole& whole, const Half& half) {
  const std::string path = file > 2 ? path_of(file) : "";
  if (!is_watched(path)) return whole();
  const auto noted = [file](const auto& write) {
    const ssize_t result = write();
    written(file);
    return result;
  };
  return operation(
      "write", path, [&] { return noted(whole); }, [&] { noted(half); });
}

template <typename Flush>
int flush_operation(int file, const Flush& flush) {
  const std::string path = path_of(file);
  if (!is_watched(path)) return flush();
  return operation("fsync", path, [&] {
    flushed(file);
    return 0;  // power is lost only as die() does it: nothing needs to wait for a disk
  });
}

/// The bake's own name is where a rename commits it.
template <typename Rename>
int rename_operation(const std::string& to, const Rename& rename) {
  if (!is_watched(to)) return rename();
  return operation(to.ends_with(".bake") ? "commit" : "rename", to, rename);
}

template <typename Remove>
int remove_operation(const std::string& path, const Remove& remove) {
  return is_watched(path) ? operation("remove", path, remove) : remove();
}

/// Only what makes or empties a file is an operation.
template <typename Open>
int open_operation(const std::string& path, int flags, const Open& open) {
  const bool changes = (flags & (O_CREAT | O_TRUNC)) != 0;
  return changes && is_watched(path) ? operation("open", path, open) : open();
}

template <typename Open>
std::FILE* open_stream(const char* path, const char* mode, const Open& open) {
  return mode[0] != 'r' && is_watched(path) ? operation("open", path, open) : open();
}

mode_t mode_of(int flags, va_list& rest) {
  return (flags & (O_CREAT | O_TMPFILE)) != 0 ? va_arg(rest, mode_t) : 0;
}

}  // namespace

extern "C" {

ssize_t write(int file, const void* from, std::size_t size) {
  static auto* const real = next<ssize_t(int, const void*, std::size_t)>("write");
  return write_operation(
      file, [&] { return real(file, from, size); }, [&] { return real(file, from, size / 2); });
}
ssize_t pwrite64(int file, const void* from, std::size_t size, off64_t at) {
  static auto* const real = next<ssize_t(int, const void*, std::size_t, off64_t)>("pwrite64");
  return write_operation(
      file, [&] { return real(file, from, size, at); },
      [&] { return real(file, from, size / 2, at); });
}
ssize_t pwrite(int file, const void* from, std::size_t size, off_t at) {
  return pwrite64(file, from, size, at);
}
ssize_t writev(int file, const struct iovec* from, int count) {
  static auto* const real = next<ssize_t(int, const struct iovec*, int)>("writev");
  static auto* const write_one = next<ssize_t(int, const void*, std::size_t)>("write");
  return write_operation(
      file, [&] { return real(file, from, count); },
      [&] { return write_one(file, from[0].iov_base, from[0].iov_len / 2); });
}
int ftruncate64(int file, off64_t size) noexcept {
  static auto* const real = next<int(int, off64_t)>("ftruncate64");
  const std::string path = path_of(file);
  const auto truncate = [&] { return real(file, size); };
  return is_watched(path) ? operation("truncate", path, truncate) : truncate();
}
int fsync(int file) {
  static auto* const real = next<int(int)>("fsync");
  return flush_operation(file, [&] { return real(file); });
}
int fdatasync(int file) {
  static auto* const real = next<int(int)>("fdatasync");
  return flush_operation(file, [&] { return real(file); });
}
int rename(const char* from, const char* to) noexcept {
  static auto* const real = next<int(const char*, const char*)>("rename");
  return rename_operation(to, [&] { return real(from, to); });
}
int renameat2(int from_at, const char* from, int to_at, const char* to, unsigned flags) noexcept {
  static auto* const real = next<int(int, const char*, int, const char*, unsigned)>("renameat2");
  return rename_operation(path_at(to_at, to), [&] {
    if (!variable("RIMLIGHT_FAULT_NO_EXCHANGE").empty()) {
      errno = EINVAL;
      return -1;
    }
    return real(from_at, from, to_at, to, flags);
  });
}
int remove(const char* path) noexcept {
  static auto* const real = next<int(const char*)>("remove");
  return remove_operation(path, [&] { return real(path); });
}
int unlink(const char* path) noexcept {
  static auto* const real = next<int(const char*)>("unlink");
  return remove_operation(path, [&] { return real(path); });
}
int unlinkat(int at, const char* path, int flags) noexcept {
  static auto* const real = next<int(int, const char*, int)>("unlinkat");
  return remove_operation(path_at(at, path), [&] { return real(at, path, flags); });
}
int mkdir(const char* path, mode_t mode) noexcept {
  static auto* const real = next<int(const char*, mode_t)>("mkdir");
  const auto make = [&] { return real(path, mode); };
  return is_watched(path) ? operation("mkdir", path, make) : make();
}
int open(const char* path, int flags, ...) {
  static auto* const real = next<int(const char*, int, ...)>("open");
  va_list rest;
  va_start(rest, flags);
  const mode_t mode = mode_of(flags, rest);
  va_end(rest);
  return open_operation(path, flags, [&] { return real(path, flags, mode); });
}
int open64(const char* path, int flags, ...) {
  static auto* const real = next<int(const char*, int, ...)>("open64");
  va_list rest;
  va_start(rest, flags);
  const mode_t mode = mode_of(flags, rest);
  va_end(rest);
  return open_operation(path, flags, [&] { return real(path, flags, mode); });
}
std::FILE* fopen(const char* path, const char* mode) {
  static auto* const real = next<std::FILE*(const char*, const char*)>("fopen");
  return open_stream(path, mode, [&] { return real(path, mode); });
}
std::FILE* fopen64(const char* path, const char* mode) {
  static auto* const real = next<std::FILE*(const char*, const char*)>("fopen64");
  return open_stream(path, mode, [&] { return real(path, mode); });
}
/// An acknowledgement of an edit: the server's frames are not masked.
ssize_t sendmsg(int socket, const struct msghdr* message, int flags) {
  static auto* const real = next<ssize_t(int, const struct msghdr*, int)>("sendmsg");
  const auto send = [&] { return real(socket, message, flags); };
  for (std::size_t i = 0; i < message->msg_iovlen; ++i) {
    const std::string_view bytes(static_cast<const char*>(message->msg_iov[i].iov_base),
                                 message->msg_iov[i].iov_len);
    if (bytes.find(R"("type":"ack")") != std::string_view::npos) {
      return operation("acknowledge", "", send);
    }
  }
  return send();
}
}
