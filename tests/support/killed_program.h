#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "tests/support/program.h"

namespace rimlight::test {

/// One operation of a program on the files below a folder.
struct DiskOperation {
  /// write, fsync, rename, commit (a rename to a bake's name), open (that makes or empties a file),
  /// truncate, remove, mkdir; or acknowledge: of an edit, to a client.
  std::string kind;
  std::string name;  // below the folder

  friend bool operator==(const DiskOperation&, const DiskOperation&) = default;
};

/// Where a program is killed.
struct KillPoint {
  enum class Phase { before, half, after };
  long number = 0;   // of the operation, from 0
  std::string kind;  // of which it is the number; empty: of all
  Phase phase = Phase::before;
  /// As if power were lost: what was not flushed is gone.
  bool loses_power = false;
};
const char* to_string(KillPoint::Phase phase);

/// The built program, run with the library fault_shim.cpp before the C library's functions.
/// Operations of all its threads are counted, one at a time.
class WatchedProgram {
 public:
  /// `folder` is what is watched. `variables` ("NAME=value") are set for it besides.
  explicit WatchedProgram(std::filesystem::path folder, std::vector<std::string> variables = {});

  /// The command that counts operations.
  std::vector<std::string> counting(const std::vector<std::string>& arguments) const;
  /// The command that is killed there, if it comes there.
  std::vector<std::string> killed(const KillPoint& point,
                                  const std::vector<std::string>& arguments) const;
  /// All operations since the last call: of one that is killed the last alone.
  std::vector<DiskOperation> operations() const;

  /// Runs such a command to its end.
  static ProgramResult run(const std::vector<std::string>& command);

 private:
  std::vector<std::string> command(const std::vector<std::string>& more,
                                   const std::vector<std::string>& arguments) const;

  std::filesystem::path folder_, report_;
  std::vector<std::string> variables_;
};

}  // namespace rimlight::test
