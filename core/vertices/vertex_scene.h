#pragma once

#include <memory>
#include <string>
#include <vector>

#include "core/light/sun_and_sky.h"
#include "core/math/camera.h"
#include "core/scene/g_buffer.h"
#include "core/transport/bake_folder.h"
#include "core/transport/vertex_bake.h"
#include "core/transport/vertex_transport.h"
#include "core/vertices/bake_error.h"

namespace rimlight {

/// A scene whose transport is at vertices: it can be seen from anywhere, and its materials edited.
struct VertexScene {
  std::string name;  // in errors
  std::shared_ptr<const VertexMesh> mesh;
  std::vector<VertexMaterial> materials;
  VertexTransportView transport;
  Camera camera;  // where a view starts
  int width = 0;
  int height = 0;
  std::vector<BakedEnvironment> environments;
  /// Whether light went from surface to surface with the baked albedo: then it does not follow an
  /// edited one.
  bool has_interreflection = false;
  SunLight sun = SunLight::harmonics;
  VertexBakeError error;
  std::shared_ptr<const void> memory;  // of the transport's views
  /// The mesh for rays, shared by all who show the scene; each makes its own without one.
  std::shared_ptr<const TriangleTree> tree;
};

/// Throws Error, naming the scene and the field, for a scene that cannot be shown: counts that do
/// not fit each other, a material or corner that there is not, numbers that are not finite, degrees
/// or sizes out of range, a bad camera.
void check_vertex_scene(const VertexScene& scene);

/// The scene of a bake, which it keeps alive, with its tree.
VertexScene vertex_scene_of(std::shared_ptr<const VertexBake> bake);

}  // namespace rimlight
