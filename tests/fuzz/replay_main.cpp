// Runs one fuzz target over the files of a folder: the corpus as an ordinary test, in every preset.

#include <algorithm>
#include <cstdio>
#include <exception>
#include <filesystem>
#include <vector>

#include "core/base/files.h"
#include "tests/fuzz/fuzz_target.h"

namespace {

std::vector<std::filesystem::path> files_of(const char* folder) {
  std::vector<std::filesystem::path> files;
  for (const auto& entry : std::filesystem::directory_iterator(folder)) {
    files.push_back(entry.path());
  }
  std::sort(files.begin(), files.end());
  return files;
}

void run(const std::string& bytes) {
  // A copy without room behind it, so that AddressSanitizer sees the first byte that is read
  // beyond.
  const std::vector<std::uint8_t> exact(bytes.begin(), bytes.end());
  LLVMFuzzerTestOneInput(exact.data(), exact.size());
}

}  // namespace

int main(int argument_count, char** arguments) {
  if (argument_count != 2) {
    std::fprintf(stderr, "usage: %s CORPUS_FOLDER\n", arguments[0]);
    return 2;
  }
  try {
    const std::vector<std::filesystem::path> files = files_of(arguments[1]);
    if (files.empty()) throw rimlight::Error(arguments[1], "no files", "a seed corpus");
    for (const auto& file : files) {
      std::fprintf(stderr, "%s\n", file.c_str());  // the last one printed is the one that fails
      const std::string bytes = rimlight::read_file(file, std::size_t{1} << 20);
      run(bytes);
      for (std::size_t part = 0; part < 16; ++part) run(bytes.substr(0, bytes.size() * part / 16));
    }
    return 0;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "found %s, expected a result or a rimlight::Error\n", error.what());
    return 1;
  }
}
