// Edits over real sockets to a server with a store.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdio>
#include <nlohmann/json.hpp>
#include <vector>

#include "tests/server/loopback_server.h"

namespace rimlight::server {
namespace {

using nlohmann::json;
using std::chrono::seconds;
using test::LoopbackServer;

constexpr seconds kPatience{20};

std::string exposure_edit(int number) {
  return json{{"type", "edit"}, {"id", std::to_string(number)}, {"exposure", number / 1024.0}}
      .dump();
}

/// The next answer to an edit; frames are acknowledged on the way. Null when none comes.
json next_answer(StreamClient& stream) {
  for (;;) {
    const auto received = stream.receive(Clock::now() + kPatience);
    if (const auto* const text = std::get_if<StreamClient::Text>(&received)) {
      const json message = json::parse(text->text);
      if (message["type"] == "ack" || message["type"] == "error") return message;
    } else if (const auto* const frame = std::get_if<StreamClient::Binary>(&received)) {
      const auto number = parse_frame_message(frame->bytes, "frame").header.frame;
      if (!stream.send_text(json{{"type", "frame_ack"}, {"frame", number}}.dump())) return {};
    } else {
      return {};
    }
  }
}

double percentile(std::vector<double> values, double part) {
  std::sort(values.begin(), values.end());
  return values[static_cast<std::size_t>(part * static_cast<double>(values.size() - 1))];
}

class DurableStream : public testing::Test {
 protected:
  LoopbackServer::Settings with_store() const {
    LoopbackServer::Settings settings;
    settings.store = folder / "sessions.sqlite";
    return settings;
  }
  rimlight::test::TemporaryFolder folder;
};

TEST_F(DurableStream, AFloodFromAClientThatReadsNothingIsHeldBackAndLosesNothing) {
  constexpr int kEdits = 2000;
  {
    const LoopbackServer server(with_store());
    const auto stream = server.open("a");
    for (int i = 1; i <= kEdits; ++i) ASSERT_TRUE(stream->send_text(exposure_edit(i)));
    for (int i = 1; i <= kEdits; ++i) {
      const json answer = next_answer(*stream);
      ASSERT_EQ(answer["type"], "ack") << answer;
      ASSERT_EQ(answer["id"], std::to_string(i));
      ASSERT_EQ(answer["revision"], i);
    }
  }
  const LoopbackServer again(with_store());
  const auto received = again.open("a")->receive(Clock::now() + kPatience);
  const json welcome = json::parse(std::get<StreamClient::Text>(received).text);
  EXPECT_EQ(welcome["revision"], kEdits);
  EXPECT_EQ(welcome["state"]["exposure"], kEdits / 1024.0);
}

TEST_F(DurableStream, AnAckCostsAFlushOfTheDiskMore) {
  const LoopbackServer durable(with_store());
  const LoopbackServer forgetful;
  const auto kept = durable.open("a");
  const auto in_memory = forgetful.open("a");
  constexpr int kEdits = 200;
  std::vector<double> with, without;
  for (int i = 1; i <= kEdits; ++i) {  // in turns: the machine is the same for both
    for (const bool durably : {true, false}) {
      StreamClient& stream = durably ? *kept : *in_memory;
      const Clock::time_point start = Clock::now();
      ASSERT_TRUE(stream.send_text(exposure_edit(i)));
      ASSERT_EQ(next_answer(stream)["type"], "ack");
      const std::chrono::duration<double, std::milli> took = Clock::now() - start;
      (durably ? with : without).push_back(took.count());
    }
  }
  for (const double part : {0.5, 0.95}) {
    const double durably = percentile(with, part), at_once = percentile(without, part);
    std::printf("edit to ack, p%.0f: %.2f ms durable, %.2f ms in memory, %.2f ms more\n",
                100 * part, durably, at_once, durably - at_once);
  }
  EXPECT_GT(percentile(with, 0.5), 0);
}

}  // namespace
}  // namespace rimlight::server
