#pragma once

#include <memory>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "core/relight/display.h"
#include "core/vertices/sun_shadows.h"
#include "core/vertices/vertex_scene.h"
#include "core/vertices/vertex_view.h"
#include "core/vertices/view_weights.h"

namespace rimlight {

/// A view, what shows it, and its shadows. One thread at a time.
struct ShownView {
  VertexView view;
  Display display;
  SunShadows shadows;
  ViewWeights weights;
  bool is_placed = false;   // whether the display is of this view
  bool is_traced = false;   // whether the shadows are
  bool is_weighed = false;  // whether the weights are

  ShownView(const VertexScene& scene, const std::shared_ptr<const TriangleTree>& tree,
            std::vector<PixelPoint> points, int sun_rays)
      : view(*scene.mesh, tree,
             {scene.width, scene.height, scene.transport.highlight_count, std::move(points)}),
        display({scene.width, scene.height}, scene.camera, view.coverage()),
        shadows(*scene.mesh, tree, sun_rays),
        weights(scene.materials.size()) {}

  /// True when anything changed.
  bool look(const Camera& camera, GBufferDetail detail) {
    const bool has_changed = view.look(camera, detail);
    if (has_changed) is_placed = is_traced = is_weighed = false;
    if (!is_placed) display.set_view(camera, view.coverage());
    is_placed = true;
    return has_changed;
  }

  /// None: no shadows are looked at.
  void find_shadows(const std::optional<Sun>& sun) {
    if (!sun) return;
    shadows.find(view, *sun, !is_traced);
    is_traced = true;
  }

  void find_weights(const VertexScene& scene, std::span<const float> sampling) {
    if (!is_weighed) {
      weights.find(view, *scene.mesh, scene.transport.highlight_count, sampling);
    }
    is_weighed = true;
  }
};

}  // namespace rimlight
