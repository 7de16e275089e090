#pragma once

#include <array>
#include <cstddef>

#include "core/light/cube_light.h"
#include "core/transport/column_run.h"
#include "core/transport/sketch.h"

namespace rimlight {

/// The light that an image shows, L̃, by layers of transport: where columns are added in layers,
/// some show an older light than others. A view; coefficients in the basis' order.
class HeldLight {
 public:
  /// Every layer shows the same. Implicit: a light is a held light.
  HeldLight(const CubeLight& all) { layers_.fill(&all); }    // NOLINT(google-explicit-constructor)
  HeldLight(const std::array<CubeLight, kLayers>& layers) {  // NOLINT(google-explicit-constructor)
    for (std::size_t layer = 0; layer < kLayers; ++layer) layers_[layer] = &layers[layer];
  }

  const CubeLight& layer(std::size_t layer) const { return *layers_[layer]; }
  std::size_t count() const { return layers_[0]->count(); }

 private:
  std::array<const CubeLight*, kLayers> layers_;
};

/// The part of the transport's energy that each layer has, in sum 1.
std::array<float, kLayers> layer_shares(const Sketch& sketch);

/// One light for a held light: its layers' mean by their shares.
void find_mean(const HeldLight& held, const std::array<float, kLayers>& shares, CubeLight& mean);

}  // namespace rimlight
