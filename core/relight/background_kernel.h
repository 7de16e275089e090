#pragma once

#include <cstddef>

namespace rimlight {

/// The texels of BackgroundMap: [6][size + 2][size + 2][4] (red, green, blue, unused), 16-byte
/// aligned.
struct BorderedFaces {
  const float* texels = nullptr;
  int size = 0;
};

/// Directions of any length but zero that are looked up together.
inline constexpr std::size_t kLookUps = 64;
struct alignas(64) BackgroundLookUps {
  float x[kLookUps] = {}, y[kLookUps] = {}, z[kLookUps] = {};
  float radiance[kLookUps][4] = {};
};

/// Fills the radiance of the first `count` directions, each turned by a matrix first: its rows,
/// [3][3]. Those behind them, up to a whole vector, may be anything finite but zero; theirs may be
/// filled too.
void look_up(const BorderedFaces& faces, const float (&turn)[3][3], std::size_t count,
             BackgroundLookUps& look_ups) noexcept;

}  // namespace rimlight
