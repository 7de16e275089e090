// Hosts, origins and limits over a real socket, and HTTP that no well-behaved client sends.
#include <gtest/gtest.h>

#include <thread>

#include "tests/server/door_client.h"
#include "tests/server/loopback_server.h"
#include "tests/support/error_of.h"

namespace rimlight::server {
namespace {

using rimlight::test::error_of;
using std::chrono::milliseconds;
using std::chrono::seconds;
using test::http;
using test::LoopbackServer;
using test::raw;
using test::RawSocket;
using test::status_line;
using test::upgrade;

TEST(HttpDoor, ANameThatIsNotTheServersIsMisdirected) {
  LoopbackServer::Settings settings;
  settings.network.host_names = {"Design.example.com"};
  const LoopbackServer server(settings);
  const auto status = [&](const std::string& host) {
    return status_line(
        raw(server, "GET / HTTP/1.1\r\nConnection: close\r\nHost: " + host + "\r\n\r\n"));
  };
  EXPECT_EQ(status("evil.example:" + std::to_string(server.port())),
            "HTTP/1.1 421 Misdirected Request");
  EXPECT_EQ(status("192.168.1.1"), "HTTP/1.1 421 Misdirected Request");
  EXPECT_EQ(status("localhost:1"), "HTTP/1.1 200 OK");
  EXPECT_EQ(status("DESIGN.example.com"), "HTTP/1.1 200 OK");
  EXPECT_EQ(upgrade(server, "/sessions/a/stream", "", "evil.example"), "421 Misdirected Request");
}

TEST(HttpDoor, PagesOfOtherOriginsAreRefusedUnlessTheyAreListed) {
  LoopbackServer::Settings settings;
  settings.network.origins = {"https://app.example"};
  const LoopbackServer server(settings);
  const auto status = [&](const std::string& origins) {
    return upgrade(server, "/sessions/a/stream", origins).substr(0, 3);
  };
  EXPECT_EQ(status("Origin: http://localhost\r\n"), "101");
  EXPECT_EQ(status("Origin: https://localhost\r\n"), "101");  // behind a proxy with TLS
  EXPECT_EQ(status("Origin: https://app.example\r\n"), "101");
  EXPECT_EQ(status("Origin: http://app.example\r\n"), "403");
  EXPECT_EQ(status("Origin: https://app.example.evil\r\n"), "403");
  EXPECT_EQ(status("Origin: ftp://localhost\r\n"), "403");
  EXPECT_EQ(status("Origin: \r\n"), "403");
  EXPECT_EQ(status("Origin: null\r\n"), "403");
  EXPECT_EQ(status("Origin: https://app.example\r\nOrigin: http://evil\r\n"), "403");
}

TEST(HttpDoor, RequestsThatAreNoneAreRefusedAtOnce) {
  const LoopbackServer server;
  const auto start = Clock::now();
  for (const char* const bytes :
       {"GET / HTTP/1.1\r\n\r\n",                                        // no Host
        "GET / HTTP/1.0\r\n\r\n",                                        // nor there
        "GET / HTTP/1.1\r\nHost: localhost\r\nHost: localhost\r\n\r\n",  // two
        "GET / HTTP/1.1\r\nHost: localhost\r\nhost: evil\r\n\r\n",
        "POST / HTTP/1.1\r\nContent-Length: 5\r\n\r\n",  // no Host, and a body that does not come
        "POST / HTTP/1.1\r\nTransfer-Encoding: chunked\r\n\r\n",
        "GET / HTTP/1.1\r\nHost: localhost\r\nContent-Length: 5\r\n\r\n",  // a body on GET
        "GET / HTTP/1.1\r\nHost: localhost\r\nTransfer-Encoding: chunked\r\n\r\n",
        "GET / HTTP/1.1\r\nHost: localhost\r\nContent-Length: 99999999999\r\n\r\n",
        "GET /\r\nHost: localhost\r\n\r\n",  // no version
        "GET / \r\nHost: localhost\r\n\r\n", "GET / HTTP/\r\nHost: localhost\r\n\r\n",
        "GET / HTTP\r\nHost: localhost\r\n\r\n", "GET  HTTP/1.1\r\nHost: localhost\r\n\r\n",
        "GET\r\nHost: localhost\r\n\r\n"}) {
    const std::string response = raw(server, bytes);
    ASSERT_GT(response.size(), 9u) << bytes;
    EXPECT_EQ(status_line(response).substr(9), "400 Bad Request") << bytes;
  }
  EXPECT_LT(Clock::now() - start, seconds(3));  // nothing waited for what does not come
  EXPECT_EQ(status_line(raw(server,
                            "GET / HTTP/1.1\r\nHost: localhost\r\nContent-Length: 0\r\n"
                            "Connection: close\r\n\r\n")),
            "HTTP/1.1 200 OK");
}

TEST(HttpDoor, AHeaderThatComesTooSlowlyEndsTheConnectionHoweverOftenAByteComes) {
  LoopbackServer::Settings settings;
  settings.network.handshake_timeout = seconds(1);
  const LoopbackServer server(settings);
  RawSocket socket(server.port());
  const auto start = Clock::now();
  socket.send("GET / HTTP/1.1\r\nHost: localhost\r\nX: ");
  for (int i = 0; i < 15; ++i) {
    socket.send("x");
    std::this_thread::sleep_for(milliseconds(100));
  }
  EXPECT_EQ(socket.read_all(), "");
  EXPECT_LT(Clock::now() - start, seconds(4));
}

TEST(HttpDoor, OneAddressHasNoMoreThanItsConnections) {
  LoopbackServer::Settings settings;
  settings.network.most_connections_per_address = 2;
  const LoopbackServer server(settings);
  const auto one = server.open("a");
  auto two = server.open("a");
  EXPECT_EQ(status_line(http(server.port(), "GET", "/")), "HTTP/1.1 503 Service Unavailable");
  EXPECT_NE(error_of([&] { server.open("a"); }).find("503"), std::string::npos);
  two->close();
  std::string line;
  for (int i = 0; i < 100 && line != "HTTP/1.1 200 OK"; ++i) {
    line = status_line(http(server.port(), "GET", "/"));
  }
  EXPECT_EQ(line, "HTTP/1.1 200 OK");
}

}  // namespace
}  // namespace rimlight::server
