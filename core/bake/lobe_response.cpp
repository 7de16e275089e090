#include "core/bake/lobe_response.h"

namespace rimlight {
namespace {

Vec3f normal_of(const LaneVectors& normals, std::size_t lane) {
  return {normals[0][lane], normals[1][lane], normals[2][lane]};
}

}  // namespace

Vec3f lobe_response(const GroupSurfaces& surfaces, const LobeSurface& lobe,
                    const Quarters& quarters) {
  const SurfaceLayer& layer = surfaces.layer(lobe.layer);
  Vec3f sum;
  for (std::size_t q = 0; q < kQuarters; ++q) {
    const Vec3f& direction = quarters[q].direction;
    const Vec3f in = lobe.frame[q].to_local(direction);
    const bool faces = dot(normal_of(layer.geometric_normal[q], lobe.lane), direction) > 0;
    if (!faces || !(in.z > 0)) continue;
    sum += evaluate(lobe.brdf, in, lobe.outgoing[q]) * (in.z * quarters[q].solid_angle);
  }
  return sum * lobe.share;
}

void LobeResponses::evaluate(const GroupSurfaces& surfaces, const TexelQuadrature& texels,
                             SkyVisibility& visibility) {
  responses_.clear();
  for (const LobeSurface& lobe : surfaces.lobes()) {
    for (std::size_t texel = 0; texel < texels.count(); ++texel) {
      LaneSet& responding = visibility.responding(lobe.layer, texel);
      if ((responding & lane_bit(lobe.lane)) == 0) continue;
      const Vec3f response = lobe_response(surfaces, lobe, texels.quarters(texel));
      if (max_component(response) > 0) {
        responses_.push_back(response);
      } else {
        responding &= ~lane_bit(lobe.lane);
      }
    }
  }
}

void LobeResponses::add(const GroupSurfaces& surfaces, const SkyVisibility& visibility,
                        GroupRows& rows) const {
  const Vec3f* response = responses_.data();
  const std::size_t texel_count = cube::texel_count(rows.cube_size);
  for (const LobeSurface& lobe : surfaces.lobes()) {
    for (std::size_t texel = 0; texel < texel_count; ++texel) {
      if ((visibility.responding(lobe.layer, texel) & lane_bit(lobe.lane)) == 0) continue;
      const Vec3f value = *response++ * visibility.visibility(lobe.layer, texel, lobe.lane);
      float* const row = rows.row(texel) + lobe.lane;
      for (std::size_t c = 0; c < 3; ++c) row[c * kGroupLanes] += value[static_cast<int>(c)];
    }
  }
}

}  // namespace rimlight
