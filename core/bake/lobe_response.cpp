#include "core/bake/lobe_response.h"

namespace rimlight {
namespace {

/// One point's part of the response, without the share.
Vec3f point_response(const LobeSurface& lobe, std::size_t quarter, const QuadraturePoint& point) {
  const Vec3f in = lobe.frame[quarter].to_local(point.direction);
  if (!(dot(lobe.geometric_normal[quarter], point.direction) > 0) || !(in.z > 0)) return {};
  return evaluate(lobe.brdf, in, lobe.outgoing[quarter]) * (in.z * point.solid_angle);
}

/// Whether the response is above zero: most often, the first points tell.
bool responds(const LobeSurface& lobe, const Quarters& quarters) {
  for (std::size_t q = 0; q < kQuarters; ++q) {
    if (max_component(point_response(lobe, q, quarters[q])) > 0) return true;
  }
  return false;
}

}  // namespace

Vec3f lobe_response(const LobeSurface& lobe, const Quarters& quarters) {
  Vec3f sum;
  for (std::size_t q = 0; q < kQuarters; ++q) sum += point_response(lobe, q, quarters[q]);
  return sum * lobe.share;
}

LaneSet responding_lanes(const GroupSurfaces& surfaces, std::size_t layer, const Quarters& quarters,
                         LaneSet facing) {
  LaneSet responding = facing;
  for_each_lane(facing & surfaces.layer(layer).lobe_lanes, [&](std::size_t lane) {
    if (!responds(surfaces.lobe(layer, lane), quarters)) responding &= ~lane_bit(lane);
  });
  return responding;
}

}  // namespace rimlight
