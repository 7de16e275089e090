// Clients that come back over real sockets: after a lost link, and after a restart of the server.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdio>
#include <nlohmann/json.hpp>

#include "server/access/access_token.h"
#include "tests/server/door_client.h"
#include "tests/server/loopback_server.h"

namespace rimlight::server {
namespace {

using nlohmann::json;
using std::chrono::seconds;
using test::LoopbackServer;
using ::testing::HasSubstr;

constexpr seconds kPatience{20};
/// What a client may wait for its first frame.
constexpr double kFirstFrameMs = 1000;

/// A client of session "a", with what its page would keep.
class Visit {
 public:
  explicit Visit(const LoopbackServer& server, const std::string& resume = "",
                 std::int64_t seen = 0)
      : start_(Clock::now()),
        stream_(StreamUrl{"127.0.0.1", std::to_string(server.port())},
                "/sessions/a/stream" +
                    (resume.empty() ? std::string()
                                    : "?resume=" + resume + "&seen=" + std::to_string(seen))) {
    welcome = next("welcome");
  }
  /// The next message of that type; null when none comes.
  json next(const std::string& type) {
    for (;;) {
      const auto received = stream_.receive(Clock::now() + kPatience);
      if (const auto* const text = std::get_if<StreamClient::Text>(&received)) {
        json message = json::parse(text->text);
        if (message["type"] == type) return message;
      } else if (const auto* const frame = std::get_if<StreamClient::Binary>(&received)) {
        const auto number = parse_frame_message(frame->bytes, "frame").header.frame;
        if (type == "frame") return number;
        if (!send({{"type", "frame_ack"}, {"frame", number}})) return {};
      } else {
        return {};
      }
    }
  }
  bool send(const json& message) { return stream_.send_text(message.dump()); }
  json ask(const json& message) { return send(message) ? next("ack") : json(); }
  double first_frame_ms() {
    EXPECT_FALSE(next("frame").is_null());
    return std::chrono::duration<double, std::milli>(Clock::now() - start_).count();
  }

  json welcome;

 private:
  Clock::time_point start_;
  StreamClient stream_;
};

void expect_resumed(const LoopbackServer& server, const json& before, const json& last,
                    const char* after) {
  Visit visit(server, before["resume"], last["revision"].get<std::int64_t>());
  const json& welcome = visit.welcome;
  EXPECT_EQ(welcome["resumed"], true);
  EXPECT_EQ(welcome["you"], before["you"]);
  EXPECT_EQ(welcome["state"], last["state"]);
  EXPECT_EQ(welcome["history"], last["history"]);
  EXPECT_EQ(welcome["missed"], 0);
  const double ms = visit.first_frame_ms();
  std::printf("first frame %.0f ms after coming back, %s\n", ms, after);
  EXPECT_LT(ms, kFirstFrameMs);
  const json undone = visit.ask({{"type", "undo"}, {"id", "u"}});
  EXPECT_EQ(undone["state"]["exposure"], 1.0);
  EXPECT_EQ(undone["by"]["id"], before["you"]["id"]);
  EXPECT_EQ(visit.ask({{"type", "redo"}, {"id", "r"}})["state"], last["state"]);
}

TEST(ResumedStream, AfterALostLinkItIsTheSameUserWithTheSameHistory) {
  const LoopbackServer server;
  json before, last;
  {
    Visit visit(server);
    before = visit.welcome;
    visit.ask({{"type", "edit"}, {"id", "1"}, {"exposure", 1}});
    last = visit.ask({{"type", "edit"}, {"id", "2"}, {"gesture", "g"}, {"exposure", 2}});
  }  // without a goodbye
  expect_resumed(server, before, last, "the link was lost");
}

TEST(ResumedStream, AfterARestartToo) {
  rimlight::test::TemporaryFolder folder;
  LoopbackServer::Settings settings;
  settings.store = folder / "sessions.sqlite";
  json before, last;
  {
    const LoopbackServer server(settings);
    Visit visit(server);
    before = visit.welcome;
    visit.ask({{"type", "edit"}, {"id", "1"}, {"exposure", 1}});
    last = visit.ask({{"type", "edit"}, {"id", "2"}, {"gesture", "g"}, {"exposure", 2}});
  }
  const LoopbackServer again(settings);
  expect_resumed(again, before, last, "the server was restarted");
}

TEST(ResumedStream, OthersAreToldWhoComesAndWhoIsGone) {
  const LoopbackServer server;
  Visit stays(server);
  {
    Visit passes(server);
    EXPECT_EQ(passes.welcome["present"].size(), 2u);
    const json came = stays.next("presence");
    EXPECT_EQ(came["present"], passes.welcome["present"]);
  }
  const json left = stays.next("presence");
  ASSERT_EQ(left["present"].size(), 1u);
  EXPECT_EQ(left["present"][0], stays.welcome["you"]);
}

TEST(ResumedStream, ASnapshotIsToldToAllAndRestored) {
  const LoopbackServer server;
  Visit one(server), other(server);
  one.ask({{"type", "snapshot"}, {"id", "s"}, {"action", "make"}, {"name", "früh"}});
  EXPECT_EQ(other.next("snapshots")["snapshots"][0]["name"], "früh");
  other.ask({{"type", "edit"}, {"id", "e"}, {"exposure", 3}});
  const json back =
      one.ask({{"type", "snapshot"}, {"id", "r"}, {"action", "restore"}, {"name", "früh"}});
  EXPECT_EQ(back["state"]["exposure"], 0.0);
  EXPECT_EQ(other.next("state")["state"]["exposure"], 0.0);
}

TEST(StateFile, IsForWhoMayOpenTheSession) {
  const auto keys =
      std::make_shared<const SigningKeys>(std::vector<SigningKey>{{"k", std::string(32, 'x')}});
  LoopbackServer::Settings settings;
  settings.network.keys = keys;
  const LoopbackServer server(settings);
  const auto bearer = [&](const std::string& session) {
    const auto now = WallClock::now();
    return "Authorization: Bearer " +
           issue_token({Role::viewer, session, "", now + std::chrono::hours(1)}, *keys, now) +
           "\r\n";
  };
  const auto get = [&](const std::string& target, const std::string& headers) {
    return test::http(server.port(), "GET", target, headers);
  };
  EXPECT_THAT(get("/sessions/a/state", ""), HasSubstr(" 401 "));
  EXPECT_THAT(get("/sessions/a/state", bearer("b")), HasSubstr(" 403 "));
  EXPECT_THAT(get("/sessions/a/state", bearer("a")), HasSubstr(" 404 "));  // nobody has opened it
  EXPECT_THAT(get("/sessions/a/state?scene=none", bearer("a")), HasSubstr(" 404 "));
  EXPECT_THAT(get("/sessions/..%2f/state", bearer("*")), HasSubstr(" 404 "));
  EXPECT_THAT(test::http(server.port(), "DELETE", "/sessions/a/state", bearer("a")),
              HasSubstr(" 405 "));
  const std::string token = bearer("a");
  EXPECT_EQ(test::upgrade(server, "/sessions/a/stream", token).substr(0, 3), "101");
  const std::string answer = get("/sessions/a/state", token);
  ASSERT_THAT(answer, HasSubstr(" 200 "));
  const json file = json::parse(answer.substr(answer.find("\r\n\r\n")));
  EXPECT_EQ(file["session"], "a");
  EXPECT_EQ(file["state"]["exposure"], 0.0);
}

}  // namespace
}  // namespace rimlight::server
