#pragma once

#include <cstddef>
#include <functional>
#include <vector>

#include "core/bake/group_surfaces.h"
#include "core/light/cube_light.h"
#include "core/scene/ray_scene.h"
#include "core/transport/curve_receivers.h"
#include "core/transport/receivers.h"

namespace rimlight {

/// The materials whose BRDFs a bake lets sessions edit: those that the scene's settings name, or
/// all that have a gloss.
struct EditableMaterials {
  std::vector<CurveMaterial> materials;
  std::vector<std::uint32_t> index;  // [material of the scene]; kNone for the others
  static constexpr std::uint32_t kNone = 0xffffffffu;

  MaterialSet set() const;
};
/// Throws Error for a name that is no material of the scene, or when there is none.
EditableMaterials find_editable_materials(const Scene& scene);

/// What the pixels show of editable materials, and what that sees of the sky.
struct CurveSurfaces {
  explicit CurveSurfaces(int cube_size) : visibility(cube_size) {}

  std::vector<CurveSurface> surfaces;  // in the order of CurveReceivers
  SkyVisibilityPacker visibility;
  /// The direct light that they reflect under each of some lights, as they were baked:
  /// [light][receiver]. Exposures take it.
  std::vector<std::vector<Vec3f>> images;
};

/// Traces primary rays and shadow rays as DirectTransport does: the same surfaces, and the same
/// share of each texel. `lights` are texels of the bake's cube size. All cores; the same bits for
/// any number. Throws Error when no pixel shows an editable material.
CurveSurfaces find_curve_surfaces(const RayScene& scene, const EditableMaterials& editable,
                                  const std::vector<CubeLight>& lights,
                                  const std::function<void(double fraction)>& progress);

}  // namespace rimlight
