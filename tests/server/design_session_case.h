#pragma once

#include <gtest/gtest.h>

#include <chrono>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <utility>
#include <vector>

#include "server/protocol/frame_message.h"
#include "server/session/design_session.h"
#include "tests/server/sphere_source.h"

namespace rimlight::server::test {

using nlohmann::json;
using std::chrono::milliseconds;

/// A client that keeps what it is sent.
class KeepingClient : public Client {
 public:
  void send_text(std::string text) override { texts.push_back(json::parse(text)); }
  void send_state(std::string text) override { states.push_back(json::parse(text)); }
  void send_presence(std::string text) override { presences.push_back(json::parse(text)); }
  void send_snapshots(std::string text) override { snapshots.push_back(json::parse(text)); }
  void send_frame(FramePtr frame) override { frames.push_back(std::move(frame)); }

  FrameHeader last() const { return parse_frame_message(frames.back()->bytes(), "frame").header; }

  std::vector<json> texts, states, presences, snapshots;
  std::vector<FramePtr> frames;
};

/// A session whose time and compute thread are the test's.
class DesignSessionTest : public testing::Test {
 protected:
  std::shared_ptr<KeepingClient> join(const Visitor& visitor = {}) {
    auto client = std::make_shared<KeepingClient>();
    session->join(client, now, visitor);
    return client;
  }
  void edit(const KeepingClient& client, double degrees, const std::string& id = "e") {
    Edit change;
    change.id = id;
    change.rotation = axis_angle({0, 1, 0}, degrees * 3.14159265358979 / 180);
    session->apply(client, change, now);
  }
  void acknowledge(const KeepingClient& client) {
    EXPECT_EQ(session->acknowledge(client, client.frames.back()->frame, now), AckResult::taken);
  }
  /// All the work that is due now.
  void work() {
    while (queue.run_one(now)) {
    }
  }
  void pass(milliseconds time) {
    now += time;
    work();
  }

  std::shared_ptr<SphereProbe> probe = std::make_shared<SphereProbe>();
  ServedScene scene = sphere_scene("sphere", 32, 24, probe);
  Clock::time_point now{std::chrono::hours(1)};
  RenderQueue queue{[this] { return now; }};
  std::shared_ptr<DesignSession> session =
      std::make_shared<DesignSession>("s", scene, 5, SessionSettings{}, queue);
};

}  // namespace rimlight::server::test
