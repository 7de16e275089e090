#pragma once

#include <vector>

#include "core/transport/bake_folder.h"

namespace rimlight::test {

/// A bake's transport as a matrix over the texels of its cube map, as someone who exports it would
/// write it: [pixel][texel][3], pixels row by row, each the integral of the transport over the
/// texel.
std::vector<float> dense_transport(const Bake& bake);

}  // namespace rimlight::test
