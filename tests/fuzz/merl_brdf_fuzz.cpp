// A MERL file from anywhere: as it is, and with the right size, the input repeated after a header
// of its first bytes. What is read has finite values.

#include <cmath>
#include <cstring>
#include <stdexcept>
#include <vector>

#include "core/material/merl_brdf.h"
#include "tests/fuzz/fuzz_target.h"

namespace {

using namespace rimlight;

/// The numbers of the whole size that begin as the input does.
std::span<const std::byte> whole_file(const std::uint8_t* data, std::size_t size) {
  static std::vector<std::byte> file(kMerlBytes);
  const std::size_t header = std::min(size, kMerlHeaderBytes);
  std::memcpy(file.data(), data, header);
  for (std::size_t at = kMerlHeaderBytes; at < kMerlBytes; at += size - header) {
    std::memcpy(file.data() + at, data + header, std::min(size - header, kMerlBytes - at));
  }
  return file;
}

void ask(const MerlBrdf& brdf) {
  for (int i = 0; i < 64; ++i) {
    const double x = i / 64.0;
    const auto value = brdf.at(HalfDifference{1.6 * x * x, 0.1 + x, 3 - 6 * x});
    if (value && !is_finite(*value)) throw std::logic_error("a value that is not finite");
  }
}

}  // namespace

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  fuzz::expect_result_or_error([&] { ask(MerlBrdf(fuzz::bytes_of(data, size), "input")); });
  if (size <= kMerlHeaderBytes) return 0;
  return fuzz::expect_result_or_error([&] { ask(MerlBrdf(whole_file(data, size), "input")); });
}
