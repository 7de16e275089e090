#pragma once

#include <cstddef>
#include <filesystem>
#include <vector>

#include "core/scene/scene.h"

namespace rimlight {

/// The largest mesh file, and the most triangles that one scene may hold.
inline constexpr std::size_t kLargestMeshFile = std::size_t{1} << 31;
inline constexpr std::size_t kMostTriangles = std::size_t{1} << 27;

/// The meshes of a file in its own units, nodes applied, and its materials (Lambert: base colour
/// factor and texture; alpha is ignored), which Mesh::material counts.
struct MeshFile {
  std::vector<Mesh> meshes;
  std::vector<Material> materials;
};

enum class FileMaterials { read, ignore };

/// Reads OBJ, PLY or glTF 2.0 through assimp, whose own repairs are off: triangulates, and nothing
/// else. Points and lines are left out. With FileMaterials::ignore no texture is opened, and there
/// is one grey material. Throws Error naming the file: missing, too large, malformed, another
/// format, no triangles, an index out of range, a coordinate that is not finite, a colour outside
/// [0, 1], too many triangles.
MeshFile read_mesh_file(const std::filesystem::path& path, FileMaterials materials);

}  // namespace rimlight
