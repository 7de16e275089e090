#pragma once

#include <optional>

#include "core/light/cube_light.h"
#include "core/math/vec.h"

namespace rimlight {

/// A small disc of light, as good as a direction to all but the edges of shadows.
struct Sun {
  Vec3d direction;            // unit, to the middle of its light
  Vec3d irradiance;           // ∫ L dω over it: what a surface that faces it receives
  double angular_radius = 0;  // radians, of the even disc with the same second moment

  friend bool operator==(const Sun&, const Sun&) = default;
};

/// How a scene of vertices is lit by a sun, where an environment has one.
enum class SunLight {
  harmonics,    // with the rest of the environment: soft shadows, which ring
  directional,  // apart: shadows as sharp as pixels, but no light of it by way of other surfaces
};

/// An environment taken apart; the two together are the whole.
struct SunAndSky {
  CubeLight sky;
  std::optional<Sun> sun;
};

/// A sun lies within so far of its middle: half the glare of a photographed one.
/// Texels larger than that are a spot by themselves.
inline constexpr double kSunSpotRadius = 3 * 3.14159265358979323846 / 180;
/// Less of the irradiance of a surface that faces it than this makes no sun.
inline constexpr double kLeastSunShare = 0.25;

/// Takes the sun out of an environment: what of its brightest spot exceeds the surroundings.
///
/// The spot is where the texel of the highest luminance is, about the middle of the texels near it
/// that are at least half as bright, kSunSpotRadius to each side (at least half a
/// texel); its surroundings are the ring from there to twice as far (and a texel more). Texels of
/// the spot are cut to the ring's mean, channel by channel, and what was cut off is the sun, to the
/// rounding of a texel: so ∫ L dω of sky and sun is that of the whole, and the irradiance of any
/// surface, up to the sun's width. It is a sun when
///   - a surface that faces it gets at least kLeastSunShare of its luminous irradiance from it, and
///   - no texel of the ring is half as bright as the brightest of the spot: windows, lamps and the
///     middle of a wide light are no suns.
/// Else the sky is the environment as it was. Luminance is that of sRGB's primaries. Deterministic.
SunAndSky split_sun(const CubeLight& light);

}  // namespace rimlight
