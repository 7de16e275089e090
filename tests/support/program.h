#pragma once

#include <sys/types.h>

#include <string>
#include <vector>

namespace rimlight::test {

/// The built `rimlight` program, run as a user would.
struct ProgramResult {
  int status = -1;     // exit status; 128 + signal when it was killed
  std::string output;  // standard output
  std::string errors;  // standard error
};

/// Runs it to its end; throws when it cannot be started or takes longer than two minutes.
ProgramResult run_program(const std::vector<std::string>& arguments);

/// A started program, killed when it goes out of scope.
class RunningProgram {
 public:
  explicit RunningProgram(const std::vector<std::string>& arguments);
  /// Another program, by its path or its name on $PATH.
  RunningProgram(const std::string& program, const std::vector<std::string>& arguments);
  RunningProgram(const RunningProgram&) = delete;
  RunningProgram& operator=(const RunningProgram&) = delete;
  ~RunningProgram();

  bool is_running();
  /// What it has written to standard output so far.
  std::string output() const;
  /// The same of standard error.
  std::string errors() const;
  /// SIGKILL: nothing is cleaned up.
  void kill();
  /// Any other.
  void signal(int number);
  /// SIGTERM: it may clean up.
  void terminate();
  ProgramResult wait();

 private:
  pid_t process_ = -1;
  int status_ = -1;
  std::string output_file_;
  std::string error_file_;
};

}  // namespace rimlight::test
