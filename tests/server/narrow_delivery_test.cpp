// What a client on a narrow link gets of lossless frames, and how soon it sees an edit. The link,
// the clock and the compute thread are the test's.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "core/image/codec.h"
#include "server/delivery/ladder.h"
#include "tests/server/design_session_case.h"

namespace rimlight::server {
namespace {

using std::chrono::milliseconds;
using test::DesignSessionTest;
using test::KeepingClient;

constexpr double kWayMs = 40;

/// A scene whose lossless frames are large, and one client that takes messages one by one.
class NarrowDeliveryTest : public DesignSessionTest {
 protected:
  NarrowDeliveryTest() {
    scene = test::sphere_scene("sphere", 800, 800, probe);
    session = std::make_shared<DesignSession>("s", scene, 5, SessionSettings{}, queue);
  }

  struct Link {
    std::shared_ptr<KeepingClient> client;
    double kBps;
    std::size_t answered = 0;
    Clock::time_point sent{};
  };
  /// Steps of 1 ms.
  void run(Link& link, milliseconds length) {
    for (const Clock::time_point end = now + length; now < end; now += milliseconds(1)) {
      work();
      if (link.answered == link.client->frames.size()) continue;
      if (link.sent == Clock::time_point{}) link.sent = now;
      const auto bytes = static_cast<double>(link.client->frames.back()->size());
      if (now - link.sent < milliseconds(std::lround(kWayMs + bytes / link.kBps))) continue;
      ++link.answered;
      link.sent = {};
      shown_ = link.client->last().revision.number;
      acknowledge(*link.client);
    }
  }
  /// From each of some edits, at any time of the rest in between, until one is seen.
  std::vector<double> latencies(Link& link, int edits) {
    std::vector<double> result;
    for (int i = 0; i < edits; ++i) {
      run(link, milliseconds(400 + 37 * i));
      edit(*link.client, degrees_ += 7);
      const Clock::time_point start = now;
      const std::int64_t revision = ++revision_;
      while (shown_ < revision && now - start < milliseconds(60'000)) run(link, milliseconds(1));
      result.push_back(std::chrono::duration<double, std::milli>(now - start).count());
    }
    return result;
  }

  std::int64_t revision_ = 0, shown_ = 0;
  double degrees_ = 0;
};

TEST_F(NarrowDeliveryTest, AnEditIsSeenSoonThoughTheExactFrameIsOnItsWay) {
  for (const double kBps : {30.0, 250.0}) {
    for (const bool vp8 : {false, true}) {
      session = std::make_shared<DesignSession>("s", scene, 5, SessionSettings{}, queue);
      revision_ = shown_ = 0;
      Link link{join({.parts = true}), kBps};
      session->set_display(*link.client, {.vp8 = vp8, .parts = true}, now);
      const std::vector<double> waits = latencies(link, 20);
      // The rest of a part, its answer and the look itself. Frames in motion may still be stepping
      // down in the first.
      const double part_ms = std::max(50.0, static_cast<double>(PartSizer::kSmallest) / kBps);
      const double most = 2.5 * (part_ms + kWayMs);
      const double worst = *std::max_element(waits.begin() + 4, waits.end());
      EXPECT_LE(worst, most) << kBps << " kB/s, vp8 " << vp8;
      RecordProperty("worst_ms", static_cast<int>(worst));
    }
  }
}

TEST_F(NarrowDeliveryTest, TheFirstLookIsASmallOneAndTheWholeFollowsInParts) {
  Link link{join({.parts = true}), 30};
  session->set_display(*link.client, {.parts = true}, now);
  work();
  ASSERT_EQ(link.client->frames.size(), 1u);
  const FrameHeader look = link.client->last();
  EXPECT_EQ(look.codec, Codec::jpeg);
  EXPECT_EQ(look.rung, 6);
  EXPECT_FALSE(look.exact);
  EXPECT_FALSE(look.part);
  EXPECT_EQ(look.revision.number, 0);
  EXPECT_EQ(probe->moving_frames, 0);  // it is of the exact picture
  run(link, milliseconds(20'000));
  std::vector<std::uint8_t> image;
  for (std::size_t i = 1; i < link.client->frames.size(); ++i) {
    const std::vector<std::uint8_t> bytes = link.client->frames[i]->bytes();
    const ParsedFrame frame = parse_frame_message(bytes, "frame");
    ASSERT_TRUE(frame.header.part);
    EXPECT_TRUE(frame.header.exact);
    EXPECT_EQ(frame.header.frame, look.frame);
    ASSERT_EQ(frame.header.part->offset, image.size());
    EXPECT_LE(frame.payload.size(), 2 * PartSizer::kSmallest + 2048);
    image.insert(image.end(), frame.payload.begin(), frame.payload.end());
    const bool is_last = i + 1 == link.client->frames.size();
    EXPECT_EQ(image.size() == frame.header.part->size, is_last);
  }
  EXPECT_TRUE(session->settled());
  const auto whole = join();
  EXPECT_EQ(image, *whole->frames.back()->payload);
}

TEST_F(NarrowDeliveryTest, WhoHasSeenTheRevisionGetsNoLookAndWhoTakesNoPartsTheWhole) {
  const auto client = join({.parts = true});
  work();
  acknowledge(*client);
  while (!session->settled()) {
    now += milliseconds(300);
    acknowledge(*client);
  }
  edit(*client, 10);
  work();
  ASSERT_FALSE(client->last().exact);
  EXPECT_EQ(probe->moving_frames, 1);
  now += milliseconds(300);
  acknowledge(*client);
  const auto whole = join();
  now += milliseconds(60);
  work();
  EXPECT_TRUE(client->last().exact);
  EXPECT_TRUE(client->last().part);
  EXPECT_TRUE(whole->last().exact);
  EXPECT_FALSE(whole->last().part);
}

TEST_F(NarrowDeliveryTest, WhoComesLaterIsNotSentTheWholeEither) {
  const auto first = join();
  work();
  ASSERT_TRUE(first->last().exact);
  const auto client = join({.parts = true});
  work();
  ASSERT_FALSE(client->frames.empty());
  EXPECT_LE(client->frames.back()->size(), 2 * PartSizer::kSmallest);
  EXPECT_EQ(probe->exact_frames, 1);
}

TEST_F(NarrowDeliveryTest, PartsOfWhatIsOutOfDateAreNotBegun) {
  const auto client = join({.parts = true});
  work();  // the look
  edit(*client, 10);
  acknowledge(*client);  // before the edit's frame is drawn
  ASSERT_EQ(client->frames.size(), 1u);
  work();
  EXPECT_EQ(client->last().revision.number, 1);
  EXPECT_FALSE(client->last().part);
}

}  // namespace
}  // namespace rimlight::server
