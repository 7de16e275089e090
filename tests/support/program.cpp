#include "tests/support/program.h"

#include <fcntl.h>
#include <signal.h>  // NOLINT: kill() is POSIX, not in <csignal>
#include <spawn.h>
#include <stdlib.h>  // NOLINT: mkstemp is POSIX, not in <cstdlib>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <filesystem>
#include <stdexcept>
#include <thread>

#include "core/base/files.h"

extern char** environ;  // NOLINT: as POSIX declares it

namespace rimlight::test {
namespace {

constexpr std::size_t kMostOutput = std::size_t{16} << 20;

std::string temporary_file() {
  std::string name = (std::filesystem::temp_directory_path() / "rimlight-out-XXXXXX").string();
  const int file = ::mkstemp(name.data());
  if (file < 0) throw std::runtime_error("mkstemp failed: " + name);
  ::close(file);
  return name;
}

}  // namespace

RunningProgram::RunningProgram(const std::vector<std::string>& arguments)
    : RunningProgram(RIMLIGHT_PROGRAM, arguments) {}

RunningProgram::RunningProgram(const std::string& program,
                               const std::vector<std::string>& arguments)
    : output_file_(temporary_file()), error_file_(temporary_file()) {
  std::vector<std::string> all = {program};
  all.insert(all.end(), arguments.begin(), arguments.end());
  std::vector<char*> pointers;
  for (std::string& argument : all) pointers.push_back(argument.data());
  pointers.push_back(nullptr);
  posix_spawn_file_actions_t actions;
  ::posix_spawn_file_actions_init(&actions);
  ::posix_spawn_file_actions_addopen(&actions, STDOUT_FILENO, output_file_.c_str(), O_WRONLY, 0);
  ::posix_spawn_file_actions_addopen(&actions, STDERR_FILENO, error_file_.c_str(), O_WRONLY, 0);
  const int error =
      ::posix_spawnp(&process_, program.c_str(), &actions, nullptr, pointers.data(), environ);
  ::posix_spawn_file_actions_destroy(&actions);
  if (error != 0) throw std::runtime_error("cannot start " + program);
}

RunningProgram::~RunningProgram() {
  if (is_running()) {
    kill();
    ::waitpid(process_, &status_, 0);
  }
  std::error_code ignored;
  std::filesystem::remove(output_file_, ignored);
  std::filesystem::remove(error_file_, ignored);
}

bool RunningProgram::is_running() {
  if (process_ < 0) return false;
  if (::waitpid(process_, &status_, WNOHANG) == 0) return true;
  process_ = -1;
  return false;
}

std::string RunningProgram::output() const { return read_file(output_file_, kMostOutput); }

std::string RunningProgram::errors() const { return read_file(error_file_, kMostOutput); }

void RunningProgram::signal(int number) {
  if (process_ >= 0) ::kill(process_, number);
}

void RunningProgram::terminate() { signal(SIGTERM); }

void RunningProgram::kill() { signal(SIGKILL); }

ProgramResult RunningProgram::wait() {
  using Clock = std::chrono::steady_clock;
  const auto deadline = Clock::now() + std::chrono::minutes(2);
  while (is_running()) {
    if (Clock::now() > deadline) throw std::runtime_error("the program takes too long");
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
  }
  return {WIFEXITED(status_) ? WEXITSTATUS(status_) : 128 + WTERMSIG(status_),
          read_file(output_file_, kMostOutput), read_file(error_file_, kMostOutput)};
}

ProgramResult run_program(const std::vector<std::string>& arguments) {
  return RunningProgram(arguments).wait();
}

}  // namespace rimlight::test
