// What a session draws with while nobody has it open.
#include <gtest/gtest.h>

#include "tests/server/design_session_case.h"

namespace rimlight::server {
namespace {

using std::chrono::milliseconds;
using test::DesignSessionTest;

class RestingSession : public DesignSessionTest {};

TEST_F(RestingSession, WhatItDrawsWithIsGivenBackWhenNobodyHasItOpenAndMadeAgain) {
  const auto first = join();
  edit(*first, 10);
  work();
  acknowledge(*first);
  pass(milliseconds(60));
  const std::vector<std::uint8_t> before = *first->frames.back()->payload;
  const FrameHeader shown = first->last();
  ASSERT_TRUE(shown.exact);
  EXPECT_EQ(probe->sources, 1);
  session->rest(now, std::chrono::seconds(30));  // somebody has it open
  work();
  EXPECT_EQ(probe->sources, 1);
  session->leave(*first, now);
  pass(std::chrono::seconds(29));
  session->rest(now, std::chrono::seconds(30));
  work();
  EXPECT_EQ(probe->sources, 1);
  now += std::chrono::seconds(1);
  session->rest(now, std::chrono::seconds(30));
  session->rest(now, std::chrono::seconds(30));
  work();
  EXPECT_EQ(probe->sources, 0);
  EXPECT_FALSE(queue.run_one(now));  // and no more work
  const auto second = join();
  work();
  ASSERT_EQ(second->frames.size(), 1u);
  EXPECT_TRUE(second->last().exact);
  EXPECT_EQ(*second->frames.back()->payload, before);
  EXPECT_GT(second->last().frame, shown.frame);
  EXPECT_EQ(probe->sources, 1);
}

TEST_F(RestingSession, WhoComesBeforeItRestsKeepsIt) {
  const auto first = join();
  work();
  session->leave(*first, now);
  now += std::chrono::seconds(30);
  session->rest(now, std::chrono::seconds(30));
  const auto second = join();
  work();
  EXPECT_EQ(probe->sources, 1);
  ASSERT_FALSE(second->frames.empty());
  EXPECT_TRUE(second->last().exact);
}

}  // namespace
}  // namespace rimlight::server
