#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include "core/curves/curve_material_state.h"
#include "core/curves/curve_transport.h"
#include "core/relight/frame_report.h"

namespace rimlight {

/// Which panels' T′ and `fixed` are those of the light and the materials that are asked for now,
/// and which are shown. Changes count up one version; a panel is fresh when it was made in the
/// version of the last change that concerns it, or later. One thread at a time; the transport
/// outlives it.
class PanelFreshness {
 public:
  explicit PanelFreshness(const CurveTransport& transport);

  /// A material's first state: it is shown on θ_h, or on θ_d, or on neither where it has no curve.
  void start(std::uint32_t material, const CurveMaterialState& state);
  /// All T′ and all `fixed` are stale.
  void change_light();
  /// The axis of a curve that alone was edited becomes the one that the material is shown on.
  void change_material(std::uint32_t material, const CurveStateChange& change,
                       const CurveMaterialState& next);

  /// What panels that are made now are made for.
  std::uint64_t version() const { return version_; }
  std::optional<CurveAxis> axis(std::uint32_t material) const { return materials_[material].axis; }
  /// The other axis that the material has a curve over.
  std::optional<CurveAxis> other_axis(std::uint32_t material) const {
    return materials_[material].other;
  }

  /// For the axis that its material is shown on, or for one of them; `fixed` included.
  bool is_fresh(std::uint32_t panel) const;
  bool is_fresh(std::uint32_t panel, CurveAxis axis) const;
  /// All panels of a material.
  bool all_fresh(std::uint32_t material) const;
  void list_stale(std::vector<std::uint32_t>& panels) const;
  void list_stale_of_other_axis(std::vector<std::uint32_t>& panels) const;

  /// What is shown of a panel is what it was made for last, and it is fresh.
  bool is_shown(std::uint32_t panel) const;
  bool all_shown(std::uint32_t material) const;
  void list_unshown(std::vector<std::uint32_t>& panels) const;
  void mark_shown(std::uint32_t panel);
  void mark_all_shown(std::uint32_t material);

  /// What is still to be made of T′ and of norms.
  Unfinished unfinished() const;

  /// Column norms were found of what is fresh.
  bool has_norms(std::uint32_t material) const;
  void mark_norms(std::uint32_t material);

 private:
  struct Material {
    std::optional<CurveAxis> axis, other;
    // The versions of the last changes of T′ by axis, of `fixed`, and of the axis that is shown.
    std::array<std::uint64_t, 2> transport{};
    std::uint64_t fixed = 0, shown = 0;
    std::uint64_t norms = 0;  // the version that they were found in
  };

  static std::size_t index(CurveAxis axis) { return axis == CurveAxis::half_angle ? 0 : 1; }
  const Material& material_of(std::uint32_t panel) const {
    return materials_[transport_->panels()[panel].material];
  }
  bool is_stale_on_other_axis(std::uint32_t panel) const;
  template <typename Is>
  void list(std::vector<std::uint32_t>& panels, const Is& is) const;
  template <typename Is>
  bool any(const Is& is) const;
  void show_on(Material& material, CurveAxis axis, const CurveMaterialState& state);

  const CurveTransport* transport_;
  std::uint64_t version_ = 1;
  std::vector<Material> materials_;
  std::vector<std::uint64_t> shown_;  // [panel]: the version that its shown rows were made in
};

}  // namespace rimlight
