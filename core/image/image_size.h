#pragma once

#include <cstdint>
#include <string>

namespace rimlight {

/// The largest image side, and the most pixels, that any reader accepts; checked before anything
/// is allocated.
inline constexpr int kLargestImageSide = 16384;
inline constexpr std::int64_t kMostPixels = std::int64_t{1} << 28;

/// Throws Error at `where` unless both sides are in 1 … kLargestImageSide and the image has at most
/// kMostPixels pixels. Sides are claims of a header: any 64-bit value may come.
void check_image_size(std::int64_t width, std::int64_t height, const std::string& where);

}  // namespace rimlight
