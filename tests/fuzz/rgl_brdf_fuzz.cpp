// An RGL tensor file from anywhere: what is read has finite values of at least 0.

#include <stdexcept>

#include "core/material/rgl_brdf.h"
#include "tests/fuzz/fuzz_target.h"

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace rimlight;
  return fuzz::expect_result_or_error([&] {
    const RglBrdf brdf(fuzz::bytes_of(data, size), "input");
    for (int i = 0; i < 64; ++i) {
      const double x = i / 64.0;
      const auto value = brdf.at(HalfDifference{1.6 * x * x, 0.1 + x, 3 - 6 * x});
      if (!value) continue;
      const bool good = is_finite(*value) && value->x >= 0 && value->y >= 0 && value->z >= 0;
      if (!good) throw std::logic_error("a value that is no reflectance");
    }
  });
}
