#pragma once

#include <cstddef>
#include <span>
#include <vector>

namespace rimlight::reference {

/// The value at a group's receiver of the pixel Haar function of a coefficient, by its definition
/// (core/transport/pixel_haar.h).
double pixel_haar_function(std::size_t coefficient, std::size_t receiver);

/// What is held of one tile, [block][3][8], to radiance: pixel Haar functions summed, times
/// reflectance. With `magnitudes`, of absolute values: what rounding errors scale with.
std::vector<double> restore_radiance(std::span<const double> held,
                                     std::span<const float> reflectance, bool magnitudes);

}  // namespace rimlight::reference
