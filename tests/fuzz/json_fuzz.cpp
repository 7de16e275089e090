// Parses the input and reads it with every accessor, everywhere: bad values, pointers and errors.

#include "core/base/json_reader.h"
#include "tests/fuzz/fuzz_target.h"

namespace {

using rimlight::JsonReader;

/// Calls one accessor. The error's text must be such that it can be sent: dump() throws at what is
/// not UTF-8.
template <typename Access>
void attempt(Access&& access) {
  try {
    access();
  } catch (const rimlight::Error& error) {
    static_cast<void>(nlohmann::json(error.what()).dump());
  }
}

void read(const JsonReader& reader, int depth) {
  constexpr int kDeepest = 200;  // this function is recursive, the parser is not
  attempt([&] { reader.boolean(); });
  attempt([&] { reader.string(); });
  attempt([&] { reader.number(-1, 1); });
  attempt([&] { reader.integer(INT64_MIN, INT64_MAX); });
  attempt([&] { reader.integer(-7, 7); });
  attempt([&] { reader.numbers(3); });
  attempt([&] { reader.one_of({"one", "two"}); });
  attempt([&] { reader.member("a"); });
  attempt([&] { reader.allow_only({"a", "b"}); });
  if (depth == kDeepest) return;
  attempt([&] {
    for (const auto& [name, member] : reader.members()) read(member, depth + 1);
  });
  attempt([&] {
    for (const JsonReader& element : reader.elements()) read(element, depth + 1);
  });
}

}  // namespace

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  return rimlight::fuzz::expect_result_or_error([&] {
    const nlohmann::json document =
        rimlight::parse_json(rimlight::fuzz::text_of(data, size), "input");
    read(JsonReader(document, "input"), 0);
  });
}
