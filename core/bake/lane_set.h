#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>

#include "core/bake/group.h"

namespace rimlight {

/// A set of a group's lanes: bit i for lane i.
using LaneSet = std::uint64_t;
static_assert(kGroupLanes == 64);
constexpr LaneSet lane_bit(std::size_t lane) { return LaneSet{1} << lane; }

/// Calls visit(lane) for the lanes of a set, from the first to the last.
template <typename Visit>
void for_each_lane(LaneSet lanes, const Visit& visit) {
  for (; lanes != 0; lanes &= lanes - 1) visit(static_cast<std::size_t>(std::countr_zero(lanes)));
}

}  // namespace rimlight
