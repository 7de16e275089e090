// RFC 6455 over a raw socket, against /selftest/echo, which is the connection that sessions have:
// framing, control frames, reserved bits and opcodes, fragments, UTF-8, close codes, large
// messages. The groups are those of the Autobahn suite, whose groups 12 and 13 (compression) do not
// apply: the server offers none.
#include <gtest/gtest.h>

#include <algorithm>

#include "tests/server/door_client.h"
#include "tests/server/raw_web_socket.h"
#include "tests/support/error_of.h"

namespace rimlight::server {
namespace {

using Sizes = std::initializer_list<std::size_t>;

using rimlight::test::error_of;
using test::bytes_of;
using test::close_payload;
using test::LoopbackServer;
using test::Opcode;
using test::RawWebSocket;
using test::WireFrame;

constexpr unsigned kProtocolError = 1002;
constexpr unsigned kInvalidData = 1007;

class WebSocketConformance : public testing::Test {
 protected:
  static LoopbackServer::Settings settings() {
    LoopbackServer::Settings result;
    result.network.selftest_echo = true;
    return result;
  }
  RawWebSocket open() const { return RawWebSocket(server.port()); }
  /// What comes back must be the same, and final.
  static void expect_echo(RawWebSocket& socket, Opcode opcode, const std::string& payload) {
    const auto frame = socket.receive();
    ASSERT_TRUE(frame);
    EXPECT_EQ(frame->opcode, opcode);
    EXPECT_TRUE(frame->final);
    EXPECT_FALSE(frame->masked);
    EXPECT_EQ(frame->reserved, 0u);
    EXPECT_TRUE(frame->payload == payload) << frame->payload.size() << " " << payload.size();
  }
  /// How a connection ends that sends these bytes, and nothing more.
  unsigned code_after(const std::string& bytes) const {
    RawWebSocket socket = open();
    socket.send(bytes);
    return socket.close_code();
  }
  unsigned code_after(const WireFrame& frame) const { return code_after(bytes_of(frame)); }

  LoopbackServer server{settings()};
};

/// A final frame of another opcode, and one that more follow.
WireFrame part(Opcode opcode, const std::string& payload) { return {opcode, payload, false}; }

// 1: framing.
TEST_F(WebSocketConformance, MessagesOfEveryLengthFieldComeBackHoweverTheyAreCut) {
  for (const Opcode opcode : {Opcode::text, Opcode::binary}) {
    RawWebSocket socket = open();
    for (const std::size_t size : Sizes{0, 1, 125, 126, 127, 128, 65535, 65536}) {
      for (const std::size_t piece : Sizes{0, 997}) {
        const std::string payload(size, opcode == Opcode::text ? '*' : '\xfe');
        socket.send(bytes_of({opcode, payload}), piece);
        expect_echo(socket, opcode, payload);
      }
    }
    socket.send(bytes_of({opcode, "byte by byte"}), 1);
    expect_echo(socket, opcode, "byte by byte");
  }
}

// RFC 6455, 5.1: a server closes when a client's frame is not masked.
TEST_F(WebSocketConformance, AFrameWithoutMaskIsRefused) {
  EXPECT_EQ(code_after({Opcode::text, "bare", true, 0, false}), kProtocolError);
}

// 2: pings and pongs.
TEST_F(WebSocketConformance, APingIsAnsweredWithItsPayloadAndAPongIsNot) {
  RawWebSocket socket = open();
  for (const std::size_t size : Sizes{0, 5, 125}) {
    const std::string payload(size, '\xff');
    socket.send(bytes_of({Opcode::ping, payload}), size == 5 ? 1 : 0);
    expect_echo(socket, Opcode::pong, payload);
  }
  socket.send({Opcode::pong, "unasked"});
  socket.send({Opcode::pong, ""});
  std::string ten;
  for (int i = 0; i < 10; ++i) {
    ten += bytes_of({Opcode::ping, "ping " + std::to_string(i)});
  }
  socket.send(ten);
  // Beast may leave out pongs of all but the newest ping (5.5.3), never change their order.
  std::string last;
  while (last != "ping 9") {
    const auto frame = socket.receive();
    ASSERT_TRUE(frame);
    ASSERT_EQ(frame->opcode, Opcode::pong);
    ASSERT_LT(last, frame->payload);
    last = frame->payload;
  }
  EXPECT_EQ(code_after({Opcode::ping, std::string(126, 'x')}), kProtocolError);
}

// 3 and 4: reserved bits and opcodes.
TEST_F(WebSocketConformance, ReservedBitsAndOpcodesAreRefused) {
  for (unsigned bits = 1; bits < 8; ++bits) {
    for (const Opcode opcode : {Opcode::text, Opcode::binary, Opcode::ping, Opcode::close}) {
      EXPECT_EQ(code_after({opcode, "", true, bits}), kProtocolError) << bits;
    }
  }
  for (const unsigned opcode : {3u, 4u, 5u, 6u, 7u, 11u, 12u, 13u, 14u, 15u}) {
    for (const char* const payload : {"", "reserved"}) {
      EXPECT_EQ(code_after({static_cast<Opcode>(opcode), payload}), kProtocolError) << opcode;
    }
  }
  RawWebSocket socket = open();  // what came before is answered
  socket.send(bytes_of({Opcode::text, "before"}) + bytes_of({Opcode::text, "bad", true, 4}) +
              bytes_of({Opcode::ping, "after"}));
  expect_echo(socket, Opcode::text, "before");
  EXPECT_EQ(socket.close_code(), kProtocolError);
}

// 5: fragments.
TEST_F(WebSocketConformance, FragmentsMakeOneMessageAndControlFramesMayComeBetween) {
  for (const std::size_t piece : Sizes{0, 1}) {
    RawWebSocket socket = open();
    socket.send(bytes_of(part(Opcode::text, "frag")) + bytes_of({Opcode::continuation, "ment"}),
                piece);
    expect_echo(socket, Opcode::text, "fragment");
    socket.send(bytes_of(part(Opcode::binary, "a")) + bytes_of({Opcode::ping, "between"}) +
                    bytes_of(part(Opcode::continuation, "")) +
                    bytes_of({Opcode::continuation, "b"}),
                piece);
    expect_echo(socket, Opcode::pong, "between");
    expect_echo(socket, Opcode::binary, "ab");
    socket.send(bytes_of(part(Opcode::text, "")) + bytes_of(part(Opcode::continuation, "")) +
                    bytes_of({Opcode::continuation, ""}),
                piece);
    expect_echo(socket, Opcode::text, "");
  }
}

TEST_F(WebSocketConformance, FragmentsOutOfOrderAreRefused) {
  for (const Opcode opcode : {Opcode::ping, Opcode::pong, Opcode::close}) {
    EXPECT_EQ(code_after(part(opcode, "")), kProtocolError);
  }
  EXPECT_EQ(code_after({Opcode::continuation, "of nothing"}), kProtocolError);
  EXPECT_EQ(code_after(part(Opcode::continuation, "of nothing")), kProtocolError);
  EXPECT_EQ(code_after(bytes_of(part(Opcode::text, "one")) + bytes_of({Opcode::text, "another"})),
            kProtocolError);
  RawWebSocket socket = open();  // again after a whole message
  socket.send(bytes_of(part(Opcode::text, "a")) + bytes_of({Opcode::continuation, "b"}) +
              bytes_of({Opcode::continuation, "c"}));
  expect_echo(socket, Opcode::text, "ab");
  EXPECT_EQ(socket.close_code(), kProtocolError);
}

// 6: UTF-8.
const std::string kGreek = "κόσμε";

TEST_F(WebSocketConformance, TextMayBeCutAnywhereEvenWithinACharacter) {
  for (std::size_t cut = 0; cut <= kGreek.size(); ++cut) {
    RawWebSocket socket = open();
    socket.send(part(Opcode::text, kGreek.substr(0, cut)));
    socket.send({Opcode::continuation, kGreek.substr(cut)});
    expect_echo(socket, Opcode::text, kGreek);
  }
  for (const std::string& text :
       {std::string("\0", 1), std::string("\xc2\x80"), std::string("\xdf\xbf"),
        std::string("\xe0\xa0\x80"), std::string("\xed\x9f\xbf"), std::string("\xee\x80\x80"),
        std::string("\xef\xbf\xbd"), std::string("\xef\xbf\xbe"), std::string("\xef\xbf\xbf"),
        std::string("\xf0\x90\x80\x80"), std::string("\xf4\x8f\xbf\xbf")}) {
    RawWebSocket socket = open();
    socket.send({Opcode::text, text});
    expect_echo(socket, Opcode::text, text);
  }
}

TEST_F(WebSocketConformance, TextThatIsNoUtf8IsRefused) {
  for (const char* const bad :
       {"\x80", "\xbf", "\xc0\x80", "\xc1\xbf", "\xc2", "\xe0\x80\x80", "\xe0\x9f\xbf", "\xe2\x82",
        "\xed\xa0\x80", "\xed\xbf\xbf", "\xf0\x80\x80\x80", "\xf0\x8f\xbf\xbf", "\xf4\x90\x80\x80",
        "\xf5\x80\x80\x80", "\xf8\x88\x80\x80\x80", "\xfc\x84\x80\x80\x80\x80", "\xfe", "\xff",
        "\xce\x20"}) {
    const std::string text = kGreek + bad;
    EXPECT_EQ(code_after({Opcode::text, text}), kInvalidData) << bad;
    EXPECT_EQ(code_after({Opcode::text, text + "after"}), kInvalidData) << bad;
    EXPECT_EQ(code_after(bytes_of(part(Opcode::text, text)) + bytes_of({Opcode::continuation, ""})),
              kInvalidData)
        << bad;
  }
}

// 6.4: at once, with the rest of the message still to come.
TEST_F(WebSocketConformance, TextThatCannotBecomeUtf8IsRefusedBeforeItEnds) {
  const std::string bad = kGreek + "\xf4\x90\x80\x80";
  EXPECT_EQ(code_after(part(Opcode::text, bad)), kInvalidData);
  EXPECT_EQ(code_after(bytes_of(part(Opcode::text, kGreek)) +
                       bytes_of(part(Opcode::continuation, "\xf4\x90"))),
            kInvalidData);
  // Within one frame of which the end never comes.
  const std::string whole = bytes_of({Opcode::text, bad + std::string(100, 'x')});
  EXPECT_EQ(code_after(whole.substr(0, whole.size() - 100)), kInvalidData);
}

// 7: closing.
TEST_F(WebSocketConformance, ACloseIsAnsweredWithItsCodeAndEndsAll) {
  for (const unsigned code : {1000u, 1001u, 1002u, 1003u, 1007u, 1008u, 1009u, 1010u, 1011u, 3000u,
                              3999u, 4000u, 4999u}) {
    EXPECT_EQ(code_after({Opcode::close, close_payload(code)}), code);
    EXPECT_EQ(code_after({Opcode::close, close_payload(code, "why " + kGreek)}), code);
  }
  EXPECT_EQ(code_after({Opcode::close, ""}), 1000u);  // none is echoed as a normal one
  EXPECT_EQ(code_after({Opcode::close, close_payload(1000, std::string(123, '*'))}), 1000u);
  for (const WireFrame& late :
       {WireFrame{Opcode::close, close_payload(1000)}, WireFrame{Opcode::ping, "late"},
        WireFrame{Opcode::text, "late"}, part(Opcode::text, "late")}) {
    RawWebSocket socket = open();
    socket.send(bytes_of({Opcode::close, close_payload(1000)}) + bytes_of(late));
    std::string before;
    EXPECT_EQ(socket.close_code(&before), 1000u);
    EXPECT_EQ(before, "");
  }
  RawWebSocket socket = open();
  socket.send(bytes_of({Opcode::text, "hello"}) + bytes_of({Opcode::close, close_payload(1000)}));
  expect_echo(socket, Opcode::text, "hello");
  EXPECT_EQ(socket.close_code(), 1000u);
}

TEST_F(WebSocketConformance, ACloseThatIsWrongIsAProtocolError) {
  for (const unsigned code : {0u, 999u, 1004u, 1005u, 1006u, 1016u, 1100u, 2000u, 2999u}) {
    EXPECT_EQ(code_after({Opcode::close, close_payload(code)}), kProtocolError) << code;
    EXPECT_EQ(code_after({Opcode::close, close_payload(code, "x")}), kProtocolError) << code;
  }
  EXPECT_EQ(code_after({Opcode::close, "a"}), kProtocolError);  // half a code
  EXPECT_EQ(code_after({Opcode::close, close_payload(1000, std::string(124, 'x'))}),
            kProtocolError);
  const unsigned code = code_after({Opcode::close, close_payload(1000, kGreek + "\xed\xa0\x80")});
  EXPECT_TRUE(code == kProtocolError || code == kInvalidData) << code;
}

// 9 and 10: large messages, in one frame, in many, in small writes; and one that is too large.
TEST_F(WebSocketConformance, MessagesUpToTheBoundComeBackAndALargerOneEndsTheConnection) {
  constexpr std::size_t kMega = std::size_t{1} << 20;
  for (const std::size_t size : Sizes{kMega / 16, kMega / 4, kMega, 4 * kMega, 16 * kMega}) {
    RawWebSocket socket = open();
    const Opcode opcode = size == 4 * kMega ? Opcode::text : Opcode::binary;
    const std::string payload(size, 'x');
    socket.send({opcode, payload});
    expect_echo(socket, opcode, payload);
  }
  EXPECT_EQ(code_after({Opcode::binary, std::string(16 * kMega + 1, 'x')}), 1009u);
}

TEST_F(WebSocketConformance, LargeMessagesComeBackFromFragmentsOfEverySize) {
  const std::string payload(std::size_t{1} << 20, 'y');
  for (const std::size_t size : Sizes{64, 1300, 4096, 65536, 1 << 20}) {
    RawWebSocket socket = open();
    std::string bytes;
    for (std::size_t at = 0; at < payload.size(); at += size) {
      bytes += bytes_of({at == 0 ? Opcode::text : Opcode::continuation, payload.substr(at, size),
                         at + size >= payload.size()});
    }
    socket.send(bytes, size == 4096 ? 1000 : 0);
    expect_echo(socket, Opcode::text, payload);
  }
}

TEST_F(WebSocketConformance, AThousandMessagesInARowComeBackInOrder) {
  RawWebSocket socket = open();
  for (int i = 0; i < 1000; ++i) {
    const std::string payload(static_cast<std::size_t>(i * 13 % 1024), static_cast<char>(i));
    socket.send({Opcode::binary, payload});
    expect_echo(socket, Opcode::binary, payload);
  }
}

TEST(SelftestEcho, IsNotThereUnlessItIsAskedForAndNeverBeyondLoopback) {
  const LoopbackServer server;
  EXPECT_EQ(test::upgrade(server, "/selftest/echo"), "404 Not Found");
  LoopbackServer::Settings settings;
  settings.network.selftest_echo = true;
  settings.network.host = "0.0.0.0";
  settings.network.keys =
      std::make_shared<const SigningKeys>(std::vector<SigningKey>{{"key", std::string(32, 'k')}});
  EXPECT_NE(error_of([&] { LoopbackServer open(settings); }).find("--selftest-echo"),
            std::string::npos);
}

TEST(SelftestEcho, CompressionIsNotOffered) {
  LoopbackServer::Settings settings;
  settings.network.selftest_echo = true;
  const LoopbackServer server(settings);
  test::RawSocket socket(server.port());
  socket.send(
      "GET /selftest/echo HTTP/1.1\r\nHost: localhost\r\nConnection: Upgrade\r\n"
      "Upgrade: websocket\r\nSec-WebSocket-Version: 13\r\n"
      "Sec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==\r\n"
      "Sec-WebSocket-Extensions: permessage-deflate; client_max_window_bits\r\n\r\n");
  const std::string answer = socket.read_some();
  EXPECT_NE(answer.find("101"), std::string::npos);
  EXPECT_NE(answer.find("Sec-WebSocket-Accept: s3pPLMBiTxaQ9kYGzzhZRbK+xOo="), std::string::npos);
  EXPECT_EQ(answer.find("permessage-deflate"), std::string::npos) << answer;
}

}  // namespace
}  // namespace rimlight::server
