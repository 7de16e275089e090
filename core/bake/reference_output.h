#pragma once

#include <cstddef>

#include "core/bake/group_source.h"
#include "core/transport/bake_folder.h"

namespace rimlight {

/// Adds the reference rows of a sample of at least `receivers` receivers in whole groups (all of
/// the picture's when it has fewer) to a bake: asks the source for them again, a few at a time. The
/// sample is the same for every bake of the same picture, so that bakes can be compared by it.
void write_reference(BakeWriter& writer, const GroupSource& source, std::size_t receivers);

}  // namespace rimlight
