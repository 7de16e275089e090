#include "core/relight/column_gains.h"

#include <bit>
#include <cmath>
#include <limits>

#include "core/base/check.h"
#include "core/base/error.h"

namespace rimlight {
namespace {

/// The largest |value| of a light.
float largest_of(const CubeLight& light) {
  float largest = 0;
  for (const float value : light.values) largest = std::max(largest, std::abs(value));
  return largest;
}

/// What lights are multiplied by before they are squared: 1 for all but those whose squares would
/// leave the range of floats, so that gains vanish or become infinite; for these the power of two
/// that takes the largest value to about 1. Plans do not depend on it.
float scale_before_squares(const PlanRequest& request) {
  constexpr float kMost = 0x1p24f;
  float largest = largest_of(request.target);
  for (std::size_t layer = 0; layer < kLayers; ++layer) {
    const CubeLight& held = request.held.layer(layer);
    if (layer > 0 && &held == &request.held.layer(0)) continue;
    largest = std::max(largest, largest_of(held));
  }
  const bool fits = largest <= kMost && largest >= 1 / kMost;
  if (fits || !(largest > 0) || !std::isfinite(largest)) return 1;
  return std::ldexp(1.0f, std::clamp(-std::ilogb(largest), -126, 126));
}

/// Planar pointers to the three channels of target and held.
struct Lights {
  const float* target[3];
  const float* held[3];

  explicit Lights(const PlanRequest& request) {
    for (int c = 0; c < 3; ++c) {
      target[c] = request.target.channel(c).data();
      held[c] = request.held.layer(0).channel(c).data();
    }
  }

  template <Alternative kAlternative>
  float delta(int channel, std::size_t i) const {
    if constexpr (kAlternative == Alternative::reset) return target[channel][i];
    return target[channel][i] - held[channel][i];
  }
};

/// Finite and not negative whatever comes, NaN included, so that bits may serve as numbers.
float tamed(float gain) {
  constexpr float kMost = std::numeric_limits<float>::max();
  gain = gain < kMost ? gain : kMost;
  return gain > 0 ? gain : 0;
}

std::uint32_t rank_of(float gain, bool changes) {
  const auto bits = std::bit_cast<std::uint32_t>(gain);
  return bits + ColumnGains::kLastRank * static_cast<std::uint32_t>(changes & (bits == 0));
}

/// gain[i] = gain_of(band, i, deltas), band by band, and ranks by gain. One plain loop over planar
/// arrays, which the compiler makes vectors of.
template <Alternative kAlternative, typename GainOf>
void measure(const PlanRequest& request, const GainOf& gain_of, ColumnGains& gains) {
  const Lights lights(request);
  gains.gain.resize(request.target.count());
  gains.rank.resize(request.target.count());
  float* const gain = gains.gain.data();
  std::uint32_t* const rank = gains.rank.data();
  for (int band = 0; band < request.basis.band_count(); ++band) {
    const auto of_band = gain_of(band);
    const std::size_t end = request.basis.band_begin(band + 1);
    for (std::size_t i = request.basis.band_begin(band); i < end; ++i) {
      const float x = lights.delta<kAlternative>(0, i);
      const float y = lights.delta<kAlternative>(1, i);
      const float z = lights.delta<kAlternative>(2, i);
      gain[i] = tamed(of_band(i, x, y, z));
      rank[i] = rank_of(gain[i], (x != 0) | (y != 0) | (z != 0));
    }
  }
}

/// Columns of which another layer than the first still lacks something come last.
void rank_other_layers(const PlanRequest& request, ColumnGains& gains) {
  for (std::size_t layer = 1; layer < kLayers; ++layer) {
    if (&request.held.layer(layer) == &request.held.layer(0)) continue;
    for (int c = 0; c < 3; ++c) {
      const float* const target = request.target.channel(c).data();
      const float* const held = request.held.layer(layer).channel(c).data();
      for (std::size_t i = 0; i < gains.rank.size(); ++i) {
        const bool lacks = (gains.rank[i] == 0) & (target[i] != held[i]);
        gains.rank[i] += ColumnGains::kLastRank * static_cast<std::uint32_t>(lacks);
      }
    }
  }
}

template <typename GainOf>
void measure(const PlanRequest& request, Alternative alternative, const GainOf& gain_of,
             ColumnGains& gains) {
  if (alternative == Alternative::reset) {
    measure<Alternative::reset>(request, gain_of, gains);
  } else {
    measure<Alternative::increment>(request, gain_of, gains);
    rank_other_layers(request, gains);
  }
}

/// Columns that alone cost more than there is are no candidates: else they would stand in the way
/// of all behind them, for ever.
void leave_out_unaffordable(const ColumnCosts& costs, std::vector<std::uint32_t>& ranks) {
  if (!costs.are_bytes()) return;
  constexpr std::uint64_t kMost = std::numeric_limits<std::uint32_t>::max();
  const auto budget = static_cast<std::uint32_t>(std::min(costs.budget(), kMost));
  for (std::size_t i = 0; i < ranks.size(); ++i) {
    ranks[i] = costs.bytes_of(i) > budget ? 0 : ranks[i];
  }
}

std::span<const float> norms_squared(const PlanRequest& request) {
  if (request.column_norm_squared.empty()) {
    throw Error("policy", "no norms of the transport's columns",
                "them, to weigh by transport or benefit");
  }
  RIMLIGHT_CHECK_EQ(request.column_norm_squared.size(), request.target.values.size());
  return request.column_norm_squared;
}

/// Energies of all parts; ranked by them.
void measure_part_energies(const PlanRequest& request, Alternative alternative,
                           ColumnGains& gains) {
  const std::size_t columns = request.target.count(), parts = columns * kLayers;
  RIMLIGHT_CHECK_EQ(request.part_norm_squared.size(), 3 * parts);
  const float scale = scale_before_squares(request);
  gains.gain.assign(parts, 0);
  gains.rank.assign(parts, 0);
  for (std::size_t layer = 0; layer < kLayers; ++layer) {
    for (std::size_t c = 0; c < 3; ++c) {
      const float* const target = request.target.channel(static_cast<int>(c)).data();
      const float* const held = request.held.layer(layer).channel(static_cast<int>(c)).data();
      const float* const squares = request.part_norm_squared.data() + c * parts;
      const float kept = alternative == Alternative::increment ? 1.0f : 0.0f;
      for (std::size_t i = 0; i < columns; ++i) {
        const float delta = scale * (target[i] - kept * held[i]);
        const std::size_t part = part_of(i, layer);
        gains.gain[part] += squares[part] * delta * delta;
        gains.rank[part] |= static_cast<std::uint32_t>(delta != 0);  // for now: whether it changes
      }
    }
  }
  for (std::size_t part = 0; part < parts; ++part) {
    gains.gain[part] = tamed(gains.gain[part]);
    gains.rank[part] = rank_of(gains.gain[part], gains.rank[part] != 0);
  }
}

}  // namespace

double ColumnGains::of_band(const Candidates& candidates, int band) const {
  const std::size_t end = candidates.band_begin(band + 1);
  double sums[4] = {};  // side by side, which the compiler may put into one vector
  std::size_t i = candidates.band_begin(band);
  for (; i + 4 <= end; i += 4) {
    for (std::size_t k = 0; k < 4; ++k) sums[k] += double{gain[i + k]};
  }
  for (; i < end; ++i) sums[0] += double{gain[i]};
  return (sums[0] + sums[1]) + (sums[2] + sums[3]);
}

bool holds_nothing(const PlanRequest& request, int band) {
  const std::size_t begin = request.basis.band_begin(band);
  const std::size_t end = request.basis.band_begin(band + 1);
  for (std::size_t layer = 0; layer < kLayers; ++layer) {
    for (int c = 0; c < 3; ++c) {
      const auto held = request.held.layer(layer).channel(c).subspan(begin, end - begin);
      if (std::ranges::any_of(held, [](float value) { return value != 0; })) return false;
    }
  }
  return true;
}

void measure_sizes(const PlanRequest& request, Selection selection, Alternative alternative,
                   ColumnGains& gains) {
  if (selection == Selection::transport) {
    const float* const squares = norms_squared(request).data();
    const std::size_t count = request.target.count();
    const auto by_norm = [=](int) {
      return [=](std::size_t i, float x, float y, float z) {
        return std::sqrt(squares[i]) * std::abs(x) + std::sqrt(squares[count + i]) * std::abs(y) +
               std::sqrt(squares[2 * count + i]) * std::abs(z);
      };
    };
    measure(request, alternative, by_norm, gains);
  } else {
    const auto by_band = [&](int band) {
      const auto weight =
          static_cast<float>(selection == Selection::area ? area_weight(request.basis, band) : 1.0);
      return [weight](std::size_t, float x, float y, float z) {
        return weight * (std::abs(x) + std::abs(y) + std::abs(z));
      };
    };
    measure(request, alternative, by_band, gains);
  }
  leave_out_unaffordable(ColumnCosts(request, Candidates::columns(request.basis)), gains.rank);
}

void measure_energies(const PlanRequest& request, const Candidates& candidates,
                      Alternative alternative, ColumnGains& gains) {
  if (candidates.are_parts()) {
    measure_part_energies(request, alternative, gains);
  } else {
    const float* const squares = norms_squared(request).data();
    const std::size_t count = request.target.count();
    const float scale = scale_before_squares(request);
    const auto by_energy = [=](int) {
      // (norm² · r) · r: r² alone could overflow where the norm is 0.
      return [=](std::size_t i, float x, float y, float z) {
        x *= scale;
        y *= scale;
        z *= scale;
        return squares[i] * x * x + squares[count + i] * y * y + squares[2 * count + i] * z * z;
      };
    };
    measure(request, alternative, by_energy, gains);
  }
  const ColumnCosts costs(request, candidates);
  if (costs.are_bytes()) {
    for (std::size_t i = 0; i < gains.gain.size(); ++i) {
      const float density = gains.gain[i] / static_cast<float>(costs.bytes_of(i));
      gains.rank[i] = rank_of(density, gains.rank[i] != 0);
    }
  }
  leave_out_unaffordable(costs, gains.rank);
}

}  // namespace rimlight
