#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

namespace rimlight {

/// Linear radiance to sRGB bytes: value · scale, clipped to [0, 1], the sRGB curve, rounded to 8
/// bits.
///   red, green, blue  [count] linear radiance, any alignment
///   scale             2^stops times the stored exposure
///   rgb               [count][3] interleaved
/// Within 1 of the curve in double everywhere, equal on all but 0.1 % of inputs. NaN gives 0.
/// Bound by bytes, not by powf: dispatches to the widest SIMD target at run time.
void tone_map(std::span<const float> red, std::span<const float> green, std::span<const float> blue,
              float scale, std::span<std::uint8_t> rgb);

/// The sRGB curve of one linear value in [0, 1] (IEC 61966-2-1), and its inverse; in double.
double srgb_from_linear(double linear);
double linear_from_srgb(double encoded);

}  // namespace rimlight
