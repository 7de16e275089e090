#include "tests/server/faulty_disk.h"

#include <signal.h>  // NOLINT: raise() of SIGKILL is POSIX
#include <sqlite3.h>

#include <atomic>
#include <limits>

namespace rimlight::server::test {
namespace {

constexpr std::int64_t kNever = std::numeric_limits<std::int64_t>::max();

std::atomic<std::int64_t> operations_done{0}, first_fault{kNever}, last_fault{kNever};
std::atomic<bool> flushes_fail{false}, kills{false};

/// Whether the operation that begins now fails; `half` of it is done first.
template <typename DoHalf>
bool fails_now(const DoHalf& do_half) {
  const std::int64_t n = operations_done++;
  if (n < first_fault || n > last_fault) return false;
  do_half();
  if (kills) ::raise(SIGKILL);
  return true;
}
bool fails_now() {
  return fails_now([] {});
}

/// Lies before the real file in the memory that SQLite gives for both.
struct File {
  sqlite3_file base;
  sqlite3_file* real() { return reinterpret_cast<sqlite3_file*>(this + 1); }
};
File* of(sqlite3_file* file) { return reinterpret_cast<File*>(file); }
sqlite3_file* real(sqlite3_file* file) { return of(file)->real(); }
sqlite3_vfs* disk() { return sqlite3_vfs_find(nullptr); }

int close(sqlite3_file* f) { return real(f)->pMethods->xClose(real(f)); }
int read(sqlite3_file* f, void* to, int size, sqlite3_int64 at) {
  return real(f)->pMethods->xRead(real(f), to, size, at);
}
int write(sqlite3_file* f, const void* from, int size, sqlite3_int64 at) {
  const auto put = [&](int bytes) { return real(f)->pMethods->xWrite(real(f), from, bytes, at); };
  return fails_now([&] { put(size / 2); }) ? SQLITE_IOERR_WRITE : put(size);
}
int truncate(sqlite3_file* f, sqlite3_int64 size) {
  return fails_now() ? SQLITE_IOERR_TRUNCATE : real(f)->pMethods->xTruncate(real(f), size);
}
/// Nothing is flushed really: no test takes the power away.
int sync(sqlite3_file*, int) {
  return fails_now() || flushes_fail ? SQLITE_IOERR_FSYNC : SQLITE_OK;
}
int file_size(sqlite3_file* f, sqlite3_int64* size) {
  return real(f)->pMethods->xFileSize(real(f), size);
}
int lock(sqlite3_file* f, int level) { return real(f)->pMethods->xLock(real(f), level); }
int unlock(sqlite3_file* f, int level) { return real(f)->pMethods->xUnlock(real(f), level); }
int is_reserved(sqlite3_file* f, int* out) {
  return real(f)->pMethods->xCheckReservedLock(real(f), out);
}
int control(sqlite3_file* f, int what, void* with) {
  return real(f)->pMethods->xFileControl(real(f), what, with);
}
int sector_size(sqlite3_file* f) { return real(f)->pMethods->xSectorSize(real(f)); }
int characteristics(sqlite3_file* f) { return real(f)->pMethods->xDeviceCharacteristics(real(f)); }

/// Version 1: without shared memory, which a store does not use.
const sqlite3_io_methods kMethods{
    1,       close,       read,    write,       truncate,        sync,    file_size, lock,
    unlock,  is_reserved, control, sector_size, characteristics, nullptr, nullptr,   nullptr,
    nullptr, nullptr,     nullptr};

int open(sqlite3_vfs*, const char* name, sqlite3_file* file, int flags, int* given) {
  file->pMethods = nullptr;
  if (fails_now()) return SQLITE_CANTOPEN;
  const int code = disk()->xOpen(disk(), name, real(file), flags, given);
  if (real(file)->pMethods != nullptr) file->pMethods = &kMethods;
  return code;
}
int remove(sqlite3_vfs*, const char* name, int flush) {
  return fails_now() ? SQLITE_IOERR_DELETE : disk()->xDelete(disk(), name, flush);
}

sqlite3_vfs& faulty() {
  static sqlite3_vfs vfs = [] {
    sqlite3_vfs made = *disk();
    made.szOsFile += static_cast<int>(sizeof(File));
    made.pNext = nullptr;
    made.zName = "rimlight-faulty-disk";
    made.xOpen = open;
    made.xDelete = remove;
    return made;
  }();
  return vfs;
}

void expect_faults(std::int64_t first, std::int64_t last) {
  first_fault = kNever;
  last_fault = last;
  operations_done = 0;
  flushes_fail = false;
  kills = false;
  first_fault = first;
}

}  // namespace

FaultyDisk::FaultyDisk() {
  mend();
  sqlite3_vfs_register(&faulty(), 0);
}
FaultyDisk::~FaultyDisk() { sqlite3_vfs_unregister(&faulty()); }

std::string FaultyDisk::name() { return faulty().zName; }
void FaultyDisk::fail(std::int64_t n, Lasting lasting) {
  expect_faults(n, lasting == Lasting::once ? n : kNever);
}
void FaultyDisk::kill(std::int64_t n) {
  expect_faults(kNever, n);
  kills = true;
  first_fault = n;
}
void FaultyDisk::fail_flushes() {
  mend();
  flushes_fail = true;
}
void FaultyDisk::mend() { expect_faults(kNever, kNever); }
std::int64_t FaultyDisk::operations() const { return operations_done; }

}  // namespace rimlight::server::test
