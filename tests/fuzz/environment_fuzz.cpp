// An uploaded picture as the decoder's child takes it: any bytes as .exr and .hdr, through the
// layout to a small cube map, whose radiance is finite and not negative.

#include <cmath>
#include <cstdlib>

#include "core/image/image_file.h"
#include "core/light/environment.h"
#include "tests/fuzz/fuzz_target.h"

namespace {

void project(rimlight::RgbImage image) {
  constexpr std::size_t kMost = std::size_t{1} << 20;  // a fuzzer's time, not the server's
  if (image.pixels.size() > kMost) return;
  const rimlight::Environment environment("input", std::move(image));
  const rimlight::CubeLight light = environment.project(8);
  for (const float value : light.values) {
    if (!(std::isfinite(value) && value >= 0)) std::abort();
  }
}

}  // namespace

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace rimlight;
  const auto bytes = fuzz::bytes_of(data, size);
  fuzz::expect_result_or_error([&] { project(decode_exr(bytes, "input")); });
  return fuzz::expect_result_or_error([&] { project(decode_hdr(bytes, "input")); });
}
