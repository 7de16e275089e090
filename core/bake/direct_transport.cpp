#include "core/bake/direct_transport.h"

#include "core/bake/group_surfaces.h"
#include "core/bake/lobe_response.h"
#include "core/bake/sky_visibility.h"
#include "core/bake/surface_response_kernel.h"
#include "core/base/check.h"

namespace rimlight {
namespace {

/// What a thread keeps between groups.
struct Workspace {
  GroupSurfaces surfaces;
  SkyVisibility visibility;
  LobeResponses lobes;
};

void find_responding(const TexelQuadrature& texels, Workspace& work) {
  work.visibility.clear(work.surfaces.layer_count(), texels);
  for (std::size_t layer = 0; layer < work.surfaces.layer_count(); ++layer) {
    for (std::size_t texel = 0; texel < texels.count(); ++texel) {
      work.visibility.responding(layer, texel) =
          facing_lanes(work.surfaces.layer(layer), texels.quarters(texel));
    }
  }
  work.lobes.evaluate(work.surfaces, texels, work.visibility);
}

void add_to_rows(const TexelQuadrature& texels, const Workspace& work, GroupRows& rows) {
  for (std::size_t texel = 0; texel < texels.count(); ++texel) {
    for (std::size_t layer = 0; layer < work.surfaces.layer_count(); ++layer) {
      if (work.visibility.responding(layer, texel) == 0) continue;
      add_lambert(work.surfaces.layer(layer),
                  {texels.quarters(texel), work.visibility.lit_rays(layer, texel),
                   work.visibility.refined(layer, texel), SkyVisibility::kRefinedWeight},
                  rows.row(texel));
    }
  }
  work.lobes.add(work.surfaces, work.visibility, rows);
}

}  // namespace

DirectTransport::DirectTransport(const RayScene& scene, int cube_size)
    : scene_(scene), texels_(cube_size) {}

void DirectTransport::add(const GroupSamples& samples, std::uint64_t seed, GroupRows& rows) const {
  RIMLIGHT_CHECK_EQ(rows.cube_size, texels_.cube_size());
  thread_local Workspace work;
  work.surfaces.assign(samples, seed);
  find_responding(texels_, work);
  work.visibility.trace(scene_, work.surfaces, texels_);
  add_to_rows(texels_, work, rows);
}

}  // namespace rimlight
