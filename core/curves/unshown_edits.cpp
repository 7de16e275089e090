#include "core/curves/unshown_edits.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/curves/lobe_width.h"

namespace rimlight {
namespace {

/// With one decimal.
std::string texel_degrees(int cube_size) {
  const long tenths = std::lround(texel_width(cube_size) * 1800 / std::numbers::pi);
  return std::to_string(tenths / 10) + "." + std::to_string(tenths % 10);
}

}  // namespace

MaterialEdit edit_of(const DesignState& state, const std::string& material) {
  const auto found = state.materials.find(material);
  return found == state.materials.end() ? MaterialEdit{} : found->second;
}

std::vector<std::string> unshown_edits(const CurveReceivers& receivers,
                                       std::span<const CurveMaterialState> states,
                                       const DesignState& state) {
  const int cube_size = receivers.visibility.cube_size;
  std::vector<std::string> result;
  bool is_any_edited = false;
  for (std::size_t m = 0; m < states.size(); ++m) {
    const CurveMaterial& baked = receivers.materials[m];
    if (states[m].half_angle && is_finer_than_texels(*states[m].half_angle, cube_size)) {
      result.push_back("the sharpness of " + baked.name + " (the light's texels are " +
                       texel_degrees(cube_size) + "° wide)");
    }
    const MaterialEdit edit = edit_of(state, baked.name);
    const auto missing = unavailable(baked, edit);
    result.insert(result.end(), missing.begin(), missing.end());
    is_any_edited |= edit != MaterialEdit{};
  }
  if (is_any_edited) {
    result.emplace_back("what edited materials do to other surfaces (that stays as baked)");
  }
  for (const auto& [name, edit] : state.materials) {
    if (std::ranges::find(receivers.materials, name, &CurveMaterial::name) ==
        receivers.materials.end()) {
      result.push_back("edits of " + name + " (this bake has it built in)");
    }
  }
  return result;
}

}  // namespace rimlight
