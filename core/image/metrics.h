#pragma once

#include <span>

#include "core/math/vec.h"

namespace rimlight {

/// The exposure scale that takes the mean luminance-like average of `radiance` (mean over receivers
/// and channels, each value clamped at the 99th percentile) to 0.18. 1 when that mean is 0 (all
/// black, or all but 1 % of it), or not finite.
double auto_exposure_scale(std::span<const Vec3f> radiance);

/// Display-referred PSNR in dB: both images times `scale`, clipped to [0, 1], sRGB curve, 8 bits;
/// over all given receivers and channels; capped at 99 dB. The spans have the same size. NaN shows
/// as black, as in tone_map; the bytes here are exact, tone_map's can differ by 1 at a boundary.
double display_psnr(std::span<const Vec3f> image, std::span<const Vec3f> reference, double scale);

/// ‖image − reference‖₂ / ‖reference‖₂ of linear radiance, accumulated in double; infinity when the
/// reference is black and the image is not, 0 when both are. The spans have the same size.
double relative_l2(std::span<const Vec3f> image, std::span<const Vec3f> reference);

}  // namespace rimlight
