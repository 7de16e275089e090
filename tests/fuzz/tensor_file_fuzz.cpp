// A tensor file whose hashes are right and whose contents are not: every tensor is read.

#include <unistd.h>

#include <algorithm>
#include <filesystem>
#include <fstream>

#include "core/transport/tensor_file.h"
#include "tests/fuzz/fuzz_target.h"

namespace {

/// One file a process, written again for each input.
const std::filesystem::path& scratch_file() {
  static const std::filesystem::path kPath = std::filesystem::temp_directory_path() /
                                             ("rimlight-tensor-fuzz-" + std::to_string(::getpid()));
  return kPath;
}

}  // namespace

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace rimlight;
  std::ofstream(scratch_file(), std::ios::binary) << fuzz::text_of(data, size);
  TensorFileSummary summary;
  summary.bytes = size;
  const auto bytes = fuzz::bytes_of(data, size);
  for (std::size_t block = 0; block * kHashedBlock < size; ++block) {
    const std::size_t begin = block * kHashedBlock;
    summary.block_hashes.push_back(
        hash_bytes(bytes.subspan(begin, std::min(kHashedBlock, size - begin)), block));
  }
  const int result = fuzz::expect_result_or_error([&] {
    const TensorFile file(scratch_file(), summary);
    for (const std::string& name : file.names()) {
      fuzz::expect_result_or_error([&] { file.tensor<float>(name, ElementType::f32); });
      fuzz::expect_result_or_error([&] { file.tensor<std::uint8_t>(name, ElementType::u8); });
    }
    file.verify();
  });
  std::filesystem::remove(scratch_file());
  return result;
}
