// Floods of sockets that drip bytes: all are closed, and nobody who works is held up. Longer and
// wider by script/flood.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <nlohmann/json.hpp>
#include <thread>

#include "server/upload/decoded_environment.h"
#include "tests/server/loopback_server.h"

namespace rimlight::server {
namespace {

using nlohmann::json;
using std::chrono::milliseconds;
using std::chrono::seconds;
using test::LoopbackServer;
using test::RawSocket;

/// For a frame while the flood's sockets are open, which they may be for longer.
constexpr seconds kPatience{5};
constexpr seconds kHandshakeTimeout{7};

int setting(const char* name, int normal) {
  const char* const asked = std::getenv(name);
  return asked == nullptr ? normal : std::atoi(asked);
}

/// Edits at a steady pace; from each edit to the frame that shows it, in milliseconds, sorted.
std::vector<double> latencies(StreamClient& editor, Clock::duration time) {
  std::vector<double> result;
  const auto end = Clock::now() + time;
  for (int i = 0; Clock::now() < end; ++i) {
    const auto sent = Clock::now();
    const double exposure = i % 64 / 16.0;
    EXPECT_TRUE(editor.send_text(json{{"type", "edit"}, {"exposure", exposure}}.dump()));
    std::int64_t revision = -1;
    for (bool shown = false; !shown;) {
      const auto received = editor.receive(sent + kPatience);
      if (const auto* const text = std::get_if<StreamClient::Text>(&received)) {
        const json message = json::parse(text->text);
        if (message["type"] == "ack") revision = message["revision"];
      } else if (const auto* const frame = std::get_if<StreamClient::Binary>(&received)) {
        const auto header = parse_frame_message(frame->bytes, "frame").header;
        EXPECT_TRUE(editor.send_text(json{{"type", "frame_ack"}, {"frame", header.frame}}.dump()));
        shown = revision >= 0 && header.revision.number >= revision;
      } else {
        ADD_FAILURE() << "no frame of an edit";
        return {1e9};
      }
    }
    result.push_back(std::chrono::duration<double, std::milli>(Clock::now() - sent).count());
    std::this_thread::sleep_until(sent + milliseconds(10));
  }
  std::ranges::sort(result);
  return result;
}

double p99(const std::vector<double>& sorted) { return sorted[sorted.size() * 99 / 100]; }

/// Sockets that send `start`, then a byte each 100 ms, until the server closes them.
class Drip {
 public:
  Drip(std::uint16_t port, int count, const std::string& start) {
    for (int i = 0; i < count; ++i) {
      sockets_.push_back(std::make_unique<RawSocket>(port));
      sockets_.back()->send(start);
    }
    thread_ = std::jthread([this](const std::stop_token& stop) {
      while (!stop.stop_requested()) {
        for (const auto& socket : sockets_) socket->send("x");
        std::this_thread::sleep_for(milliseconds(100));
      }
    });
  }
  /// Waits until the server has closed all; false after four seconds more.
  bool all_closed() {
    thread_.request_stop();
    thread_.join();
    for (const auto& socket : sockets_) {
      const auto start = Clock::now();
      socket->read_all();
      if (Clock::now() - start > seconds(4)) return false;
    }
    return true;
  }

 private:
  std::vector<std::unique_ptr<RawSocket>> sockets_;
  std::jthread thread_;
};

class Flood : public testing::TestWithParam<std::string> {};

TEST_P(Flood, IsClosedAndHoldsUpNobody) {
  LoopbackServer::Settings settings;
  settings.network.handshake_timeout = kHandshakeTimeout;
  settings.network.most_connections = 64;
  const LoopbackServer server(settings);
  const int count = setting("RIMLIGHT_FLOOD_CONNECTIONS", 200);
  const milliseconds time(setting("RIMLIGHT_FLOOD_MS", 1500));
  const auto editor = server.open("a");
  const double before = p99(latencies(*editor, time));
  Drip drip(server.port(), count, GetParam());
  const auto start = Clock::now();
  const auto late = server.open("b");  // there is a place for who asks properly
  const auto opened = Clock::now() - start;
  const double during = p99(latencies(*editor, time));
  latencies(*late, milliseconds(200));
  std::this_thread::sleep_until(start + kHandshakeTimeout + milliseconds(500));
  EXPECT_TRUE(drip.all_closed());
  const double after = p99(latencies(*editor, time));
  std::printf("%d sockets: p99 %.1f ms before, %.1f during, %.1f after; another opens in %.0f ms\n",
              count, before, during, after,
              std::chrono::duration<double, std::milli>(opened).count());
  EXPECT_LT(opened, kHandshakeTimeout);
}

std::string name_of(const testing::TestParamInfo<std::string>& info) {
  const std::vector<std::string> names{"Headers", "Silence", "Uploads", "Bodies"};
  return names[info.index];
}

INSTANTIATE_TEST_SUITE_P(
    Slow, Flood,
    testing::Values("GET / HTTP/1.1\r\nHost: localhost\r\nX: ", "",
                    "POST /sessions/a/environments/x HTTP/1.1\r\nHost: localhost\r\n"
                    "Content-Length: 5000\r\n\r\n#?RADIANCE\n",
                    "POST / HTTP/1.1\r\nHost: localhost\r\nContent-Length: 5000\r\n\r\n"),
    name_of);

}  // namespace
}  // namespace rimlight::server
