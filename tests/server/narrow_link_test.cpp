// The short form of script/slow-client: real sockets, one client on a narrow link.

#include <gtest/gtest.h>

#include <algorithm>
#include <thread>

#include "cli/load_client.h"
#include "cli/load_report.h"
#include "server/delivery/ladder.h"
#include "tests/server/loopback_server.h"

namespace rimlight::server {
namespace {

using test::LoopbackServer;

constexpr double kSeconds = 3;

LoopbackServer::Settings pictures_of(int width, int height) {
  LoopbackServer::Settings settings;
  settings.width = width;
  settings.height = height;
  return settings;
}

/// An editor, and watchers of its session each on a link of so many kB/s (0: as fast as it is).
std::vector<LoadRecord> play_together(const LoopbackServer& server, LoadCodec codec,
                                      const std::vector<double>& watchers) {
  static int runs = 0;
  const std::string session = "run-" + std::to_string(runs++);
  const StreamUrl url{"127.0.0.1", std::to_string(server.port())};
  const auto start = std::chrono::steady_clock::now() + std::chrono::milliseconds(100);
  std::vector<LoadRecord> records(1 + watchers.size());
  std::vector<std::jthread> threads;
  for (std::size_t i = 0; i < records.size(); ++i) {
    threads.emplace_back([&, i] {
      const LoadClientSettings settings{url,      session, "sphere", start,
                                        kSeconds, 10,      codec,    i == 0 ? 0 : watchers[i - 1]};
      records[i] = play(settings, i == 0 ? default_script(kSeconds) : LoadScript{});
    });
  }
  threads.clear();
  return records;
}

double p99(LoadRecord& record) { return percentile(record.latencies_ms, 0.99); }

TEST(NarrowLink, AClientOnItChangesNobodyElsesFramesOrLatency) {
  const LoopbackServer server(pictures_of(512, 384));
  for (const LoadCodec codec : {LoadCodec::jpeg, LoadCodec::vp8}) {
    if (codec == LoadCodec::vp8 && !has_vp8()) continue;
    const int best = codec == LoadCodec::vp8 ? 0 : static_cast<int>(kVp8Rungs);
    std::vector<LoadRecord> alone = play_together(server, codec, {0});
    std::vector<LoadRecord> beside =
        play_together(server, codec, {0, codec == LoadCodec::vp8 ? 14.0 : 80.0});
    for (const LoadRecord& record : beside) {
      EXPECT_TRUE(record.failures.empty()) << record.failures.front();
      EXPECT_TRUE(record.revisions_ascend);
      ASSERT_TRUE(record.last_header);
      EXPECT_TRUE(record.last_header->exact);
      EXPECT_EQ(record.last_header->revision, record.state_revision);
    }
    EXPECT_EQ(beside[1].last_payload, beside[2].last_payload);
    // Of the machine's own noise: a busy one may halve what two runs see.
    EXPECT_GE(2 * beside[0].frames, alone[0].frames);
    EXPECT_LE(p99(beside[0]), 3 * p99(alone[0]) + 30);
    EXPECT_GT(beside[0].rungs[best].frames, 0);
    // The narrow one steps down, by its own delay.
    EXPECT_GT(beside[2].rungs.rbegin()->first, best);
    EXPECT_LT(beside[2].frames, beside[0].frames);
  }
}

TEST(NarrowLink, AnEditsFrameDoesNotWaitForALosslessOne) {
  const LoopbackServer server(pictures_of(800, 600));
  constexpr double kBytesPerMs = 30;
  LoadScript script;  // bursts of edits, each while the lossless frame of the one before is sent
  for (int burst = 0; burst < 4; ++burst) {
    for (int i = 0; i < 5; ++i) {
      ScriptedEdit edit;
      edit.at_ms = 900.0 * burst + 40.0 * i;
      edit.rotation = axis_angle({0, 1, 0}, 0.1 * (10 * burst + i) + 0.05);
      script.edits.push_back(edit);
    }
  }
  const LoadRecord record = play({{"127.0.0.1", std::to_string(server.port())},
                                  "narrow",
                                  "sphere",
                                  std::chrono::steady_clock::now(),
                                  4.5,
                                  10,
                                  LoadCodec::jpeg,
                                  kBytesPerMs},
                                 script);
  ASSERT_TRUE(record.last_header && record.last_header->exact);
  EXPECT_TRUE(record.failures.empty()) << record.failures.front();
  EXPECT_TRUE(record.last_header->part);
  const double lossless_ms = static_cast<double>(record.last_payload.size()) / kBytesPerMs;
  RecordProperty("lossless_ms", std::to_string(lossless_ms));
  ASSERT_GT(lossless_ms, 700);  // the next burst comes before it is there
  ASSERT_EQ(record.latencies_ms.size(), script.edits.size());
  EXPECT_LT(*std::max_element(record.latencies_ms.begin() + 5, record.latencies_ms.end()),
            lossless_ms / 2);
}

}  // namespace
}  // namespace rimlight::server
