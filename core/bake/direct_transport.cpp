#include "core/bake/direct_transport.h"

#include <memory>
#include <vector>

#include "core/bake/group_surfaces.h"
#include "core/bake/lambert_kernel.h"
#include "core/bake/lobe_response.h"
#include "core/bake/sky_visibility.h"
#include "core/base/check.h"

namespace rimlight {
namespace {

/// What a thread keeps between groups.
struct Workspace {
  GroupSurfaces surfaces;
  SkyVisibility visibility;
  std::vector<Vec3f> lobe_responses;  // by texel, layer, lane
};

void find_responding(const TexelQuadrature& texels, Workspace& work) {
  work.lobe_responses.clear();
  work.visibility.clear(work.surfaces.layer_count(), texels);
  for (std::size_t texel = 0; texel < texels.count(); ++texel) {
    const Quarters& quarters = texels.quarters(texel);
    for (std::size_t layer = 0; layer < work.surfaces.layer_count(); ++layer) {
      const LaneSet facing = facing_lanes(work.surfaces.layer(layer), quarters);
      work.visibility.responding(layer, texel) =
          responding_lanes(work.surfaces, layer, quarters, facing, work.lobe_responses);
    }
  }
}

void add_to_rows(const TexelQuadrature& texels, const Workspace& work, GroupRows& rows) {
  const Vec3f* response = work.lobe_responses.data();
  for (std::size_t texel = 0; texel < texels.count(); ++texel) {
    float* const row = rows.row(texel);
    for (std::size_t i = 0; i < work.surfaces.layer_count(); ++i) {
      const LaneSet responding = work.visibility.responding(i, texel);
      if (responding == 0) continue;
      const SurfaceLayer& layer = work.surfaces.layer(i);
      add_lambert(layer,
                  {texels.quarters(texel), work.visibility.lit_rays(i, texel),
                   work.visibility.refined(i, texel), SkyVisibility::kRefinedWeight},
                  row);
      for_each_lane(responding & layer.lobe_lanes, [&](std::size_t lane) {
        const Vec3f value = *response++ * work.visibility.visibility(i, texel, lane);
        for (std::size_t c = 0; c < 3; ++c) {
          row[c * kGroupLanes + lane] += value[static_cast<int>(c)];
        }
      });
    }
  }
}

}  // namespace

DirectTransport::DirectTransport(const RayScene& scene, int cube_size)
    : scene_(scene), texels_(cube_size) {}

void DirectTransport::add(const GroupSamples& samples, std::uint64_t seed, GroupRows& rows) const {
  RIMLIGHT_CHECK_EQ(rows.cube_size, texels_.cube_size());
  thread_local const auto workspace = std::make_unique<Workspace>();
  Workspace& work = *workspace;
  work.surfaces.assign(samples, seed);
  find_responding(texels_, work);
  work.visibility.trace(scene_, work.surfaces, texels_);
  add_to_rows(texels_, work, rows);
}

}  // namespace rimlight
