// A scene source from anywhere, with no files beside it.

#include "core/scene/scene_source.h"
#include "tests/fuzz/fuzz_target.h"

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  return rimlight::fuzz::expect_result_or_error(
      [&] { rimlight::parse_scene(rimlight::fuzz::text_of(data, size), "input", "/nonexistent"); });
}
