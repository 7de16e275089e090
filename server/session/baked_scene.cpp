#include "server/session/baked_scene.h"

#include <utility>

#include "core/base/error.h"
#include "server/protocol/stream_target.h"

namespace rimlight::server {
namespace {

/// Draws with a FrameRenderer of its own.
class RendererSource final : public FrameSource {
 public:
  RendererSource(std::shared_ptr<const Bake> bake, const RelightSettings& settings)
      : renderer_(std::move(bake), settings) {}

  FrameReport render_moving(const DesignState& state, Rgb8Image& frame) override {
    return renderer_.render_moving(state, frame);
  }
  bool render_exact(const DesignState& state, Rgb8Image& frame, FrameReport& report,
                    const std::function<bool()>& abandon) override {
    return renderer_.render_exact(state, frame, report, abandon);
  }

 private:
  FrameRenderer renderer_;
};

}  // namespace

std::string scene_name(const std::filesystem::path& bake_folder) {
  const std::filesystem::path normal = bake_folder.lexically_normal();
  return (normal.has_filename() ? normal : normal.parent_path()).stem().string();
}

ServedScene serve_bake(std::shared_ptr<const Bake> bake, const RelightSettings& settings) {
  ServedScene scene;
  scene.name = scene_name(bake->folder());
  if (!is_valid_name(scene.name)) {
    throw Error(bake->folder().string(), "the bake's name " + quote(scene.name),
                "1 to 64 of A-Z a-z 0-9 . _ -, to stand in a URL");
  }
  for (const BakedEnvironment& baked : bake->environments()) {
    scene.environments.push_back(baked.environment->name());
  }
  if (scene.environments.empty()) {
    throw Error(bake->folder().string(), "no environments", "one or more");
  }
  scene.width = bake->manifest().pixels.width;
  scene.height = bake->manifest().pixels.height;
  scene.camera = bake->manifest().camera;
  scene.make_source = [bake = std::move(bake), settings] {
    return std::make_unique<RendererSource>(bake, settings);
  };
  return scene;
}

}  // namespace rimlight::server
