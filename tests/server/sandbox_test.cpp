// What a decoder cannot do once it is shut in: each in a process of its own, forked before threads.
#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <functional>
#include <new>
#include <vector>

#include "server/upload/sandbox.h"

namespace rimlight::server {
namespace {

/// How a forked child ends that shuts itself in and then does that: 0 when it answers true.
int status_of(const std::function<bool()>& action, const SandboxLimits& limits = {}) {
  const pid_t child = ::fork();
  if (child == 0) {
    try {
      enter_sandbox(limits);
      ::_exit(action() ? 0 : 1);
    } catch (const std::bad_alloc&) {
      ::_exit(7);
    } catch (...) {
      ::_exit(9);
    }
  }
  int status = 0;
  ::waitpid(child, &status, 0);
  return WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
}

TEST(Sandbox, ThereIsNoFileNoSocketAndNoOtherProcess) {
  if (!kShutsIn) GTEST_SKIP() << "built with a sanitizer";
  EXPECT_EQ(status_of([] { return true; }), 0);
  EXPECT_EQ(status_of([] { return ::open("/etc/passwd", O_RDONLY) < 0 && errno == EPERM; }), 0);
  EXPECT_EQ(status_of([] { return ::socket(AF_INET, SOCK_STREAM, 0) < 0 && errno == EPERM; }), 0);
  EXPECT_EQ(status_of([] { return ::socket(AF_UNIX, SOCK_STREAM, 0) < 0 && errno == EPERM; }), 0);
  EXPECT_EQ(status_of([] { return ::fork() < 0; }), 0);
  EXPECT_EQ(status_of([] {
              char* const arguments[] = {nullptr};
              return ::execve("/bin/true", arguments, arguments) < 0 && errno == EPERM;
            }),
            0);
  EXPECT_EQ(status_of([] { return ::unlink("/tmp/none") < 0 && errno == EPERM; }), 0);
  EXPECT_EQ(status_of([] { return ::kill(::getppid(), 0) < 0; }), 0);
}

bool spins() {
  volatile int i = 1;
  while (i > 0) i = i % 1000 + 1;
  return true;
}

bool takes_memory() {
  const std::vector<char> memory(std::size_t{4} << 30);
  return !memory.empty();
}

TEST(Sandbox, MemoryAndTimeEnd) {
  if (kShutsIn) {
    EXPECT_EQ(status_of(takes_memory), 7);
  }
  EXPECT_EQ(status_of(spins, {.cpu_seconds = 1}), 128 + 9);  // both limits are one: SIGKILL
}

}  // namespace
}  // namespace rimlight::server
