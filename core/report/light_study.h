#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "core/basis/cube_haar.h"
#include "core/light/cube_light.h"

namespace rimlight {

/// Light where there should be next to none: trails that an incremental update leaves where a
/// bright source was. Energies of the texels whose target, channels summed, is under 1 % of the
/// brightest texel's, over the target's energy in all texels. Without ghosts the two are alike.
struct GhostEnergy {
  double held = 0;
  double target = 0;
};

/// Lights are coefficients. A black target gives zeros.
GhostEnergy find_ghosts(const CubeHaar& haar, const CubeLight& target, const CubeLight& held);

/// How fast light changes at each scale, whatever approximates it (Overbeck 2006, figure 5.4):
/// coefficients of a sequence's frames, Haar-transformed once more along time, over the first 2^n
/// frames, n as large as they allow. Norms (√ of summed squares): [temporal band][spatial band],
/// the temporal band 0 being the mean of all frames, the last the differences of neighbours.
std::vector<std::vector<double>> spatio_temporal_norms(const CubeHaar& haar,
                                                       std::span<const CubeLight> frames);

/// What share of the light some frames update, and where (Overbeck 2006, figure 5.3).
struct Coverage {
  /// For each texel, face by face: the bands of which a wavelet over it was chosen, averaged over
  /// the frames.
  std::vector<double> bands_over_texel;
  /// Different columns chosen in any of the frames, by band.
  std::vector<int> columns_of_band;
};

/// Columns that each frame chose.
Coverage find_coverage(const CubeHaar& haar, std::span<const std::vector<std::uint32_t>> frames);

}  // namespace rimlight
