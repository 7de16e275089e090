#pragma once

#include <cstdint>
#include <vector>

#include "core/image/image.h"

namespace rimlight {

/// The side of a picture that is made smaller by `divisor`: rounded up, so that nothing is 0.
constexpr int divided_side(int side, int divisor) { return (side + divisor - 1) / divisor; }

/// Makes pictures smaller by a whole divisor: each pixel is the mean of its divisor × divisor
/// pixels, over those that are there at the right and lower edges, in linear light, so that the sum
/// of light stays what it was and small highlights do not go dark (a mean of sRGB bytes loses up to
/// half of them). Error: at most 1 in 255 of the mean in double. Allocates nothing after warm-up.
/// One thread at a time; uses all cores.
class PictureScaler {
 public:
  static constexpr int kLargestDivisor = 16;

  PictureScaler();
  /// divisor 1 … kLargestDivisor. Replaces `small`.
  void shrink(const Rgb8Image& picture, int divisor, Rgb8Image& small) const;

 private:
  std::vector<std::uint16_t> linear_;  // [256]: sRGB byte to linear light in 65535ths
  std::vector<std::uint8_t> encoded_;  // [kSteps + 1]: linear light back to an sRGB byte
};

}  // namespace rimlight
