#include "core/bake/lobe_response.h"

namespace rimlight {

Vec3f lobe_response(const LobeSurface& lobe, const Quarters& quarters) {
  Vec3f sum;
  for (std::size_t q = 0; q < kQuarters; ++q) {
    const Vec3f& direction = quarters[q].direction;
    const Vec3f in = lobe.frame[q].to_local(direction);
    if (!(dot(lobe.geometric_normal[q], direction) > 0) || !(in.z > 0)) continue;
    sum += evaluate(lobe.brdf, in, lobe.outgoing[q]) * (in.z * quarters[q].solid_angle);
  }
  return sum * lobe.share;
}

LaneSet responding_lanes(const GroupSurfaces& surfaces, std::size_t layer, const Quarters& quarters,
                         LaneSet facing, std::vector<Vec3f>& lobe_responses) {
  const SurfaceLayer& in = surfaces.layer(layer);
  LaneSet responding = facing;
  for_each_lane(facing & in.lobe_lanes, [&](std::size_t lane) {
    const auto& lobe = surfaces.lobes()[static_cast<std::size_t>(in.lobe[lane])];
    const Vec3f response = lobe_response(lobe, quarters);
    if (max_component(response) > 0) {
      lobe_responses.push_back(response);
    } else {
      responding &= ~lane_bit(lane);
    }
  });
  return responding;
}

}  // namespace rimlight
