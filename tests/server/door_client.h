#pragma once

#include <algorithm>
#include <string>

#include "tests/server/loopback_server.h"

namespace rimlight::server::test {

/// The first line of a response.
inline std::string status_line(const std::string& response) {
  return response.substr(0, response.find("\r\n"));
}

/// The first line of the answer to an upgrade with those headers, without the protocol.
inline std::string upgrade(const LoopbackServer& server, const std::string& target,
                           const std::string& headers = "", const std::string& host = "localhost") {
  RawSocket socket(server.port());
  socket.send("GET " + target + " HTTP/1.1\r\nHost: " + host +
              "\r\nConnection: Upgrade\r\nUpgrade: websocket\r\nSec-WebSocket-Version: 13\r\n"
              "Sec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==\r\n" +
              headers + "\r\n");
  const std::string line = status_line(socket.read_some());
  return line.substr(std::min<std::size_t>(9, line.size()));
}

/// What the server says to those bytes until it closes.
inline std::string raw(const LoopbackServer& server, const std::string& bytes) {
  RawSocket socket(server.port());
  socket.send(bytes);
  return socket.read_all();
}

}  // namespace rimlight::server::test
