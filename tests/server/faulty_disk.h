#pragma once

#include <cstdint>
#include <string>

namespace rimlight::server::test {

/// A way of SQLite's to the disk on which one operation fails, or all from one on. Counts writes,
/// flushes, truncations, openings and deletions. One at a time.
class FaultyDisk {
 public:
  FaultyDisk();
  ~FaultyDisk();
  FaultyDisk(const FaultyDisk&) = delete;
  FaultyDisk& operator=(const FaultyDisk&) = delete;

  /// For SqliteStoreSettings::vfs.
  static std::string name();
  enum class Lasting { once, from_then_on };
  /// The n-th operation from now on fails, counted from 0; a write leaves half of its bytes.
  void fail(std::int64_t n, Lasting lasting);
  /// The process is killed (SIGKILL) at the n-th, in the middle of a write, before anything else.
  void kill(std::int64_t n);
  /// Flushes alone fail, until mend().
  void fail_flushes();
  void mend();
  /// Operations since the last call of one of these.
  std::int64_t operations() const;
};

}  // namespace rimlight::server::test
