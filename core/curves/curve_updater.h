#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <vector>

#include "core/base/aligned_vector.h"
#include "core/curves/curve_column_kernel.h"
#include "core/curves/curve_transport.h"
#include "core/relight/cost_model.h"
#include "core/relight/frame_update.h"

namespace rimlight {

/// Which coefficients a frame applies.
///   nwa      a material that is not at its target starts from zero; the largest of the target
///   bi       the largest of target − held
///   benefit  the largest (target − held)² · the column's squared norm: what each takes off the
///            squared error of the image, by itself
enum class CurvePolicy : std::uint8_t { nwa, bi, benefit };

/// How one update came about.
struct CurveUpdateReport {
  std::size_t columns = 0;
  std::size_t bytes = 0;           // of T̂, read for them
  std::size_t panels_rebuilt = 0;  // against drift
  double plan_ms = 0;
  double apply_ms = 0;
};

/// Holds what rows show, and the curves that they show: B_row = fixed + T̂ · held, on one axis of
/// each material (or none). Moves held towards target within a budget, column by column.
///
/// The same calls give the same bits at any thread count, but for budgets in milliseconds.
/// Each addition rounds a sum by at most 2⁻²⁴ of it, so that n of them leave an error of about
/// √(n/3) · 2⁻²⁴; each panel is made afresh from what is held once in kMostAdditions columns, as in
/// Relighter. Allocates nothing after it is made. One thread at a time; computes on all cores. The
/// transport outlives it; none of its panels is made while a method runs.
class CurveUpdater {
 public:
  CurveUpdater(const CurveTransport& transport, CurvePolicy policy);

  /// What a material's rows show from now on is T̂ of `axis` times `held`: one fresh product over
  /// its panels. No axis: `fixed` alone.
  void show(std::uint32_t material, std::optional<CurveAxis> axis, const CurveCoefficients& held);
  /// A panel was made anew: one fresh product with what is held.
  void refresh(std::size_t panel);

  /// The curve asked for; on the axis that is shown.
  void set_target(std::uint32_t material, const CurveCoefficients& target);
  /// Applies what the policy chooses. Never above a budget of coefficients or bytes; within one of
  /// milliseconds at least one column while a target is not held.
  CurveUpdateReport update(const FrameBudget& budget);
  /// All targets held, by one fresh product in ascending order of coefficients: bits that depend on
  /// the targets alone. `abandon` as in Relighter::apply_exact.
  [[nodiscard]] bool apply_exact(const std::function<bool()>& abandon);

  std::optional<CurveAxis> axis(std::uint32_t material) const { return shown_[material].axis; }
  const CurveCoefficients& held(std::uint32_t material) const { return shown_[material].held; }
  const CurveCoefficients& target(std::uint32_t material) const { return shown_[material].target; }
  bool is_at_target(std::uint32_t material) const { return held(material) == target(material); }
  /// ‖T̂ (target − held)‖² over all materials: the absolute squared error that curves still lack.
  double squared_error() const;

  /// B of a panel's rows, [3][kPanelRows].
  std::span<const float> image(std::size_t panel) const;

  static constexpr std::size_t kMostAdditions = 80'000;

 private:
  struct Shown {
    std::optional<CurveAxis> axis;
    CurveCoefficients held{}, target{};
    std::size_t column_bytes = 0;      // of all panels
    std::vector<CurveColumn> columns;  // of the batch, ascending
    bool starts_from_zero = false;     // the batch does
    // Against drift.
    std::uint32_t panel_count = 0;
    std::size_t rebuild_credit = 0;  // panels · columns added since one was rebuilt
    std::uint32_t next_rebuilt = 0;  // of its panels, in turn
    std::uint32_t rebuilt = 0;       // in this batch
  };
  /// A column that a batch may add.
  struct Choice {
    double gain = 0, size = 0;
    std::uint32_t material = 0, coefficient = 0;

    bool goes_before(const Choice& other) const;
  };

  void list_choices();
  /// Fills the columns of all materials; their bytes.
  std::size_t choose(const FrameBudget& budget);
  void apply_choice(CurveUpdateReport& report);
  bool apply_batch(const FrameBudget& budget, CurveUpdateReport& report);
  void update_until(double deadline_ms, CurveUpdateReport& report);
  void choose_rebuilt(Shown& shown);
  bool is_rebuilt(const Shown& shown, std::uint32_t panel) const;
  void apply_to(std::size_t panel, float* image) const;
  void make_fresh(std::size_t panel, const CurveCoefficients& curve, float* image) const;

  const CurveTransport& transport_;
  CurvePolicy policy_;
  std::vector<Shown> shown_;                      // [material]
  std::vector<std::uint32_t> place_in_material_;  // [panel]: which of its material's panels
  AlignedVector<float> image_;                    // [panel][3][kPanelRows]
  AlignedVector<float> fresh_;                    // where the exact product grows
  std::vector<Choice> choices_;
  CostModel cost_;
};

}  // namespace rimlight
