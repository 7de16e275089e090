#include "core/basis/cube_haar.h"

#include <bit>

#include "core/base/check.h"

namespace rimlight {
namespace {

/// Where a level's four outputs of one 2×2 block go.
struct LevelPlaces {
  std::size_t scaling, across_x, across_y, diagonal;
};

LevelPlaces places(const CubeHaar& haar, int band, std::size_t face, std::size_t row,
                   std::size_t column) {
  if (band == 0) return {face * 4, face * 4 + 1, face * 4 + 2, face * 4 + 3};
  const std::size_t side = std::size_t{1} << band;
  const std::size_t kind_stride = side * side;
  const std::size_t first = haar.band_begin(band) + face * 3 * kind_stride + row * side + column;
  return {0, first, first + kind_stride, first + 2 * kind_stride};
}

}  // namespace

CubeHaar::CubeHaar(int size) : size_(size) {
  RIMLIGHT_CHECK(size >= 2 && size <= cube::kLargestSize);
  RIMLIGHT_CHECK(std::has_single_bit(static_cast<unsigned>(size)));
  band_count_ = std::countr_zero(static_cast<unsigned>(size));
}

int CubeHaar::band_of(std::size_t coefficient) const {
  int band = 0;
  while (coefficient >= band_begin(band + 1)) ++band;
  return band;
}

void CubeHaar::forward(std::span<float> texels, std::span<float> coefficients,
                       std::size_t lanes) const {
  RIMLIGHT_CHECK_EQ(texels.size(), coefficient_count() * lanes);
  RIMLIGHT_CHECK_EQ(coefficients.size(), texels.size());
  // Level by level the scaling coefficients shrink in place into the front of each face's texels.
  for (int band = band_count_ - 1; band >= 0; --band) {
    const std::size_t side = std::size_t{1} << band;
    for (std::size_t face = 0; face < cube::kFaces; ++face) {
      float* const values = texels.data() + face * static_cast<std::size_t>(size_ * size_) * lanes;
      for (std::size_t row = 0; row < side; ++row) {
        for (std::size_t column = 0; column < side; ++column) {
          const float* const low = values + (4 * row * side + 2 * column) * lanes;
          const float* const high = low + 2 * side * lanes;
          float* const shrunk = values + (row * side + column) * lanes;
          const LevelPlaces at = places(*this, band, face, row, column);
          float* const scaling = band == 0 ? coefficients.data() + at.scaling * lanes : shrunk;
          float* const across_x = coefficients.data() + at.across_x * lanes;
          float* const across_y = coefficients.data() + at.across_y * lanes;
          float* const diagonal = coefficients.data() + at.diagonal * lanes;
          for (std::size_t i = 0; i < lanes; ++i) {
            const float a = low[i], b = low[lanes + i], c = high[i], d = high[lanes + i];
            scaling[i] = 0.5f * ((a + b) + (c + d));
            across_x[i] = 0.5f * ((a - b) + (c - d));
            across_y[i] = 0.5f * ((a + b) - (c + d));
            diagonal[i] = 0.5f * ((a - b) - (c - d));
          }
        }
      }
    }
  }
}

void CubeHaar::inverse(std::span<const float> coefficients, std::span<float> texels,
                       std::size_t lanes) const {
  RIMLIGHT_CHECK_EQ(texels.size(), coefficient_count() * lanes);
  RIMLIGHT_CHECK_EQ(coefficients.size(), texels.size());
  for (int band = 0; band < band_count_; ++band) {
    const std::size_t side = std::size_t{1} << band;
    for (std::size_t face = 0; face < cube::kFaces; ++face) {
      float* const values = texels.data() + face * static_cast<std::size_t>(size_ * size_) * lanes;
      // Backwards, so that a block's four texels never cover a scaling coefficient still to be
      // read.
      for (std::size_t row = side; row-- > 0;) {
        for (std::size_t column = side; column-- > 0;) {
          const LevelPlaces at = places(*this, band, face, row, column);
          const float* const scaling = band == 0 ? coefficients.data() + at.scaling * lanes
                                                 : values + (row * side + column) * lanes;
          const float* const across_x = coefficients.data() + at.across_x * lanes;
          const float* const across_y = coefficients.data() + at.across_y * lanes;
          const float* const diagonal = coefficients.data() + at.diagonal * lanes;
          float* const low = values + (4 * row * side + 2 * column) * lanes;
          float* const high = low + 2 * side * lanes;
          for (std::size_t i = 0; i < lanes; ++i) {
            const float s = scaling[i], x = across_x[i], y = across_y[i], xy = diagonal[i];
            low[i] = 0.5f * ((s + x) + (y + xy));
            low[lanes + i] = 0.5f * ((s - x) + (y - xy));
            high[i] = 0.5f * ((s + x) - (y + xy));
            high[lanes + i] = 0.5f * ((s - x) - (y - xy));
          }
        }
      }
    }
  }
}

}  // namespace rimlight
