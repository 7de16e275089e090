#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "core/curves/curve_light.h"
#include "core/curves/lobe_tables.h"
#include "core/math/vec.h"

namespace rimlight {

/// One of a surface's points, ready for the light of one quarter of the texels.
struct LobePoint {
  Vec3f tangent, bitangent, normal, geometric_normal;  // world
  Vec3f outgoing;                                      // in that frame; z > 0
  Vec3f rest_out;                                      // P(θ_o) of a measured BRDF
};

/// Points of light of one quarter as a surface sees them.
struct LitQuarter {
  const LightPoints::Quarter* points = nullptr;
  const PointRadiance* radiance = nullptr;
  const float* visibility = nullptr;       // [point], the surface's share in it; kVector-aligned
  std::span<const std::uint32_t> vectors;  // which kVector points to look at
};

/// Sums over points above both horizons, each weighted by V · Δω · cos θ_i · L, RGB.
struct LobeSums {
  Vec3f plain;   // of 1
  Vec3f sloped;  // of 1 − (1 − slope · cos θ_i)^5, for diffuse terms that fall off so
  Vec3f lobe;    // of the lobe
};

/// T′ of one surface point, [copy][bin][RGB and 0]: two copies, to be summed.
inline constexpr std::size_t kBinFloats = 2 * kCurveBins * 4;

/// Adds to the sums; to `lobe` all factors with their curves. 16 points take about 50 ns.
void add_shading(const LobeTables& tables, const LobePoint& point, const LitQuarter& light,
                 LobeSums& sums) noexcept;

/// Adds the lobe, without the factor of the tables' axis, to `bins` by that axis' angle, and the
/// rest to the sums. 64-byte aligned.
void add_bins(const LobeTables& tables, const LobePoint& point, const LitQuarter& light,
              LobeSums& sums, std::span<float, kBinFloats> bins) noexcept;

}  // namespace rimlight
