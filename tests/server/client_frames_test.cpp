// What each client of a session gets: codecs, rungs, parts, hidden tabs.

#include <gtest/gtest.h>

#include <cmath>
#include <deque>
#include <functional>

#include "core/image/codec.h"
#include "core/image/vp8_codec.h"
#include "tests/server/design_session_case.h"

namespace rimlight::server {
namespace {

using std::chrono::milliseconds;
using test::DesignSessionTest;
using test::KeepingClient;

class ClientFramesTest : public DesignSessionTest {
 protected:
  /// Joined, the first exact frame taken.
  std::shared_ptr<KeepingClient> join_with(const Display& display) {
    const auto client = join();
    session->set_display(*client, display, now);
    work();
    if (!client->frames.empty()) acknowledge(*client);
    return client;
  }
  /// Edits at 50 a second; each client answers after its own delay, which may depend on the frame.
  using Delay = std::function<milliseconds(const FrameMessage&)>;
  struct Watcher {
    std::shared_ptr<KeepingClient> client;
    Delay delay;
    std::size_t answered = 0;
    Clock::time_point sent{};
  };
  /// The first exact frame takes its time as the others do.
  Watcher watch(const Display& display, Delay delay) {
    const auto client = join();
    session->set_display(*client, display, now);
    work();
    return {client, std::move(delay)};
  }
  void move(std::deque<Watcher>& watchers, milliseconds length) {
    const Clock::time_point end = now + length;
    for (int i = 0; now < end; ++i) {
      if (i % 20 == 0) edit(*watchers[0].client, degrees_ += 1);
      work();
      now += milliseconds(1);
      for (Watcher& watcher : watchers) {
        const auto& frames = watcher.client->frames;
        if (watcher.answered == frames.size()) continue;
        if (watcher.sent == Clock::time_point{}) watcher.sent = now;
        if (now - watcher.sent < watcher.delay(*frames.back())) continue;
        watcher.answered = frames.size();
        watcher.sent = {};
        acknowledge(*watcher.client);
      }
    }
  }
  static Delay link(double round_trip_ms, double bytes_per_ms) {
    return [=](const FrameMessage& frame) {
      return milliseconds(
          std::lround(round_trip_ms + static_cast<double>(frame.size()) / bytes_per_ms));
    };
  }
  static FrameHeader header_of(const FramePtr& frame) {
    return parse_frame_message(frame->bytes(), "frame").header;
  }

  double degrees_ = 0;
};

/// A scene whose lossless frames are large.
class LargeFramesTest : public ClientFramesTest {
 protected:
  LargeFramesTest() {
    scene = test::sphere_scene("sphere", 800, 800, probe);
    session = std::make_shared<DesignSession>("s", scene, 5, SessionSettings{}, queue);
  }
};

TEST_F(ClientFramesTest, WhoNeverSaysGetsJpegAndPngWhole) {
  const auto client = join_with({});
  edit(*client, 10);
  work();
  EXPECT_EQ(client->last().codec, Codec::jpeg);
  EXPECT_EQ(client->last().rung, 3);
  EXPECT_EQ(client->last().quality, 80);
  acknowledge(*client);
  pass(milliseconds(60));
  EXPECT_EQ(client->last().codec, Codec::png);
  EXPECT_FALSE(client->last().part);
  EXPECT_FALSE(client->last().rung);
}

TEST_F(ClientFramesTest, WhoCanGetsAStreamThatDecodesToNearlyTheJpegsPicture) {
  if (!has_vp8()) GTEST_SKIP() << "a build without VP8";
  const auto one = join_with({.vp8 = true});
  const auto other = join_with({});
  Vp8Decoder decoder;
  for (int i = 1; i <= 20; ++i) {
    edit(*one, 3.0 * i);
    work();
    ASSERT_EQ(one->last().codec, Codec::vp8);
    EXPECT_EQ(one->last().key, i == 1);
    EXPECT_EQ(one->last().revision.number, i);
    const std::vector<std::uint8_t> bytes = one->frames.back()->bytes(),
                                    jpeg = other->frames.back()->bytes();
    const ParsedFrame frame = parse_frame_message(bytes, "frame");
    const ParsedFrame beside = parse_frame_message(jpeg, "frame");
    EXPECT_EQ(frame.header.frame, beside.header.frame);  // one picture, drawn once
    Rgb8Image shown;
    decoder.decode(frame.payload, "frame", shown);
    const Rgb8Image expected = decode_jpeg(beside.payload.data(), beside.payload.size(), "jpeg");
    ASSERT_EQ(shown.bytes.size(), expected.bytes.size());
    double error = 0;
    for (std::size_t b = 0; b < shown.bytes.size(); ++b) {
      error += std::abs(shown.bytes[b] - expected.bytes[b]);
    }
    EXPECT_LT(error / static_cast<double>(shown.bytes.size()), 6) << "frame " << i;
    acknowledge(*one);
    acknowledge(*other);
  }
  EXPECT_EQ(probe->moving_frames, 20);
}

TEST_F(LargeFramesTest, AClientOnANarrowLinkChangesNoFrameOfAnother) {
  scene = test::sphere_scene("sphere", 320, 320, probe);
  for (const bool vp8 : {false, has_vp8()}) {
    const std::size_t best = vp8 ? 0 : kVp8Rungs;
    std::vector<std::size_t> frames, bytes;
    for (const bool with_slow : {false, true}) {
      session = std::make_shared<DesignSession>("s", scene, 5, SessionSettings{}, queue);
      std::deque<Watcher> watchers{watch({.vp8 = vp8}, link(2, 1e6))};
      if (with_slow) watchers.push_back(watch({.vp8 = vp8}, link(40, vp8 ? 12 : 40)));
      move(watchers, milliseconds(4000));
      std::size_t others = 0;
      bytes.push_back(0);
      for (const FramePtr& frame : watchers[0].client->frames) {
        const FrameHeader header = header_of(frame);
        others += !header.exact && header.rung != best;
        bytes.back() += frame->size();
      }
      EXPECT_LE(others, vp8 ? 30u : 0u);  // JPEG for half a second, at most
      frames.push_back(watchers[0].client->frames.size());
      if (!with_slow) continue;
      const auto& slow = watchers[1].client->frames;
      EXPECT_LT(slow.size(), frames.back() / 2);
      EXPECT_GT(header_of(slow.back()).rung.value_or(0), best);
    }
    EXPECT_EQ(frames[0], frames[1]);
    EXPECT_GT(frames[0], 190u);
    EXPECT_LT(static_cast<double>(bytes[1]), 1.2 * static_cast<double>(bytes[0]));
  }
}

TEST_F(ClientFramesTest, ClientsFarAwayShareAStreamWithThoseNear) {
  if (!has_vp8()) GTEST_SKIP() << "a build without VP8";
  std::deque<Watcher> watchers{watch({.vp8 = true}, link(2, 1e6)),
                               watch({.vp8 = true}, link(150, 1e6)),
                               watch({.vp8 = true}, link(61, 1e6))};
  move(watchers, milliseconds(5000));
  for (const Watcher& watcher : watchers) {
    Vp8Decoder decoder;
    int vp8 = 0, others = 0, keys = 0;
    std::int64_t last = -1;
    for (const FramePtr& message : watcher.client->frames) {
      const std::vector<std::uint8_t> bytes = message->bytes();
      const ParsedFrame frame = parse_frame_message(bytes, "frame");
      ASSERT_GT(frame.header.frame, last);
      last = frame.header.frame;
      if (frame.header.codec != Codec::vp8) {
        ++others;
        continue;
      }
      EXPECT_EQ(frame.header.rung, 0);
      Rgb8Image shown;
      decoder.decode(frame.payload, "frame", shown);  // throws where a key frame is missing
      ++vp8;
      keys += frame.header.key;
    }
    EXPECT_GT(vp8, 25);
    EXPECT_LE(keys, 4);
    EXPECT_LE(others, 35);  // the first exact one, and JPEGs until the next key frame
  }
}

TEST_F(ClientFramesTest, AHiddenTabGetsNoFramesAndTheNewestExactOneWhenItComesBack) {
  const auto hidden = join_with({.hidden = true});
  const auto other = join_with({});
  EXPECT_TRUE(hidden->frames.empty());
  for (int i = 1; i <= 10; ++i) {
    edit(*other, i);
    work();
    acknowledge(*other);
  }
  pass(milliseconds(60));
  acknowledge(*other);
  EXPECT_TRUE(hidden->frames.empty());
  session->set_display(*hidden, {}, now);
  ASSERT_EQ(hidden->frames.size(), 1u);
  EXPECT_TRUE(hidden->last().exact);
  EXPECT_EQ(hidden->last().revision.number, 10);
}

TEST_F(ClientFramesTest, WhileAllAreHiddenNothingIsDrawn) {
  const auto client = join_with({});
  session->set_display(*client, {.hidden = true}, now);
  const int before = probe->exact_frames;
  edit(*client, 10);
  pass(milliseconds(500));
  EXPECT_EQ(probe->moving_frames, 0);
  EXPECT_EQ(probe->exact_frames, before);
  session->set_display(*client, {}, now);
  pass(milliseconds(1));
  acknowledge(*client);
  pass(milliseconds(60));
  EXPECT_TRUE(client->last().exact);
  EXPECT_EQ(client->last().revision.number, 1);
}

TEST_F(ClientFramesTest, ADecoderThatFailedGetsJpegFromTheNextFrameOn) {
  const auto client = join_with({.vp8 = true});
  edit(*client, 10);
  work();
  EXPECT_EQ(client->last().codec, has_vp8() ? Codec::vp8 : Codec::jpeg);
  session->set_display(*client, {}, now);
  acknowledge(*client);
  edit(*client, 20);
  work();
  EXPECT_EQ(client->last().codec, Codec::jpeg);
  session->set_display(*client, {.vp8 = true}, now);
  acknowledge(*client);
  edit(*client, 30);
  work();
  EXPECT_TRUE(client->last().key);  // a new decoder begins with a key frame
}

TEST_F(ClientFramesTest, ClientsAtOtherRungsGetThePictureThatTheyLackWithoutANewOne) {
  const auto fast = join_with({});
  const auto small = join_with({.most_pixels = 100});
  edit(*fast, 10);
  work();
  ASSERT_EQ(small->last().rung, 6);
  EXPECT_EQ(small->last().width, 8);
  acknowledge(*fast);
  edit(*fast, 20);
  work();  // `small` has not answered
  acknowledge(*fast);
  const int drawn = probe->moving_frames;
  acknowledge(*small);
  work();
  EXPECT_EQ(probe->moving_frames, drawn);
  EXPECT_EQ(small->last().revision.number, 2);
  EXPECT_EQ(small->last().rung, 6);
}

TEST_F(LargeFramesTest, ALosslessFrameInPartsIsThePictureAndAnEditEndsIt) {
  const auto whole = join_with({});
  const auto client = join();
  session->set_display(*client, {.parts = true}, now);
  now += milliseconds(500);
  acknowledge(*client);  // it had the first frame whole: it said so too late
  edit(*client, 10);
  work();
  acknowledge(*client);
  acknowledge(*whole);
  now += milliseconds(60);
  work();
  std::vector<std::uint8_t> image;
  int parts = 0;
  for (bool more = true; more; ++parts) {
    const std::vector<std::uint8_t> bytes = client->frames.back()->bytes();
    const ParsedFrame frame = parse_frame_message(bytes, "frame");
    ASSERT_TRUE(frame.header.part) << parts;
    EXPECT_EQ(frame.header.part->offset, image.size());
    image.insert(image.end(), frame.payload.begin(), frame.payload.end());
    more = image.size() < frame.header.part->size;
    now += milliseconds(200);
    acknowledge(*client);
  }
  EXPECT_GT(parts, 1);
  EXPECT_EQ(image, *whole->frames.back()->payload);
  acknowledge(*whole);
  // Once more, with an edit in between.
  edit(*client, 20);
  work();
  acknowledge(*client);
  acknowledge(*whole);
  now += milliseconds(60);
  work();
  ASSERT_TRUE(client->last().part);
  edit(*client, 30);
  acknowledge(*client);
  work();
  EXPECT_FALSE(client->last().exact);
  EXPECT_EQ(client->last().revision.number, 3);
  acknowledge(*client);
  now += milliseconds(60);
  work();
  ASSERT_TRUE(client->last().part);
  EXPECT_EQ(client->last().part->offset, 0u);
  // A hidden client's rest is not sent; it gets the whole when it shows again.
  session->set_display(*client, {.parts = true, .hidden = true}, now);
  const std::size_t sent = client->frames.size();
  acknowledge(*client);
  EXPECT_EQ(client->frames.size(), sent);
  session->set_display(*client, {.parts = true}, now);
  ASSERT_EQ(client->frames.size(), sent + 1);
  EXPECT_EQ(client->last().part->offset, 0u);
}

}  // namespace
}  // namespace rimlight::server
