#pragma once

#include <span>

#include "core/math/vec.h"

namespace rimlight {

/// The exposure scale that takes the mean luminance-like average of `radiance` (mean over receivers
/// and channels, each value clamped at the 99th percentile) to 0.18. 1 when everything is black.
double auto_exposure_scale(std::span<const Vec3f> radiance);

/// Display-referred PSNR in dB: both images times `scale`, clipped to [0, 1], sRGB curve, 8 bits;
/// over all given receivers and channels; capped at 99 dB. The spans have the same size.
double display_psnr(std::span<const Vec3f> image, std::span<const Vec3f> reference, double scale);

/// ‖image − reference‖₂ / ‖reference‖₂ of linear radiance, accumulated in double; infinity when the
/// reference is black and the image is not, 0 when both are.
double relative_l2(std::span<const Vec3f> image, std::span<const Vec3f> reference);

}  // namespace rimlight
