#pragma once

#include <functional>

#include "core/image/image.h"

namespace rimlight {

/// The images of the built-in environments, lat-long, kBuiltinWidth × kBuiltinHeight.
inline constexpr int kBuiltinWidth = 1024;
inline constexpr int kBuiltinHeight = 512;

RgbImage sunny_image();
RgbImage studio_image();
RgbImage cathedral_image();

/// A lat-long image of a radiance over unit directions, on all threads: the mean of samples ×
/// samples points of each pixel.
RgbImage render_lat_long(int samples, const std::function<Vec3d(const Vec3d&)>& radiance);

/// Smooth noise of period 1 in [0, 1], different for each seed.
double smooth_noise(double x, double y, std::uint64_t seed);

/// A number in [0, 1) of a lattice point.
double lattice_noise(std::int64_t x, std::int64_t y, std::uint64_t seed);

}  // namespace rimlight
