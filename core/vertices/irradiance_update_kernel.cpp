// Compiled once for each SIMD target; the one in use is chosen at the first call.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "core/vertices/irradiance_update_kernel.cpp"
#include "core/vertices/irradiance_update_kernel.h"

#include <hwy/foreach_target.h>  // IWYU pragma: keep; before highway.h
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace rimlight::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;
using Floats = hn::CappedTag<float, 16>;
using Halves = hn::Rebind<hwy::float16_t, Floats>;

HWY_INLINE hn::Vec<Floats> load_half(const Half* from) {
  return hn::PromoteTo(Floats(), hn::Load(Halves(), reinterpret_cast<const hwy::float16_t*>(from)));
}

/// The sums of a vector of vertices stay in registers over all coefficients.
void add_lanes(const CoefficientUpdate& update, float* HWY_RESTRICT irradiance) {
  const Floats d;
  const std::size_t changed = update.coefficients.size();
  const std::size_t channel = update.channels == 1 ? 0 : update.count * kBatchVertices;
  for (std::size_t lane = 0; lane < kBatchVertices; lane += hn::Lanes(d)) {
    float* const to = irradiance + lane;
    auto red = hn::Load(d, to), green = hn::Load(d, to + kBatchVertices),
         blue = hn::Load(d, to + 2 * kBatchVertices);
    for (std::size_t k = 0; k < changed; ++k) {
      const Half* const from = update.transport + update.coefficients[k] * kBatchVertices + lane;
      const float* const delta = update.deltas.data() + k;
      const auto first = load_half(from);
      const auto second = channel == 0 ? first : load_half(from + channel);
      const auto third = channel == 0 ? first : load_half(from + 2 * channel);
      red = hn::MulAdd(hn::Set(d, delta[0]), first, red);
      green = hn::MulAdd(hn::Set(d, delta[changed]), second, green);
      blue = hn::MulAdd(hn::Set(d, delta[2 * changed]), third, blue);
    }
    hn::Store(red, d, to);
    hn::Store(green, d, to + kBatchVertices);
    hn::Store(blue, d, to + 2 * kBatchVertices);
  }
}

}  // namespace rimlight::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace rimlight {

HWY_EXPORT(add_lanes);

void add_coefficients(const CoefficientUpdate& update, float* irradiance) noexcept {
  HWY_DYNAMIC_DISPATCH(add_lanes)(update, irradiance);
}

}  // namespace rimlight
#endif  // HWY_ONCE
