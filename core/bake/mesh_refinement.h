#pragma once

#include <cstddef>

#include "core/scene/scene.h"

namespace rimlight {

/// Splits every edge that is longer than `longest_edge` (> 0, in the mesh's unit) at its middle, in
/// rounds, until none is: a triangle becomes 2, 3 or 4, by how many of its edges are split. Whether
/// and where depends on an edge's two ends alone, so that triangles that share one agree, also
/// those of other meshes with the same two positions: no T-junctions come to be, and what is closed
/// stays so. An edge stays longer only where no float is near its middle.
///
/// Middles have the mean position, texture coordinate and normal (unit; the mesh has one for each
/// of its vertices). They come after the mesh's vertices, which keep their indices. Triangles keep
/// their orientation, and those that come of one stay together.
///
/// False when that takes more than `most_added` vertices; the mesh is then refined in part.
[[nodiscard]] bool refine(Mesh& mesh, double longest_edge, std::size_t most_added);

}  // namespace rimlight
