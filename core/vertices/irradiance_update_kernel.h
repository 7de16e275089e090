#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "core/base/half.h"
#include "core/transport/vertex_transport.h"

namespace rimlight {

/// What some coefficients of a light change by, in one batch of transport.
struct CoefficientUpdate {
  const Half* transport = nullptr;  // [channels][count][kBatchVertices], 64-byte aligned
  std::size_t channels = 1;         // 1 or 3
  std::size_t count = 0;
  std::span<const std::uint32_t> coefficients;  // below count
  std::span<const float> deltas;                // [3][coefficients.size()]
};

/// irradiance[c] += Σ_k delta^c_k · transport^c_k, [3][kBatchVertices], 64-byte aligned; in the
/// order of the coefficients, lane by lane.
void add_coefficients(const CoefficientUpdate& update, float* irradiance) noexcept;

}  // namespace rimlight
