#include "core/vertices/panel_transport.h"

#include <algorithm>
#include <functional>

#include "core/base/check.h"
#include "core/base/parallel.h"
#include "core/vertices/vertex_product_kernel.h"

namespace rimlight {

void PanelTransport::assign(const Shape& shape, const Fill& fill) {
  RIMLIGHT_CHECK(shape.channels == 1 || shape.channels == kLightChannels);
  sh::check_degree(shape.degree);
  shape_ = shape;
  const std::size_t size = shape.channels * sh::coefficient_count(shape.degree) * kBatchVertices;
  values_.resize(panel_count() * size);
  const auto bands = static_cast<std::size_t>(shape.degree) + 1;
  band_squares_.assign(panel_count() * shape.channels * bands, 0.0f);
  last_band_.clear();
  const auto body = [&](std::size_t panel) {
    thread_local AlignedVector<float> values;
    if (values.size() < size) values.resize(size);
    fill(panel, std::span(values).first(size));
    store(panel, std::span(values).first(size));
  };
  parallel_for(panel_count(), std::cref(body));
}

void PanelTransport::store(std::size_t panel, std::span<const float> values) {
  store_halves(values, values_.data() + panel * values.size());
  const auto bands = static_cast<std::size_t>(shape_.degree) + 1;
  const std::size_t channel = values.size() / shape_.channels;
  const std::size_t lanes = std::min(kBatchVertices, shape_.vertices - panel * kBatchVertices);
  for (std::size_t c = 0; c < shape_.channels; ++c) {
    float* const squares = band_squares_.data() + (panel * shape_.channels + c) * bands;
    for (std::size_t k = 0; k < bands; ++k) {
      const float* const band = values.data() + c * channel + k * k * kBatchVertices;
      squares[k] = sum_of_squares({band, (2 * k + 1) * kBatchVertices}) / static_cast<float>(lanes);
    }
  }
}

void PanelTransport::choose_bands(std::span<const float> light, float tolerance) {
  const std::size_t given = light.size() / kLightChannels;
  const int last = std::min(shape_.degree, sh::degree_of_count(given));
  const auto bands = static_cast<std::size_t>(shape_.degree) + 1;
  light_.assign(kLightChannels * bands, 0.0f);
  for (std::size_t c = 0; c < kLightChannels; ++c) {
    for (std::size_t k = 0; k <= static_cast<std::size_t>(last); ++k) {
      const float* const band = light.data() + c * given + k * k;
      float square = 0;
      for (std::size_t m = 0; m <= 2 * k; ++m) square += band[m] * band[m];
      light_[c * bands + k] = square / static_cast<float>(2 * k + 1);
    }
  }
  last_band_.resize(panel_count());
  for (std::size_t panel = 0; panel < panel_count(); ++panel) {
    std::array<float, kLightChannels> dropped{};
    int k = last;
    for (; k > 0; --k) {
      for (std::size_t c = 0; c < kLightChannels; ++c) {
        const std::size_t of = panel * shape_.channels + (shape_.channels == 1 ? 0 : c);
        dropped[c] += band_squares_[of * bands + static_cast<std::size_t>(k)] *
                      light_[c * bands + static_cast<std::size_t>(k)];
      }
      if (!(*std::ranges::max_element(dropped) <= tolerance * tolerance) || tolerance <= 0) break;
    }
    last_band_[panel] = k;
  }
}

void PanelTransport::apply(std::span<const float> light, std::span<float> to) const {
  constexpr std::size_t kSums = kLightChannels * kBatchVertices;
  RIMLIGHT_CHECK_EQ(last_band_.size(), panel_count());
  RIMLIGHT_CHECK_EQ(to.size(), panel_count() * kSums);
  const std::size_t given = light.size() / kLightChannels;
  const std::size_t count = sh::coefficient_count(shape_.degree);
  const auto body = [&](std::size_t panel) {
    const std::size_t used = std::min(given, sh::coefficient_count(last_band_[panel]));
    sum_batch({values_.data() + panel * shape_.channels * count * kBatchVertices, shape_.channels,
               count, light.data(), given, used},
              to.data() + panel * kSums);
  };
  parallel_for(panel_count(), std::cref(body));
}

double PanelTransport::left_out() const {
  std::size_t used = 0;
  for (const int last : last_band_) used += sh::coefficient_count(last);
  const std::size_t all = last_band_.size() * sh::coefficient_count(shape_.degree);
  return all == 0 ? 0 : 1 - static_cast<double>(used) / static_cast<double>(all);
}

}  // namespace rimlight
