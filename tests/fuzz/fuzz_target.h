#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>

#include "core/base/error.h"

/// Takes one input, whatever its bytes; every fuzz target defines it. libFuzzer calls it, or
/// replay_main.cpp with the files of the corpus.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size);

namespace rimlight::fuzz {

inline std::string_view text_of(const std::uint8_t* data, std::size_t size) {
  return {reinterpret_cast<const char*>(data), size};
}
inline std::span<const std::byte> bytes_of(const std::uint8_t* data, std::size_t size) {
  return std::as_bytes(std::span(data, size));
}

/// Bad input may end in Error and in nothing else: another exception, like a crash, is a finding.
template <typename Action>
int expect_result_or_error(Action&& action) {
  try {
    action();
  } catch (const Error&) {
    return 0;
  }
  return 0;
}

}  // namespace rimlight::fuzz
