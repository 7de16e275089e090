#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>

#include "core/basis/cube_haar.h"
#include "core/light/cube_light.h"
#include "core/relight/held_light.h"
#include "core/relight/update_plan.h"

namespace rimlight {

/// How much one update may apply: columns counted, as in the papers (an RGB coefficient counts
/// once), or the bytes that it moves.
struct Budget {
  enum class Unit : std::uint8_t { coefficients, bytes };
  Unit unit = Unit::coefficients;
  std::size_t amount = 0;

  static constexpr Budget coefficients(std::size_t amount) { return {Unit::coefficients, amount}; }
  static constexpr Budget bytes(std::size_t amount) { return {Unit::bytes, amount}; }
};

/// What an update is planned from. Lights are coefficients in the basis' order.
struct PlanRequest {
  const CubeHaar& basis;
  const CubeLight& target;  // asked for
  HeldLight held;           // what the image shows
  Budget budget;

  // What is known of M's columns; empty where it is not.
  std::span<const float> column_norm_squared = {};   // [3][columns]: Σ M² over receivers, ≥ 0
  std::span<const std::uint32_t> column_bytes = {};  // [columns]: what applying a column reads
  std::size_t band_image_bytes = 0;                  // what clearing one band's image B_b writes
  /// The image is one of all bands: they are reset together or not at all.
  bool one_image = false;

  // The same of the columns' layers. With both, a policy may choose layers by themselves.
  std::span<const float> part_norm_squared = {};   // [3][parts]
  std::span<const std::uint32_t> part_bytes = {};  // [parts]
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
/// The same from each layer's held light, weighed by the layers' shares.
double weighted_distance(const CubeHaar& basis, const CubeLight& target, const HeldLight& held,
                         const std::array<float, kLayers>& shares);
/// The same distance from the black light.
double weighted_size(const CubeHaar& basis, const CubeLight& a);

/// Storage that planning reuses from frame to frame. Holds nothing that a plan depends on.
class PlanWorkspace {
 public:
  struct Storage;

  PlanWorkspace();
  PlanWorkspace(PlanWorkspace&&) noexcept;
  PlanWorkspace& operator=(PlanWorkspace&&) noexcept;
  ~PlanWorkspace();

  Storage& storage() { return *storage_; }

 private:
  std::unique_ptr<Storage> storage_;
};

/// Decides how held becomes more like target within a budget: see policies.h for each, and
/// policy_settings.h for their names. Immutable; any thread.
class UpdatePolicy {
 public:
  virtual ~UpdatePolicy() = default;

  /// A pure function of the request: replaces `plan`, allocates nothing once plan and workspace
  /// have grown. Never above the budget. The plan's columns ascend, and those whose delta is zero
  /// are left out; a column is whole unless the policy says otherwise; of equals the lower index
  /// goes first; a band that would be incremented by no column is held. Throws Error when the
  /// request lacks what the policy or the budget weighs by.
  void make_plan(const PlanRequest& request, PlanWorkspace& workspace, UpdatePlan& plan) const;

 private:
  virtual void plan_checked(const PlanRequest& request, PlanWorkspace::Storage& storage,
                            UpdatePlan& plan) const = 0;
};

}  // namespace rimlight
