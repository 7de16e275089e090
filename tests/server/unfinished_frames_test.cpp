// What a source leaves unfinished goes on while no frame is due.

#include <gtest/gtest.h>

#include "tests/server/design_session_case.h"

namespace rimlight::server {
namespace {

using std::chrono::milliseconds;
using test::DesignSessionTest;

TEST_F(DesignSessionTest, UnfinishedWorkGoesOnUntilNoneIsLeftAndThenCostsNothing) {
  const auto client = join();
  work();
  acknowledge(*client);
  probe->slices_left = 5;
  edit(*client, 10);
  work();
  EXPECT_EQ(probe->slices_left, 0);  // before the exact frame is due
  acknowledge(*client);
  pass(milliseconds(50));
  EXPECT_TRUE(client->last().exact);
  EXPECT_EQ(queue.next_due(), Clock::time_point::max());
}

TEST_F(DesignSessionTest, TheExactFrameWaitsForWhatIsUnfinishedOfIt) {
  const auto client = join();
  work();
  acknowledge(*client);
  probe->slices_for_exact = 3;
  std::vector<int> exact_frames;
  probe->on_slice = [&] { exact_frames.push_back(probe->exact_frames); };
  edit(*client, 10);
  now += milliseconds(50);
  work();
  acknowledge(*client);
  work();
  EXPECT_EQ(probe->slices_for_exact, 0);
  EXPECT_EQ(exact_frames, (std::vector<int>{1, 1, 1}));
  EXPECT_TRUE(client->last().exact);
  EXPECT_EQ(client->last().revision.number, 1);
}

TEST_F(DesignSessionTest, AnEditInterruptsUnfinishedWorkAndIsShownFirst) {
  const auto client = join();
  work();
  acknowledge(*client);
  probe->slices_for_exact = 4;
  edit(*client, 10);
  ASSERT_TRUE(queue.run_one(now));  // the moving frame
  acknowledge(*client);
  probe->on_slice = [&] { edit(*client, 20); };
  ASSERT_TRUE(queue.run_one(now));  // a slice, abandoned
  probe->on_slice = nullptr;
  EXPECT_EQ(probe->slices_for_exact, 4);
  ASSERT_TRUE(queue.run_one(now));
  EXPECT_EQ(client->last().revision.number, 2);
  EXPECT_EQ(probe->slices_for_exact, 4);
}

TEST_F(DesignSessionTest, AnotherSessionHasItsTurnBetweenSlices) {
  const auto other = std::make_shared<DesignSession>("t", scene, 5, SessionSettings{}, queue);
  const auto client = join();
  work();
  acknowledge(*client);
  probe->slices_for_exact = 3;
  edit(*client, 10);
  ASSERT_TRUE(queue.run_one(now));
  const auto guest = std::make_shared<test::KeepingClient>();
  now += milliseconds(1);  // were both due at once, memory addresses would decide
  other->join(guest, now);
  now += milliseconds(1);
  ASSERT_TRUE(queue.run_one(now));  // a slice, which was due first
  EXPECT_EQ(probe->slices_for_exact, 2);
  ASSERT_TRUE(queue.run_one(now));
  EXPECT_EQ(guest->frames.size(), 1u);
  EXPECT_EQ(probe->slices_for_exact, 2);
  other->close();
}

TEST_F(DesignSessionTest, NobodyWatchingNothingGoesOn) {
  const auto client = join();
  work();
  acknowledge(*client);
  probe->slices_left = 3;
  edit(*client, 10);
  ASSERT_TRUE(queue.run_one(now));
  session->leave(*client, now);
  work();
  EXPECT_EQ(probe->slices_left, 3);
}

}  // namespace
}  // namespace rimlight::server
