#pragma once

#include <array>
#include <cstddef>

namespace rimlight {

/// Rays to the sky side by side, one array a component: vector code writes them here, and Embree
/// reads them here (RayScene::visible). Directions may have any length but zero.
///
/// Each array has room for kCapacity rays and for the rest of a vector of kSlack floats that begins
/// at the last of them. One thread at a time.
struct SkyRays {
  static constexpr std::size_t kCapacity = 1024;
  static constexpr std::size_t kSlack = 16;
  using Component = std::array<float, kCapacity + kSlack>;

  alignas(64) std::array<Component, 3> origin{};
  std::array<Component, 3> direction{};
  std::size_t count = 0;

 private:
  friend class RayScene;
  // What Embree wants beside them; only the ends change: minus infinity marks an occluded ray.
  Component end{};
  Component zero{};
  std::array<unsigned, kCapacity + kSlack> all_bits = [] {
    std::array<unsigned, kCapacity + kSlack> bits{};
    bits.fill(0xffffffffu);
    return bits;
  }();
  std::array<unsigned, kCapacity + kSlack> no_bits{};
};

}  // namespace rimlight
