#include "server/schedule/overload.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <vector>

#include "server/schedule/render_queue.h"
#include "server/session/session_registry.h"
#include "tests/server/design_session_case.h"
#include "tests/server/loopback_server.h"

namespace rimlight::server {
namespace {

using test::DesignSessionTest;

using std::chrono::microseconds;
using std::chrono::milliseconds;
using std::chrono::seconds;
using Stage = Overload::Stage;

const Clock::time_point kStart{std::chrono::hours(1)};

/// Jobs that each begin so late, one every 10 ms.
Clock::time_point run(Overload& overload, milliseconds late, milliseconds time,
                      Clock::time_point from) {
  const Clock::time_point end = from + time;
  for (; from < end; from += milliseconds(10)) overload.begin(from - late, from);
  return from;
}

TEST(Overload, LeavesBudgetsWholeWhileJobsAreNearlyInTime) {
  Overload overload;
  EXPECT_EQ(overload.budget_share(kStart), 1);
  EXPECT_EQ(overload.stage(kStart), Stage::none);
  const auto now = run(overload, milliseconds(24), seconds(10), kStart);
  EXPECT_EQ(overload.budget_share(now), 1);
  EXPECT_EQ(overload.stage(now), Stage::none);
}

TEST(Overload, MeansFollowTheirTimes) {
  Overload overload;
  auto now = run(overload, milliseconds(0), seconds(5), kStart);
  now = run(overload, milliseconds(100), milliseconds(500), now);
  EXPECT_NEAR(overload.mean_lateness_ms(), 100 * -std::expm1(-1), 1.5);
  EXPECT_NEAR(overload.budget_share(now), 25 / (100 * -std::expm1(-1)), 0.01);
  EXPECT_EQ(overload.stage(now), Stage::smaller_budgets);
}

TEST(Overload, SharesAreNeverBelowTheLeast) {
  Overload overload;
  const auto now = run(overload, seconds(3600), seconds(5), kStart);
  EXPECT_EQ(overload.budget_share(now), 0.125);
}

TEST(Overload, StagesComeOneAfterTheOtherAndGoAtHalfOfWhatBeganThem) {
  Overload overload;
  auto now = run(overload, milliseconds(245), seconds(20), kStart);
  EXPECT_EQ(overload.stage(now), Stage::smaller_budgets);
  now = run(overload, milliseconds(260), seconds(20), now);
  EXPECT_EQ(overload.stage(now), Stage::no_new_sessions);
  now = run(overload, milliseconds(610), seconds(20), now);
  EXPECT_EQ(overload.stage(now), Stage::editors_first);
  now = run(overload, milliseconds(310), seconds(20), now);
  EXPECT_EQ(overload.stage(now), Stage::editors_first);
  now = run(overload, milliseconds(290), seconds(20), now);
  EXPECT_EQ(overload.stage(now), Stage::no_new_sessions);
  now = run(overload, milliseconds(130), seconds(20), now);
  EXPECT_EQ(overload.stage(now), Stage::no_new_sessions);
  now = run(overload, milliseconds(120), seconds(20), now);
  EXPECT_EQ(overload.stage(now), Stage::smaller_budgets);
}

TEST(Overload, OneLateJobIsNoOverload) {
  Overload overload;
  auto now = run(overload, milliseconds(0), seconds(5), kStart);
  overload.begin(now - seconds(1), now);
  EXPECT_EQ(overload.budget_share(now), 1);
  EXPECT_EQ(overload.stage(now), Stage::none);
}

TEST(Overload, EndsWhenNothingIsAskedFor) {
  Overload overload;
  const auto now = run(overload, seconds(2), seconds(20), kStart);
  EXPECT_EQ(overload.stage(now), Stage::editors_first);
  EXPECT_EQ(overload.stage(now + milliseconds(2100)), Stage::none);
  EXPECT_EQ(overload.budget_share(now + milliseconds(2100)), 1);
}

TEST(Overload, AJobBeforeItsTimeIsNotLate) {
  Overload overload;
  overload.begin(kStart + seconds(1), kStart);
  EXPECT_EQ(overload.mean_lateness_ms(), 0);
}

/// Sessions that are always edited, in turn: each frame takes 2 ms and its share of 8 ms.
class Turns : public testing::TestWithParam<int> {
 protected:
  struct Job : RenderJob, std::enable_shared_from_this<Job> {
    explicit Job(Turns& turns_) : turns(turns_) {}
    void work(Clock::time_point at) noexcept override {
      const double share = turns.queue.overload().budget_share(at);
      turns.now += microseconds(static_cast<int>(2000 + 8000 * share));
      ++frames;
      turns.shares.push_back(share);
      turns.queue.schedule(shared_from_this(), turns.now);
    }
    Turns& turns;
    int frames = 0;
  };

  Clock::time_point now = kStart;
  RenderQueue queue{[this] { return now; }};
  std::vector<double> shares;
};

TEST_P(Turns, SettleWithoutSwingingAndFairly) {
  const int count = GetParam();
  std::vector<std::shared_ptr<Job>> jobs;
  for (int i = 0; i < count; ++i) {
    jobs.push_back(std::make_shared<Job>(*this));
    queue.schedule(jobs.back(), now);
  }
  const auto play = [&](seconds time) {
    shares.clear();
    const auto end = now + time;
    while (now < end) ASSERT_TRUE(queue.run_one(now));
  };
  play(seconds(5));
  play(seconds(5));
  const auto [low, high] = std::ranges::minmax(shares);
  EXPECT_LT(high - low, 0.02);
  // (n − 1) (2 + 8 s) ms late, with s = 25 / late.
  const double others = count - 1;
  const double late = others + std::sqrt(others * others + 200 * others);
  EXPECT_NEAR(high, std::clamp(25 / std::max(late, 1.0), 0.125, 1.0), 0.03);
  for (const auto& job : jobs) EXPECT_NEAR(job->frames, jobs[0]->frames, 1);
}
INSTANTIATE_TEST_SUITE_P(Sessions, Turns, testing::Values(1, 2, 4, 8, 32, 100));

TEST_F(DesignSessionTest, FramesInMotionGetTheShareOfTheirBudget) {
  const auto client = join();
  work();
  acknowledge(*client);
  edit(*client, 10);
  work();
  EXPECT_EQ(probe->budget_share, 1);
  acknowledge(*client);
  pass(milliseconds(60));
  acknowledge(*client);
  edit(*client, 20);
  now += milliseconds(400);  // nobody had a turn
  work();
  EXPECT_LT(probe->budget_share, 1);
}

TEST(EditorsFirst, WhoMayOnlyWatchGetsExactFramesAlone) {
  Clock::time_point now = kStart;
  RenderQueue queue([&] { return now; }, {.shedding = milliseconds(0)});
  const ServedScene scene = test::sphere_scene("sphere", 32, 24);
  const auto session = std::make_shared<DesignSession>("s", scene, 5, SessionSettings{}, queue);
  const auto editor = std::make_shared<test::KeepingClient>();
  const auto watcher = std::make_shared<test::KeepingClient>();
  session->join(editor, now, {.role = Role::editor});
  session->join(watcher, now, {.role = Role::viewer});
  const auto work = [&] {
    while (queue.run_one(now)) {
    }
  };
  const auto acknowledge = [&](const test::KeepingClient& client) {
    EXPECT_EQ(session->acknowledge(client, client.frames.back()->frame, now), AckResult::taken);
  };
  work();
  ASSERT_EQ(queue.overload().stage(now), Stage::editors_first);
  acknowledge(*editor);
  acknowledge(*watcher);
  for (int i = 1; i <= 3; ++i) {
    Edit edit;
    edit.id = std::to_string(i);
    edit.exposure_stops = 0.1 * i;
    session->apply(*editor, edit, now);
    now += milliseconds(10);
    work();
    acknowledge(*editor);
  }
  EXPECT_EQ(editor->frames.size(), 4u);
  EXPECT_EQ(watcher->frames.size(), 1u);
  now += milliseconds(60);
  work();
  ASSERT_EQ(watcher->frames.size(), 2u);
  EXPECT_TRUE(watcher->last().exact);
  EXPECT_EQ(watcher->last().revision, editor->last().revision);
}

TEST(SessionRegistry, OpensNoSessionUnderOverloadButLetsPeopleJoin) {
  Clock::time_point now = kStart;
  RenderQueue queue([&] { return now; }, {.refusing = milliseconds(0)});
  const SceneCatalog scenes({test::sphere_scene("sphere", 32, 24)});
  SessionRegistry registry(scenes, queue, {});
  const auto client = std::make_shared<test::KeepingClient>();
  const auto session = registry.join("one", "", client, now);
  ASSERT_NE(session, nullptr);
  ASSERT_TRUE(queue.run_one(now));
  ASSERT_EQ(queue.overload().stage(now), Stage::no_new_sessions);
  EXPECT_EQ(registry.join("two", "", client, now), nullptr);
  EXPECT_EQ(registry.join("one", "", client, now), session);
  now += seconds(3);
  EXPECT_NE(registry.join("two", "", client, now), nullptr);
}

TEST(OverloadStream, NewSessionsGet503WithATimeToTryAgain) {
  test::LoopbackServer::Settings settings;
  settings.overload.refusing = milliseconds(0);
  test::LoopbackServer server(settings);
  const auto stream = server.open("one");
  // The first exact frame is a job that the queue has begun.
  while (
      !std::holds_alternative<StreamClient::Binary>(stream->receive(Clock::now() + seconds(5)))) {
  }
  test::RawSocket socket(server.port());
  socket.send(
      "GET /sessions/two/stream HTTP/1.1\r\nHost: 127.0.0.1:" + std::to_string(server.port()) +
      "\r\nUpgrade: websocket\r\nConnection: Upgrade\r\nSec-WebSocket-Version: 13\r\n"
      "Sec-WebSocket-Key: AAAAAAAAAAAAAAAAAAAAAA==\r\n\r\n");
  const std::string refused = socket.read_some();
  EXPECT_TRUE(refused.starts_with("HTTP/1.1 503 ")) << refused;
  EXPECT_NE(refused.find("Retry-After: 5\r\n"), std::string::npos) << refused;
  EXPECT_NE(test::http(server.port(), "GET", "/metrics").find("\nrimlight_overload_stage 2\n"),
            std::string::npos);
  EXPECT_NO_THROW(server.open("one"));
}

}  // namespace
}  // namespace rimlight::server
