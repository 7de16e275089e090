#pragma once

#include <cstddef>

#include "core/transport/receivers.h"

namespace rimlight {

/// The orthonormal two-dimensional Haar transform over the 8×8 pixels of a group, all three levels,
/// in place. What neighbouring pixels share becomes few numbers, and transport is stored so; the
/// image is held so too, and transformed back once a frame, since the transform is linear.
///
/// Receivers lie in PixelLayout's order, coefficients in the order
///
///     0       scaling
///     1 – 3   wavelets of 8×8 pixels: across x, across y, diagonal
///     4 – 15  wavelets of 4×4 pixels: across x, across y, diagonal, each 2×2 row by row
///     16 – 63 wavelets of 2×2 pixels: the same, each 4×4 row by row
///
/// so that a block of 8 coefficients holds neighbours of one kind.
///   values  eight blocks of 8 floats, the first of each `block_stride` floats after the one
///   before;
///           16-byte aligned, block_stride a multiple of 4
/// Error: each output is a sum of at most 12 rounded operations.
void pixel_haar_forward(float* values, std::size_t block_stride);

/// The inverse, and the transpose, of pixel_haar_forward().
void pixel_haar_inverse(float* values, std::size_t block_stride);

/// The inverse for one tile of held radiance: [block][3][8], each group and channel by itself.
void pixel_haar_inverse_tile(float* tile);

}  // namespace rimlight
