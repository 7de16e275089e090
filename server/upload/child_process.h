#pragma once

#include <chrono>
#include <cstddef>
#include <stop_token>
#include <string>
#include <string_view>
#include <vector>

namespace rimlight::server {

/// A program that reads its standard input to the end and answers on standard output.
struct ChildCommand {
  std::vector<std::string> arguments;  // the program's path first
  std::chrono::milliseconds deadline{30'000};
  std::size_t most_output = 0;  // bytes
  std::stop_token stop = {};    // ends it as the deadline does
};

/// How it ended.
struct ChildResult {
  enum class End { exited, killed, too_late, too_much_output };
  End end = End::killed;
  int status = -1;      // of `exited`
  std::string output;   // of it, at most most_output
  std::string message;  // its standard error, at most 4 KiB
};

/// Runs it with that input, an empty environment and no descriptor but the three; whatever happens,
/// it has ended when this returns. Throws Error where it cannot be started. Any thread; waits.
ChildResult run_child(const ChildCommand& command, std::string_view input);

}  // namespace rimlight::server
