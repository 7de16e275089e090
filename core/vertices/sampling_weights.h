#pragma once

#include <vector>

#include "core/vertices/vertex_scene.h"

namespace rimlight {

/// How the error of sampling is spread over a bake's vertices: the mean square of each one's, over
/// the mean of all those that have a highlight, or of all those that have none. [vertex].
///
/// Only blocked rays make errors (shadowed_visibility). While the first N rays of a vertex do, the
/// square grows with the share b of them that is blocked, πb/4N for irradiance by the cosine; rays
/// are added once it is above the error ε that was asked for, so that it goes no higher. So it goes
/// as min(1, b/b₀), N about √π/ε (ray_rounds.h). b is what the vertex' mean transport lacks of an
/// open one's; where light comes by way of other surfaces the lack is smaller, but so for all.
std::vector<float> sampling_weights(const VertexScene& scene);

}  // namespace rimlight
