// A list of light directions from anywhere, as text and as JSON.

#include "core/import/direction_list.h"
#include "tests/fuzz/fuzz_target.h"

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace rimlight;
  const std::string_view text = fuzz::text_of(data, size);
  fuzz::expect_result_or_error([&] { parse_direction_text(text, "input", DirectionAxes::z_up); });
  return fuzz::expect_result_or_error([&] { parse_direction_json(text, "input"); });
}
