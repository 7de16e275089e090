// Who is let in, and what they may do there: access tokens over a real socket.
#include <gtest/gtest.h>
#include <spdlog/sinks/ostream_sink.h>
#include <spdlog/spdlog.h>

#include <nlohmann/json.hpp>
#include <sstream>

#include "server/access/access_token.h"
#include "tests/server/door_client.h"
#include "tests/server/loopback_server.h"
#include "tests/support/error_of.h"

namespace rimlight::server {
namespace {

using nlohmann::json;
using rimlight::test::error_of;
using std::chrono::hours;
using std::chrono::seconds;
using test::http;
using test::LoopbackServer;
using test::status_line;
using test::upgrade;

constexpr seconds kPatience{10};
const auto kKeys = std::make_shared<const SigningKeys>(
    std::vector<SigningKey>{{"new", std::string(32, 'n')}, {"old", std::string(32, 'o')}});

LoopbackServer::Settings with_keys() {
  LoopbackServer::Settings settings;
  settings.network.keys = kKeys;
  return settings;
}

std::string token_of(Role role, const std::string& session, const SigningKeys& keys = *kKeys,
                     std::chrono::nanoseconds age = {}) {
  const auto issued = WallClock::now() - age;
  return issue_token({role, session, "Ann", issued + hours(1)}, keys, issued);
}

std::unique_ptr<StreamClient> open(const LoopbackServer& server, const std::string& session,
                                   const std::string& token) {
  return std::make_unique<StreamClient>(StreamUrl{"127.0.0.1", std::to_string(server.port())},
                                        "/sessions/" + session + "/stream?token=" + token);
}

/// The next text of that type, frames and other texts passed over; null when none comes.
json wait_for(StreamClient& client, const std::string& type) {
  const auto end = Clock::now() + kPatience;
  while (Clock::now() < end) {
    const auto received = client.receive(end);
    if (std::holds_alternative<StreamClient::Closed>(received)) return nullptr;
    const auto* const text = std::get_if<StreamClient::Text>(&received);
    if (text != nullptr && json::parse(text->text)["type"] == type) return json::parse(text->text);
  }
  return nullptr;
}

/// With what code the server closes; -1 when it does not.
int close_code(StreamClient& client) {
  const auto end = Clock::now() + kPatience;
  while (Clock::now() < end) {
    const auto received = client.receive(end);
    if (const auto* const closed = std::get_if<StreamClient::Closed>(&received)) {
      return closed->code;
    }
  }
  return -1;
}

const std::string kEdit = R"({"type":"edit","id":"e","rotation":[0,0,0,1]})";

TEST(Door, OpensForATokenOfTheSessionInTheHeaderOrTheUrl) {
  const LoopbackServer server(with_keys());
  const std::string token = token_of(Role::editor, "room");
  EXPECT_EQ(upgrade(server, "/sessions/room/stream?token=" + token), "101 Switching Protocols");
  EXPECT_EQ(upgrade(server, "/sessions/room/stream?scene=sphere&token=" + token),
            "101 Switching Protocols");
  EXPECT_EQ(upgrade(server, "/sessions/room/stream?token=" + token + "&scene=sphere"),
            "101 Switching Protocols");
  EXPECT_EQ(upgrade(server, "/sessions/room/stream", "Authorization: Bearer " + token + "\r\n"),
            "101 Switching Protocols");
  EXPECT_EQ(upgrade(server, "/sessions/other/stream?token=" + token_of(Role::viewer, "*")),
            "101 Switching Protocols");
  const SigningKeys old({{"old", std::string(32, 'o')}});
  EXPECT_EQ(upgrade(server, "/sessions/room/stream?token=" + token_of(Role::viewer, "room", old)),
            "101 Switching Protocols");
}

TEST(Door, StaysClosedWithoutOneAndTellsStrangersNothing) {
  const LoopbackServer server(with_keys());
  const std::string token = token_of(Role::editor, "room");
  const SigningKeys other({{"new", std::string(32, 'x')}});
  std::vector<std::string> answers;
  for (const std::string& shown :
       {std::string(), std::string("x"), token.substr(1), token + "A",
        token_of(Role::owner, "room", other), token_of(Role::owner, "room", *kKeys, hours(2))}) {
    const std::string query = shown.empty() ? "" : "?token=" + shown;
    EXPECT_EQ(upgrade(server, "/sessions/room/stream" + query), "401 Unauthorized") << shown;
    const std::string header = "Authorization: Bearer " + shown + "\r\n";
    EXPECT_EQ(upgrade(server, "/sessions/room/stream", header), "401 Unauthorized") << shown;
    answers.push_back(http(server.port(), "GET", "/api/scenes", header));
  }
  for (const std::string& answer : answers) EXPECT_EQ(answer, answers.front());
  EXPECT_NE(answers.front().find("WWW-Authenticate: Bearer"), std::string::npos);
  // Neither sessions nor scenes can be guessed at without a token.
  EXPECT_EQ(upgrade(server, "/sessions/room/stream?scene=none"), "401 Unauthorized");
  EXPECT_EQ(upgrade(server, "/sessions/other/stream?token=" + token), "403 Forbidden");
  // A broken header is not mended by the URL.
  EXPECT_EQ(upgrade(server, "/sessions/room/stream?token=" + token, "Authorization: Basic eA\r\n"),
            "401 Unauthorized");
  EXPECT_EQ(upgrade(server, "/sessions/room/stream?token=" + token + "&token=" + token),
            "404 Not Found");
}

TEST(Door, WhatTheApiTellsNeedsATokenThePageAndHealthDoNot) {
  const LoopbackServer server(with_keys());
  EXPECT_EQ(status_line(http(server.port(), "GET", "/")), "HTTP/1.1 200 OK");
  EXPECT_EQ(status_line(http(server.port(), "GET", "/healthz")), "HTTP/1.1 200 OK");
  const std::string header = "Authorization: bearer " + token_of(Role::viewer, "room") + "\r\n";
  for (const char* const target : {"/api/scenes", "/api/curves", "/api/none"}) {
    EXPECT_EQ(status_line(http(server.port(), "GET", target)), "HTTP/1.1 401 Unauthorized");
    EXPECT_NE(status_line(http(server.port(), "GET", target, header)), "HTTP/1.1 401 Unauthorized");
  }
}

TEST(Door, AViewersEditsAreRefusedAndAnEditorsAreNot) {
  const LoopbackServer server(with_keys());
  const auto viewer = open(server, "room", token_of(Role::viewer, "room"));
  ASSERT_TRUE(viewer->send_text(kEdit));
  const json error = wait_for(*viewer, "error");
  ASSERT_FALSE(error.is_null());
  EXPECT_EQ(error["id"], "e");
  EXPECT_NE(error["reason"].get<std::string>().find("only lets you watch"), std::string::npos);
  for (const Role role : {Role::editor, Role::owner}) {
    const auto editor = open(server, "room", token_of(role, "room"));
    ASSERT_TRUE(editor->send_text(kEdit));
    EXPECT_EQ(wait_for(*editor, "ack")["revision"], role == Role::editor ? 1 : 2);
  }
  EXPECT_FALSE(wait_for(*viewer, "state").is_null());  // it does watch
}

TEST(Door, AConnectionEndsWithItsToken) {
  const LoopbackServer server(with_keys());
  // Expires within the bound of the clocks, less two seconds.
  const auto issued = WallClock::now() - hours(1);
  const auto expires = WallClock::now() - kClockSkew + seconds(2);
  const auto client =
      open(server, "room", issue_token({Role::viewer, "room", "", expires}, *kKeys, issued));
  const auto start = Clock::now();
  EXPECT_EQ(close_code(*client), 1008);
  EXPECT_LT(Clock::now() - start, seconds(4));
}

TEST(Door, NoTokenIsEverLogged) {
  std::ostringstream log;
  const auto before = spdlog::default_logger();
  const auto sink = std::make_shared<spdlog::sinks::ostream_sink_mt>(log);
  spdlog::set_default_logger(std::make_shared<spdlog::logger>("test", sink));
  spdlog::set_level(spdlog::level::trace);
  const std::string good = token_of(Role::editor, "room");
  const std::string bad = good.substr(0, good.size() - 4) + "AAAA";
  {
    const LoopbackServer server(with_keys());
    for (const std::string& token : {good, bad}) {
      upgrade(server, "/sessions/room/stream?token=" + token);
      upgrade(server, "/sessions/room/stream?tokem=" + token);
      upgrade(server, "/sessions/other/stream?token=" + token);
      upgrade(server, "/sessions/room/stream?scene=none&token=" + token);
      upgrade(server, "/sessions/room/stream", "Authorization: Bearer " + token + "\r\n");
      http(server.port(), "GET", "/" + token);
      http(server.port(), "GET", "/api/curves?token=" + token);
    }
    const auto client = open(server, "room", good);
    ASSERT_TRUE(client->send_text(good));
    EXPECT_FALSE(wait_for(*client, "error").is_null());
  }
  spdlog::set_default_logger(before);
  EXPECT_NE(log.str().find("reason \"token\", status 401, detail \"forged\""), std::string::npos)
      << log.str();
  EXPECT_NE(log.str().find("of another session"), std::string::npos) << log.str();
  for (std::size_t i = 0; i + 12 <= good.size(); i += 6) {
    EXPECT_EQ(log.str().find(good.substr(i, 12)), std::string::npos) << log.str();
  }
}

TEST(Door, AFloodOfMessagesIsRefusedThenClosedAndNobodyElseIs) {
  LoopbackServer::Settings settings;
  settings.network.messages_per_second = 10;  // a bucket of 40
  const LoopbackServer server(settings);
  const auto other = server.open("a");
  const auto flood = server.open("a");
  ASSERT_TRUE(flood->send_text(R"({"type":"ping","id":"p"})"));
  EXPECT_FALSE(wait_for(*flood, "pong").is_null());
  for (int i = 0; i < 60; ++i) ASSERT_TRUE(flood->send_text(kEdit));
  const json error = wait_for(*flood, "error");
  ASSERT_FALSE(error.is_null());
  EXPECT_NE(error["reason"].get<std::string>().find("at most 10 a second"), std::string::npos);
  EXPECT_EQ(error["id"], "e");
  for (int i = 0; i < 400 && flood->send_text(kEdit); ++i) {
  }
  EXPECT_EQ(close_code(*flood), 1008);
  ASSERT_TRUE(other->send_text(kEdit));
  EXPECT_FALSE(wait_for(*other, "ack").is_null());
}

TEST(Door, BeyondLoopbackKeysAreNeeded) {
  LoopbackServer::Settings settings;
  settings.network.host = "0.0.0.0";
  const std::string refusal = error_of([&] { LoopbackServer server(settings); });
  EXPECT_NE(refusal.find("rimlight token --new-key"), std::string::npos) << refusal;
  settings.network.keys = kKeys;
  const LoopbackServer server(settings);
  EXPECT_EQ(upgrade(server, "/sessions/a/stream"), "401 Unauthorized");
  EXPECT_EQ(upgrade(server, "/sessions/a/stream?token=" + token_of(Role::viewer, "a"), "",
                    "192.0.2.1:8080"),
            "101 Switching Protocols");
  EXPECT_EQ(upgrade(server, "/sessions/a/stream", "", "evil.example"), "421 Misdirected Request");
}

}  // namespace
}  // namespace rimlight::server
