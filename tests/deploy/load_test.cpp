// Many clients on one server: what each gets, that no session starves, and that what vanished
// clients took comes back. The short form is of a small bake, and checks what holds on any machine;
// script/load plays the long form of a real one, prints the numbers and checks their bounds.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <thread>

#include "cli/load_client.h"
#include "cli/load_report.h"
#include "core/image/codec.h"
#include "server/session/baked_scene.h"
#include "tests/deploy/served_program.h"
#include "tests/support/small_bake.h"
#include "tests/support/temporary_folder.h"

namespace rimlight {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;
using test::ServedProgram;
using Clock = std::chrono::steady_clock;

const char* long_form_bake() { return std::getenv("RIMLIGHT_LOAD_BAKE"); }
double play_seconds() { return long_form_bake() != nullptr ? 10 : 1.5; }

/// One client of each session that edits, and others that watch.
struct Crowd {
  std::size_t sessions = 1;
  std::size_t watchers = 0;  // of each session
};

class Load : public testing::Test {
 protected:
  Load() {
    if (long_form_bake() != nullptr) {
      bake_ = long_form_bake();
    } else {
      bake_ = (folder_ / "a.bake").string();
      test::write_small_bake(bake_, {});
    }
    server_ = std::make_unique<ServedProgram>(
        std::vector<std::string>{bake_, "--store", (folder_ / "s.sqlite").string()});
  }

  /// What all see, editors first.
  std::vector<LoadRecord> play_all(const Crowd& crowd, const LoadScript& script) {
    static int runs = 0;
    const std::string run = "crowd-" + std::to_string(runs++) + "-";
    const std::size_t count = crowd.sessions * (1 + crowd.watchers);
    const auto start = Clock::now() + milliseconds(500);
    std::vector<LoadRecord> records(count);
    std::vector<std::jthread> threads;
    for (std::size_t i = 0; i < count; ++i) {
      threads.emplace_back([&, i] {
        const LoadClientSettings settings{.url = server_->url(),
                                          .session = run + std::to_string(i % crowd.sessions),
                                          .scene = "",
                                          .start = start,
                                          .seconds = play_seconds(),
                                          .settle_seconds = 60};
        records[i] = play(settings, i < crowd.sessions ? script : LoadScript{});
      });
    }
    threads.clear();
    return records;
  }
  std::vector<LoadRecord> play_all(const Crowd& crowd) {
    return play_all(crowd, default_script(play_seconds()));
  }

  /// A value of /metrics.
  double metric(const std::string& name) const {
    const std::string text = server_->get("/metrics");
    const std::size_t at = text.find("\n" + name + " ");
    return at == std::string::npos ? -1 : std::atof(text.c_str() + at + name.size() + 2);
  }

  std::string bake_;
  test::TemporaryFolder folder_;
  std::unique_ptr<ServedProgram> server_;
};

double rate(const LoadRecord& record) {
  return static_cast<double>(record.frames) / record.motion_seconds;
}

/// Frames a second of each, ascending.
std::vector<double> rates(const std::vector<LoadRecord>& records) {
  std::vector<double> result;
  for (const LoadRecord& record : records) result.push_back(rate(record));
  std::ranges::sort(result);
  return result;
}

void print(const char* what, const std::vector<LoadRecord>& records) {
  const auto each = rates(records);
  double sum = 0;
  for (const double one : each) sum += one;
  std::vector<double> latencies;
  for (const auto& record : records) {
    latencies.insert(latencies.end(), record.latencies_ms.begin(), record.latencies_ms.end());
  }
  const double p50 = percentile(latencies, 0.5), p95 = percentile(latencies, 0.95);
  std::printf(
      "%s: %.1f frames/s in all; each %.1f to %.1f, median %.1f; edit to frame p50 %.1f ms, "
      "p95 %.1f ms\n",
      what, sum, each.front(), each.back(), each[each.size() / 2], p50, p95);
}

void expect_all_served(const std::vector<LoadRecord>& records) {
  for (const LoadRecord& record : records) {
    EXPECT_TRUE(record.failures.empty()) << record.failures.front();
    EXPECT_EQ(record.edits_acknowledged, record.edits_sent);
    EXPECT_TRUE(record.revisions_ascend);
    EXPECT_GT(record.frames, 0);
    ASSERT_TRUE(record.last_header);
    EXPECT_TRUE(record.last_header->exact);
    EXPECT_EQ(record.last_header->revision, record.state_revision);
  }
}

TEST_F(Load, OneClient) {
  const auto records = play_all({});
  print("1 client", records);
  expect_all_served(records);
  if (long_form_bake() != nullptr) {
    EXPECT_GE(rate(records[0]), 0.95 * 60);  // as many as edits
  }
}

TEST_F(Load, SixtyFourClientsOfOneSession) {
  const auto records = play_all({.watchers = 63});
  print("64 clients of one session", records);
  expect_all_served(records);
  if (long_form_bake() != nullptr) {
    EXPECT_GE(rates(records).front(), 20);
  }
}

TEST_F(Load, ThirtyTwoSessionsThatAreAllEdited) {
  const auto records = play_all({.sessions = 32});
  print("32 sessions", records);
  expect_all_served(records);
  const auto each = rates(records);
  double sum = 0;
  for (const double one : each) sum += one;
  EXPECT_GE(each.front(), sum / 32 / 3);
  if (long_form_bake() != nullptr) {
    EXPECT_GE(sum, 120);
  }
}

TEST_F(Load, StreamingCostsLittleOverTheSameWorkInALoop) {
  LoadScript script;  // more edits than frames
  for (double at = 0; at < play_seconds() * 1000; at += 4) {
    ScriptedEdit edit;
    edit.at_ms = at;
    edit.rotation = axis_angle({0, 1, 0}, 1e-4 * at * (1 + 1e-5 * at));
    script.edits.push_back(edit);
  }
  const auto records = play_all({}, script);
  server_.reset();
  server::DrawSettings drawing;  // as `rimlight serve` does by default
  drawing.relight.budget = parse_budget("8ms", "budget");
  const server::ServedScene scene = server::open_scene(bake_, drawing);
  const auto source = scene.make_source();
  JpegEncoder jpeg;
  Rgb8Image image;
  std::vector<std::uint8_t> bytes;
  DesignState state;
  state.environment = scene.environments.front();
  int frames = 0;
  const auto end = Clock::now() + milliseconds(static_cast<int>(play_seconds() * 1000));
  for (; Clock::now() < end; ++frames) {
    state.rotation = *script.edits[static_cast<std::size_t>(frames) % script.edits.size()].rotation;
    source->render_moving(state, image);
    jpeg.encode(image, 80, bytes);
  }
  const double looped = frames / play_seconds();
  std::printf("streaming: %.1f frames/s; in a loop: %.1f; ratio %.2f\n", rate(records[0]), looped,
              rate(records[0]) / looped);
  expect_all_served(records);
  if (long_form_bake() != nullptr) {
    EXPECT_GE(rate(records[0]), 0.8 * std::min(looped, 250.0));
  }
}

TEST_F(Load, WhatVanishedClientsTookComesBack) {
  const int rounds = long_form_bake() != nullptr ? 60 : 4;
  constexpr int kClients = 100, kSessions = 40;
  // What a session draws with is made when somebody first waits for a frame; those who vanish do so
  // now and then only, and it would look like growth.
  for (int i = 0; i < kSessions; ++i) {
    StreamClient client(server_->url(), "/sessions/gone-" + std::to_string(i) + "/stream");
    const auto end = Clock::now() + seconds(30);
    while (!std::holds_alternative<StreamClient::Binary>(client.receive(end)) &&
           Clock::now() < end) {
    }
    ASSERT_LT(Clock::now(), end);
  }
  const auto vanish = [&](int round) {
    std::vector<std::unique_ptr<StreamClient>> clients;
    for (int i = 0; i < kClients; ++i) {
      const std::string session = "gone-" + std::to_string((round * kClients + i) % kSessions);
      clients.push_back(
          std::make_unique<StreamClient>(server_->url(), "/sessions/" + session + "/stream"));
      (void)clients.back()->send_text(R"({"type":"edit","id":"1","exposure":0.5})");
    }
  };  // without a goodbye
  const auto settle = [&] {
    for (const auto end = Clock::now() + seconds(30);
         Clock::now() < end && metric("rimlight_connections") > 0;) {
      std::this_thread::sleep_for(milliseconds(50));
    }
    EXPECT_EQ(metric("rimlight_connections"), 0);
  };
  vanish(0);
  settle();
  const double files = metric("process_open_fds");
  double memory = metric("process_resident_memory_bytes");
  for (int round = 1; round <= rounds; ++round) {
    if (round == rounds / 2) memory = metric("process_resident_memory_bytes");
    vanish(round);
    settle();
  }
  const double grown = metric("process_resident_memory_bytes") - memory;
  std::printf("%d clients that vanished: %.0f open files before, %.0f after; %+.1f kB a client\n",
              rounds * kClients, files, metric("process_open_fds"),
              grown / 1000 / (rounds - rounds / 2.0) / kClients);
  EXPECT_LE(metric("process_open_fds"), files + 4);
  EXPECT_LT(grown, 16e6);  // what the kernel and the allocator round up to
}

}  // namespace
}  // namespace rimlight
