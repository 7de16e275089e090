#include "core/relight/policy.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <functional>

#include "core/base/check.h"

namespace rimlight {
namespace {

Vec3f delta_of(const PlanRequest& request, BandAction action, std::size_t index) {
  const Vec3f target = request.target.at(index);
  return action == BandAction::reset ? target : target - request.held.at(index);
}

float size_of(const Vec3f& delta) {
  return std::abs(delta.x) + std::abs(delta.y) + std::abs(delta.z);
}

/// Sizes are not negative, so their bits order as they do; a lower index makes the larger key.
std::uint64_t key_of(float size, std::size_t index) {
  return std::uint64_t{std::bit_cast<std::uint32_t>(size)} << 32 |
         static_cast<std::uint32_t>(~static_cast<std::uint32_t>(index));
}

std::uint32_t index_of(std::uint64_t key) { return ~static_cast<std::uint32_t>(key); }

/// Leaves the `budget` largest keys, in no order.
void keep_largest(std::vector<std::uint64_t>& keys, std::size_t budget) {
  if (keys.size() <= budget) return;
  const auto end = keys.begin() + static_cast<std::ptrdiff_t>(budget);
  std::nth_element(keys.begin(), end, keys.end(), std::greater<>());
  keys.erase(end, keys.end());
}

/// ‖a − b‖₁ in double; four sums side by side, which the compiler may put into one vector.
double distance(std::span<const float> a, std::span<const float> b) {
  double sums[4] = {};
  std::size_t i = 0;
  for (; i + 4 <= a.size(); i += 4) {
    for (std::size_t k = 0; k < 4; ++k) sums[k] += std::abs(double{a[i + k]} - double{b[i + k]});
  }
  for (; i < a.size(); ++i) sums[0] += std::abs(double{a[i]} - double{b[i]});
  return (sums[0] + sums[1]) + (sums[2] + sums[3]);
}

double size(std::span<const float> a) {
  double sums[4] = {};
  std::size_t i = 0;
  for (; i + 4 <= a.size(); i += 4) {
    for (std::size_t k = 0; k < 4; ++k) sums[k] += std::abs(double{a[i + k]});
  }
  for (; i < a.size(); ++i) sums[0] += std::abs(double{a[i]});
  return (sums[0] + sums[1]) + (sums[2] + sums[3]);
}

std::span<const float> band_of(const CubeHaar& basis, const CubeLight& light, int band,
                               int channel) {
  const std::size_t begin = basis.band_begin(band);
  return light.channel(channel).subspan(begin, basis.band_begin(band + 1) - begin);
}

}  // namespace

double area_weight(const CubeHaar& basis, int band) { return std::sqrt(basis.band_area(band)); }

double weighted_distance(const CubeHaar& basis, const CubeLight& a, const CubeLight& b) {
  double sum = 0;
  for (int band = 0; band < basis.band_count(); ++band) {
    for (int c = 0; c < 3; ++c) {
      sum += area_weight(basis, band) *
             distance(band_of(basis, a, band, c), band_of(basis, b, band, c));
    }
  }
  return sum;
}

double weighted_size(const CubeHaar& basis, const CubeLight& a) {
  double sum = 0;
  for (int band = 0; band < basis.band_count(); ++band) {
    for (int c = 0; c < 3; ++c) sum += area_weight(basis, band) * size(band_of(basis, a, band, c));
  }
  return sum;
}

void UpdatePolicy::make_plan(const PlanRequest& request, PlanWorkspace& workspace,
                             UpdatePlan& plan) const {
  const CubeHaar& basis = request.basis;
  RIMLIGHT_CHECK_EQ(request.target.count(), basis.coefficient_count());
  RIMLIGHT_CHECK_EQ(request.held.count(), basis.coefficient_count());
  plan.bands.assign(static_cast<std::size_t>(basis.band_count()), {});
  plan.columns.clear();
  auto& keys = workspace.candidates;
  keys.clear();
  for (int b = 0; b < basis.band_count(); ++b) {
    BandLight light;
    for (int c = 0; c < 3; ++c) {
      light.target[c] = band_of(basis, request.target, b, c);
      light.held[c] = band_of(basis, request.held, b, c);
    }
    const BandAction action = choose(light);
    plan.bands[static_cast<std::size_t>(b)].action = action;
    const auto weight = static_cast<float>(area_weight(basis, b));
    for (std::size_t i = basis.band_begin(b); i < basis.band_begin(b + 1); ++i) {
      const float size = weight * size_of(delta_of(request, action, i));
      if (size > 0) keys.push_back(key_of(size, i));
    }
  }
  keep_largest(keys, request.coefficient_budget);
  // Ascending indices: the low half alone, the other way round.
  std::ranges::sort(keys, {}, index_of);
  auto key = keys.begin();
  for (int b = 0; b < basis.band_count(); ++b) {
    BandUpdate& update = plan.bands[static_cast<std::size_t>(b)];
    update.first = plan.columns.size();
    for (; key != keys.end() && index_of(*key) < basis.band_begin(b + 1); ++key) {
      plan.columns.push_back({index_of(*key), delta_of(request, update.action, index_of(*key))});
    }
    update.count = plan.columns.size() - update.first;
    if (update.action == BandAction::increment && update.count == 0)
      update.action = BandAction::hold;
  }
}

BandAction NwaPolicy::choose(const BandLight&) const { return BandAction::reset; }

BandAction PbiPolicy::choose(const BandLight& band) const {
  double change = 0, whole = 0;
  for (int c = 0; c < 3; ++c) {
    change += distance(band.target[c], band.held[c]);
    whole += size(band.target[c]);
  }
  return change < whole ? BandAction::increment : BandAction::reset;
}

}  // namespace rimlight
