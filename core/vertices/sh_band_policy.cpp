#include "core/vertices/sh_band_policy.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "core/base/check.h"
#include "core/basis/sh.h"

namespace rimlight {
namespace {

constexpr double kFall = 0.1;  // of the tolerance, from round to round
constexpr std::size_t kChannels = 3;

}  // namespace

ShBandPolicy::ShBandPolicy(int degree, double tolerance)
    : degree_(degree), tolerance_(tolerance), bands_(static_cast<std::size_t>(degree + 1)) {
  sh::check_degree(degree);
  RIMLIGHT_CHECK(tolerance > 0);
  ranked_.resize(sh::coefficient_count(degree));
  residual_.resize(ranked_.size());
  for (std::size_t l = 0; l < bands_.size(); ++l) {
    bands_[l].begin = l * l;
    bands_[l].end = (l + 1) * (l + 1);
  }
}

void ShBandPolicy::rank(std::span<const float> target, std::span<const float> held) {
  const std::size_t count = residual_.size();
  for (std::size_t i = 0; i < count; ++i) {
    residual_[i] = 0;
    for (std::size_t c = 0; c < kChannels; ++c) {
      residual_[i] += std::abs(double{target[c * count + i]} - double{held[c * count + i]});
    }
  }
  std::iota(ranked_.begin(), ranked_.end(), 0u);
  for (Band& band : bands_) {
    band.next = band.begin;
    const auto first = ranked_.begin() + static_cast<std::ptrdiff_t>(band.begin);
    const auto last = ranked_.begin() + static_cast<std::ptrdiff_t>(band.end);
    // Of equal ones the first: the choice depends on the residual alone.
    std::sort(first, last, [this](std::uint32_t a, std::uint32_t b) {
      return residual_[a] != residual_[b] ? residual_[a] > residual_[b] : a < b;
    });
    band.error = 0;
    for (std::size_t i = band.begin; i < band.end; ++i) band.error += residual_[i];
  }
}

/// The band's next coefficient, when what is left of the band is above `least`; at 0 any that is
/// left, whatever rounding made of the sum.
bool ShBandPolicy::take(Band& band, double least) {
  if (band.next == band.end || (least > 0 && !(band.error > least))) return false;
  const std::uint32_t coefficient = ranked_[band.next];
  if (!(residual_[coefficient] > 0)) return false;
  ++band.next;
  band.error -= residual_[coefficient];
  chosen_.push_back(coefficient);
  return true;
}

std::span<const std::uint32_t> ShBandPolicy::choose(std::span<const float> target,
                                                    std::span<const float> held,
                                                    std::size_t budget) {
  RIMLIGHT_CHECK_EQ(target.size(), kChannels * residual_.size());
  RIMLIGHT_CHECK_EQ(held.size(), target.size());
  rank(target, held);
  chosen_.clear();
  double whole = 0;
  for (const float value : target) whole += std::abs(double{value});
  const auto wanted = static_cast<std::size_t>(
      std::ranges::count_if(residual_, [](double residual) { return residual > 0; }));
  const std::size_t most = std::min(budget, wanted);
  // A light that went black has no relative error: what is left of it goes first to last.
  double least = tolerance_ * whole;
  while (chosen_.size() < most) {
    for (Band& band : bands_) {
      while (chosen_.size() < most && take(band, least)) {
      }
    }
    least = least < 1e-30 ? 0 : least * kFall;
  }
  std::ranges::sort(chosen_);
  return chosen_;
}

}  // namespace rimlight
