// What a client sends: text messages, frame messages (as `rimlight load` reads them) and stream
// paths.

#include <variant>

#include "server/protocol/frame_message.h"
#include "server/protocol/messages.h"
#include "server/protocol/query_string.h"
#include "server/protocol/stream_target.h"
#include "server/session/edit_history.h"
#include "tests/fuzz/fuzz_target.h"

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace rimlight;
  static const server::KnownMaterials known{
      {"brass", "clay"}, {{"brass", {CurveAxis::half_angle}}}, {"gold"}};
  const std::string_view text = fuzz::text_of(data, size);
  fuzz::expect_result_or_error([&] {
    try {
      server::parse_client_message(text, {"sunny", "studio"}, known);
    } catch (const Error& error) {
      // The reply must be one that can be sent: dump() throws at what is not UTF-8.
      server::write_error(error, server::find_message_id(text));
    }
  });
  fuzz::expect_result_or_error([&] { server::parse_stream_target(text); });
  fuzz::expect_result_or_error([&] { server::parse_state_target(text); });
  fuzz::expect_result_or_error([&] {
    const server::EditStepPtr step = server::read_step(text, 1, "store");
    server::EditHistory history({step}, {});
    nlohmann::json state = server::state_to_json({});
    (void)history.undo(state);
  });
  fuzz::expect_result_or_error([&] { server::parse_query(text, {"scene", "material"}); });
  return fuzz::expect_result_or_error(
      [&] { server::parse_frame_message(std::span(data, size), "input"); });
}
