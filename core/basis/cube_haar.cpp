#include "core/basis/cube_haar.h"

#include <algorithm>
#include <bit>

#include "core/base/check.h"

namespace rimlight {
namespace {

/// Values that a run handles at once: locals of a fixed size, so that the compiler can see that
/// nothing aliases and turns the loops into vectors.
constexpr std::size_t kChunk = 8;

/// The four outputs of a run of 2×2 blocks.
template <typename T>
struct Quarters {
  T* scaling;
  T* across_x;
  T* across_y;
  T* diagonal;
};

/// How the four texels of block i lie: i·kStep in two rows, the right one `offset` further on.
///   kStep 1, offset lanes   one block of many lanes
///   kStep 2, offset 1       many blocks of one lane, side by side
template <std::size_t kStep, std::size_t kCount>
void split_chunk(const float* low, const float* high, std::size_t offset,
                 const Quarters<float>& out) {
  float s[kCount], x[kCount], y[kCount], xy[kCount];
  for (std::size_t i = 0; i < kCount; ++i) {
    const float a = low[i * kStep], b = low[i * kStep + offset];
    const float c = high[i * kStep], d = high[i * kStep + offset];
    s[i] = 0.5f * ((a + b) + (c + d));
    x[i] = 0.5f * ((a - b) + (c - d));
    y[i] = 0.5f * ((a + b) - (c + d));
    xy[i] = 0.5f * ((a - b) - (c - d));
  }
  // Written only now: the scaling coefficients may take the place of what was read.
  std::copy_n(s, kCount, out.scaling);
  std::copy_n(x, kCount, out.across_x);
  std::copy_n(y, kCount, out.across_y);
  std::copy_n(xy, kCount, out.diagonal);
}

template <std::size_t kStep, std::size_t kCount>
void join_chunk(const Quarters<const float>& in, float* low, float* high, std::size_t offset) {
  float a[kCount], b[kCount], c[kCount], d[kCount];
  for (std::size_t i = 0; i < kCount; ++i) {
    const float s = in.scaling[i], x = in.across_x[i], y = in.across_y[i], xy = in.diagonal[i];
    a[i] = 0.5f * ((s + x) + (y + xy));
    b[i] = 0.5f * ((s - x) + (y - xy));
    c[i] = 0.5f * ((s + x) - (y + xy));
    d[i] = 0.5f * ((s - x) - (y - xy));
  }
  for (std::size_t i = 0; i < kCount; ++i) {
    low[i * kStep] = a[i];
    low[i * kStep + offset] = b[i];
    high[i * kStep] = c[i];
    high[i * kStep + offset] = d[i];
  }
}

template <typename T>
Quarters<T> advanced(const Quarters<T>& at, std::size_t i) {
  return {at.scaling + i, at.across_x + i, at.across_y + i, at.diagonal + i};
}

template <std::size_t kStep>
void split_run(const float* low, const float* high, std::size_t offset, const Quarters<float>& out,
               std::size_t count) {
  std::size_t i = 0;
  for (; i + kChunk <= count; i += kChunk) {
    split_chunk<kStep, kChunk>(low + i * kStep, high + i * kStep, offset, advanced(out, i));
  }
  for (; i < count; ++i) {
    split_chunk<kStep, 1>(low + i * kStep, high + i * kStep, offset, advanced(out, i));
  }
}

/// From the end: the joined texels may take the place of scaling coefficients already read.
template <std::size_t kStep>
void join_run(const Quarters<const float>& in, float* low, float* high, std::size_t offset,
              std::size_t count) {
  std::size_t i = count;
  for (; i % kChunk != 0; --i) {
    const std::size_t at = i - 1;
    join_chunk<kStep, 1>(advanced(in, at), low + at * kStep, high + at * kStep, offset);
  }
  for (; i != 0; i -= kChunk) {
    const std::size_t at = i - kChunk;
    join_chunk<kStep, kChunk>(advanced(in, at), low + at * kStep, high + at * kStep, offset);
  }
}

/// Where the blocks of one row of a band begin among the coefficients. In band 0, whose only block
/// has its scaling coefficient there too, that one is set; elsewhere the texels' front holds it.
template <typename T>
Quarters<T> row_quarters(T* coefficients, const CubeHaar& haar, int band, std::size_t face,
                         std::size_t row, std::size_t lanes, T* shrunk) {
  if (band == 0) {
    T* const first = coefficients + face * 4 * lanes;
    return {first, first + lanes, first + 2 * lanes, first + 3 * lanes};
  }
  const std::size_t side = std::size_t{1} << band;
  const std::size_t kind_stride = side * side * lanes;
  T* const first =
      coefficients + (haar.band_begin(band) + face * 3 * side * side + row * side) * lanes;
  return {shrunk, first, first + kind_stride, first + 2 * kind_stride};
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
  const std::size_t face_values = static_cast<std::size_t>(size_ * size_) * lanes;
  // Level by level the scaling coefficients shrink in place into the front of each face's texels.
  for (int band = band_count_ - 1; band >= 0; --band) {
    const std::size_t side = std::size_t{1} << band;
    for (std::size_t face = 0; face < cube::kFaces; ++face) {
      float* const values = texels.data() + face * face_values;
      for (std::size_t row = 0; row < side; ++row) {
        const float* const low = values + 4 * row * side * lanes;
        const float* const high = low + 2 * side * lanes;
        const Quarters<float> out = row_quarters(coefficients.data(), *this, band, face, row, lanes,
                                                 values + row * side * lanes);
        if (lanes == 1) {
          split_run<2>(low, high, 1, out, side);
          continue;
        }
        for (std::size_t column = 0; column < side; ++column) {
          split_run<1>(low + 2 * column * lanes, high + 2 * column * lanes, lanes,
                       advanced(out, column * lanes), lanes);
        }
      }
    }
  }
}

void CubeHaar::inverse(std::span<const float> coefficients, std::span<float> texels,
                       std::size_t lanes) const {
  RIMLIGHT_CHECK_EQ(texels.size(), coefficient_count() * lanes);
  RIMLIGHT_CHECK_EQ(coefficients.size(), texels.size());
  const std::size_t face_values = static_cast<std::size_t>(size_ * size_) * lanes;
  for (int band = 0; band < band_count_; ++band) {
    const std::size_t side = std::size_t{1} << band;
    for (std::size_t face = 0; face < cube::kFaces; ++face) {
      float* const values = texels.data() + face * face_values;
      // Backwards, so that a block's four texels never cover a scaling coefficient still to be
      // read.
      for (std::size_t row = side; row-- > 0;) {
        float* const low = values + 4 * row * side * lanes;
        float* const high = low + 2 * side * lanes;
        const Quarters<const float> in = row_quarters<const float>(
            coefficients.data(), *this, band, face, row, lanes, values + row * side * lanes);
        if (lanes == 1) {
          join_run<2>(in, low, high, 1, side);
          continue;
        }
        for (std::size_t column = side; column-- > 0;) {
          join_run<1>(advanced(in, column * lanes), low + 2 * column * lanes,
                      high + 2 * column * lanes, lanes, lanes);
        }
      }
    }
  }
}

}  // namespace rimlight
