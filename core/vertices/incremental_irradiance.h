#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "core/base/aligned_vector.h"
#include "core/transport/vertex_transport.h"

namespace rimlight {

/// Irradiance of all vertices, and the light that it shows: E = M · L̃, kept up with a target by
/// changing some coefficients a frame, E += M ΔL (Overbeck 2006, eq. 4.2, in spherical harmonics).
///
/// The same calls give the same bits at any number of threads. Allocates nothing after the first
/// frames. One thread at a time; computes on all cores.
class IncrementalIrradiance {
 public:
  /// Black, under a black light. The transport must outlive it; CheckFailure when its sizes do not
  /// fit each other.
  explicit IncrementalIrradiance(const VertexTransportView& transport);

  /// The light that is shown, L̃: [3][(n + 1)²].
  std::span<const float> held() const { return held_; }
  /// [batch][3][kBatchVertices].
  std::span<const float> irradiance() const { return irradiance_; }

  /// Brings the named coefficients (rising, below (n + 1)²) of the held light to the target's,
  /// [3][(n
  /// + 1)²]. Some batches are summed afresh from the held light, each about once in kMostAdditions
  /// coefficients, so that rounding never shows (see Relighter::apply()).
  void update(std::span<const std::uint32_t> coefficients, std::span<const float> target);

  /// One fresh product with the whole target, which is held then: bits that depend on it alone.
  void set(std::span<const float> target);

  static constexpr std::size_t kMostAdditions = 80'000;

 private:
  std::size_t batches() const { return batch_count(transport_.vertex_count); }
  const Half* batch(std::size_t index) const;
  std::size_t batches_due(std::size_t additions);
  void sum_afresh(std::size_t batch);

  VertexTransportView transport_;
  std::size_t count_;  // (n + 1)²
  AlignedVector<float> held_, irradiance_, deltas_;
  std::size_t next_ = 0;    // batch to be summed afresh
  std::size_t credit_ = 0;  // batches · additions since one was
};

}  // namespace rimlight
