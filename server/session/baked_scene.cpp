#include "server/session/baked_scene.h"

#include <utility>

#include "core/base/error.h"
#include "core/curves/curve_layer.h"
#include "server/protocol/stream_target.h"

namespace rimlight::server {
namespace {

/// Draws with a renderer of its own: a FrameRenderer or a VertexRenderer, whose methods are the
/// same.
template <typename Renderer>
class RendererSource final : public FrameSource {
 public:
  template <typename... Arguments>
  explicit RendererSource(const FrameBudget& budget, Arguments&&... arguments)
      : budget_(budget), renderer_(std::forward<Arguments>(arguments)...) {}

  void set_budget_share(double share) override {
    if (budget_.unit != FrameBudget::Unit::milliseconds) return;
    renderer_.set_budget({budget_.unit, budget_.amount * share});
  }

  FrameReport render_moving(const DesignState& state, Rgb8Image& frame) override {
    return renderer_.render_moving(state, frame);
  }
  bool render_exact(const DesignState& state, Rgb8Image& frame, FrameReport& report,
                    const std::function<bool()>& abandon) override {
    return renderer_.render_exact(state, frame, report, abandon);
  }
  void add_environment(const std::shared_ptr<const Environment>& environment) override {
    renderer_.add_environment(environment);
  }
  Unfinished improve(const std::function<bool()>& abandon) override {
    if constexpr (requires { renderer_.improve(abandon); }) {
      return renderer_.improve(abandon);
    } else {
      return Unfinished::nothing;
    }
  }

 private:
  const FrameBudget budget_;
  Renderer renderer_;
};

/// What all kinds of bakes have. `where` names the bake in errors.
ServedScene served_scene(const std::string& name, const std::string& where,
                         const std::vector<BakedEnvironment>& environments) {
  ServedScene scene;
  scene.name = name;
  if (!is_valid_name(scene.name)) {
    throw Error(where, "the bake's name " + quote(scene.name),
                "1 to 64 of A-Z a-z 0-9 . _ -, to stand in a URL");
  }
  for (const BakedEnvironment& baked : environments) {
    scene.environments.push_back(baked.environment->name());
  }
  if (scene.environments.empty()) throw Error(where, "no environments", "one or more");
  return scene;
}

}  // namespace

std::string scene_name(const std::filesystem::path& bake_folder) {
  const std::filesystem::path normal = bake_folder.lexically_normal();
  return (normal.has_filename() ? normal : normal.parent_path()).stem().string();
}

ServedScene serve_bake(std::shared_ptr<const Bake> bake, const RelightSettings& settings) {
  ServedScene scene =
      served_scene(scene_name(bake->folder()), bake->folder().string(), bake->environments());
  scene.width = bake->manifest().pixels.width;
  scene.height = bake->manifest().pixels.height;
  scene.camera = bake->manifest().camera;
  scene.editable = bake->manifest().materials;
  for (const CurveMaterial& each : bake->manifest().measured_brdfs) {
    scene.measured.push_back({each.name, *each.measured});
  }
  scene.make_source = [bake = std::move(bake), settings] {
    return std::make_unique<RendererSource<FrameRenderer>>(settings.budget, bake, settings,
                                                           curve_layer_of(bake));
  };
  return scene;
}

ServedScene serve_vertices(const std::string& name, std::shared_ptr<const VertexScene> vertices,
                           const VertexSettings& settings) {
  check_vertex_scene(*vertices);
  ServedScene scene = served_scene(name, vertices->name, vertices->environments);
  scene.width = vertices->width;
  scene.height = vertices->height;
  scene.camera = vertices->camera;
  scene.any_view = true;
  scene.materials = vertices->materials;
  scene.make_source = [vertices = std::move(vertices), settings] {
    return std::make_unique<RendererSource<VertexRenderer>>(settings.budget, vertices, settings);
  };
  return scene;
}

ServedScene open_scene(const std::filesystem::path& bake_folder, const DrawSettings& settings) {
  if (bake_kind(bake_folder) == kVertexKind) {
    const auto vertices = std::make_shared<const VertexScene>(
        vertex_scene_of(std::make_shared<const VertexBake>(bake_folder)));
    VertexSettings of_vertices = settings.vertices;
    of_vertices.budget = settings.relight.budget;
    VertexRenderer::prepare(*vertices, of_vertices);
    return serve_vertices(scene_name(bake_folder), vertices, of_vertices);
  }
  auto bake = std::make_shared<const Bake>(bake_folder);
  FrameRenderer::prepare(*bake, settings.relight);
  return serve_bake(std::move(bake), settings.relight);
}

}  // namespace rimlight::server
