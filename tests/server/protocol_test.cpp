#include <gtest/gtest.h>

#include <cmath>

#include "core/math/random.h"
#include "server/protocol/frame_message.h"
#include "server/protocol/messages.h"
#include "server/protocol/stream_target.h"
#include "tests/support/error_of.h"

namespace rimlight::server {
namespace {

using rimlight::test::error_of;
using ::testing::Test;

const std::vector<std::string> kEnvironments{"day", "night"};

ClientMessage parsed(const std::string& text) { return parse_client_message(text, kEnvironments); }

TEST(ClientMessages, EachKindComesBackAsItWasSent) {
  const auto edit = std::get<Edit>(parsed(
      R"({"type":"edit","id":"7","rotation":[0,0,2,0],"environment":"night","exposure":-1.5})"));
  EXPECT_EQ(edit, (Edit{"7", Quaternion{0, 0, 1, 0}, "night", -1.5}));
  EXPECT_EQ(std::get<Edit>(parsed(R"({"type":"edit","exposure":20})")),
            (Edit{"", std::nullopt, std::nullopt, 20.0}));
  EXPECT_EQ(std::get<FrameAck>(parsed(R"({"type":"frame_ack","frame":12})")), FrameAck{12});
  EXPECT_EQ(std::get<Ping>(parsed(R"({"type":"ping","id":"a"})")), Ping{"a"});
  EXPECT_EQ(std::get<Display>(parsed(R"({"type":"display","codecs":["av2","vp8","jpeg"]})")),
            (Display{.vp8 = true}));
  EXPECT_EQ(std::get<Display>(parsed(R"({"type":"display","codecs":[],"parts":true,"hidden":true,)"
                                     R"("most_pixels":5})")),
            (Display{false, true, true, 5}));
}

TEST(ClientMessages, RotationsComeBackAsUnitQuaternions) {
  Random random(1);
  for (int i = 0; i < 200; ++i) {
    const double size = std::exp2(random.uniform(-15, 15));
    const Quaternion q = random_rotation(random);
    const nlohmann::json message{{"type", "edit"},
                                 {"rotation", {q.x * size, q.y * size, q.z * size, q.w * size}}};
    const Quaternion got = *std::get<Edit>(parsed(message.dump())).rotation;
    EXPECT_NEAR(norm(got), 1, 1e-12);
    EXPECT_NEAR(got.x * q.x + got.y * q.y + got.z * q.z + got.w * q.w, 1, 1e-12);
  }
}

struct BadMessage {
  const char* text;
  const char* error;  // part of what() must be this
};

class BadMessages : public testing::TestWithParam<BadMessage> {};

TEST_P(BadMessages, GetAnErrorThatNamesTheField) {
  const std::string error = error_of([] { parsed(GetParam().text); });
  EXPECT_NE(error.find(GetParam().error), std::string::npos) << error;
}

INSTANTIATE_TEST_SUITE_P(
    Table, BadMessages,
    testing::Values(
        BadMessage{"", "malformed JSON"}, BadMessage{"{", "malformed JSON"},
        BadMessage{"[]", "expected an object"}, BadMessage{"null", "expected an object"},
        BadMessage{"{}", "no \"type\""}, BadMessage{R"({"type":7})", "message: /type"},
        BadMessage{R"({"type":"shout"})", "found \"shout\", expected one of \"edit\""},
        BadMessage{R"({"type":"edit"})", "sets nothing"},
        BadMessage{R"({"type":"edit","rotaton":[0,0,0,1]})", "unknown field \"rotaton\""},
        BadMessage{R"({"type":"edit","rotation":[0,0,0]})", "/rotation: found 3 elements"},
        BadMessage{R"({"type":"edit","rotation":[0,0,0,0]})", "a quaternion [x, y, z, w]"},
        BadMessage{R"({"type":"edit","rotation":[1e-9,0,0,0]})", "a quaternion [x, y, z, w]"},
        BadMessage{R"({"type":"edit","rotation":[1e300,0,0,0]})", "/rotation/0"},
        BadMessage{R"({"type":"edit","rotation":[1e999,0,0,0]})", "message"},
        BadMessage{R"({"type":"edit","rotation":[null,0,0,1]})", "/rotation/0: found null"},
        BadMessage{R"({"type":"edit","rotation":[NaN,0,0,1]})", "malformed JSON"},
        BadMessage{R"({"type":"edit","exposure":20.1})", "/exposure: found 20.1"},
        BadMessage{R"({"type":"edit","exposure":"1"})", "/exposure: found \"1\""},
        BadMessage{R"({"type":"edit","environment":"dusk"})", "expected one of \"day\" \"night\""},
        BadMessage{R"({"type":"edit","environment":"day","environment":"night"})", "twice"},
        BadMessage{R"({"type":"edit","id":5,"exposure":1})", "/id: found 5"},
        BadMessage{R"({"type":"display"})", "no \"codecs\""},
        BadMessage{R"({"type":"display","codecs":"vp8"})", "/codecs: found"},
        BadMessage{R"({"type":"display","codecs":[1]})", "/codecs/0: found 1"},
        BadMessage{R"({"type":"display","codecs":[],"most_pixels":0})", "/most_pixels: found 0"},
        BadMessage{R"({"type":"display","codecs":[],"hidden":1})", "/hidden: found 1"},
        BadMessage{R"({"type":"display","codecs":[],"x":1})", "unknown field \"x\""},
        BadMessage{R"({"type":"frame_ack"})", "no \"frame\""},
        BadMessage{R"({"type":"frame_ack","frame":-1})", "/frame: found -1"},
        BadMessage{R"({"type":"frame_ack","frame":1.5})", "/frame: found 1.5"},
        BadMessage{R"({"type":"frame_ack","frame":1,"x":1})", "unknown field \"x\""},
        BadMessage{R"({"type":"ping","frame":1})", "unknown field \"frame\""}));

TEST(ClientMessages, DeepNestingIsAnErrorNotACrash) {
  const std::string deep = std::string(30000, '[') + std::string(30000, ']');
  EXPECT_NE(error_of([&] { parsed(deep); }), "no error");
}

TEST(ClientMessages, AnIdOfALongNameIsRefusedAndNotRepeated) {
  const std::string text =
      R"({"type":"edit","exposure":1,"id":")" + std::string(kLongestId + 1, 'x') + "\"}";
  EXPECT_NE(error_of([&] { parsed(text); }).find("at most 64 bytes"), std::string::npos);
  EXPECT_EQ(find_message_id(text), std::nullopt);
  EXPECT_EQ(find_message_id(R"({"id":"7","type":"nonsense"})"), "7");
  EXPECT_EQ(find_message_id("{"), std::nullopt);
}

TEST(ServerMessages, ErrorsWithBytesThatAreNotUtf8AreStillJson) {
  // quote() shortens after 80 bytes, which may cut a character in two.
  const std::string name = std::string(79, 'x') + "é";
  const std::string text = write_error(Error("message", quote(name), "less"), "id");
  const nlohmann::json message = nlohmann::json::parse(text);
  EXPECT_EQ(message["type"], "error");
  EXPECT_EQ(message["id"], "id");
  EXPECT_EQ(message["where"], "message");
}

FrameHeader sample_header() {
  FrameHeader header;
  header.frame = 41;
  header.revision = {1234567890123456, 17};
  header.codec = Codec::png;
  header.width = 512;
  header.height = 384;
  header.exact = true;
  header.terms = 6144;
  header.residual = 0.125;
  header.estimate = 0.0625;
  header.queue_ms = 0.25;
  header.rotate_ms = 1.5;
  header.update_ms = 2.125;
  header.display_ms = 0.875;
  header.encode_ms = 3;
  header.wait_ms = 0.5;
  return header;
}

Payload shared(std::vector<std::uint8_t> bytes) {
  return std::make_shared<const std::vector<std::uint8_t>>(std::move(bytes));
}

TEST(FrameMessages, PartsOfAnImageComeBackWithTheirPlace) {
  const Payload payload = shared({1, 2, 3, 4, 5});
  FrameHeader header = sample_header();
  header.part = {3, 5};
  const std::vector<std::uint8_t> bytes = write_frame_message(header, payload, 2)->bytes();
  const ParsedFrame frame = parse_frame_message(bytes, "frame");
  EXPECT_EQ(frame.header, header);
  EXPECT_EQ(std::vector(frame.payload.begin(), frame.payload.end()),
            (std::vector<std::uint8_t>{4, 5}));
  // More bytes than the whole image has from there.
  std::vector<std::uint8_t> more = bytes;
  more.push_back(6);
  EXPECT_NE(error_of([&] { parse_frame_message(more, "frame"); }).find("3 bytes of a part"),
            std::string::npos);
}

TEST(FrameMessages, StreamsSayTheirRungAndQuality) {
  FrameHeader header = sample_header();
  header.codec = Codec::vp8;
  header.exact = header.key = false;
  header.rung = 1;
  header.quality = 20;
  const std::vector<std::uint8_t> bytes = write_frame_message(header, shared({7}))->bytes();
  EXPECT_EQ(parse_frame_message(bytes, "frame").header, header);
}

TEST(FrameMessages, HeaderAndPayloadComeBackAsTheyWereWritten) {
  const std::vector<std::uint8_t> payload{0, 255, 7, 123, 34};
  const FramePtr message = write_frame_message(sample_header(), shared(payload));
  EXPECT_EQ(message->frame, 41);
  const std::vector<std::uint8_t> bytes = message->bytes();
  EXPECT_EQ(bytes.size(), message->size());
  const ParsedFrame frame = parse_frame_message(bytes, "frame");
  EXPECT_EQ(frame.header, sample_header());
  EXPECT_TRUE(
      std::equal(frame.payload.begin(), frame.payload.end(), payload.begin(), payload.end()));
}

TEST(FrameMessages, EveryTruncationOfTheHeaderIsAnError) {
  const std::vector<std::uint8_t> message =
      write_frame_message(sample_header(), shared({}))->bytes();
  const std::size_t whole = message.size();
  ASSERT_GT(whole, 100u);
  for (std::size_t size = 0; size < whole; ++size) {
    const std::span<const std::uint8_t> part(message.data(), size);
    EXPECT_NE(error_of([&] { parse_frame_message(part, "frame"); }), "no error") << size;
  }
}

TEST(FrameMessages, AHeaderLengthBeyondTheMessageIsAnError) {
  const std::vector<std::uint8_t> message{255, 255, 255, 255, '{', '}'};
  EXPECT_NE(error_of([&] { parse_frame_message(message, "frame"); }).find("4294967295 bytes"),
            std::string::npos);
}

TEST(StreamTargets, NameASessionAndAScene) {
  EXPECT_EQ(parse_stream_target("/sessions/a/stream"), (StreamTarget{"a", ""}));
  EXPECT_EQ(parse_stream_target("/sessions/A.b_c-9/stream?scene=terrace"),
            (StreamTarget{"A.b_c-9", "terrace"}));
  EXPECT_EQ(parse_stream_target("/sessions/a/stream?token=x.y_z&scene=s"),
            (StreamTarget{"a", "s", "x.y_z"}));
  const std::string resume(64, 'e');
  EXPECT_TRUE(parse_stream_target("/sessions/a/stream?parts=1").parts);
  EXPECT_FALSE(parse_stream_target("/sessions/a/stream").parts);
  EXPECT_EQ(parse_stream_target("/sessions/a/stream?seen=42&resume=" + resume),
            (StreamTarget{"a", "", "", resume, 42}));
  EXPECT_EQ(parse_state_target("/sessions/a/state?scene=s"), (StreamTarget{"a", "s"}));
  EXPECT_TRUE(is_state_target("/sessions/a/state?x"));
  EXPECT_FALSE(is_state_target("/sessions/a/stream?/state"));
}

TEST(StreamTargets, AnythingElseIsAnError) {
  for (const std::string& target : {std::string("/"),
                                    std::string("/sessions//stream"),
                                    std::string("/sessions/stream"),
                                    std::string("/sessions/a"),
                                    std::string("/sessions/a/b/stream"),
                                    std::string("/sessions/a%2fb/stream"),
                                    std::string("/sessions/ä/stream"),
                                    std::string("/sessions/a/stream?scene="),
                                    std::string("/sessions/a/stream?scene=../x"),
                                    std::string("/sessions/a/stream?scene=x&y=z"),
                                    std::string("/sessions/a/stream?scene=x&scene=y"),
                                    std::string("/sessions/a/stream?resume=short"),
                                    "/sessions/a/stream?resume=" + std::string(64, 'E'),
                                    std::string("/sessions/a/stream?seen=-1"),
                                    std::string("/sessions/a/stream?parts=2"),
                                    std::string("/sessions/a/stream?parts=1&parts=1"),
                                    std::string("/sessions/a/stream?seen=1e3"),
                                    std::string("/sessions/a/stream?seen=1234567890123456"),
                                    std::string("/sessions/a/stream?seen=1&seen=1"),
                                    std::string("/sessions/a/state"),
                                    std::string("/sessions/a/stream?token=x&token=y"),
                                    std::string("/sessions/a/stream?x=y"),
                                    "/sessions/" + std::string(65, 'a') + "/stream"}) {
    EXPECT_NE(error_of([&] { parse_stream_target(target); }), "no error") << target;
  }
  EXPECT_EQ(parse_stream_target("/sessions/" + std::string(64, 'a') + "/stream").session.size(),
            64u);
}

}  // namespace
}  // namespace rimlight::server
