#include "tests/deploy/served_program.h"

#include <arpa/inet.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <sys/time.h>
#include <unistd.h>

#include <chrono>
#include <nlohmann/json.hpp>
#include <stdexcept>
#include <thread>

namespace rimlight::test {
namespace {

sockaddr_in loopback(std::uint16_t port) {
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_port = htons(port);
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  return address;
}

}  // namespace

ServedProgram::ServedProgram(std::vector<std::string> arguments, std::uint16_t port) {
  using Clock = std::chrono::steady_clock;
  arguments.insert(arguments.begin(), "serve");
  arguments.insert(arguments.end(), {"--port", std::to_string(port), "--json"});
  program_ = std::make_unique<RunningProgram>(arguments);
  const auto end = Clock::now() + std::chrono::seconds(30);
  while (program_->output().find('\n') == std::string::npos) {
    if (!program_->is_running()) throw std::runtime_error(program_->wait().errors);
    if (Clock::now() > end) throw std::runtime_error("the server does not start");
    std::this_thread::sleep_for(std::chrono::milliseconds(2));
  }
  const std::string address = nlohmann::json::parse(program_->output())["address"];
  port_ = static_cast<std::uint16_t>(std::stoi(address.substr(address.rfind(':') + 1)));
}

std::string ServedProgram::get(const std::string& target, const std::string& headers) const {
  return ask(port_, "GET " + target + " HTTP/1.1\r\nHost: localhost\r\nConnection: close\r\n" +
                        headers + "\r\n");
}

std::string ask(std::uint16_t port, const std::string& request, Answer wanted) {
  const int socket = ::socket(AF_INET, SOCK_STREAM, 0);
  const timeval timeout{10, 0};  // HAProxy tries a server that is away for 3 s
  ::setsockopt(socket, SOL_SOCKET, SO_RCVTIMEO, &timeout, sizeof timeout);
  const sockaddr_in address = loopback(port);
  std::string response;
  if (::connect(socket, reinterpret_cast<const sockaddr*>(&address), sizeof address) == 0 &&
      ::send(socket, request.data(), request.size(), MSG_NOSIGNAL) > 0) {
    char buffer[4096];
    for (ssize_t n = 0; (n = ::recv(socket, buffer, sizeof buffer, 0)) > 0;) {
      response.append(buffer, static_cast<std::size_t>(n));
      if (wanted == Answer::header && response.find("\r\n\r\n") != std::string::npos) break;
    }
  }
  ::close(socket);
  return response;
}

std::uint16_t free_port() {
  const int socket = ::socket(AF_INET, SOCK_STREAM, 0);
  sockaddr_in address = loopback(0);
  socklen_t size = sizeof address;
  ::bind(socket, reinterpret_cast<const sockaddr*>(&address), size);
  ::getsockname(socket, reinterpret_cast<sockaddr*>(&address), &size);
  ::close(socket);
  return ntohs(address.sin_port);
}

}  // namespace rimlight::test
