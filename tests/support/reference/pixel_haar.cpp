#include "tests/support/reference/pixel_haar.h"

#include <cmath>

#include "core/transport/receivers.h"

namespace rimlight::reference {

double pixel_haar_function(std::size_t coefficient, std::size_t receiver) {
  const auto [x, y] = PixelLayout{64, 64}.pixel(receiver);
  if (coefficient == 0) return 1.0 / 8;
  int side = 8;  // of the wavelets in pixels; those of 8 begin at 1, of 4 at 4, of 2 at 16
  std::size_t first = 1;
  while (coefficient >= 4 * first) first *= 4, side /= 2;
  const int across = 8 / side;
  const auto place = static_cast<int>((coefficient - first) % first);
  const auto kind = (coefficient - first) / first;
  const int left = place % across * side, top = place / across * side;
  if (x < left || x >= left + side || y < top || y >= top + side) return 0;
  const double along_x = x - left < side / 2 ? 1 : -1, along_y = y - top < side / 2 ? 1 : -1;
  const double sign = kind == 0 ? along_x : kind == 1 ? along_y : along_x * along_y;
  return sign / side;
}

std::vector<double> restore_radiance(std::span<const double> held,
                                     std::span<const float> reflectance, bool magnitudes) {
  constexpr std::size_t kLanes = PixelLayout::kGroupReceivers;
  const auto place = [](std::size_t receiver, std::size_t channel) {
    return receiver / kBlockReceivers * kBlockFloats + channel * kBlockReceivers +
           receiver % kBlockReceivers;
  };
  std::vector<double> radiance(held.size());
  for (std::size_t receiver = 0; receiver < held.size() / 3; ++receiver) {
    const std::size_t group = receiver / kLanes * kLanes;
    for (std::size_t c = 0; c < 3; ++c) {
      double sum = 0;
      for (std::size_t i = 0; i < kLanes; ++i) {
        const double function = pixel_haar_function(i, receiver % kLanes);
        sum += (magnitudes ? std::abs(function) : function) * held[place(group + i, c)];
      }
      radiance[place(receiver, c)] = sum * static_cast<double>(reflectance[place(receiver, c)]);
    }
  }
  return radiance;
}

}  // namespace rimlight::reference
