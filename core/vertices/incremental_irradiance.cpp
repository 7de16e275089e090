#include "core/vertices/incremental_irradiance.h"

#include <algorithm>

#include "core/base/check.h"
#include "core/base/parallel.h"
#include "core/vertices/irradiance_update_kernel.h"
#include "core/vertices/vertex_product_kernel.h"

namespace rimlight {
namespace {

constexpr std::size_t kBatchFloats = kLightChannels * kBatchVertices;

}  // namespace

IncrementalIrradiance::IncrementalIrradiance(const VertexTransportView& transport)
    : transport_(transport), count_(sh::coefficient_count(transport.irradiance_degree)) {
  RIMLIGHT_CHECK(transport.irradiance_channels == 1 || transport.irradiance_channels == 3);
  RIMLIGHT_CHECK_EQ(transport.irradiance.size(),
                    batches() * transport.irradiance_channels * count_ * kBatchVertices);
  held_.resize(kLightChannels * count_);
  irradiance_.resize(batches() * kBatchFloats);
}

const Half* IncrementalIrradiance::batch(std::size_t index) const {
  return transport_.irradiance.data() +
         index * transport_.irradiance_channels * count_ * kBatchVertices;
}

void IncrementalIrradiance::sum_afresh(std::size_t index) {
  sum_batch({.transport = batch(index),
             .channels = transport_.irradiance_channels,
             .transport_stride = count_,
             .light = held_.data(),
             .light_stride = count_,
             .count = count_},
            irradiance_.data() + index * kBatchFloats);
}

std::size_t IncrementalIrradiance::batches_due(std::size_t additions) {
  credit_ = std::min(credit_ + additions * batches(), kMostAdditions * batches());
  const std::size_t due = credit_ / kMostAdditions;
  credit_ -= due * kMostAdditions;
  return due;
}

void IncrementalIrradiance::update(std::span<const std::uint32_t> coefficients,
                                   std::span<const float> target) {
  RIMLIGHT_CHECK_EQ(target.size(), held_.size());
  RIMLIGHT_CHECK(coefficients.empty() || coefficients.back() < count_);
  const std::size_t changed = coefficients.size();
  deltas_.resize(kLightChannels * changed);
  for (std::size_t c = 0; c < kLightChannels; ++c) {
    for (std::size_t k = 0; k < changed; ++k) {
      const std::size_t at = c * count_ + coefficients[k];
      deltas_[c * changed + k] = target[at] - held_[at];
      held_[at] = target[at];
    }
  }
  if (changed == 0) return;
  const std::size_t due = batches_due(changed);
  parallel_for(batches(), [&](std::size_t i) {
    const std::size_t index = (next_ + i) % batches();
    if (i < due) {
      sum_afresh(index);
    } else {
      add_coefficients(
          {batch(index), transport_.irradiance_channels, count_, coefficients, deltas_},
          irradiance_.data() + index * kBatchFloats);
    }
  });
  next_ = (next_ + due) % batches();
}

void IncrementalIrradiance::set(std::span<const float> target) {
  RIMLIGHT_CHECK_EQ(target.size(), held_.size());
  std::ranges::copy(target, held_.begin());
  credit_ = 0;
  parallel_for(batches(), [this](std::size_t index) { sum_afresh(index); });
}

}  // namespace rimlight
