#pragma once

#include <span>
#include <string>
#include <vector>

#include "core/curves/curve_material_state.h"
#include "core/relight/design_state.h"
#include "core/transport/curve_receivers.h"

namespace rimlight {

/// What a design state sets of a material; nothing set for one that it does not name.
MaterialEdit edit_of(const DesignState& state, const std::string& material);

/// What a state asks of a bake's materials and its images do not show, in words for people: lobes
/// finer than the light's texels, fields that a model does not have, the light that edited
/// materials send to others, materials that are not among the editable ones. `states`: [material].
std::vector<std::string> unshown_edits(const CurveReceivers& receivers,
                                       std::span<const CurveMaterialState> states,
                                       const DesignState& state);

}  // namespace rimlight
