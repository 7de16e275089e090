#pragma once

#include <bit>
#include <cstdint>

namespace rimlight {

/// IEEE 754 binary16, as its bits: 1 sign, 5 exponent (bias 15), 10 fraction.
using Half = std::uint16_t;

/// Exponent 31 is infinity or NaN: storage refuses it.
constexpr bool is_finite(Half half) { return (half & 0x7c00) != 0x7c00; }

/// Rounds to nearest, ties to even; from 65,520 on to infinity, NaN to a quiet NaN of its sign.
/// Integer operations only, so that flushed denormals change nothing.
constexpr Half to_half(float value) {
  const auto bits = std::bit_cast<std::uint32_t>(value);
  const std::uint32_t sign = (bits >> 16) & 0x8000u;
  const std::uint32_t magnitude = bits & 0x7fffffffu;
  if (magnitude > 0x7f800000u) return static_cast<Half>(sign | 0x7e00u);   // NaN
  if (magnitude >= 0x47800000u) return static_cast<Half>(sign | 0x7c00u);  // 2¹⁶ and above
  if (magnitude >= 0x38800000u) {  // 2⁻¹⁴: normal halves
    const std::uint32_t rounded = magnitude + 0xfffu + ((magnitude >> 13) & 1u);
    return static_cast<Half>(sign | ((rounded - (112u << 23)) >> 13));
  }
  if (magnitude < 0x33000000u) return static_cast<Half>(sign);  // below 2⁻²⁵
  // Subnormal halves count units of 2⁻²⁴; the float is (fraction with its hidden 1) · 2^(e − 150).
  const std::uint32_t fraction = (magnitude & 0x7fffffu) | 0x800000u;
  const std::uint32_t shift = 126u - (magnitude >> 23);  // 14 … 24
  const std::uint32_t below_half = (1u << (shift - 1)) - 1u;
  return static_cast<Half>(sign | ((fraction + below_half + ((fraction >> shift) & 1u)) >> shift));
}

/// Exact. Half subnormals are normal floats, so flushed denormals change nothing.
constexpr float to_float(Half half) {
  const std::uint32_t sign = (half & 0x8000u) << 16;
  const std::uint32_t exponent = (half >> 10) & 31u;
  const std::uint32_t fraction = half & 0x3ffu;
  if (exponent == 0) {
    const float magnitude = static_cast<float>(fraction) * 0x1p-24f;
    return std::bit_cast<float>(sign | std::bit_cast<std::uint32_t>(magnitude));
  }
  if (exponent == 31) return std::bit_cast<float>(sign | 0x7f800000u | (fraction << 13));
  return std::bit_cast<float>(sign | ((exponent + 112u) << 23) | (fraction << 13));
}

}  // namespace rimlight
