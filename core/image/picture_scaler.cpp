#include "core/image/picture_scaler.h"

#include <algorithm>
#include <cmath>

#include "core/base/check.h"
#include "core/base/parallel.h"
#include "core/image/tone_map.h"

namespace rimlight {
namespace {

constexpr double kWhite = 65535;
/// Linear light is looked up in so many steps. The curve's steepest slope is 12.92: one step there
/// is 12.92 · 255 / 16384 = 0.2 of a byte.
constexpr std::uint32_t kSteps = 16384;

}  // namespace

PictureScaler::PictureScaler() : linear_(256), encoded_(kSteps + 1) {
  for (std::size_t i = 0; i < linear_.size(); ++i) {
    linear_[i] = static_cast<std::uint16_t>(
        std::lround(kWhite * linear_from_srgb(static_cast<double>(i) / 255)));
  }
  for (std::size_t i = 0; i < encoded_.size(); ++i) {
    encoded_[i] = static_cast<std::uint8_t>(
        std::lround(255 * srgb_from_linear(static_cast<double>(i) / kSteps)));
  }
}

void PictureScaler::shrink(const Rgb8Image& picture, int divisor, Rgb8Image& small) const {
  RIMLIGHT_CHECK(divisor >= 1 && divisor <= kLargestDivisor);
  RIMLIGHT_CHECK(picture.width > 0 && picture.height > 0);
  small.resize(divided_side(picture.width, divisor), divided_side(picture.height, divisor));
  constexpr int kRows = 16;  // of the small picture, a thread's share
  const auto shares = static_cast<std::size_t>(divided_side(small.height, kRows));
  parallel_for(shares, [&](std::size_t share) {
    const int first = static_cast<int>(share) * kRows;
    const int last = std::min(first + kRows, small.height);
    for (int y = first; y < last; ++y) {
      const int top = y * divisor, bottom = std::min(top + divisor, picture.height);
      std::uint8_t* out = small.bytes.data() +
                          3 * static_cast<std::size_t>(y) * static_cast<std::size_t>(small.width);
      for (int x = 0; x < small.width; ++x) {
        const int left = x * divisor, right = std::min(left + divisor, picture.width);
        std::uint32_t sum[3] = {0, 0, 0};
        for (int from_y = top; from_y < bottom; ++from_y) {
          const std::uint8_t* in =
              picture.bytes.data() +
              3 * (static_cast<std::size_t>(from_y) * static_cast<std::size_t>(picture.width) +
                   static_cast<std::size_t>(left));
          for (int from_x = left; from_x < right; ++from_x, in += 3) {
            for (int c = 0; c < 3; ++c) sum[c] += linear_[in[c]];
          }
        }
        const auto count = static_cast<std::uint32_t>((right - left) * (bottom - top));
        for (const std::uint32_t light : sum) {
          // In kSteps of white, rounded; 256 pixels of 65535 times kSteps need 64 bits.
          const std::uint64_t scaled = std::uint64_t{light} * kSteps + 32767 * count;
          *out++ = encoded_[scaled / (std::uint64_t{65535} * count)];
        }
      }
    }
  });
}

}  // namespace rimlight
