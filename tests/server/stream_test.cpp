#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "core/image/codec.h"
#include "server/protocol/frame_message.h"
#include "tests/server/loopback_server.h"
#include "tests/support/error_of.h"

namespace rimlight::server {
namespace {

using nlohmann::json;
using std::chrono::milliseconds;
using std::chrono::seconds;
using test::LoopbackServer;
using test::RawSocket;

constexpr seconds kPatience{10};
constexpr const char* kUpgrade =
    "GET /sessions/a/stream HTTP/1.1\r\nHost: localhost\r\nConnection: Upgrade\r\nUpgrade: "
    "websocket\r\n"
    "Sec-WebSocket-Version: 13\r\nSec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==\r\n\r\n";

Clock::time_point soon() { return Clock::now() + kPatience; }

std::string rotation_edit(double degrees, const std::string& id = "e") {
  const Quaternion q = axis_angle({0, 1, 0}, degrees * 3.14159265358979 / 180);
  return json{{"type", "edit"}, {"id", id}, {"rotation", {q.x, q.y, q.z, q.w}}}.dump();
}

/// A client that acknowledges what it takes.
class Viewer {
 public:
  explicit Viewer(std::unique_ptr<StreamClient> stream) : stream_(std::move(stream)) {}

  StreamClient& stream() { return *stream_; }
  bool send(const std::string& text) { return stream_->send_text(text); }
  bool edit(double degrees) { return send(rotation_edit(degrees)); }

  /// The next text message, frames passed over; null when none comes.
  json next_text() {
    for (;;) {
      const StreamClient::Received received = stream_->receive(soon());
      if (const auto* const text = std::get_if<StreamClient::Text>(&received)) {
        return json::parse(text->text);
      }
      if (!take(received)) return nullptr;
    }
  }
  /// Reads until a message of that type.
  json wait_for(const std::string& type) {
    for (json message = next_text(); !message.is_null(); message = next_text()) {
      if (message["type"] == type) return message;
    }
    return nullptr;
  }
  /// Reads until the exact frame of at least that revision; false when it does not come.
  bool wait_for_exact(std::int64_t revision) {
    const Clock::time_point end = soon();
    while (Clock::now() < end) {
      if (!headers.empty() && headers.back().exact && headers.back().revision.number >= revision) {
        return true;
      }
      const StreamClient::Received received = stream_->receive(end);
      if (!std::holds_alternative<StreamClient::Text>(received) && !take(received)) return false;
    }
    return false;
  }
  /// True when revisions and frame numbers ascend.
  bool in_order() const {
    for (std::size_t i = 1; i < headers.size(); ++i) {
      if (headers[i].revision < headers[i - 1].revision) return false;
      if (headers[i].frame <= headers[i - 1].frame) return false;
    }
    return true;
  }

  std::vector<FrameHeader> headers;
  std::vector<std::uint8_t> payload;  // of the last frame

 private:
  bool take(const StreamClient::Received& received) {
    const auto* const binary = std::get_if<StreamClient::Binary>(&received);
    if (binary == nullptr) return false;
    const ParsedFrame frame = parse_frame_message(binary->bytes, "frame");
    headers.push_back(frame.header);
    payload.assign(frame.payload.begin(), frame.payload.end());
    return send(json{{"type", "frame_ack"}, {"frame", frame.header.frame}}.dump());
  }

  std::unique_ptr<StreamClient> stream_;
};

/// The pixels that the last frame of a session must have.
Rgb8Image expected_sphere(double degrees) {
  test::SphereSource source(64, 48, std::make_shared<test::SphereProbe>());
  DesignState state{"day", axis_angle({0, 1, 0}, degrees * 3.14159265358979 / 180), 0};
  Rgb8Image image;
  FrameReport report;
  source.render_exact(state, image, report, {});
  return image;
}

TEST(Stream, EditsAreAcknowledgedAndTheLastFrameIsExactlyTheirImage) {
  const LoopbackServer server;
  Viewer viewer(server.open("a"));
  EXPECT_EQ(viewer.next_text()["type"], "welcome");
  ASSERT_TRUE(viewer.wait_for_exact(0));
  for (int i = 1; i <= 30; ++i) {
    ASSERT_TRUE(viewer.send(rotation_edit(i, std::to_string(i))));
    const json ack = viewer.wait_for("ack");
    ASSERT_EQ(ack["id"], std::to_string(i));
    ASSERT_EQ(ack["revision"], i);
  }
  ASSERT_TRUE(viewer.wait_for_exact(30));
  EXPECT_TRUE(viewer.in_order());
  EXPECT_GE(viewer.headers.size(), 3u);
  const Rgb8Image image = decode_png(viewer.payload.data(), viewer.payload.size(), "frame");
  EXPECT_EQ(image.bytes, expected_sphere(30).bytes);
}

TEST(Stream, SeveralClientsOfOneSessionSeeOneStateAndTheSameLastFrame) {
  const LoopbackServer server;
  std::vector<std::unique_ptr<Viewer>> viewers;
  for (int i = 0; i < 5; ++i) viewers.push_back(std::make_unique<Viewer>(server.open("shared")));
  Viewer other(server.open("other"));
  for (int i = 1; i <= 20; ++i) {
    ASSERT_TRUE(viewers[static_cast<std::size_t>(i % 5)]->edit(i));
    ASSERT_FALSE(viewers[static_cast<std::size_t>(i % 5)]->wait_for("ack").is_null());
  }
  for (const auto& viewer : viewers) {
    ASSERT_TRUE(viewer->wait_for_exact(20));
    EXPECT_TRUE(viewer->in_order());
    EXPECT_EQ(viewer->payload, viewers[0]->payload);
  }
  ASSERT_TRUE(other.wait_for_exact(0));
  EXPECT_NE(other.payload, viewers[0]->payload);
}

TEST(Stream, MalformedMessagesGetAReasonAndTheConnectionAndEveryoneElseGoOn) {
  const LoopbackServer server;
  Viewer bad(server.open("a"));
  Viewer good(server.open("a"));
  for (const std::string& text :
       {std::string("{"), std::string("[]"), std::string("{\"type\":\"shout\"}"),
        std::string("{\"type\":\"edit\",\"rotation\":[0,0,0,0]}"), std::string(),
        std::string("{\"type\":\"frame_ack\",\"frame\":999}"), std::string(30000, '[')}) {
    ASSERT_TRUE(bad.send(text));
    const json reply = bad.wait_for("error");
    ASSERT_FALSE(reply.is_null()) << text.substr(0, 40);
    EXPECT_FALSE(reply["reason"].get<std::string>().empty());
  }
  ASSERT_TRUE(bad.stream().send_binary("bytes"));
  EXPECT_NE(bad.wait_for("error")["reason"].get<std::string>().find("binary"), std::string::npos);
  ASSERT_TRUE(bad.send(R"({"type":"edit","id":"77","exposure":99})"));
  EXPECT_EQ(bad.wait_for("error")["id"], "77");
  ASSERT_TRUE(bad.send(R"({"type":"ping","id":"p"})"));
  EXPECT_EQ(bad.wait_for("pong")["id"], "p");
  ASSERT_TRUE(bad.edit(5));
  EXPECT_TRUE(bad.wait_for_exact(1));
  EXPECT_TRUE(good.wait_for_exact(1));
}

TEST(Stream, AGiantMessageEndsItsOwnConnectionOnly) {
  const LoopbackServer server;
  Viewer good(server.open("a"));
  RawSocket giant(server.port());
  giant.send(kUpgrade);
  ASSERT_NE(giant.read_some().find("101"), std::string::npos);
  // A masked text frame of kLargestMessage + 1 bytes: its header is enough.
  giant.send(std::string("\x81\xff\0\0\0\0\0\1\0\1mask", 14));
  static_assert(kLargestMessage + 1 == 0x10001);
  const std::string received = giant.read_all();
  EXPECT_NE(received.find("\x03\xf1"), std::string::npos);  // closed with 1009: too big
  ASSERT_TRUE(good.edit(5));
  EXPECT_TRUE(good.wait_for_exact(1));
}

TEST(Stream, ASlowReaderSkipsFramesAndStillGetsTheLastExactOne) {
  const LoopbackServer server;
  Viewer slow(server.open("a"));
  Viewer fast(server.open("a"));
  ASSERT_TRUE(fast.wait_for_exact(0));
  for (int i = 1; i <= 200; ++i) {  // slow reads nothing meanwhile
    ASSERT_TRUE(fast.edit(i));
    ASSERT_FALSE(fast.wait_for("ack").is_null());
  }
  ASSERT_TRUE(fast.wait_for_exact(200));
  ASSERT_TRUE(slow.wait_for_exact(200));
  EXPECT_TRUE(slow.in_order());
  EXPECT_LE(slow.headers.size(), 4u);  // the first, the one that waited, and the last
  EXPECT_GT(fast.headers.size(), slow.headers.size());
  EXPECT_EQ(slow.payload, fast.payload);
}

TEST(Stream, AFloodOfEditsFromAClientThatReadsNothingIsBoundedAndLosesNothing) {
  const LoopbackServer server;
  Viewer flood(server.open("a"));
  for (int i = 1; i <= 2000; ++i) {
    ASSERT_TRUE(flood.send(rotation_edit(i, std::to_string(i))));
  }
  json last;
  for (int i = 0; i < 2000; ++i) last = flood.wait_for("ack");
  EXPECT_EQ(last["id"], "2000");
  EXPECT_EQ(last["revision"], 2000);
  EXPECT_TRUE(flood.wait_for_exact(2000));
}

TEST(Stream, ClientsThatVanishInTheMiddleOfAFrameLeaveTheOthersAlone) {
  LoopbackServer::Settings settings;
  settings.width = 1024;  // frames larger than the sockets' buffers
  settings.height = 1024;
  const LoopbackServer server(settings);
  for (int i = 0; i < 10; ++i) {
    RawSocket socket(server.port());
    socket.send(kUpgrade);
    ASSERT_NE(socket.read_some().find("101"), std::string::npos);
    if (i % 2 == 0) socket.reset();
  }
  Viewer good(server.open("a"));
  ASSERT_TRUE(good.edit(5));
  EXPECT_TRUE(good.wait_for_exact(1));
}

TEST(Stream, AHalfOpenSocketIsClosedAfterTheTimeouts) {
  LoopbackServer::Settings settings;
  settings.network.handshake_timeout = seconds(1);
  settings.network.idle_timeout = seconds(1);
  const LoopbackServer server(settings);
  RawSocket silent(server.port());  // says nothing at all
  RawSocket half(server.port());    // begins a request
  half.send("GET / HTTP/1.1\r\n");
  RawSocket upgraded(server.port());  // answers no ping
  upgraded.send(kUpgrade);
  const Clock::time_point start = Clock::now();
  silent.read_all();  // until the server closes; its own timeout is thirty seconds
  half.read_all();
  EXPECT_NE(upgraded.read_all().find("101"), std::string::npos);
  EXPECT_LT(Clock::now() - start, seconds(4));
}

TEST(Stream, StoppingWhileItStreamsSaysGoodbyeToAll) {
  LoopbackServer server;
  std::vector<std::unique_ptr<Viewer>> viewers;
  for (int i = 0; i < 4; ++i) {
    viewers.push_back(std::make_unique<Viewer>(server.open("s" + std::to_string(i % 2))));
    ASSERT_TRUE(viewers.back()->edit(i));
  }
  std::jthread reading([&] {  // one client takes part in the closing handshake, the others do not
    const Clock::time_point end = soon();
    for (;;) {
      const StreamClient::Received received = viewers[0]->stream().receive(end);
      if (std::holds_alternative<StreamClient::Nothing>(received)) break;
      if (const auto* const closed = std::get_if<StreamClient::Closed>(&received)) {
        EXPECT_EQ(closed->code, 1001);  // going away
        break;
      }
    }
  });
  EXPECT_LT(server.stop(), milliseconds(4000));
  reading.join();
  EXPECT_NE(rimlight::test::error_of([&] { server.open("late"); }), "no error");
}

TEST(Stream, AnIdleServerStopsAtOnce) {
  LoopbackServer server;
  EXPECT_LT(server.stop(), milliseconds(500));
}

}  // namespace
}  // namespace rimlight::server
