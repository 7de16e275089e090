#pragma once

#include <cstddef>

#include "core/bake/group_source.h"
#include "core/transport/bake_folder.h"

namespace rimlight {

/// Where reference rows come from. What they cannot tell about errors is left away.
struct ReferenceSources {
  const GroupSource& rows;                // that the bake was made of
  const GroupSource* retraced = nullptr;  // the same with another seed
  const GroupSource* finer = nullptr;     // the same on a cube map of twice the size
};

/// Adds the reference rows of a sample of at least `receivers` receivers in whole groups (all of
/// the picture's when it has fewer) to a bake: asks the source for them again, a few at a time; and
/// for one group in kGroupsPerCheck of it the rows of the other sources. The sample is the same for
/// every bake of the same picture, so that bakes can be compared by it.
void write_reference(BakeWriter& writer, const ReferenceSources& sources, std::size_t receivers);

inline constexpr std::size_t kGroupsPerCheck = 8;

}  // namespace rimlight
