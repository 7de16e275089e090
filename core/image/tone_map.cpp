#include "core/image/tone_map.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "core/image/tone_map.cpp"  // compiled once per SIMD target
#include <hwy/foreach_target.h>                       // must come before highway.h
// clang-format off: the order matters
#include <hwy/highway.h>
// clang-format on

#include <algorithm>
#include <cstring>

#include "core/base/check.h"

HWY_BEFORE_NAMESPACE();
namespace rimlight::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;
using Floats = hn::ScalableTag<float>;
using Lanes = hn::Vec<Floats>;
using Bytes = hn::Rebind<std::uint8_t, Floats>;

/// 255 · srgb_from_linear(x) + ½ for x in [0.0031308, 1], so that truncation rounds it. The power
/// 1/2.4 is t^(5/3) with t = x^(1/4), and that is smooth on t in [0.236, 1]: the minimax polynomial
/// of degree 7 (Remez) is off by 8.3e-5 of a byte step; rounding in float adds at most 1.5e-4. So a
/// byte differs from the exact one only within 2.4e-4 of a boundary: for 0.05 % of inputs that are
/// evenly spread over bytes.
HWY_INLINE Lanes encode_power(Floats d, Lanes x) {
  const Lanes t = hn::Sqrt(hn::Sqrt(x));
  Lanes sum = hn::Set(d, -19.43369018755369f);
  for (const float coefficient :
       {100.65216731676036f, -229.09578436555273f, 308.33374956905607f, -294.7536072843313f,
        372.6891161562602f, 31.511847089955744f, -14.403880527488923f}) {
    sum = hn::MulAdd(sum, t, hn::Set(d, coefficient));
  }
  return sum;
}

/// One channel of Lanes pixels to bytes.
HWY_INLINE hn::Vec<Bytes> encode(Floats d, Lanes radiance, Lanes scale) {
  const Lanes scaled = hn::Mul(radiance, scale);
  // A comparison with NaN is false, so NaN becomes 0.
  const Lanes x =
      hn::IfThenElseZero(hn::Gt(scaled, hn::Zero(d)), hn::Min(scaled, hn::Set(d, 1.0f)));
  const Lanes line = hn::MulAdd(x, hn::Set(d, 255 * 12.92f), hn::Set(d, 0.5f));
  const Lanes code = hn::IfThenElse(hn::Le(x, hn::Set(d, 0.0031308f)), line, encode_power(d, x));
  return hn::DemoteTo(Bytes(), hn::ConvertTo(hn::RebindToSigned<Floats>(), code));
}

/// Whole vectors of pixels; count is a multiple of the lanes.
void tone_map_vectors(const float* HWY_RESTRICT red, const float* HWY_RESTRICT green,
                      const float* HWY_RESTRICT blue, float scale, std::size_t count,
                      std::uint8_t* HWY_RESTRICT rgb) {
  const Floats d;
  const Lanes factor = hn::Set(d, scale);
  for (std::size_t i = 0; i < count; i += hn::Lanes(d)) {
    hn::StoreInterleaved3(encode(d, hn::LoadU(d, red + i), factor),
                          encode(d, hn::LoadU(d, green + i), factor),
                          encode(d, hn::LoadU(d, blue + i), factor), Bytes(), rgb + 3 * i);
  }
}

/// Any count: the rest behind the last whole vector goes through one padded with zeros, so that a
/// pixel's bytes do not depend on its place.
void tone_map_pixels(const float* red, const float* green, const float* blue, float scale,
                     std::size_t count, std::uint8_t* rgb) {
  constexpr std::size_t kMostLanes = HWY_MAX_BYTES / sizeof(float);
  const std::size_t whole = count - count % hn::Lanes(Floats());
  tone_map_vectors(red, green, blue, scale, whole, rgb);
  const std::size_t rest = count - whole;
  if (rest == 0) return;
  float padded[3][kMostLanes] = {};
  std::uint8_t bytes[3 * kMostLanes];
  std::copy_n(red + whole, rest, padded[0]);
  std::copy_n(green + whole, rest, padded[1]);
  std::copy_n(blue + whole, rest, padded[2]);
  tone_map_vectors(padded[0], padded[1], padded[2], scale, hn::Lanes(Floats()), bytes);
  std::memcpy(rgb + 3 * whole, bytes, 3 * rest);
}

}  // namespace rimlight::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace rimlight {

HWY_EXPORT(tone_map_pixels);

void tone_map(std::span<const float> red, std::span<const float> green, std::span<const float> blue,
              float scale, std::span<std::uint8_t> rgb) {
  RIMLIGHT_CHECK_EQ(green.size(), red.size());
  RIMLIGHT_CHECK_EQ(blue.size(), red.size());
  RIMLIGHT_CHECK_EQ(rgb.size(), 3 * red.size());
  HWY_DYNAMIC_DISPATCH(tone_map_pixels)
  (red.data(), green.data(), blue.data(), scale, red.size(), rgb.data());
}

}  // namespace rimlight
#endif  // HWY_ONCE
