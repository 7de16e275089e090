// The log: one line an event, with connection ids, no secrets, and no flood.
#include "server/log/event_log.h"

#include <gtest/gtest.h>
#include <spdlog/sinks/ostream_sink.h>
#include <spdlog/spdlog.h>

#include <nlohmann/json.hpp>
#include <set>
#include <sstream>
#include <thread>

#include "server/access/access_token.h"
#include "tests/server/door_client.h"
#include "tests/server/loopback_server.h"

namespace rimlight::server {
namespace {

using nlohmann::json;
using std::chrono::milliseconds;
using std::chrono::seconds;
using test::LoopbackServer;

/// What is logged while it lives, instead of the log.
class KeptLog {
 public:
  KeptLog() : before_(spdlog::default_logger()) {
    auto sink = std::make_shared<spdlog::sinks::ostream_sink_mt>(text_);
    sink->set_pattern("%v");
    auto logger = std::make_shared<spdlog::logger>("kept", sink);
    spdlog::set_default_logger(logger);
  }
  ~KeptLog() { spdlog::set_default_logger(before_); }
  std::string text() const { return text_.str(); }
  /// The lines with that text, in order.
  std::vector<std::string> lines(const std::string& with) const {
    std::vector<std::string> found;
    std::istringstream all(text_.str());
    for (std::string line; std::getline(all, line);) {
      if (line.find(with) != std::string::npos) found.push_back(line);
    }
    return found;
  }

 private:
  std::ostringstream text_;
  std::shared_ptr<spdlog::logger> before_;
};

TEST(EventLog, SaysEventsInWords) {
  const KeptLog log;
  log_event(Severity::info, "thing_happened", {{"connection", 7}, {"session", "a \"b\""}});
  EXPECT_EQ(log.text(), "thing happened: connection 7, session \"a \\\"b\\\"\"\n");
}

TEST(EventLog, CutsLongTextsAndTakesAnyBytes) {
  const KeptLog log;
  log_event(Severity::info, "long_text", {{"detail", std::string(1000, 'x')}});
  log_event(Severity::info, "odd_text", {{"detail", "\xff\n\x01"}});
  EXPECT_EQ(log.text().find(std::string(201, 'x')), std::string::npos);
  EXPECT_NE(log.text().find(std::string(200, 'x')), std::string::npos);
  EXPECT_EQ(log.lines("odd").size(), 1u);  // on one line
}

TEST(EventAllowance, LetsABurstPassThenSoManyASecondAndCountsTheRest) {
  EventAllowance allowance;
  auto now = EventAllowance::Clock::now();
  int logged = 0;
  for (int i = 0; i < 10000; ++i) logged += allowance.take("flood", now).has_value() ? 1 : 0;
  EXPECT_EQ(logged, static_cast<int>(EventAllowance::kBurst));
  EXPECT_EQ(allowance.take("other", now), 0);  // has an allowance of its own
  now += seconds(1);
  EXPECT_EQ(allowance.take("flood", now), 10000 - logged);
  EXPECT_EQ(allowance.take("flood", now), 0);
  logged = 2;
  for (int i = 0; i < 10000; ++i) logged += allowance.take("flood", now).has_value() ? 1 : 0;
  EXPECT_EQ(logged, static_cast<int>(EventAllowance::kPerSecond));
}

/// The number after "connection " in a line.
std::string connection_of(const std::string& line) {
  const std::size_t at = line.find("connection ", line.find(": ")) + 11;
  return line.substr(at, line.find(',', at) - at);
}

/// Whether the client is told that nobody else is there.
bool sees_it_alone(StreamClient& client) {
  const auto end = Clock::now() + seconds(10);
  while (Clock::now() < end) {
    const auto received = client.receive(end);
    const auto* const text = std::get_if<StreamClient::Text>(&received);
    if (text == nullptr) continue;
    const json message = json::parse(text->text);
    if (message["type"] == "presence" && message["present"].size() == 1) return true;
  }
  return false;
}

TEST(ServerLog, FollowsAConnectionByItsNumberAndSaysOnceWhyItEnded) {
  const KeptLog log;
  {
    LoopbackServer server;
    const auto first = server.open("lobby");
    const auto second = server.open("lobby");
    first->close();
    ASSERT_TRUE(sees_it_alone(*second));
    (void)server.stop();
  }
  const auto opened = log.lines("connection opened"), closed = log.lines("connection closed");
  ASSERT_EQ(opened.size(), 2u) << log.text();
  ASSERT_EQ(closed.size(), 2u) << log.text();
  EXPECT_NE(connection_of(opened[0]), connection_of(opened[1]));
  EXPECT_NE(opened[0].find("session \"lobby\", scene \"sphere\", role \"owner\""),
            std::string::npos);
  // Two threads may tell of their opening in either order; connections are numbered as they come.
  EXPECT_EQ((std::set{connection_of(opened[0]), connection_of(opened[1])}),
            (std::set{connection_of(closed[0]), connection_of(closed[1])}));
  EXPECT_LT(connection_of(closed[0]), connection_of(closed[1]));
  EXPECT_NE(closed[0].find("reason \"client_closed\""), std::string::npos) << closed[0];
  EXPECT_NE(closed[1].find("reason \"server_stopped\""), std::string::npos) << closed[1];
}

TEST(ServerLog, HasRefusalsOnceWithTheirReasonAndNeverATokenWhereverItStood) {
  const auto keys =
      std::make_shared<const SigningKeys>(std::vector<SigningKey>{{"new", std::string(32, 'n')}});
  const auto now = WallClock::now();
  const std::string token =
      issue_token({Role::editor, "room", "Ann", now + std::chrono::hours(1)}, *keys, now);
  const KeptLog log;
  {
    LoopbackServer::Settings settings;
    settings.network.keys = keys;
    LoopbackServer server(settings);
    const std::string forged = token.substr(0, token.size() - 4) + "AAAA";
    EXPECT_EQ(test::upgrade(server, "/sessions/room/stream?token=" + token).substr(0, 3), "101");
    EXPECT_EQ(test::upgrade(server, "/sessions/room/stream?token=" + forged).substr(0, 3), "401");
    EXPECT_EQ(test::upgrade(server, "/sessions/other/stream?token=" + token).substr(0, 3), "403");
    // In places where it does not belong.
    for (const std::string& target :
         {"/sessions/room/stream?scene=" + token, "/sessions/" + token + "/stream",
          "/sessions/room/stream?tokn=" + token, "/sessions/room/stream&token=" + token,
          "/sessions/room/stream?scene=none&token=" + token, "/" + token}) {
      (void)test::upgrade(server, target);
      (void)test::http(server.port(), "GET", target);
      (void)test::http(server.port(), token, target);
    }
    (void)test::raw(server, "GET / HTTP/1.1\r\nHost: " + token + "\r\n\r\n");
    (void)test::raw(server, token + "\r\n\r\n");
  }
  EXPECT_EQ(log.lines("reason \"token\", status 401, detail \"forged\"").size(), 1u) << log.text();
  EXPECT_EQ(log.lines("status 403, detail \"of another session\"").size(), 1u) << log.text();
  EXPECT_GE(log.lines("refused").size(), 15u);
  const std::string signature = token.substr(token.rfind('.') + 1);
  const std::string claims = token.substr(0, token.rfind('.')).substr(token.find('.') + 1);
  EXPECT_EQ(log.text().find(signature.substr(0, 12)), std::string::npos) << log.text();
  EXPECT_EQ(log.text().find(claims.substr(0, 12)), std::string::npos) << log.text();
  EXPECT_EQ(log.text().find(std::string(32, 'n')), std::string::npos) << log.text();
}

TEST(ServerLog, AFloodOfRefusalsIsBounded) {
  const KeptLog log;
  const LoopbackServer server;
  for (int i = 0; i < 400; ++i) {
    (void)test::raw(server, "GET / HTTP/1.1\r\nHost: evil.example\r\n\r\n");
  }
  EXPECT_GT(log.lines("refused").size(), 0u);
  EXPECT_LT(log.lines("refused").size(), 350u);
}

}  // namespace
}  // namespace rimlight::server
