#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "core/transport/vertex_transport.h"

namespace rimlight {

/// What each coefficient of a light does to the irradiance of all vertices: Σ over vertices of the
/// squares of its column of M, [3][(n + 1)²].
std::vector<float> column_energies(const VertexTransportView& transport);

/// Which coefficients of a light a frame brings up to date, of all bands alike: those that take
/// most off the squared error of the irradiance, Σ over channels of (residual · column norm)²,
/// where columns are taken to be orthogonal. Next to ShBandPolicy it leaves a third to a half of
/// the error of a turning light, since it lets no band go stale for a lower one that is nearly
/// right.
///
/// Allocates nothing after its first choice. One thread at a time; the same choice for the same
/// residual.
class ShBenefitPolicy {
 public:
  /// `energies` as column_energies() gives them; finite and ≥ 0, else CheckFailure.
  explicit ShBenefitPolicy(std::vector<float> energies);

  /// At most `budget` coefficients, in rising order, each of which lowers the error. target and
  /// held: [3][(n + 1)²], else CheckFailure. Valid until the next call.
  std::span<const std::uint32_t> choose(std::span<const float> target, std::span<const float> held,
                                        std::size_t budget);

 private:
  std::vector<float> energies_;
  std::vector<double> gain_;  // [coefficient]
  std::vector<std::uint32_t> ranked_;
};

}  // namespace rimlight
