#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <vector>

#include "core/math/random.h"
#include "server/delivery/delay_meter.h"
#include "server/delivery/ladder.h"

namespace rimlight::server {
namespace {

using Clock = DelayMeter::Clock;
constexpr double kLosslessBytes = 300e3;

/// A link of one bandwidth and way, with one message on it at a time.
struct Link {
  double bytes_per_ms = 250;
  double round_trip_ms = 40;
  double jitter_ms = 0;  // uniform, above the round trip
  Random random{5};

  double delay_ms(double bytes) {
    return round_trip_ms + bytes / bytes_per_ms + jitter_ms * random.uniform();
  }
};

Clock::duration from_ms(double ms) {
  return std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double, std::milli>(ms));
}

/// A client that edits for a while, and gets the lossless frame each time it rests.
struct Simulation {
  Link link;
  RungRange range = rungs_for({}, 512, 512);
  DelayMeter meter{};
  LadderClimber climber{range};
  Clock::time_point now{std::chrono::hours(1)};
  int moves = 0;
  std::vector<double> queue_ms{};  // of frames in motion

  double send(double bytes) {
    const double delay = link.delay_ms(bytes);
    now += from_ms(delay);
    return meter.record(static_cast<std::size_t>(bytes), delay, now);
  }
  void move(double seconds) {
    const Clock::time_point end = now + from_ms(1000 * seconds);
    while (now < end) {
      const std::size_t rung = climber.rung();
      // A scene's frames vary by a fifth.
      const double bytes = 1000 * kRungs[rung].kilobytes * link.random.uniform(0.8, 1.2);
      queue_ms.push_back(send(bytes));
      climber.record(rung, queue_ms.back(), now);
      moves += climber.rung() != rung;
      now += from_ms(16);
    }
  }
  void rest() {
    send(kLosslessBytes);
    now += from_ms(1000);
  }
};

TEST(DelayMeter, FindsTheWayAndTheTimeOfAByteUnderJitter) {
  for (const double bandwidth : {50.0, 250.0, 2000.0}) {
    for (const double way : {2.0, 40.0, 200.0}) {
      Simulation run{{bandwidth, way, 5}};
      run.rest();
      run.move(3);
      run.rest();
      EXPECT_NEAR(run.meter.base_ms(), way, 6) << bandwidth << " bytes/ms";
      EXPECT_NEAR(run.meter.ms_per_byte() * bandwidth, 1, 0.25) << way << " ms";
    }
  }
}

TEST(DelayMeter, ALongWayIsNoQueue) {
  Simulation run{{1e4, 300}};
  run.rest();
  run.move(20);
  EXPECT_EQ(run.climber.rung(), run.range.first);
  EXPECT_LT(*std::max_element(run.queue_ms.begin() + 1, run.queue_ms.end()), 10);
}

TEST(DelayMeter, FramesOfOneSizeDoNotHideANarrowLink) {
  DelayMeter meter;
  Clock::time_point now{std::chrono::hours(1)};
  meter.record(300'000, 1240, now);  // 250 bytes/ms, 40 ms
  double queue = 0;
  for (int i = 0; i < 1000; ++i) {
    now += from_ms(144);
    queue = meter.record(26'000, 144, now);  // for over two minutes nothing else
  }
  EXPECT_NEAR(queue, 104, 5);
}

TEST(DelayMeter, AShorterWayIsSeenAtOnceAndALongerOneInSeconds) {
  Simulation run{{1e4, 100}};
  run.move(3);
  run.link.round_trip_ms = 20;
  run.move(0.2);
  EXPECT_NEAR(run.meter.base_ms(), 20, 5);
  run.link.round_trip_ms = 150;
  run.move(12);
  EXPECT_NEAR(run.meter.base_ms(), 150, 5);
}

/// The rung whose frames the link carries within the bound, by arithmetic.
std::size_t best_rung(const Link& link, const RungRange& range, double share) {
  std::size_t rung = range.first;
  while (rung + 1 < range.end &&
         1000 * kRungs[rung].kilobytes / link.bytes_per_ms > share * LadderClimber::kMostQueueMs) {
    ++rung;
  }
  return rung;
}

TEST(Ladder, SettlesWhereTheLinkCarriesTheFramesAndStaysThere) {
  for (const bool vp8 : {false, true}) {
    for (const double bandwidth : {20.0, 60.0, 100.0, 150.0, 250.0, 400.0, 700.0, 1500.0, 1e5}) {
      for (const double way : {1.0, 40.0, 150.0}) {
        for (const double jitter : {0.0, 10.0, 40.0}) {
          Simulation run{{bandwidth, way, jitter}, rungs_for({.vp8 = vp8}, 512, 512)};
          run.rest();
          run.move(10);
          const int early = run.moves;
          run.rest();
          run.move(120);
          const std::string where = std::to_string(bandwidth) + " bytes/ms, " +
                                    std::to_string(way) + " ms, jitter " + std::to_string(jitter);
          EXPECT_LE(early, 5) << where;
          EXPECT_LE(run.moves - early, 6) << where;  // in two minutes
          EXPECT_GE(run.climber.rung(), best_rung(run.link, run.range, 1.3)) << where;
          EXPECT_LE(run.climber.rung(), best_rung(run.link, run.range, 0.3) + (jitter > 20))
              << where;
        }
      }
    }
  }
}

TEST(Ladder, GoesDownWithinAFewFramesAndUpAgainInSeconds) {
  Simulation run{{1e4, 30}};
  run.rest();
  run.move(5);
  ASSERT_EQ(run.climber.rung(), kVp8Rungs);
  run.link.bytes_per_ms = 120;
  run.queue_ms.clear();
  run.move(2);
  EXPECT_GE(run.climber.rung(), kVp8Rungs + 2);
  std::size_t slow = 0;
  for (const double ms : run.queue_ms) slow += ms > LadderClimber::kMostQueueMs;
  EXPECT_LE(slow, 6u);
  run.link.bytes_per_ms = 1e4;
  run.move(1.5);
  EXPECT_GE(run.climber.rung(), kVp8Rungs + 1);  // not at once
  run.move(15);
  EXPECT_EQ(run.climber.rung(), kVp8Rungs);
}

TEST(Ladder, AStepUpThatFailsIsTriedEverMoreSeldom) {
  // A rung that is fine below and hopeless above, whatever the frames' sizes promise.
  LadderClimber climber(rungs_for({}, 512, 512));
  Clock::time_point now{std::chrono::hours(1)};
  std::vector<double> rises;
  for (int i = 0; i < 20'000; ++i) {
    now += from_ms(20);
    const std::size_t rung = climber.rung();
    climber.record(rung, rung == kVp8Rungs ? 200 : 1, now);
    if (climber.rung() < rung) rises.push_back(20.0 * i);
  }
  ASSERT_GE(rises.size(), 4u);
  for (std::size_t i = 2; i < std::min<std::size_t>(rises.size(), 5); ++i) {
    EXPECT_GT(rises[i] - rises[i - 1], 1.7 * (rises[i - 1] - rises[i - 2]));
  }
  EXPECT_LE(rises.size(), 11u);  // in 400 s
}

TEST(Ladder, AnAcknowledgementFromBeforeAStepChangesNothing) {
  LadderClimber climber(rungs_for({}, 512, 512));
  const Clock::time_point now{std::chrono::hours(1)};
  for (int i = 0; i < 2; ++i) climber.record(kVp8Rungs, 500, now);
  ASSERT_EQ(climber.rung(), kVp8Rungs + 1);
  for (int i = 0; i < 10; ++i) climber.record(kVp8Rungs, 500, now);
  EXPECT_EQ(climber.rung(), kVp8Rungs + 1);
}

TEST(Ladder, RungsFollowWhatTheClientCanShow) {
  EXPECT_EQ(rungs_for({}, 512, 512), (RungRange{3, 7}));
  EXPECT_EQ(rungs_for({.vp8 = true}, 512, 512), (RungRange{0, 3}));
  EXPECT_EQ(rungs_for({.vp8 = true, .most_pixels = 512 * 512 - 1}, 512, 512), (RungRange{2, 3}));
  // Outside every stream: JPEG, and the smallest at least.
  EXPECT_EQ(rungs_for({.vp8 = true, .most_pixels = 256 * 256 - 1}, 512, 512), (RungRange{6, 7}));
  EXPECT_EQ(rungs_for({.vp8 = true, .most_pixels = 1}, 512, 512), (RungRange{6, 7}));
  EXPECT_EQ(rungs_for({.most_pixels = 256 * 256}, 511, 511), (RungRange{5, 7}));
}

TEST(Ladder, AnotherRangeKeepsTheHeightOrBeginsAtTheTop) {
  LadderClimber climber({0, 3});
  const Clock::time_point now{std::chrono::hours(1)};
  for (int i = 0; i < 2; ++i) climber.record(0, 500, now);
  ASSERT_EQ(climber.rung(), 1u);
  climber.set_range({2, 3});
  EXPECT_EQ(climber.rung(), 2u);
  climber.set_range({0, 3});
  EXPECT_EQ(climber.rung(), 2u);
  climber.set_range({3, 7});
  EXPECT_EQ(climber.rung(), 3u);
}

/// The parts in which a link is sent a lossless frame, in ms each, and what the sizer learns.
std::vector<double> send_parts(Simulation& run, PartSizer& sizer, std::size_t total) {
  std::vector<double> times;
  for (std::size_t sent = 0; sent < total;) {
    const std::size_t bytes = std::min(sizer.bytes(), total - sent);
    sent += bytes;
    const Clock::time_point before = run.now;
    const double queue_ms = run.send(static_cast<double>(bytes));
    times.push_back(std::chrono::duration<double, std::milli>(run.now - before).count());
    sizer.record(bytes, times.back(), queue_ms, run.meter.ms_per_byte());
  }
  return times;
}

TEST(PartSizer, AnEditNeverWaitsLongForAPartWhateverTheLink) {
  for (const double bandwidth : {30.0, 80.0, 250.0, 1000.0, 20'000.0}) {  // kB/s
    for (const double way : {1.0, 40.0, 150.0}) {
      Simulation run{{bandwidth, way}};
      PartSizer sizer;
      const std::vector<double> first = send_parts(run, sizer, 300'000);
      const std::vector<double> second = send_parts(run, sizer, 300'000);
      // At first the parts are to find out: at most twice the smallest one before that is known.
      const double smallest_ms = static_cast<double>(PartSizer::kSmallest) / bandwidth;
      const double known = std::max(1.3 * LadderClimber::kMostQueueMs, 1.01 * smallest_ms);
      EXPECT_LE(*std::ranges::max_element(first) - way, std::max(known, 2.1 * smallest_ms))
          << bandwidth << " kB/s, " << way << " ms";
      EXPECT_LE(*std::ranges::max_element(second) - way, known) << bandwidth << ", " << way;
      // And it does not take many more messages than it must.
      const double fitting = bandwidth * LadderClimber::kMostQueueMs;
      const double parts = 300'000 / std::max(4096.0, std::min(fitting, 300'000.0));
      EXPECT_LE(static_cast<double>(second.size()), 2 * parts + 2) << bandwidth << ", " << way;
    }
  }
}

TEST(PartSizer, ALinkThatBecomesNarrowHasSmallPartsAfterOne) {
  PartSizer sizer;
  for (int i = 0; i < 8; ++i) sizer.record(sizer.bytes(), 1, 0.5, 0);
  EXPECT_GT(sizer.bytes(), 1'000'000u);
  sizer.record(100'000, 3000, 2990, 0);
  EXPECT_EQ(sizer.bytes(), PartSizer::kSmallest);
  for (int i = 0; i < 40; ++i) sizer.record(sizer.bytes(), 1, 0.5, 1e-9);
  EXPECT_EQ(sizer.bytes(), PartSizer::kLargest);
}

TEST(Ladder, ALinkThatPartsHaveShownToBeNarrowBeginsLower) {
  const Clock::time_point now{std::chrono::hours(1)};
  LadderClimber climber({3, 7});
  climber.expect(1 / 1000.0, 1);  // 1 MB/s: 26 ms
  EXPECT_EQ(climber.rung(), 3u);
  climber.expect(1 / 100.0, 1);  // 150 ms of rung 4, 50 of 5
  EXPECT_EQ(climber.rung(), 5u);
  climber.record(5, 10, now);
  climber.expect(1.0, 1);  // what was measured on the rung goes first
  EXPECT_EQ(climber.rung(), 5u);
  LadderClimber small({3, 7});
  small.expect(1 / 100.0, 0.25);
  EXPECT_EQ(small.rung(), 3u);
}

TEST(PreviewRung, IsTheBestThatTakesNoLongerThanAPart) {
  EXPECT_EQ(preview_rung(PartSizer::kLargest, 3, 512, 512), 3u);
  EXPECT_EQ(preview_rung(PartSizer::kSmallest, 3, 512, 512), 6u);
  EXPECT_EQ(preview_rung(16'000, 0, 512, 512), 4u);
  EXPECT_EQ(preview_rung(16'000, 5, 512, 512), 5u);
  EXPECT_EQ(preview_rung(16'000, 3, 1024, 1024), 6u);
}

}  // namespace
}  // namespace rimlight::server
