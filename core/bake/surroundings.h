#pragma once

#include <span>

#include "core/bake/lane_set.h"
#include "core/basis/cube_map.h"

namespace rimlight {

/// The lanes next to any of `lanes` in the group's 8×8 pixels, by a side or by a corner. A lane is
/// not next to itself.
LaneSet lanes_beside(LaneSet lanes);

/// For each texel the lanes whose surroundings hold both a lit and a dark answer. Around (texel,
/// lane) lie the eight texels around it on its face, in the same lane, and the same texel in the
/// eight lanes around: not (texel, lane) itself.
///   lit, dark, mixed  [texel_count(cube_size)]; mixed is overwritten
void find_mixed_surroundings(int cube_size, std::span<const LaneSet> lit,
                             std::span<const LaneSet> dark, std::span<LaneSet> mixed);

}  // namespace rimlight
