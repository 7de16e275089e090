#include "core/image/codec.h"
#include "tests/fuzz/fuzz_target.h"

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  return rimlight::fuzz::expect_result_or_error([&] { rimlight::decode_png(data, size, "input"); });
}
