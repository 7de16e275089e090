#pragma once

#include <gtest/gtest.h>

#include <CLI/CLI.hpp>
#include <string>

#include "cli/command.h"

namespace rimlight::test {

/// What a subcommand prints that is run with those arguments, its name first; throws what it
/// throws.
inline std::string command_output(void (*add)(CLI::App&, Action&), const std::string& line) {
  CLI::App program("test", "rimlight");
  Action chosen;
  add(program, chosen);
  program.parse(line);
  testing::internal::CaptureStdout();
  try {
    EXPECT_EQ(chosen(), 0);
  } catch (...) {
    testing::internal::GetCapturedStdout();
    throw;
  }
  return testing::internal::GetCapturedStdout();
}

}  // namespace rimlight::test
