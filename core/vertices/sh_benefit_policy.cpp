#include "core/vertices/sh_benefit_policy.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/base/check.h"
#include "core/base/parallel.h"

namespace rimlight {
namespace {

constexpr std::size_t kChannels = 3;

}  // namespace

std::vector<float> column_energies(const VertexTransportView& transport) {
  const std::size_t count = sh::coefficient_count(transport.irradiance_degree);
  const std::size_t channels = transport.irradiance_channels;
  const std::size_t batches = batch_count(transport.vertex_count);
  RIMLIGHT_CHECK_EQ(transport.irradiance.size(), batches * channels * count * kBatchVertices);
  std::vector<float> energies(kChannels * count);
  parallel_for(channels * count, [&](std::size_t column) {
    double sum = 0;
    for (std::size_t batch = 0; batch < batches; ++batch) {
      const std::size_t first = (batch * channels * count + column) * kBatchVertices;
      for (const Half value : transport.irradiance.subspan(first, kBatchVertices)) {
        sum += double{to_float(value)} * double{to_float(value)};
      }
    }
    energies[column] = static_cast<float>(sum);
  });
  // What has no colour is in one channel.
  for (std::size_t c = channels; c < kChannels; ++c) {
    std::copy_n(energies.begin(), count, energies.begin() + static_cast<std::ptrdiff_t>(c * count));
  }
  return energies;
}

ShBenefitPolicy::ShBenefitPolicy(std::vector<float> energies) : energies_(std::move(energies)) {
  RIMLIGHT_CHECK_EQ(energies_.size() % kChannels, 0u);
  for (const float energy : energies_) RIMLIGHT_CHECK(std::isfinite(energy) && energy >= 0);
  gain_.resize(energies_.size() / kChannels);
  ranked_.reserve(gain_.size());
}

std::span<const std::uint32_t> ShBenefitPolicy::choose(std::span<const float> target,
                                                       std::span<const float> held,
                                                       std::size_t budget) {
  RIMLIGHT_CHECK_EQ(target.size(), energies_.size());
  RIMLIGHT_CHECK_EQ(held.size(), energies_.size());
  const std::size_t count = gain_.size();
  ranked_.clear();
  for (std::size_t i = 0; i < count; ++i) {
    gain_[i] = 0;
    for (std::size_t at = i; at < energies_.size(); at += count) {
      const double residual = double{target[at]} - double{held[at]};
      gain_[i] += residual * residual * double{energies_[at]};
    }
    if (gain_[i] > 0) ranked_.push_back(static_cast<std::uint32_t>(i));
  }
  if (budget < ranked_.size()) {
    const auto last = ranked_.begin() + static_cast<std::ptrdiff_t>(budget);
    // Of equal ones the first: the choice depends on the residual alone.
    std::nth_element(ranked_.begin(), last, ranked_.end(),
                     [this](std::uint32_t a, std::uint32_t b) {
                       return gain_[a] != gain_[b] ? gain_[a] > gain_[b] : a < b;
                     });
    ranked_.erase(last, ranked_.end());
    std::ranges::sort(ranked_);
  }
  return ranked_;
}

}  // namespace rimlight
