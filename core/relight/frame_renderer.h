#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <string>

#include "core/image/image.h"
#include "core/relight/design_state.h"
#include "core/relight/frame_report.h"
#include "core/relight/frame_update.h"
#include "core/relight/image_layer.h"
#include "core/relight/policy_settings.h"
#include "core/transport/bake_folder.h"

namespace rimlight {

struct RelightSettings {
  PolicySettings policy;
  FrameBudget budget;         // of a moving frame; milliseconds are for all of it, up to its pixels
  int background_size = 256;  // texels a side of the cube map of the environment behind the pixels
};

/// Turns a design state into pixels of one bake: rotates the light, plans and applies the update,
/// composites the environment behind the pixels, tone-maps. Holds B and the held light of one
/// design session. Allocates nothing after the first frames of each environment. One thread at a
/// time; computes on all cores.
///
/// A pixel is B + (1 − coverage) · L(ω): ω the camera's ray through the pixel's middle, L the
/// environment in the same rotation, looked up in a finer cube map than the light's.
///
/// Every call throws Error for a state that cannot be shown: an unknown environment, a rotation
/// that is no unit quaternion to 10⁻³, an exposure that is not within ±kMostStops; and what the
/// layer refuses. A view other than the bake's camera, and without a layer edits of materials,
/// cannot be shown: the report says so.
class FrameRenderer {
 public:
  /// `layer`: what pixels get beside B, if anything.
  FrameRenderer(std::shared_ptr<const Bake> bake, const RelightSettings& settings,
                std::unique_ptr<ImageLayer> layer = nullptr);
  ~FrameRenderer();

  /// Projects all environments of a bake now, for every renderer of it: else the first frame of
  /// each environment does, and takes a second for it. Any thread.
  static void prepare(const Bake& bake, const RelightSettings& settings);

  /// An environment beside those of the bake; in the place of one of the same name. Its exposure is
  /// found as a bake finds it: 0 stops take the mean of the covered pixels, unrotated, to 0.18.
  /// Costs one exact product.
  void add_environment(std::shared_ptr<const Environment> environment);

  /// What later moving frames may cost.
  void set_budget(const FrameBudget& budget);
  /// An approximate frame within the budget.
  FrameReport render_moving(const DesignState& state, Rgb8Image& frame);

  /// The exact frame: one fresh full product in canonical order, the code path of `rimlight
  /// render`: the same bytes for the same state, whatever came before. `abandon` is asked between
  /// tiles, from several threads at once; when it answers true, nothing more is done, the frame is
  /// not touched and false comes back.
  bool render_exact(const DesignState& state, Rgb8Image& frame, FrameReport& report,
                    const std::function<bool()>& abandon = {});

  /// Makes later frames of the state that was shown last better, until `abandon` answers true
  /// (asked from several threads at once); what there is still to do.
  Unfinished improve(const std::function<bool()>& abandon);

  /// The exact frame as linear radiance, composited, before exposure and tone mapping.
  void render_radiance(const DesignState& state, RgbImage& image, FrameReport& report);

  const Bake& bake() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace rimlight
