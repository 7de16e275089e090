#pragma once

#include <array>
#include <functional>
#include <memory>
#include <optional>

#include "core/image/image.h"
#include "core/relight/design_state.h"
#include "core/relight/frame_report.h"
#include "core/relight/frame_update.h"
#include "core/scene/g_buffer.h"
#include "core/vertices/vertex_light.h"
#include "core/vertices/vertex_scene.h"

namespace rimlight {

/// The points of a pixel in an exact frame: each in its own row and its own column of four.
inline constexpr std::array<PixelPoint, 4> kSmoothPoints{
    {{0.375, 0.125}, {0.875, 0.375}, {0.125, 0.625}, {0.625, 0.875}}};

/// Rays from each of them over the disc of a sun that is apart.
inline constexpr int kSmoothSunRays = 4;

struct VertexSettings {
  int background_size = 256;  // texels a side of the cube map of the environment behind the pixels
  int light_size = 256;       // of the one that is projected to harmonics
  /// Without one a small bright light, cut off after the transport's degree, leaves black rings
  /// about its highlights; a fitted one blurs each light by no more than that takes.
  LightWindow window = LightWindow::fitted;
  /// Of a moving frame: milliseconds are for all of it, up to its pixels (see FrameDeadline for
  /// what cannot be shortened). Coefficients and bytes do not bind: every frame is lit by all
  /// coefficients of the light.
  FrameBudget budget = {};
  /// Without a deadline, a frame in motion of a new view is coarse, every second pixel both ways,
  /// where the whole one takes longer than this; 0: always.
  double view_ms = 25;
  /// Another way for the sun than the scene asks for.
  std::optional<SunLight> sun = std::nullopt;
};

/// Turns a design state into pixels of a scene of vertices, seen from any camera: turns the light
/// in harmonics, finds the light of the vertices that the view needs, interpolates it, evaluates
/// highlights at each pixel, puts the environment behind, tone-maps. What does not change from
/// frame to frame is kept: a view while it stands still, the light of vertices under one light. One
/// thread at a time; computes on all cores.
///
/// A sun (split_sun) that the scene wants apart (SunLight::directional) is no part of the
/// harmonics: a pixel that sees it, by shadow rays, gets
///
///   tint · albedo / π · E · max(0, n · s)  +  highlight · E · lobe(mirrored ω_o · s)
///
/// from its irradiance E and direction s; a frame in motion by one ray to its middle, an exact
/// frame by kSmoothSunRays over its disc at each of the kSmoothPoints.
///
/// A pixel is as in FrameRenderer, and so are exposure and environments; its states and methods are
/// the same too. Surfaces are seen from behind as from in front, without a highlight; the report
/// says where that is more than a hundredth.
///
/// Every call throws Error for a state that cannot be shown: as FrameRenderer's, and for a view
/// without rays (check_camera), a material that there is not, values of it out of range.
class VertexRenderer {
 public:
  /// Throws Error when check_vertex_scene() does.
  VertexRenderer(std::shared_ptr<const VertexScene> scene, const VertexSettings& settings);
  ~VertexRenderer();

  /// Projects all environments of a scene now, for every renderer of it. Any thread.
  static void prepare(const VertexScene& scene, const VertexSettings& settings);

  /// An environment beside those of the scene; in the place of one of the same name. Its exposure
  /// is found as a bake finds it, in the scene's own camera.
  void add_environment(std::shared_ptr<const Environment> environment);

  /// What later moving frames may cost.
  void set_budget(const FrameBudget& budget);
  /// A frame of one ray through each pixel, or each fourth pixel, within the budget.
  FrameReport render_moving(const DesignState& state, Rgb8Image& frame);
  /// The same as linear radiance, composited, before exposure and tone mapping.
  FrameReport render_moving(const DesignState& state, RgbImage& image);

  /// The exact frame: four rays through each pixel; the same bytes for the same state, whatever
  /// came before. `abandon` is asked between steps and tiles, from several threads at once; when it
  /// answers true, the frame is not touched and false comes back.
  bool render_exact(const DesignState& state, Rgb8Image& frame, FrameReport& report,
                    const std::function<bool()>& abandon = {});

  /// The exact frame as linear radiance, composited, before exposure and tone mapping.
  void render_radiance(const DesignState& state, RgbImage& image, FrameReport& report);

  const VertexScene& scene() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace rimlight
