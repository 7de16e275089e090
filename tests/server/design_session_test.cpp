#include "server/session/design_session.h"

#include <gtest/gtest.h>

#include "core/base/error.h"
#include "server/session/session_registry.h"
#include "tests/server/design_session_case.h"
#include "tests/support/error_of.h"

namespace rimlight::server {
namespace {

using nlohmann::json;
using rimlight::test::error_of;
using std::chrono::milliseconds;
using test::DesignSessionTest;
using test::KeepingClient;
using test::sphere_scene;
using test::SphereProbe;

TEST_F(DesignSessionTest, TheFirstClientIsWelcomedAndGetsTheExactFrameAtOnce) {
  const auto client = join();
  ASSERT_EQ(client->texts.size(), 1u);
  EXPECT_EQ(client->texts[0]["type"], "welcome");
  EXPECT_EQ(client->texts[0]["environments"], json({"day", "night"}));
  EXPECT_EQ(client->texts[0]["state"]["environment"], "day");
  EXPECT_EQ(client->texts[0]["revision"], 0);
  EXPECT_EQ(client->texts[0]["epoch"], 5);
  work();
  ASSERT_EQ(client->frames.size(), 1u);
  EXPECT_TRUE(client->last().exact);
  EXPECT_EQ(client->last().codec, Codec::png);
  EXPECT_EQ(client->last().revision, (Revision{5, 0}));
}

TEST_F(DesignSessionTest, ABurstOfEditsCostsOneFrame) {
  const auto client = join();
  work();
  acknowledge(*client);
  for (int i = 1; i <= 100; ++i) edit(*client, i, std::to_string(i));
  work();
  EXPECT_EQ(probe->moving_frames, 1);
  ASSERT_EQ(client->frames.size(), 2u);
  EXPECT_EQ(client->last().revision.number, 100);
  EXPECT_EQ(client->last().codec, Codec::jpeg);
  EXPECT_FALSE(client->last().exact);
  ASSERT_EQ(client->texts.size(), 101u);
  for (int i = 1; i <= 100; ++i) {
    const json& ack = client->texts[static_cast<std::size_t>(i)];
    EXPECT_EQ(ack["type"], "ack");
    EXPECT_EQ(ack["id"], std::to_string(i));
    EXPECT_EQ(ack["revision"], i);
  }
}

TEST_F(DesignSessionTest, AfterQuietThereIsOneExactFrameAndThenNoCostAtAll) {
  const auto client = join();
  work();
  acknowledge(*client);
  edit(*client, 10);
  work();
  acknowledge(*client);
  pass(milliseconds(49));
  EXPECT_EQ(client->frames.size(), 2u);
  pass(milliseconds(1));
  ASSERT_EQ(client->frames.size(), 3u);
  EXPECT_TRUE(client->last().exact);
  EXPECT_EQ(client->last().revision.number, 1);
  acknowledge(*client);
  EXPECT_EQ(queue.next_due(), Clock::time_point::max());
}

TEST_F(DesignSessionTest, AnEditPutsTheExactFrameOff) {
  const auto client = join();
  work();
  acknowledge(*client);
  for (int i = 0; i < 20; ++i) {
    edit(*client, i + 1);
    work();
    acknowledge(*client);
    pass(milliseconds(40));
  }
  EXPECT_EQ(probe->exact_frames, 1);  // the first
  EXPECT_EQ(probe->moving_frames, 20);
}

TEST_F(DesignSessionTest, AnEditDuringTheExactFrameAbandonsIt) {
  const auto client = join();
  work();
  acknowledge(*client);
  edit(*client, 10);
  work();
  acknowledge(*client);
  probe->on_row = [&](int row) {
    if (row == 5) edit(*client, 20);
  };
  now += milliseconds(50);
  ASSERT_TRUE(queue.run_one(now));
  probe->on_row = nullptr;
  EXPECT_EQ(probe->abandoned, 1);
  EXPECT_EQ(client->frames.size(), 2u);
  work();
  ASSERT_EQ(client->frames.size(), 3u);
  EXPECT_EQ(client->last().revision.number, 2);
  EXPECT_FALSE(client->last().exact);
  acknowledge(*client);
  pass(milliseconds(50));
  EXPECT_TRUE(client->last().exact);
  EXPECT_EQ(client->last().revision.number, 2);
}

TEST_F(DesignSessionTest, ASlowClientGetsFewerFramesNeverOlderAndTheLastExactOne) {
  const auto fast = join();
  const auto slow = join();
  work();
  ASSERT_EQ(slow->frames.size(), 1u);  // and never acknowledges it, until the end
  acknowledge(*fast);
  for (int i = 1; i <= 10; ++i) {
    edit(*fast, i);
    work();
    acknowledge(*fast);
  }
  EXPECT_EQ(fast->frames.size(), 11u);
  EXPECT_EQ(slow->frames.size(), 1u);
  acknowledge(*slow);
  ASSERT_EQ(slow->frames.size(), 2u);
  EXPECT_EQ(slow->last().revision.number, 10);
  EXPECT_EQ(slow->frames.back()->payload, fast->frames.back()->payload);  // encoded once for all
  pass(milliseconds(50));
  EXPECT_EQ(slow->frames.size(), 2u);
  acknowledge(*slow);
  ASSERT_EQ(slow->frames.size(), 3u);
  EXPECT_TRUE(slow->last().exact);
}

TEST_F(DesignSessionTest, FramesThatNobodyCanTakeAreNotMade) {
  const auto client = join();
  work();
  for (int i = 1; i <= 10; ++i) {
    edit(*client, i);
    pass(milliseconds(10));
  }
  EXPECT_EQ(probe->moving_frames, 0);
  acknowledge(*client);
  work();
  EXPECT_EQ(probe->moving_frames, 1);
  EXPECT_EQ(client->last().revision.number, 10);
}

TEST_F(DesignSessionTest, OthersAreToldTheStateThatOneSets) {
  const auto one = join();
  const auto other = join();
  Edit change;
  change.id = "x";
  change.environment = "night";
  change.exposure_stops = 2;
  session->apply(*one, change, now);
  EXPECT_EQ(one->texts.back()["type"], "ack");
  EXPECT_EQ(one->texts.back()["state"]["environment"], "night");
  EXPECT_TRUE(one->states.empty());
  ASSERT_EQ(other->states.size(), 1u);
  EXPECT_EQ(other->states[0]["state"]["environment"], "night");
  EXPECT_EQ(other->states[0]["state"]["exposure"], 2);
  EXPECT_EQ(other->states[0]["state"]["rotation"], json({0, 0, 0, 1}));
  EXPECT_EQ(other->states[0]["revision"], 1);
}

TEST_F(DesignSessionTest, WhoComesLaterGetsTheCurrentExactFrameWithoutWork) {
  const auto first = join();
  work();
  const auto second = join();
  ASSERT_EQ(second->frames.size(), 1u);
  EXPECT_EQ(second->frames[0]->payload, first->frames[0]->payload);
  EXPECT_EQ(probe->exact_frames, 1);
}

TEST_F(DesignSessionTest, AFrameIsAcknowledgedOnce) {
  const auto client = join();
  EXPECT_EQ(session->acknowledge(*client, 0, now), AckResult::not_in_flight);
  work();
  EXPECT_EQ(session->acknowledge(*client, 99, now), AckResult::not_in_flight);
  acknowledge(*client);
  EXPECT_EQ(session->acknowledge(*client, client->frames.back()->frame, now),
            AckResult::not_in_flight);
}

TEST_F(DesignSessionTest, WithoutClientsNothingIsDone) {
  const auto client = join();
  edit(*client, 10);
  EXPECT_FALSE(session->idle_since());
  session->leave(*client, now);
  EXPECT_EQ(session->idle_since(), now);
  pass(milliseconds(1000));
  EXPECT_EQ(probe->moving_frames + probe->exact_frames, 0);
  join();
  pass(milliseconds(100));
  EXPECT_EQ(probe->exact_frames, 1);
}

TEST_F(DesignSessionTest, AFailingRenderIsToldAndTriedAgainAfterTheNextEdit) {
  probe->broken = true;
  const auto client = join();
  work();
  ASSERT_EQ(client->texts.size(), 2u);
  EXPECT_EQ(client->texts[1]["type"], "error");
  EXPECT_EQ(client->texts[1]["reason"], "sphere: found a broken source, expected a whole one");
  EXPECT_EQ(queue.next_due(), Clock::time_point::max());
  probe->broken = false;
  edit(*client, 10);
  pass(milliseconds(100));
  ASSERT_FALSE(client->frames.empty());
  EXPECT_EQ(client->last().revision.number, 1);
}

TEST_F(DesignSessionTest, AClosedSessionWorksNoMore) {
  const auto client = join();
  session->close();
  edit(*client, 10);
  pass(milliseconds(1000));
  EXPECT_TRUE(client->frames.empty());
}

class SessionRegistryTest : public testing::Test {
 protected:
  std::shared_ptr<DesignSession> join(const std::string& name, const std::string& scene = "") {
    clients.push_back(std::make_shared<KeepingClient>());
    return registry.join(name, scene, clients.back(), now);
  }

  SceneCatalog scenes{{sphere_scene("one", 8, 8), sphere_scene("two", 8, 8)}};
  RenderQueue queue;
  RegistrySettings settings{{}, 2, std::chrono::seconds(60)};
  SessionRegistry registry{scenes, queue, settings};
  Clock::time_point now = Clock::now();
  std::vector<std::shared_ptr<KeepingClient>> clients;
};

TEST_F(SessionRegistryTest, OneNameAndSceneIsOneSession) {
  const auto a = join("a");
  EXPECT_EQ(join("a", "one"), a);
  EXPECT_NE(join("a", "two"), a);
  EXPECT_EQ(registry.size(), 2u);
  EXPECT_NE(error_of([&] { (void)join("a", "three"); }).find("\"three\""), std::string::npos);
}

TEST_F(SessionRegistryTest, WhenAllAreInUseTheNextIsRefusedAndAnIdleOneMakesRoom) {
  const auto a = join("a");
  const auto b = join("b");
  EXPECT_EQ(join("c"), nullptr);
  a->leave(*clients[0], now);
  EXPECT_NE(join("c"), nullptr);
  EXPECT_EQ(registry.size(), 2u);
}

TEST_F(SessionRegistryTest, IdleSessionsAreDroppedAndComeBackWithALaterEpoch) {
  const auto a = join("a");
  const auto epoch = clients[0]->texts[0]["epoch"].get<std::int64_t>();
  a->leave(*clients[0], now);
  registry.drop_idle(now + std::chrono::seconds(59));
  EXPECT_EQ(registry.size(), 1u);
  registry.drop_idle(now + std::chrono::seconds(60));
  EXPECT_EQ(registry.size(), 0u);
  (void)join("a");
  EXPECT_GT(clients.back()->texts[0]["epoch"].get<std::int64_t>(), epoch);
}

TEST_F(DesignSessionTest, AViewThatFramesDoNotShowIsKeptAndTheFramesSaySo) {
  const auto client = join();
  work();
  EXPECT_TRUE(client->last().unshown.empty());
  EXPECT_EQ(client->texts[0]["any_view"], false);
  acknowledge(*client);
  Edit change;
  change.view = Camera{{1, 2, 3}, {0, 0, 0}, {0, 1, 0}, 40};
  change.materials["brass"].set = MaterialEdit{.albedo = {}, .highlight = {}, .exponent = 3};
  session->apply(*client, change, now);
  EXPECT_EQ(client->texts.back()["state"]["view"]["camera"]["position"], json({1.0, 2.0, 3.0}));
  EXPECT_EQ(client->texts.back()["state"]["material"]["parameter"]["brass"]["exponent"], 3.0);
  work();
  EXPECT_FALSE(client->last().exact);
  EXPECT_EQ(client->last().unshown, std::vector<std::string>{"the moved camera"});
  acknowledge(*client);
  pass(milliseconds(60));
  EXPECT_TRUE(client->last().exact);
  EXPECT_EQ(client->last().unshown, std::vector<std::string>{"the moved camera"});
}

TEST_F(DesignSessionTest, AnEditThatComesAfterTheQueueLookedAtTheClockWaitedForNothing) {
  const auto client = join();
  work();
  acknowledge(*client);
  edit(*client, 10);
  session->work(now - milliseconds(2));
  ASSERT_EQ(client->last().revision.number, 1);
  EXPECT_EQ(client->last().queue_ms, 0);
}

TEST_F(DesignSessionTest, AnEditThatMakesTheStateTooLargeIsRefusedWhole) {
  const auto client = join();
  Edit change;
  for (std::size_t i = 0; i < kMostMaterials; ++i) {
    change.materials["m" + std::to_string(i)].set = MaterialEdit{{}, {}, 3};
  }
  session->apply(*client, change, now);
  Edit more;
  more.exposure_stops = 5;
  more.materials["one"].set = MaterialEdit{{}, {}, 3};
  const std::size_t replies = client->texts.size();
  EXPECT_NE(error_of([&] { session->apply(*client, more, now); }), "no error");
  EXPECT_EQ(client->texts.size(), replies);
  EXPECT_EQ(client->texts.back()["state"]["exposure"], 0.0);
}

}  // namespace
}  // namespace rimlight::server
