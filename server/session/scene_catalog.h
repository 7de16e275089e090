#pragma once

#include <functional>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "core/math/camera.h"
#include "core/transport/vertex_transport.h"
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
  std::function<std::unique_ptr<FrameSource>()> make_source;
};

/// The names of a scene's materials.
std::vector<std::string> material_names(const ServedScene& scene);

/// The scenes by name; the first is the default. Immutable after it is made; any thread.
class SceneCatalog {
 public:
  /// Throws Error when there is none, or two have one name.
  explicit SceneCatalog(std::vector<ServedScene> scenes);

  /// The default scene for an empty name; null when there is none of that name.
  const ServedScene* find(std::string_view name) const;
  /// The body of /api/scenes.
  std::string to_json() const;

 private:
  std::vector<ServedScene> scenes_;
};

}  // namespace rimlight::server
