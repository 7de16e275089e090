#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "tests/server/loopback_server.h"
#include "tests/support/error_of.h"

namespace rimlight::server {
namespace {

using rimlight::test::error_of;
using test::http;
using test::LoopbackServer;
using test::RawSocket;

bool starts_with(const std::string& text, const std::string& start) {
  return text.compare(0, start.size(), start) == 0;
}

std::string body(const std::string& response) {
  return response.substr(response.find("\r\n\r\n") + 4);
}

TEST(Http, ServesThePageTheScenesAndItsHealth) {
  const LoopbackServer server;
  const std::string page = http(server.port(), "GET", "/");
  EXPECT_TRUE(starts_with(page, "HTTP/1.1 200")) << page;
  EXPECT_EQ(body(page), "<!doctype html><p>page");
  EXPECT_NE(page.find("Content-Security-Policy: default-src 'self'"), std::string::npos);
  EXPECT_NE(page.find("nosniff"), std::string::npos);
  EXPECT_EQ(body(http(server.port(), "GET", "/?session=x")), body(page));
  EXPECT_EQ(body(http(server.port(), "GET", "/healthz")), "ok\n");
  const auto scenes = nlohmann::json::parse(body(http(server.port(), "GET", "/api/scenes")));
  EXPECT_EQ(scenes["scenes"][0]["name"], "sphere");
  EXPECT_EQ(scenes["scenes"][0]["default"], true);
  EXPECT_EQ(scenes["scenes"][0]["size"]["width"], 64);
}

TEST(Http, AKnownEtagIsAnsweredWithoutTheBody) {
  const LoopbackServer server;
  const std::string page = http(server.port(), "GET", "/");
  const std::size_t at = page.find("ETag: ") + 6;
  const std::string etag = page.substr(at, page.find("\r\n", at) - at);
  const std::string again = http(server.port(), "GET", "/", "If-None-Match: " + etag + "\r\n");
  EXPECT_TRUE(starts_with(again, "HTTP/1.1 304")) << again;
  EXPECT_EQ(body(again), "");
}

TEST(Http, HeadHasTheLengthAndNoBody) {
  const LoopbackServer server;
  const std::string head = http(server.port(), "HEAD", "/");
  EXPECT_TRUE(starts_with(head, "HTTP/1.1 200")) << head;
  EXPECT_NE(head.find("Content-Length: 22"), std::string::npos) << head;
  EXPECT_EQ(body(head), "");
}

TEST(Http, WhatIsNotThereIsNotFoundWhateverItsPath) {
  const LoopbackServer server;
  for (const char* const target :
       {"/none", "/../../etc/passwd", "/%2e%2e/%2e%2e/etc/passwd", "//etc/passwd", "/..", "/.",
        "/index.html/../../etc/passwd", "/sessions/a/stream", "/api/", "*"}) {
    const std::string response = http(server.port(), "GET", target);
    EXPECT_TRUE(starts_with(response, "HTTP/1.1 404")) << target << ": " << response;
  }
}

TEST(Http, OtherMethodsAreRefused) {
  const LoopbackServer server;
  const std::string response = http(server.port(), "DELETE", "/");
  EXPECT_TRUE(starts_with(response, "HTTP/1.1 405")) << response;
  EXPECT_NE(response.find("Allow: GET, HEAD"), std::string::npos);
}

TEST(Http, MalformedAndOversizedRequestsAreRefusedAndOthersGoOn) {
  const LoopbackServer server;
  for (const std::string& bytes :
       {std::string("nonsense\r\n\r\n"), std::string("GET / HTTP/9.9\r\n\r\n"),
        "GET /" + std::string(100000, 'a') + " HTTP/1.1\r\n\r\n",
        std::string("POST / HTTP/1.1\r\nHost: localhost\r\nContent-Length: 5\r\n\r\nhello"),
        std::string(64, '\0') + "\r\n\r\n"}) {
    RawSocket socket(server.port());
    socket.send(bytes);
    const std::string response = socket.read_all();
    // A reset may overtake the reply when the peer has not read all; silence is no success either.
    if (!response.empty()) {
      EXPECT_TRUE(starts_with(response, "HTTP/1.1 400")) << response;
    }
    EXPECT_EQ(body(http(server.port(), "GET", "/healthz")), "ok\n");
  }
}

TEST(Http, AnUpgradeToNothingIsRefusedWithTheReason) {
  const LoopbackServer server;
  const StreamUrl url{"127.0.0.1", std::to_string(server.port())};
  const auto refusal = [&](const std::string& target) {
    return error_of([&] { StreamClient client(url, target); });
  };
  EXPECT_NE(refusal("/sessions/a%20b/stream").find("404"), std::string::npos);
  EXPECT_NE(refusal("/other").find("404"), std::string::npos);
  EXPECT_NE(refusal("/sessions/a/stream?scene=none").find("the scene"), std::string::npos)
      << refusal("/sessions/a/stream?scene=none");
}

TEST(Http, AWebSocketFromAnotherOriginIsRefused) {
  const LoopbackServer server;
  const auto upgrade = [&](const std::string& origin) {
    RawSocket socket(server.port());
    socket.send(
        "GET /sessions/a/stream HTTP/1.1\r\nHost: 127.0.0.1:" + std::to_string(server.port()) +
        "\r\nConnection: Upgrade\r\nUpgrade: websocket\r\nSec-WebSocket-Version: 13\r\n"
        "Sec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==\r\nOrigin: " +
        origin + "\r\n\r\n");
    return socket.read_some();
  };
  EXPECT_TRUE(starts_with(upgrade("http://evil.example"), "HTTP/1.1 403"));
  EXPECT_TRUE(starts_with(upgrade("null"), "HTTP/1.1 403"));
  EXPECT_TRUE(
      starts_with(upgrade("http://127.0.0.1:" + std::to_string(server.port())), "HTTP/1.1 101"));
}

TEST(Http, BeyondTheBoundOfConnectionsTheNextIsRefusedUntilOneEnds) {
  LoopbackServer::Settings settings;
  settings.network.most_connections = 2;
  const LoopbackServer server(settings);
  auto one = server.open("a");
  const auto two = server.open("b");
  EXPECT_TRUE(starts_with(http(server.port(), "GET", "/"), "HTTP/1.1 503"));
  EXPECT_NE(error_of([&] { server.open("c"); }).find("503"), std::string::npos);
  one->close();
  std::string response;
  for (int i = 0; i < 100 && !starts_with(response, "HTTP/1.1 200"); ++i) {
    response = http(server.port(), "GET", "/");
  }
  EXPECT_TRUE(starts_with(response, "HTTP/1.1 200")) << response;
}

TEST(Http, ABusyPortAndAPublicAddressAreErrorsThatNameTheAddress) {
  const LoopbackServer server;
  LoopbackServer::Settings settings;
  settings.network.port = server.port();
  const std::string busy = error_of([&] { LoopbackServer second(settings); });
  EXPECT_NE(busy.find("127.0.0.1:" + std::to_string(server.port())), std::string::npos) << busy;
  EXPECT_NE(busy.find("in use"), std::string::npos) << busy;
  settings.network.host = "0.0.0.0";
  EXPECT_NE(error_of([&] { LoopbackServer open(settings); }).find("a loopback address"),
            std::string::npos);
  settings.network.host = "example";
  EXPECT_NE(error_of([&] { LoopbackServer open(settings); }).find("an IP address"),
            std::string::npos);
}

}  // namespace
}  // namespace rimlight::server
