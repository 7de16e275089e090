#include "core/transport/pixel_haar.h"

#include <cstring>

namespace rimlight {
namespace {

/// Four numbers of one kind in a row of wavelets: one vector of any CPU there is, so there is
/// nothing to dispatch.
using Four = float __attribute__((vector_size(16)));

Four load(const float* from) {
  Four result;
  std::memcpy(&result, from, sizeof result);
  return result;
}
void store(const Four& a, float* to) { std::memcpy(to, &a, sizeof a); }

/// Lanes 0 and 2 of a, then of b; and lanes 1 and 3.
Four even(Four a, Four b) { return __builtin_shufflevector(a, b, 0, 2, 4, 6); }
Four odd(Four a, Four b) { return __builtin_shufflevector(a, b, 1, 3, 5, 7); }
/// Lanes of a and b in turn: 0 and 1 of each; and 2 and 3.
Four mix_lower(Four a, Four b) { return __builtin_shufflevector(a, b, 0, 4, 1, 5); }
Four mix_upper(Four a, Four b) { return __builtin_shufflevector(a, b, 2, 6, 3, 7); }

/// Four quads at once: the pixels of 2×2 (first the row, then the column), or their mean and
/// wavelets. The transform is its own inverse.
struct Quads {
  Four a, b, c, d;

  Quads transformed() const {
    const Four top = a + b, top_across = a - b, bottom = c + d, bottom_across = c - d;
    return {0.5f * (top + bottom), 0.5f * (top_across + bottom_across), 0.5f * (top - bottom),
            0.5f * (top_across - bottom_across)};
  }
};

}  // namespace

void pixel_haar_forward(float* values, std::size_t stride) {
  Quads fine[4];
  for (std::size_t r = 0; r < 4; ++r) {
    const float* const left = values + 2 * r * stride;
    const float* const right = left + stride;
    const Four top_left = load(left), top_right = load(right);
    const Four low_left = load(left + 4), low_right = load(right + 4);
    fine[r] = Quads{even(top_left, top_right), odd(top_left, top_right), even(low_left, low_right),
                    odd(low_left, low_right)}
                  .transformed();
  }
  const Quads middle = Quads{even(fine[0].a, fine[2].a), odd(fine[0].a, fine[2].a),
                             even(fine[1].a, fine[3].a), odd(fine[1].a, fine[3].a)}
                           .transformed();
  const Four coarse = middle.a;
  const float top = coarse[0] + coarse[1], top_across = coarse[0] - coarse[1];
  const float bottom = coarse[2] + coarse[3], bottom_across = coarse[2] - coarse[3];
  values[0] = 0.5f * (top + bottom);
  values[1] = 0.5f * (top_across + bottom_across);
  values[2] = 0.5f * (top - bottom);
  values[3] = 0.5f * (top_across - bottom_across);
  store(middle.b, values + 4);
  store(middle.c, values + stride);
  store(middle.d, values + stride + 4);
  for (std::size_t r = 0; r < 4; ++r) {
    float* const row = values + (2 + r / 2) * stride + r % 2 * 4;
    store(fine[r].b, row);
    store(fine[r].c, row + 2 * stride);
    store(fine[r].d, row + 4 * stride);
  }
}

void pixel_haar_inverse(float* values, std::size_t stride) {
  const float top = values[0] + values[2], top_across = values[1] + values[3];
  const float bottom = values[0] - values[2], bottom_across = values[1] - values[3];
  const Four coarse = {0.5f * (top + top_across), 0.5f * (top - top_across),
                       0.5f * (bottom + bottom_across), 0.5f * (bottom - bottom_across)};
  const Quads middle =
      Quads{coarse, load(values + 4), load(values + stride), load(values + stride + 4)}
          .transformed();
  const Four means[4] = {mix_lower(middle.a, middle.b), mix_lower(middle.c, middle.d),
                         mix_upper(middle.a, middle.b), mix_upper(middle.c, middle.d)};
  Quads fine[4];
  for (std::size_t r = 0; r < 4; ++r) {
    const float* const row = values + (2 + r / 2) * stride + r % 2 * 4;
    fine[r] =
        Quads{means[r], load(row), load(row + 2 * stride), load(row + 4 * stride)}.transformed();
  }
  for (std::size_t r = 0; r < 4; ++r) {
    float* const left = values + 2 * r * stride;
    float* const right = left + stride;
    store(mix_lower(fine[r].a, fine[r].b), left);
    store(mix_upper(fine[r].a, fine[r].b), right);
    store(mix_lower(fine[r].c, fine[r].d), left + 4);
    store(mix_upper(fine[r].c, fine[r].d), right + 4);
  }
}

void pixel_haar_inverse_tile(float* tile) {
  constexpr std::size_t kGroupFloats = kTileFloats / 64;
  for (float* group = tile; group < tile + kTileFloats; group += kGroupFloats) {
    for (std::size_t c = 0; c < 3; ++c)
      pixel_haar_inverse(group + c * kBlockReceivers, kBlockFloats);
  }
}

}  // namespace rimlight
