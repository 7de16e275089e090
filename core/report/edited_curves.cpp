#include "core/report/edited_curves.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <string>
#include <utility>

#include "core/base/check.h"
#include "core/base/error.h"
#include "core/base/parallel.h"
#include "core/base/stopwatch.h"
#include "core/curves/quick_image.h"

namespace rimlight {
namespace {

constexpr std::uint64_t kSampleSeed = 1;

CurveReceivers receivers_of(const Bake& bake) {
  if (!bake.has_curves()) {
    throw Error(bake.folder().string(), "no editable materials", "a bake of kind \"brdf_curve\"");
  }
  return bake.curve_receivers();
}

std::uint32_t find_material(const CurveReceivers& receivers, const std::string& name,
                            const std::string& where) {
  std::string names;
  for (std::uint32_t m = 0; m < receivers.materials.size(); ++m) {
    if (receivers.materials[m].name == name) return m;
    names += " " + quote(receivers.materials[m].name);
  }
  throw Error(where, "the material " + quote(name), "one of the bake's editable ones:" + names);
}

void set_curve(MaterialEdit& edit, CurveAxis axis, CurveEdit curve) {
  (axis == CurveAxis::half_angle ? edit.half_angle : edit.difference_angle) = std::move(curve);
}

}  // namespace

EditedCurves::EditedCurves(const Bake& bake, const CurveSession& session, const CubeLight& texels)
    : session_(session),
      receivers_(receivers_of(bake)),
      sky_(receivers_.visibility.cube_size),
      light_(sky_, texels, 0),
      transport_(receivers_),
      edits_(receivers_.materials.size()),
      axes_(receivers_.materials.size()) {
  for (const CurveMaterial& material : receivers_.materials) {
    states_.push_back(resolve(material, {}, {}, "material " + material.name));
  }
  for (const CurveStroke& stroke : session.strokes) {
    const std::string where = session.name + ": " + stroke.title;
    const std::uint32_t m = find_material(receivers_, stroke.material, where);
    if (!states_[m].has(stroke.axis)) {
      MaterialEdit edit;
      set_curve(edit, stroke.axis, stroke.to);
      throw Error(where, unavailable(receivers_.materials[m], edit).at(0),
                  "a curve that the model has");
    }
    material_of_stroke_.push_back(m);
  }
}

CurveCoefficients EditedCurves::target(std::uint32_t material) const {
  const auto axis = axes_[material];
  if (!axis) return {};
  return transport_.basis(*axis).coefficients(*states_[material].curve(*axis));
}

std::size_t EditedCurves::row_count() const {
  std::size_t count = 0;
  for (const CurvePanel& panel : transport_.panels()) count += panel.row_count;
  return count;
}

EditedCurves::Made EditedCurves::make(std::uint32_t material, std::optional<CurveAxis> axis) {
  Made made{material, 0, 0};
  axes_[material] = axis;
  ++version_;
  Stopwatch watch;
  parallel_for(transport_.panels().size(), [&](std::size_t panel) {
    if (transport_.panels()[panel].material != material) return;
    if (axis) {
      transport_.rebuild(panel, light_, states_[material], *axis, version_);
    } else {
      transport_.rebuild_fixed(panel, light_, states_[material], version_);
    }
  });
  made.transport_ms = watch.lap_ms();
  if (axis) transport_.find_norms(material, *axis);
  made.norms_ms = watch.lap_ms();
  return made;
}

std::vector<EditedCurves::Made> EditedCurves::make_all() {
  std::vector<Made> all;
  for (std::uint32_t m = 0; m < states_.size(); ++m) {
    const auto first = std::ranges::find(material_of_stroke_, m);
    std::optional<CurveAxis> axis;
    if (first != material_of_stroke_.end()) {
      axis = session_.strokes[static_cast<std::size_t>(first - material_of_stroke_.begin())].axis;
    } else {
      for (const CurveAxis each : {CurveAxis::half_angle, CurveAxis::difference_angle}) {
        if (!axis && states_[m].has(each)) axis = each;
      }
    }
    all.push_back(make(m, axis));
  }
  return all;
}

std::optional<EditedCurves::Made> EditedCurves::make_for(std::size_t stroke) {
  const std::uint32_t m = material_of_stroke_[stroke];
  const CurveAxis axis = session_.strokes[stroke].axis;
  if (axes_[m] == axis) return std::nullopt;
  return make(m, axis);
}

void EditedCurves::go_to(const CurveSession::Place& place) {
  const CurveStroke& stroke = session_.strokes[place.stroke];
  const std::uint32_t m = material_of_stroke_[place.stroke];
  RIMLIGHT_CHECK(axes_[m] == stroke.axis);
  set_curve(edits_[m], stroke.axis, stroke.at(place.step));
  states_[m] = resolve(receivers_.materials[m], edits_[m], {}, session_.name + ": " + stroke.title);
}

double EditedCurves::distance_to_sums(std::span<const float> image, std::size_t sample) const {
  std::vector<std::uint32_t> all(transport_.panels().size());
  std::iota(all.begin(), all.end(), 0u);
  return std::sqrt(QuickShader(transport_, states_)
                       .sampled_squared_error(light_, all, image, sample, kSampleSeed));
}

}  // namespace rimlight
