#include "core/curves/panel_freshness.h"

#include <algorithm>

namespace rimlight {
namespace {

CurveAxis opposite(CurveAxis axis) {
  return axis == CurveAxis::half_angle ? CurveAxis::difference_angle : CurveAxis::half_angle;
}

}  // namespace

PanelFreshness::PanelFreshness(const CurveTransport& transport)
    : transport_(&transport),
      materials_(transport.material_count()),
      shown_(transport.panels().size()) {}

void PanelFreshness::show_on(Material& material, CurveAxis axis, const CurveMaterialState& state) {
  const auto before = material.axis;
  material.axis = material.other = std::nullopt;
  for (const CurveAxis each : {axis, opposite(axis)}) {
    if (!state.has(each)) continue;
    (material.axis ? material.other : material.axis) = each;
  }
  if (material.axis != before) material.shown = version_;
}

void PanelFreshness::start(std::uint32_t material, const CurveMaterialState& state) {
  Material& of = materials_[material];
  show_on(of, CurveAxis::half_angle, state);
  of.transport = {version_, version_};
  of.fixed = of.shown = version_;
}

void PanelFreshness::change_light() {
  ++version_;
  for (Material& material : materials_) {
    material.transport = {version_, version_};
    material.fixed = version_;
  }
}

void PanelFreshness::change_material(std::uint32_t material, const CurveStateChange& change,
                                     const CurveMaterialState& next) {
  if (!change.any()) return;
  ++version_;
  Material& of = materials_[material];
  for (const CurveAxis axis : {CurveAxis::half_angle, CurveAxis::difference_angle}) {
    if (change.transport(axis)) of.transport[index(axis)] = version_;
  }
  if (change.fixed) of.fixed = version_;
  CurveAxis axis = of.axis.value_or(CurveAxis::half_angle);
  if (change.half_angle != change.difference_angle) {
    axis = change.half_angle ? CurveAxis::half_angle : CurveAxis::difference_angle;
  }
  show_on(of, axis, next);
}

bool PanelFreshness::is_fresh(std::uint32_t panel, CurveAxis axis) const {
  return transport_->fresh_for(panel, axis) >= material_of(panel).transport[index(axis)];
}

bool PanelFreshness::is_fresh(std::uint32_t panel) const {
  const Material& material = material_of(panel);
  if (transport_->fixed_fresh_for(panel) < material.fixed) return false;
  return !material.axis || is_fresh(panel, *material.axis);
}

bool PanelFreshness::all_fresh(std::uint32_t material) const {
  for (std::uint32_t panel = 0; panel < shown_.size(); ++panel) {
    if (transport_->panels()[panel].material == material && !is_fresh(panel)) return false;
  }
  return true;
}

template <typename Is>
void PanelFreshness::list(std::vector<std::uint32_t>& panels, const Is& is) const {
  panels.clear();
  for (std::uint32_t panel = 0; panel < shown_.size(); ++panel) {
    if (is(panel)) panels.push_back(panel);
  }
}

template <typename Is>
bool PanelFreshness::any(const Is& is) const {
  for (std::uint32_t panel = 0; panel < shown_.size(); ++panel) {
    if (is(panel)) return true;
  }
  return false;
}

void PanelFreshness::list_stale(std::vector<std::uint32_t>& panels) const {
  list(panels, [this](std::uint32_t panel) { return !is_fresh(panel); });
}

bool PanelFreshness::is_stale_on_other_axis(std::uint32_t panel) const {
  const auto other = material_of(panel).other;
  return other && !is_fresh(panel, *other);
}

void PanelFreshness::list_stale_of_other_axis(std::vector<std::uint32_t>& panels) const {
  list(panels, [this](std::uint32_t panel) { return is_stale_on_other_axis(panel); });
}

void PanelFreshness::list_unshown(std::vector<std::uint32_t>& panels) const {
  list(panels, [this](std::uint32_t panel) { return !is_shown(panel); });
}

bool PanelFreshness::is_shown(std::uint32_t panel) const {
  const Material& material = material_of(panel);
  std::uint64_t least = std::max(material.fixed, material.shown);
  if (material.axis) least = std::max(least, material.transport[index(*material.axis)]);
  return shown_[panel] >= least;
}

bool PanelFreshness::all_shown(std::uint32_t material) const {
  for (std::uint32_t panel = 0; panel < shown_.size(); ++panel) {
    if (transport_->panels()[panel].material == material && !is_shown(panel)) return false;
  }
  return true;
}

void PanelFreshness::mark_shown(std::uint32_t panel) { shown_[panel] = version_; }

void PanelFreshness::mark_all_shown(std::uint32_t material) {
  for (std::uint32_t panel = 0; panel < shown_.size(); ++panel) {
    if (transport_->panels()[panel].material == material) mark_shown(panel);
  }
}

Unfinished PanelFreshness::unfinished() const {
  if (any([this](std::uint32_t panel) { return !is_fresh(panel); })) {
    return Unfinished::exact_frame;
  }
  bool all_norms = true;
  for (std::uint32_t m = 0; m < materials_.size(); ++m) all_norms &= has_norms(m);
  const bool is_other_axis_stale =
      any([this](std::uint32_t panel) { return is_stale_on_other_axis(panel); });
  return all_norms && !is_other_axis_stale ? Unfinished::nothing : Unfinished::next_edits;
}

bool PanelFreshness::has_norms(std::uint32_t material) const {
  const Material& of = materials_[material];
  return !of.axis || of.norms >= std::max(of.shown, of.transport[index(*of.axis)]);
}

void PanelFreshness::mark_norms(std::uint32_t material) { materials_[material].norms = version_; }

}  // namespace rimlight
