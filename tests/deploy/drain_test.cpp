// SIGTERM: the server says that it leaves, keeps what it acknowledged, shows the last edit to who
// waits for it, closes with code 1001, and is gone within five seconds whatever its clients do.
#include <gtest/gtest.h>

#include <atomic>
#include <nlohmann/json.hpp>
#include <thread>

#include "server/protocol/frame_message.h"
#include "tests/deploy/served_program.h"
#include "tests/support/small_bake.h"
#include "tests/support/temporary_folder.h"

namespace rimlight {
namespace {

using nlohmann::json;
using std::chrono::milliseconds;
using std::chrono::seconds;
using test::ServedProgram;
using Clock = std::chrono::steady_clock;

constexpr seconds kPatience{20};

/// A client that edits as fast as it is answered, or only watches, until it is closed.
struct Seen {
  std::int64_t acknowledged = 0;  // the last revision
  std::int64_t exact = -1;        // the newest revision of an exact frame
  int refused = 0;
  int code = -1;  // of the close frame
};

enum class Habit { edits, watches };

Seen run(StreamClient& client, Habit habit) {
  Seen result;
  std::int64_t sent = 0;
  const auto edit = [&] {
    const json message{{"type", "edit"},
                       {"id", std::to_string(++sent)},
                       {"exposure", static_cast<double>(sent % 64) / 64}};
    (void)client.send_text(message.dump());
  };
  for (const auto end = Clock::now() + kPatience; Clock::now() < end;) {
    const auto received = client.receive(end);
    if (const auto* const closed = std::get_if<StreamClient::Closed>(&received)) {
      result.code = closed->code;
      break;
    }
    if (const auto* const frame = std::get_if<StreamClient::Binary>(&received)) {
      const auto header = server::parse_frame_message(frame->bytes, "frame").header;
      if (header.exact) result.exact = std::max(result.exact, header.revision.number);
      (void)client.send_text(json{{"type", "frame_ack"}, {"frame", header.frame}}.dump());
    } else if (const auto* const text = std::get_if<StreamClient::Text>(&received)) {
      const json message = json::parse(text->text);
      if (message["type"] == "ack") result.acknowledged = message["revision"];
      if (message["type"] == "error") {
        ++result.refused;
        std::this_thread::sleep_for(milliseconds(5));
      }
      if (habit == Habit::edits && message["type"] != "state") edit();
    }
  }
  return result;
}

class Drain : public testing::Test {
 protected:
  Drain() { test::write_small_bake(folder / "a.bake", {}); }

  std::unique_ptr<ServedProgram> start() const {
    return std::make_unique<ServedProgram>(std::vector<std::string>{
        (folder / "a.bake").string(), "--store", (folder / "s.sqlite").string()});
  }
  static std::unique_ptr<StreamClient> open(const ServedProgram& server) {
    return std::make_unique<StreamClient>(server.url(), "/sessions/a/stream");
  }
  /// The first line of the answer to an upgrade, and its Retry-After.
  static std::string upgrade(const ServedProgram& server) {
    return test::ask(server.port(),
                     "GET /sessions/b/stream HTTP/1.1\r\nHost: localhost\r\n"
                     "Connection: Upgrade\r\nUpgrade: websocket\r\n"
                     "Sec-WebSocket-Version: 13\r\n"
                     "Sec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==\r\n\r\n");
  }

  test::TemporaryFolder folder;
};

TEST_F(Drain, LosesNoAcknowledgedEditShowsTheLastAndClosesAllInTime) {
  const auto server = start();
  const auto editor = open(*server), watcher = open(*server), sleeper = open(*server);
  Seen edited, watched;
  std::jthread editing([&] { edited = run(*editor, Habit::edits); });
  std::jthread watching([&] { watched = run(*watcher, Habit::watches); });
  std::this_thread::sleep_for(milliseconds(300));  // the sleeper never reads
  EXPECT_EQ(server->get("/readyz").substr(9, 3), "200");

  const auto asked = Clock::now();
  server->program().terminate();
  std::string readiness = server->get("/readyz");
  while (readiness.substr(0, 12) == "HTTP/1.1 200") readiness = server->get("/readyz");
  EXPECT_EQ(readiness.substr(9, 3), "503") << "the port closed before /readyz said so";
  EXPECT_NE(readiness.find("the server is stopping"), std::string::npos) << readiness;
  const std::string refusal = upgrade(*server);
  EXPECT_EQ(refusal.substr(9, 3), "503");
  EXPECT_NE(refusal.find("Retry-After: "), std::string::npos) << refusal;
  const auto ended = server->program().wait();
  const auto took = Clock::now() - asked;
  editing.join();
  watching.join();

  EXPECT_EQ(ended.status, 0) << ended.errors;
  EXPECT_LT(took, seconds(5));
  EXPECT_EQ(edited.code, 1001);
  EXPECT_EQ(watched.code, 1001);
  EXPECT_GT(edited.acknowledged, 10);
  EXPECT_GT(edited.refused, 0) << "edits after the signal are refused";
  EXPECT_EQ(watched.exact, edited.acknowledged) << "the last edit was not shown exactly";
  std::printf("%d edits acknowledged, %d refused; ended after %.2f s\n",
              static_cast<int>(edited.acknowledged), edited.refused,
              std::chrono::duration<double>(took).count());

  const auto again = start();
  const auto later = open(*again);
  const auto first = later->receive(Clock::now() + kPatience);
  const json welcome = json::parse(std::get<StreamClient::Text>(first).text);
  EXPECT_EQ(welcome["revision"], edited.acknowledged);
}

TEST_F(Drain, IsQuickWhenNobodyIsThereAndTheNoticeIsOff) {
  ::setenv("RIMLIGHT_DRAIN_NOTICE_MS", "0", 1);
  const auto server = start();
  ::unsetenv("RIMLIGHT_DRAIN_NOTICE_MS");
  const auto asked = Clock::now();
  server->program().terminate();
  EXPECT_EQ(server->program().wait().status, 0);
  EXPECT_LT(Clock::now() - asked, seconds(1));
}

TEST_F(Drain, ASecondSignalEndsItAtOnce) {
  const auto server = start();
  const auto sleeper = open(*server);  // takes no frame, so that the drain waits for it
  std::this_thread::sleep_for(milliseconds(200));
  server->program().terminate();
  std::this_thread::sleep_for(milliseconds(100));
  ASSERT_TRUE(server->program().is_running());
  const auto asked = Clock::now();
  server->program().terminate();
  EXPECT_EQ(server->program().wait().status, 0);
  EXPECT_LT(Clock::now() - asked, milliseconds(1000));
}

}  // namespace
}  // namespace rimlight
