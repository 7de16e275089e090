#pragma once

#include "core/bake/vertex_mesh.h"
#include "core/bake/vertex_packing.h"
#include "core/light/environment.h"

namespace rimlight {

/// The exposure that shows the vertices well under an environment (auto_exposure_scale of what they
/// reflect): a highlight counts as evenly spread, and every vertex the same, for there is no view.
double vertex_exposure_scale(const PreparedVertices& prepared, const CalculatedTransport& transport,
                             const Environment& environment);

}  // namespace rimlight
