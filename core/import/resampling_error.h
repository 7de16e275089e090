#pragma once

#include <span>
#include <string>
#include <vector>

#include "core/import/transport_source.h"
#include "core/math/vec.h"

namespace rimlight {

/// A light as two sets of values for the directions: one straight from the environment, one by way
/// of the cube map's texels (TransportResampler::light_of_directions).
struct ResampledLight {
  std::string name;
  std::vector<Vec3f> direct;     // [directions]
  std::vector<Vec3f> resampled;  // [directions]
};

/// How far pictures from resampled transport are from those of the directions themselves.
struct ResamplingError {
  std::string light;
  double relative_l2 = 0;  // of linear radiance
  double psnr_db = 0;      // display-referred
};

/// Both pictures, B = Σ_j light_j M_j, under each light, over the pixels whose coverage (by
/// receiver, padded ones 0) is not 0. Reads the source once, in parallel.
std::vector<ResamplingError> measure_resampling(const TransportSource& source,
                                                std::span<const float> coverage,
                                                const std::vector<ResampledLight>& lights);

}  // namespace rimlight
