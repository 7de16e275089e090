// The short form of script/slow-client: real sockets, one client on a narrow link.

#include <gtest/gtest.h>

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
      const LoadClientSettings settings{.url = url,
                                        .session = session,
                                        .scene = "sphere",
                                        .start = start,
                                        .seconds = kSeconds,
                                        .codec = codec,
                                        .slow_kBps = i == 0 ? 0 : watchers[i - 1]};
      records[i] = play(settings, i == 0 ? default_script(kSeconds) : LoadScript{});
    });
  }
  threads.clear();
  return records;
}

TEST(NarrowLink, AClientOnItChangesNobodyElsesFrames) {
  const LoopbackServer server(pictures_of(512, 384));
  for (const LoadCodec codec : {LoadCodec::jpeg, LoadCodec::vp8}) {
    if (codec == LoadCodec::vp8 && !has_vp8()) continue;
    const int best = codec == LoadCodec::vp8 ? 0 : static_cast<int>(kVp8Rungs);
    std::vector<LoadRecord> alone = play_together(server, codec, {0});
    std::vector<LoadRecord> beside =
        play_together(server, codec, {0, codec == LoadCodec::vp8 ? 30.0 : 80.0});
    for (const LoadRecord& record : beside) {
      EXPECT_TRUE(record.failures.empty()) << record.failures.front();
      EXPECT_TRUE(record.revisions_ascend);
      ASSERT_TRUE(record.last_header);
      EXPECT_TRUE(record.last_header->exact);
      EXPECT_EQ(record.last_header->revision, record.state_revision);
    }
    EXPECT_EQ(beside[1].last_payload, beside[2].last_payload);
    // How soon, script/slow-client measures.
    EXPECT_EQ(beside[0].edits_acknowledged, alone[0].edits_acknowledged);
    EXPECT_GT(beside[0].rungs[best].frames, 0);
    // The narrow one steps down, by its own delay; this picture's VP8 frames fit its link.
    if (codec == LoadCodec::jpeg) {
      EXPECT_GT(beside[2].rungs.rbegin()->first, best);
    }
    EXPECT_LT(beside[2].frames, beside[0].frames);
  }
}

}  // namespace
}  // namespace rimlight::server
