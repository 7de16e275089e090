// A .npy file from anywhere: the header, and every number behind it.

#include <algorithm>
#include <vector>

#include "core/import/npy_file.h"
#include "tests/fuzz/fuzz_target.h"

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace rimlight;
  return fuzz::expect_result_or_error([&] {
    const NpyArray array(fuzz::bytes_of(data, size), "input");
    std::vector<float> values(std::min<std::size_t>(array.count(), 1000));
    for (std::size_t first = 0; first < array.count(); first += values.size()) {
      values.resize(std::min(values.size(), array.count() - first));
      array.read(first, values);
    }
  });
}
