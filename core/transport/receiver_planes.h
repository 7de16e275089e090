#pragma once

#include <array>
#include <cstddef>
#include <span>

#include "core/math/vec.h"
#include "core/transport/receivers.h"

namespace rimlight {

/// How a group's rows of M are written so that most of what is stored is small. M's three channels
/// c of a pixel p are
///
///     M_c(p) = reflectance_c(p) · T_c(p)
///     T_c    = Σ_k factor_kc · plane_k      k = 0 luma, 1 and 2 chroma
///
/// and each plane is transformed by pixel_haar_forward() over the group's pixels. Reflectance is
/// what a pixel's row has in size and colour next to its neighbours' (texture, albedo): T is smooth
/// where they are not, and almost without colour where light comes straight from the environment.
///
/// An image is held as its pixel Haar coefficients of T_c, so that one column is one multiple of
/// stored numbers; restore_radiance() makes radiance of it.
inline constexpr std::size_t kPlanes = 3;
inline constexpr std::size_t kGroupFloats = 3 * PixelLayout::kGroupReceivers;

/// factor_kc: what a unit of plane k adds to T's channels. Luma is a mean of the channels, weighted
/// roughly as the eye weighs them; chroma is what red and blue have beyond it. Each factor has
/// length √3, so that an error in any plane weighs the same in T.
inline constexpr float kLumaRed = 0.3f, kLumaGreen = 0.5f, kLumaBlue = 0.2f;
inline constexpr float kRedScale = 1.4852213f;   // √(3 / (1 + (0.3/0.5)²))
inline constexpr float kBlueScale = 1.6081688f;  // √(3 / (1 + (0.2/0.5)²))
inline constexpr std::array<Vec3f, kPlanes> kPlaneFactors = {
    Vec3f{1, 1, 1},
    Vec3f{kRedScale, -kRedScale*(kLumaRed / kLumaGreen), 0},
    Vec3f{0, -kBlueScale*(kLumaBlue / kLumaGreen), kBlueScale},
};

/// The reflectance of a group's pixels: for each channel the norm of its row over the root mean
/// square of such norms in the group, at least kLeastReflectance; 0 where the row is 0.
///   rows  [columns][3][64], M
///   reflectance  [3][64], overwritten
inline constexpr float kLeastReflectance = 0x1p-6f;
void find_reflectance(std::span<const float> rows, std::span<float, kGroupFloats> reflectance);

/// Rows of M to planes, in place: [columns][3][64] to [columns][plane][64 coefficients]. Pixels
/// without any transport take the mean of the others, as whose neighbours they cost nothing: their
/// reflectance is 0, whatever they hold. Error: relative 2⁻²⁰ of the column's largest T.
void to_planes(std::span<float> rows, std::span<const float, kGroupFloats> reflectance);

/// One tile of radiance from what is held, in place: inverse pixel Haar, then times reflectance.
///   held         [block][3][8]: coefficients of T_c, block b of a group its coefficients 8b … 8b +
///   7 reflectance  [block][3][8], receivers in order
void restore_radiance(std::span<float, kTileFloats> held,
                      std::span<const float, kTileFloats> reflectance);

}  // namespace rimlight
