#include "server/upload/child_process.h"

#include <fcntl.h>
#include <poll.h>
#include <signal.h>
#include <spawn.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstdint>
#include <cstring>
#include <utility>

#include "core/base/error.h"

namespace rimlight::server {
namespace {

using Clock = std::chrono::steady_clock;

constexpr std::size_t kMostMessage = 4096;
constexpr std::chrono::milliseconds kGlance{50};  // at whether to stop

/// Two connected sockets: unlike a pipe's, their end can be written to without a signal.
class Link {
 public:
  Link() {
    if (::socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, ends_.data()) != 0) {
      throw Error("a decoder", std::strerror(errno), "two descriptors");
    }
    ::fcntl(ours(), F_SETFL, O_NONBLOCK);
  }
  Link(const Link&) = delete;
  Link& operator=(const Link&) = delete;
  ~Link() {
    close_ours();
    close_theirs();
  }
  int ours() const { return ends_[0]; }
  int theirs() const { return ends_[1]; }
  void close_ours() { close(ends_[0]); }
  void close_theirs() { close(ends_[1]); }

 private:
  static void close(int& end) {
    if (end >= 0) ::close(std::exchange(end, -1));
  }
  std::array<int, 2> ends_{-1, -1};
};

/// A child that never outlives this.
class Child {
 public:
  Child(const std::vector<std::string>& arguments, const Link& input, const Link& output,
        const Link& errors) {
    posix_spawn_file_actions_t actions;
    ::posix_spawn_file_actions_init(&actions);
    ::posix_spawn_file_actions_adddup2(&actions, input.theirs(), 0);
    ::posix_spawn_file_actions_adddup2(&actions, output.theirs(), 1);
    ::posix_spawn_file_actions_adddup2(&actions, errors.theirs(), 2);
    ::posix_spawn_file_actions_addclosefrom_np(&actions, 3);
    std::vector<char*> texts;
    for (const std::string& text : arguments) texts.push_back(const_cast<char*>(text.c_str()));
    texts.push_back(nullptr);
    char* environment[] = {nullptr};
    const int failure =
        ::posix_spawn(&process_, texts.front(), &actions, nullptr, texts.data(), environment);
    ::posix_spawn_file_actions_destroy(&actions);
    if (failure != 0) throw Error(arguments.front(), std::strerror(failure), "a decoder");
  }
  Child(const Child&) = delete;
  Child& operator=(const Child&) = delete;
  ~Child() {
    if (process_ > 0) {
      kill();
      wait();
    }
  }
  void kill() const { ::kill(process_, SIGKILL); }
  int wait() {
    int status = 0;
    while (::waitpid(process_, &status, 0) < 0 && errno == EINTR) {
    }
    process_ = -1;
    return status;
  }

 private:
  pid_t process_ = -1;
};

/// Takes what has come, up to `most` and one more; false at the end.
bool read_some(int from, std::string& bytes, std::size_t most) {
  char buffer[65536];
  const ssize_t n = ::read(from, buffer, std::min(sizeof buffer, most + 1 - bytes.size()));
  if (n > 0) bytes.append(buffer, static_cast<std::size_t>(n));
  return n > 0 || (n < 0 && (errno == EAGAIN || errno == EINTR));
}

/// The talk with a child, until it has closed its output.
class Talk {
 public:
  Talk(const ChildCommand& command, std::string_view input)
      : command_(command), left_(input), end_(Clock::now() + command.deadline) {}

  ChildResult run() {
    Child child(command_.arguments, input_, output_, errors_);
    for (Link* const link : {&input_, &output_, &errors_}) link->close_theirs();
    result_.end = ChildResult::End::exited;
    while (result_.end == ChildResult::End::exited && output_.ours() >= 0) step();
    if (result_.end != ChildResult::End::exited) child.kill();
    const int status = child.wait();
    if (result_.end == ChildResult::End::exited) {
      read_some(errors_.ours(), result_.message, kMostMessage);
      if (WIFEXITED(status)) {
        result_.status = WEXITSTATUS(status);
      } else {
        result_.end = ChildResult::End::killed;
      }
    }
    return std::move(result_);
  }

 private:
  void step() {
    const auto left = std::chrono::ceil<std::chrono::milliseconds>(end_ - Clock::now()).count();
    if (left <= 0 || command_.stop.stop_requested()) {
      result_.end = ChildResult::End::too_late;
      return;
    }
    // poll() passes over descriptors that are negative: closed ones.
    pollfd ready[3] = {
        {input_.ours(), POLLOUT, 0}, {output_.ours(), POLLIN, 0}, {errors_.ours(), POLLIN, 0}};
    ::poll(ready, 3, static_cast<int>(std::min<std::int64_t>(left, kGlance.count())));
    if (ready[0].revents != 0) write();
    if (ready[1].revents != 0 && !read_some(output_.ours(), result_.output, command_.most_output)) {
      output_.close_ours();
    }
    if (ready[2].revents != 0 && result_.message.size() <= kMostMessage &&
        !read_some(errors_.ours(), result_.message, kMostMessage)) {
      errors_.close_ours();
    }
    if (result_.output.size() > command_.most_output || result_.message.size() > kMostMessage) {
      result_.end = ChildResult::End::too_much_output;
    }
  }

  void write() {
    const ssize_t n = ::send(input_.ours(), left_.data(), left_.size(), MSG_NOSIGNAL);
    if (n > 0) left_.remove_prefix(static_cast<std::size_t>(n));
    const bool is_broken = n < 0 && errno != EAGAIN && errno != EINTR;
    if (left_.empty() || is_broken) input_.close_ours();
  }

  const ChildCommand& command_;
  std::string_view left_;  // of the input
  const Clock::time_point end_;
  Link input_, output_, errors_;
  ChildResult result_;
};

}  // namespace

ChildResult run_child(const ChildCommand& command, std::string_view input) {
  return Talk(command, input).run();
}

}  // namespace rimlight::server
