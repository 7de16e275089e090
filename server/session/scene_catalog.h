#pragma once

#include <functional>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "core/math/camera.h"
#include "core/transport/vertex_transport.h"
#include "server/protocol/editable_material.h"
#include "server/protocol/material_edits.h"
#include "server/session/frame_source.h"

namespace rimlight::server {

/// One scene that is served. Immutable; any thread may call `make_source`.
struct ServedScene {
  std::string name;                       // in URLs: see is_valid_name()
  std::vector<std::string> environments;  // not empty; sessions start with the first
  int width = 0;
  int height = 0;
  Camera camera;
  bool any_view = false;                  // whether frames follow an edited view
  std::vector<VertexMaterial> materials;  // whose edits frames follow, as they were baked
  std::vector<CurveMaterial> editable;    // whose BRDFs are edited, as they were baked
  std::vector<MeasuredChoice> measured;   // what they may load
  std::function<std::unique_ptr<FrameSource>()> make_source;
};

/// What edits of the scene may name. Where it has measured BRDFs, every editable material may have
/// one, and so curves of both axes.
KnownMaterials known_materials(const ServedScene& scene);

/// The scenes by name; the first is the default. Immutable after it is made; any thread.
class SceneCatalog {
 public:
  /// Throws Error when there is none, or two have one name.
  explicit SceneCatalog(std::vector<ServedScene> scenes);

  /// The default scene for an empty name; null when there is none of that name.
  const ServedScene* find(std::string_view name) const;
  /// The body of /api/scenes.
  std::string to_json() const;
  /// The body of /api/curves: the factors of a scene's material as it was baked, or of a measured
  /// BRDF that it may load. `query` is "scene=NAME&material=NAME" and perhaps "&measured=NAME",
  /// percent-encoded. Throws Error for a query that cannot be read, and names that are not there.
  std::string curves(std::string_view query) const;

 private:
  std::vector<ServedScene> scenes_;
};

}  // namespace rimlight::server
