#include "core/report/light_study.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <set>

#include "core/base/parallel.h"
#include "core/basis/cube_map.h"

namespace rimlight {
namespace {

constexpr double kDarkShare = 0.01;

/// [texel]: the three channels' texels from coefficients.
CubeLight to_texels(const CubeHaar& haar, const CubeLight& coefficients) {
  CubeLight texels(haar.size());
  for (int c = 0; c < 3; ++c) haar.inverse(coefficients.channel(c), texels.channel(c));
  return texels;
}

double squared(const Vec3f& value) {
  const Vec3d wide = {value.x, value.y, value.z};
  return wide.x * wide.x + wide.y * wide.y + wide.z * wide.z;
}

/// Orthonormal Haar transform of one coefficient's values in time, in place: value 0 the mean, then
/// bands of 1, 2, 4, … differences, coarse to fine.
void transform_time(std::span<double> values) {
  std::vector<double> next(values.size());
  for (std::size_t count = values.size(); count > 1; count /= 2) {
    for (std::size_t i = 0; i < count / 2; ++i) {
      next[i] = (values[2 * i] + values[2 * i + 1]) * std::sqrt(0.5);
      next[count / 2 + i] = (values[2 * i] - values[2 * i + 1]) * std::sqrt(0.5);
    }
    std::copy_n(next.begin(), count, values.begin());
  }
}

/// Marks the texels under a wavelet's support.
void mark_support(const CubeHaar& haar, std::size_t column, std::vector<std::uint32_t>& bands) {
  const int band = haar.band_of(column);
  const std::size_t n = static_cast<std::size_t>(haar.size());
  std::size_t face = column / 4, row = 0, across = 0;
  if (band > 0) {
    const std::size_t side = std::size_t{1} << band;
    const std::size_t place = column - haar.band_begin(band);
    face = place / (3 * side * side);
    row = place / side % side;
    across = place % side;
  }
  const std::size_t width = n >> band;
  for (std::size_t y = row * width; y < (row + 1) * width; ++y) {
    for (std::size_t x = across * width; x < (across + 1) * width; ++x) {
      bands[(face * n + y) * n + x] |= std::uint32_t{1} << band;
    }
  }
}

}  // namespace

GhostEnergy find_ghosts(const CubeHaar& haar, const CubeLight& target, const CubeLight& held) {
  const CubeLight asked = to_texels(haar, target), shown = to_texels(haar, held);
  const auto brightness = [&](std::size_t i) {
    const Vec3f texel = asked.at(i);
    return std::abs(texel.x + texel.y + texel.z);
  };
  float peak = 0;
  double whole = 0;
  for (std::size_t i = 0; i < asked.count(); ++i) {
    peak = std::max(peak, brightness(i));
    whole += squared(asked.at(i));
  }
  GhostEnergy ghosts;
  if (!(whole > 0)) return ghosts;
  for (std::size_t i = 0; i < asked.count(); ++i) {
    if (!(brightness(i) < kDarkShare * peak)) continue;
    ghosts.held += squared(shown.at(i)) / whole;
    ghosts.target += squared(asked.at(i)) / whole;
  }
  return ghosts;
}

std::vector<std::vector<double>> spatio_temporal_norms(const CubeHaar& haar,
                                                       std::span<const CubeLight> frames) {
  if (frames.empty()) return {};
  const std::size_t count = std::bit_floor(frames.size());
  const auto temporal_bands = static_cast<std::size_t>(std::bit_width(count));
  const auto bands = static_cast<std::size_t>(haar.band_count());
  std::vector<std::vector<double>> norms(temporal_bands, std::vector<double>(bands));
  parallel_for(bands, [&](std::size_t band) {
    std::vector<double> values(count);
    const int b = static_cast<int>(band);
    for (std::size_t column = haar.band_begin(b); column < haar.band_begin(b + 1); ++column) {
      for (int c = 0; c < 3; ++c) {
        for (std::size_t i = 0; i < count; ++i) values[i] = frames[i].channel(c)[column];
        transform_time(values);
        for (std::size_t i = 0; i < count; ++i) {
          norms[static_cast<std::size_t>(std::bit_width(i))][band] += values[i] * values[i];
        }
      }
    }
  });
  for (auto& row : norms) {
    for (double& norm : row) norm = std::sqrt(norm);
  }
  return norms;
}

Coverage find_coverage(const CubeHaar& haar, std::span<const std::vector<std::uint32_t>> frames) {
  Coverage coverage;
  coverage.bands_over_texel.resize(haar.coefficient_count());
  coverage.columns_of_band.resize(static_cast<std::size_t>(haar.band_count()));
  std::set<std::uint32_t> chosen;
  for (const auto& columns : frames) {
    std::vector<std::uint32_t> bands(haar.coefficient_count());
    for (const std::uint32_t column : columns) mark_support(haar, column, bands);
    for (std::size_t i = 0; i < bands.size(); ++i) {
      coverage.bands_over_texel[i] += std::popcount(bands[i]) / static_cast<double>(frames.size());
    }
    chosen.insert(columns.begin(), columns.end());
  }
  for (const std::uint32_t column : chosen) {
    ++coverage.columns_of_band[static_cast<std::size_t>(haar.band_of(column))];
  }
  return coverage;
}

}  // namespace rimlight
