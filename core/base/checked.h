#pragma once

#include <cstddef>
#include <optional>

namespace rimlight {

/// a × b, or nothing when it does not fit: sizes from outside are multiplied with this only.
inline std::optional<std::size_t> checked_product(std::size_t a, std::size_t b) {
  std::size_t result = 0;
  if (__builtin_mul_overflow(a, b, &result)) return std::nullopt;
  return result;
}

/// a + b, or nothing when it does not fit.
inline std::optional<std::size_t> checked_sum(std::size_t a, std::size_t b) {
  std::size_t result = 0;
  if (__builtin_add_overflow(a, b, &result)) return std::nullopt;
  return result;
}

}  // namespace rimlight
