#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "cli/load_stream.h"
#include "tests/support/program.h"

namespace rimlight::test {

/// `rimlight serve`, started with those arguments on a free port of 127.0.0.1 or the one given, and
/// waited for until it answers. Killed when it goes out of scope.
class ServedProgram {
 public:
  explicit ServedProgram(std::vector<std::string> arguments, std::uint16_t port = 0);

  std::uint16_t port() const { return port_; }
  StreamUrl url() const { return {"127.0.0.1", std::to_string(port_)}; }
  RunningProgram& program() { return *program_; }
  /// The whole response to a GET with those headers; empty when nobody answers.
  std::string get(const std::string& target, const std::string& headers = "") const;

 private:
  std::unique_ptr<RunningProgram> program_;
  std::uint16_t port_;
};

/// How much of an answer is wanted.
enum class Answer { whole, header };
/// A request to 127.0.0.1 and what comes back until the peer closes, or in part after ten seconds;
/// empty when nobody listens.
std::string ask(std::uint16_t port, const std::string& request, Answer wanted = Answer::whole);

/// A port that nobody listens on just now.
std::uint16_t free_port();

}  // namespace rimlight::test
