#pragma once

#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <mutex>
#include <optional>
#include <span>
#include <vector>

#include "core/base/aligned_vector.h"
#include "core/curves/curve_basis.h"
#include "core/curves/curve_light.h"
#include "core/curves/curve_material_state.h"
#include "core/transport/curve_receivers.h"

namespace rimlight {

inline constexpr std::size_t kPanelRows = 64;
/// RGB of a panel's rows: [3][kPanelRows].
inline constexpr std::size_t kPanelFloats = 3 * kPanelRows;

/// Rows of one material and one tile: one thread's work. A row is what one receiver shows of the
/// material, in one surface or more.
struct CurvePanel {
  std::uint32_t material = 0;
  std::uint32_t tile = 0;
  std::uint32_t row_count = 0;  // ≤ kPanelRows; the rest is zero everywhere
  std::array<std::uint32_t, kPanelRows> receivers{};
  std::array<std::uint32_t, kPanelRows + 1> first_surface{};  // of each row
};
/// All surfaces, in their order. CheckFailure when they are not sorted as CurveReceivers says.
std::vector<CurvePanel> make_panels(const CurveReceivers& receivers);

/// T′ of editable materials: what each row shows is
///     B = fixed + Σ_k T̂_k ĉ_k
/// with the curve's coefficients ĉ (CurveBasis), on either axis,
///     T′_row,bin = Σ_surfaces share Σ_texels L V Σ_quarters [angle in bin] · q · cos⁺ θ_i · Δω,
/// with q the quotient BRDF times the other axis' curve, and point i of the surface in quarter i of
/// the texel; below a normal's horizon counts nothing (Ben-Artzi, Overbeck and Ramamoorthi 2006,
/// equation 7; the sum that bakes of direct light take too). `fixed` is the diffuse part, and the
/// whole lobe of models without factors.
///
/// Stored in 16 bits: a coefficient of a channel is a whole multiple of a step of its own in each
/// panel, 1/32767 of the largest of its 64 rows.
///
/// Panels are made one by one, in any order. Different panels may be made from several threads; a
/// panel that is being made may not be read. The receivers and what they view outlive it.
class CurveTransport {
 public:
  explicit CurveTransport(const CurveReceivers& receivers);

  std::span<const CurvePanel> panels() const { return panels_; }
  /// The index of each.
  std::vector<std::uint32_t> all_panels() const;
  const CurveReceivers& receivers() const { return receivers_; }
  std::size_t material_count() const { return receivers_.materials.size(); }
  const CurveBasis& basis(CurveAxis axis) const { return axes_[index(axis)].basis; }

  /// Makes T′ of a panel for one axis, and `fixed`, from a light of the visibility's size. `state`
  /// is the panel's material; it has the axis (CheckFailure). `version`, not 0, is what fresh_for()
  /// then answers. The first call for an axis allocates its T′: 96 KiB a panel.
  void rebuild(std::size_t panel, const CurveLight& light, const CurveMaterialState& state,
               CurveAxis axis, std::uint64_t version);
  /// Makes `fixed` alone.
  void rebuild_fixed(std::size_t panel, const CurveLight& light, const CurveMaterialState& state,
                     std::uint64_t version);
  /// The version that the panel's T′, or its `fixed`, was made for; 0 before the first. Any thread.
  std::uint64_t fresh_for(std::size_t panel, CurveAxis axis) const;
  std::uint64_t fixed_fresh_for(std::size_t panel) const;

  /// Numbers of T̂ [coefficient][3][kPanelRows] and their steps [coefficient][3]; empty before
  /// the axis was first asked for.
  std::span<const std::int16_t> numbers(std::size_t panel, CurveAxis axis) const;
  std::span<const float> steps(std::size_t panel, CurveAxis axis) const;
  /// [3][kPanelRows]
  std::span<const float> fixed(std::size_t panel) const;

  /// The Gram matrices T̂ᵀT̂ of one material and axis over its panels as they are now: from them
  /// come column norms and the exact L2 norm of any T̂ d. Takes some 0.1 ms a panel, on all cores;
  /// no panel may be made meanwhile. Same bits at any thread count.
  void find_norms(std::uint32_t material, CurveAxis axis);
  /// Σ_rows (T̂_k)² of a column, per channel, by the last find_norms(); zero before.
  Vec3d column_norm_squared(std::uint32_t material, CurveAxis axis, std::size_t coefficient) const;
  /// ‖T̂ d‖² over rows and channels, by the last find_norms(): an absolute squared error of the
  /// image. No estimate, but for rounding: 1e-7 (Σ_k ‖T̂_k d_k‖)².
  double squared_norm(std::uint32_t material, CurveAxis axis, const CurveCoefficients& d) const;

 private:
  void set_fixed(std::size_t panel, std::size_t row, const Vec3f& value);
  static std::size_t index(CurveAxis axis) { return axis == CurveAxis::half_angle ? 0 : 1; }

  struct Axis {
    explicit Axis(CurveAxis axis) : basis(axis) {}
    CurveBasis basis;
    std::once_flag allocated;
    AlignedVector<std::int16_t> numbers;
    AlignedVector<float> steps;
    std::vector<std::atomic<std::uint64_t>> version;  // [panel]
    std::vector<std::vector<double>> gram;            // [material][3][256][256]
  };

  CurveReceivers receivers_;
  std::vector<CurvePanel> panels_;
  std::array<Axis, 2> axes_{Axis(CurveAxis::half_angle), Axis(CurveAxis::difference_angle)};
  AlignedVector<float> fixed_;  // [panel][3][kPanelRows]
  std::vector<std::atomic<std::uint64_t>> fixed_version_;
};

}  // namespace rimlight
