#include "core/bake/direct_transport.h"

#include <memory>
#include <utility>

#include "core/bake/group_surfaces.h"
#include "core/bake/lambert_kernel.h"
#include "core/bake/lobe_response.h"
#include "core/bake/sky_visibility.h"
#include "core/base/check.h"
#include "core/math/random.h"

namespace rimlight {
namespace {

/// What a thread keeps between groups.
struct Workspace {
  GroupSurfaces surfaces;
  SkyVisibility visibility;
};

void find_responding(const TexelQuadrature& texels, Workspace& work) {
  work.visibility.clear(work.surfaces.layer_count(), texels);
  for (std::size_t texel = 0; texel < texels.count(); ++texel) {
    const Quarters& quarters = texels.quarters(texel);
    for (std::size_t layer = 0; layer < work.surfaces.layer_count(); ++layer) {
      const LaneSet facing = facing_lanes(work.surfaces.layer(layer), quarters);
      work.visibility.responding(layer, texel) =
          responding_lanes(work.surfaces, layer, quarters, facing);
    }
  }
}

/// Adds what one layer reflects of one texel to its row.
void add_to_row(const TexelQuadrature& texels, const Workspace& work, std::size_t layer,
                std::size_t texel, float* row) {
  const LaneSet responding = work.visibility.responding(layer, texel);
  if (responding == 0) return;
  const Quarters& quarters = texels.quarters(texel);
  const SurfaceLayer& surfaces = work.surfaces.layer(layer);
  add_lambert(surfaces,
              {quarters, work.visibility.lit_rays(layer, texel),
               work.visibility.refined(layer, texel), SkyVisibility::kRefinedWeight},
              row);
  for_each_lane(responding & surfaces.lobe_lanes, [&](std::size_t lane) {
    const float visibility = work.visibility.visibility(layer, texel, lane);
    if (visibility == 0) return;
    const Vec3f value = lobe_response(work.surfaces.lobe(layer, lane), quarters) * visibility;
    for (std::size_t c = 0; c < 3; ++c) row[c * kGroupLanes + lane] += value[static_cast<int>(c)];
  });
}

}  // namespace

DirectTransport::DirectTransport(const RayScene& scene, int cube_size, MaterialSet materials)
    : scene_(scene), texels_(cube_size), materials_(std::move(materials)) {}

void DirectTransport::add(const GroupSamples& samples, std::uint64_t seed, GroupRows& rows) const {
  RIMLIGHT_CHECK_EQ(rows.cube_size, texels_.cube_size());
  thread_local const auto workspace = std::make_unique<Workspace>();
  Workspace& work = *workspace;
  work.surfaces.assign(samples, materials_);
  find_responding(texels_, work);
  work.visibility.trace(scene_, work.surfaces, texels_, mix_bits(seed));
  for (std::size_t texel = 0; texel < texels_.count(); ++texel) {
    for (std::size_t layer = 0; layer < work.surfaces.layer_count(); ++layer) {
      add_to_row(texels_, work, layer, texel, rows.row(texel));
    }
  }
}

}  // namespace rimlight
