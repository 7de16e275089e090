#include "core/relight/held_light.h"

namespace rimlight {

std::array<float, kLayers> layer_shares(const Sketch& sketch) {
  std::array<double, kLayers> energy{};
  for (std::size_t part = 0; part < sketch.part_norm_squared.size(); ++part) {
    energy[part % kLayers] += static_cast<double>(sketch.part_norm_squared[part]);
  }
  double sum = 0;
  for (const double of_layer : energy) sum += of_layer;
  std::array<float, kLayers> shares{};
  if (!(sum > 0)) return {1};  // a black bake, which shows no light
  for (std::size_t layer = 0; layer < kLayers; ++layer) {
    shares[layer] = static_cast<float>(energy[layer] / sum);
  }
  return shares;
}

void find_mean(const HeldLight& held, const std::array<float, kLayers>& shares, CubeLight& mean) {
  mean = held.layer(0);
  // From the first layer's: where all show the same, so does the mean, to the bit.
  for (std::size_t layer = 1; layer < kLayers; ++layer) {
    const auto& values = held.layer(layer).values;
    const auto& first = held.layer(0).values;
    for (std::size_t i = 0; i < values.size(); ++i) {
      mean.values[i] += shares[layer] * (values[i] - first[i]);
    }
  }
}

}  // namespace rimlight
