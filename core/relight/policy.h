#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "core/basis/cube_haar.h"
#include "core/light/cube_light.h"
#include "core/relight/update_plan.h"

namespace rimlight {

/// What an update is planned from. Lights are coefficients in the basis' order.
struct PlanRequest {
  const CubeHaar& basis;
  const CubeLight& target;             // asked for
  const CubeLight& held;               // what the image shows
  std::size_t coefficient_budget = 0;  // an RGB coefficient counts once
};

/// The weight of a coefficient of a band when sizes are compared across bands: √area, the area
/// counted in texels of the finest level under its wavelet.
///
/// The papers weight by area (Ng 2003; Overbeck 2006, §6.1) coefficients c of wavelets that are ±1
/// on their support A. Ours are orthonormal, ±1/√A there: the same term of the light is
/// c ψ = (c √A) (ψ / √A), so our coefficient is c √A, and area · |c| = √A · |ours|. It is the L1
/// norm of the term over the cube map, the measure in which the papers report errors.
double area_weight(const CubeHaar& basis, int band);

/// Σ over coefficients of area weight · Σ over channels of |a − b|.
double weighted_distance(const CubeHaar& basis, const CubeLight& a, const CubeLight& b);
/// The same distance from the black light.
double weighted_size(const CubeHaar& basis, const CubeLight& a);

/// Storage that planning reuses from frame to frame.
struct PlanWorkspace {
  std::vector<std::uint64_t> candidates;  // size in the high half, ~index in the low one
};

/// Decides how held becomes more like target within a budget. Immutable; any thread.
class UpdatePolicy {
 public:
  virtual ~UpdatePolicy() = default;
  virtual const char* name() const = 0;

  /// A pure function of the request: replaces `plan`, allocates nothing once plan and workspace
  /// have grown. All bands' candidates are compared together by weighted size, |channels| summed:
  /// target in reset bands, target − held in the others; those of size zero are none. Equal sizes
  /// go to the lower index.
  void make_plan(const PlanRequest& request, PlanWorkspace& workspace, UpdatePlan& plan) const;

 private:
  /// reset or increment, given one band's coefficients [3][count of band].
  struct BandLight {
    std::span<const float> target[3];
    std::span<const float> held[3];
  };
  virtual BandAction choose(const BandLight& band) const = 0;

  friend class NwaPolicy;
  friend class PbiPolicy;
};

/// Non-incremental wavelet approximation (Ng, Ramamoorthi and Hanrahan 2003): all bands start from
/// zero in every frame.
class NwaPolicy final : public UpdatePolicy {
 public:
  const char* name() const override { return "nwa"; }

 private:
  BandAction choose(const BandLight& band) const override;
};

/// Per-band incremental with the simple test (Overbeck 2006, §6.2.2): a band is incremented when
/// ‖target − held‖₁ < ‖target‖₁ over its coefficients and channels, else reset. So the first frame
/// resets all bands.
class PbiPolicy final : public UpdatePolicy {
 public:
  const char* name() const override { return "pbi"; }

 private:
  BandAction choose(const BandLight& band) const override;
};

}  // namespace rimlight
