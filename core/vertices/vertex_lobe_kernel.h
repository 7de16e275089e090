#pragma once

#include <array>
#include <cstddef>
#include <span>

namespace rimlight {

/// A point of a triangle that mirrors the eye to some direction.
struct MirroringPoint {
  std::array<const float*, 3> corners{};  // the light that arrives there: [3][stride]
  std::array<float, 3> weights{};         // of the corners
  const float* lobe = nullptr;            // [stride]: what a convolution multiplies harmonics by
};

/// radiance[i][c] = Σ_k harmonics[i][k] · lobe_k · Σ_corner weight · corner[c][k], in fp32:
///   harmonics  [point][stride]: at the mirrored directions         radiance  [point][3]
/// Everything 64-byte aligned but radiance; stride a multiple of 16, padded with zeros. A point
/// gets the same bits whatever the others are.
void gather_lobes(std::span<const MirroringPoint> points, const float* harmonics,
                  std::size_t stride, float* radiance) noexcept;

/// The SIMD target in use ("AVX3", …).
const char* vertex_lobe_target();

}  // namespace rimlight
