#include "server/delivery/shared_stream.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <deque>
#include <memory>
#include <vector>

#include "core/image/vp8_codec.h"
#include "core/math/random.h"

namespace rimlight::server {
namespace {

using std::chrono::milliseconds;
using Kind = SharedStream::Kind;
using Clock = SharedStream::Clock;

constexpr int kWidth = 48, kHeight = 32;

Rgb8Image picture_at(double turn) {
  Rgb8Image image(kWidth, kHeight);
  std::size_t i = 0;
  for (int y = 0; y < kHeight; ++y) {
    for (int x = 0; x < 3 * kWidth; ++x) {
      image.bytes[i++] = static_cast<std::uint8_t>(127 + 120 * std::sin(0.1 * x + 0.2 * y + turn));
    }
  }
  return image;
}

struct Encoded {
  StreamFrame frame;
  std::vector<std::uint8_t> bytes;
};

/// A client that takes a frame each `pace` rounds, and decodes what it gets.
struct Follower {
  int pace = 1;
  KeptPictures kept{};
  int busy_until = 0;
  std::unique_ptr<Vp8Decoder> decoder = std::make_unique<Vp8Decoder>();
  const Encoded* owed = nullptr;
  int frames = 0, keys = 0, jpegs = 0;

  SharedStream::Member member(int round) const {
    KeptPictures later = kept;
    if (owed != nullptr) owed->frame.keep(later);
    return {later, round >= busy_until && owed == nullptr, owed == nullptr};
  }
  void take(const Encoded& encoded, int round, const Rgb8Image* expected) {
    EXPECT_TRUE(encoded.frame.can_follow(kept)) << "round " << round;
    Rgb8Image shown;
    decoder->decode(encoded.bytes, "frame", shown);
    if (expected != nullptr) {
      EXPECT_EQ(shown.bytes, expected->bytes) << "round " << round;
    }
    encoded.frame.keep(kept);
    busy_until = round + pace;
    ++frames;
    keys += encoded.frame.links.is_key();
  }
};

/// A stream with real encoders and decoders.
class StreamRun {
 public:
  explicit StreamRun(std::vector<int> paces) {
    for (const int pace : paces) followers.emplace_back().pace = pace;
  }

  void round() {
    now += milliseconds(16);
    for (Follower& follower : followers) {
      if (follower.owed != nullptr && round_ >= follower.busy_until) {
        follower.take(*std::exchange(follower.owed, nullptr), round_, nullptr);
      }
    }
    std::vector<SharedStream::Member> members;
    for (const Follower& follower : followers) members.push_back(follower.member(round_));
    if (const auto frame = stream.plan(members, Kind::new_picture, now)) make(*frame);
    for (Follower& follower : followers) {
      if (follower.owed == nullptr && round_ >= follower.busy_until) {  // nothing it can follow
        ++follower.jpegs;
        follower.busy_until = round_ + follower.pace;
      }
    }
    ++round_;
  }

  SharedStream stream;
  std::deque<Follower> followers;
  std::deque<Encoded> all;
  Clock::time_point now{std::chrono::hours(1)};

 private:
  void make(const StreamFrame& frame) {
    Encoded& encoded = all.emplace_back(Encoded{frame, {}});
    encoder_.encode(picture_at(0.05 * round_), frame.links, encoded.bytes);
    stream.made(frame, now);
    whole_.decode(encoded.bytes, "whole", shown_);
    const bool must = frame.links.is_key() || frame.links.to_golden;
    for (Follower& follower : followers) {
      const SharedStream::Member member = follower.member(round_);
      if (!frame.can_follow(member.kept)) continue;
      if (member.is_ready) {
        follower.take(encoded, round_, &shown_);
      } else if (must && member.can_owe) {
        follower.owed = &encoded;
      }
    }
  }

  Vp8Encoder encoder_{kWidth, kHeight, 12};
  Vp8Decoder whole_;
  Rgb8Image shown_;
  int round_ = 0;
};

class SharedStreamTest : public testing::Test {
 protected:
  void SetUp() override {
    if (!has_vp8()) GTEST_SKIP() << "a build without VP8";
  }
};

TEST_F(SharedStreamTest, OneAloneGetsOneKeyFrameAndThenEveryFrameFromTheLast) {
  StreamRun run({1});
  for (int i = 0; i < 100; ++i) run.round();
  EXPECT_EQ(run.followers[0].frames, 100);
  EXPECT_EQ(run.followers[0].keys, 1);
  EXPECT_TRUE(run.all.back().frame.links.from_last);
}

TEST_F(SharedStreamTest, EachKeepsItsPaceWithoutKeyFramesAndWithoutCostToOthers) {
  StreamRun run({1, 9, 4, 23, 1});
  for (int i = 0; i < 600; ++i) run.round();
  for (const Follower& follower : run.followers) {
    // Who is owed a frame takes it instead of the newest: no frame is lost by it.
    EXPECT_GE(follower.frames + follower.jpegs, 600 / follower.pace - 2) << follower.pace;
    EXPECT_LE(follower.jpegs, 32 / follower.pace + 1) << follower.pace;  // before the second key
    EXPECT_LE(follower.keys, 2) << follower.pace;
  }
  std::size_t hops = 0;
  for (const Encoded& encoded : run.all) hops += !encoded.frame.links.from_last;
  EXPECT_GT(hops, 100u);
}

TEST_F(SharedStreamTest, WhoJoinsLaterWaitsForAKeyFrameOfWhichThereAreFew) {
  StreamRun run({1, 5});
  for (int i = 0; i < 60; ++i) run.round();
  const int before = run.followers[0].keys;
  for (int joined = 0; joined < 20; ++joined) {
    run.followers.emplace_back().pace = 1 + joined % 3;
    for (int i = 0; i < 10; ++i) run.round();
  }
  for (int i = 0; i < 60; ++i) run.round();
  EXPECT_LE(run.followers[0].keys - before, 200 * 16 / 500 + 2);
  for (const Follower& follower : run.followers) {
    EXPECT_GE(follower.keys, 1);
    EXPECT_LE(follower.jpegs, 40);
  }
}

TEST_F(SharedStreamTest, AtRandomPacesAndWithLeavingNoFrameIsEverUndecodable) {
  Random random(11);
  StreamRun run({1, 2});
  for (int i = 0; i < 3000; ++i) {
    if (random.below(40) == 0 && run.followers.size() < 6) run.followers.emplace_back();
    if (random.below(60) == 0 && run.followers.size() > 1) run.followers.pop_back();
    for (Follower& follower : run.followers) {
      if (random.below(30) == 0) follower.pace = 1 + static_cast<int>(random.below(12));
    }
    run.round();  // checks what is decoded
  }
  EXPECT_GT(run.all.size(), 1000u);
}

TEST(SharedStreamPlan, ARepeatedPictureChangesNothingForOthers) {
  SharedStream stream;
  const Clock::time_point now{std::chrono::hours(1)};
  std::array<SharedStream::Member, 2> members{{{{}, true, true}, {{}, true, true}}};
  const auto key = stream.plan(members, Kind::new_picture, now);
  ASSERT_TRUE(key && key->links.is_key());
  stream.made(*key, now);
  for (auto& member : members) key->keep(member.kept);
  members[1].is_ready = false;
  const auto next = stream.plan(members, Kind::new_picture, now);
  ASSERT_TRUE(next && next->links.from_last && !next->links.to_golden);
  stream.made(*next, now);
  next->keep(members[0].kept);
  members[0].is_ready = false;
  members[1].is_ready = true;
  const auto again = stream.plan(members, Kind::repeat, now);
  ASSERT_TRUE(again && again->can_follow(members[1].kept));
  EXPECT_FALSE(again->links.to_last || again->links.to_golden || again->links.from_last);
  stream.made(*again, now);
  EXPECT_TRUE(stream.follows(members[0].kept));
}

TEST(SharedStreamPlan, AfterAFailureTheNextFrameIsAKeyFrameAndWithNobodyReadyThereIsNone) {
  SharedStream stream;
  Clock::time_point now{std::chrono::hours(1)};
  std::array<SharedStream::Member, 1> one{{{{}, true, true}}};
  const auto key = stream.plan(one, Kind::new_picture, now);
  stream.made(*key, now);
  key->keep(one[0].kept);
  stream.lost();
  const auto next = stream.plan(one, Kind::new_picture, now);
  ASSERT_TRUE(next);
  EXPECT_TRUE(next->links.is_key());
  one[0].is_ready = false;
  EXPECT_FALSE(stream.plan(one, Kind::new_picture, now));
  EXPECT_FALSE(stream.plan({}, Kind::new_picture, now));
}

}  // namespace
}  // namespace rimlight::server
