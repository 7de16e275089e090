#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <string>

#include "core/image/image.h"
#include "core/relight/design_state.h"
#include "core/transport/bake_folder.h"

namespace rimlight {

enum class PolicyKind { nwa, pbi };

struct RelightSettings {
  PolicyKind policy = PolicyKind::pbi;
  std::size_t coefficient_budget = 30;
};

/// How one frame came about.
struct FrameReport {
  bool exact = false;
  std::size_t terms = 0;  // columns applied
  std::size_t bands_reset = 0;
  double residual = 0;  // ‖target − held‖₁ / ‖target‖₁ of the lighting, area-weighted; 0 = exact
  double rotate_ms = 0;   // light rotation and Haar transform
  double update_ms = 0;   // policy and columns
  double display_ms = 0;  // composite and tone map
};

/// Turns a design state into pixels of one bake: rotates the light, plans and applies the update,
/// composites the environment behind the pixels, tone-maps. Holds B and the held light of one
/// design session. Allocates nothing after the first frames. One thread at a time; computes on all
/// cores.
class FrameRenderer {
 public:
  FrameRenderer(std::shared_ptr<const Bake> bake, const RelightSettings& settings);
  ~FrameRenderer();

  /// An approximate frame within the coefficient budget. Throws Error for an unknown environment.
  FrameReport render_moving(const DesignState& state, Rgb8Image& frame);

  /// The exact frame: one fresh full product in canonical order, the code path of `rimlight
  /// render`. `abandon` is asked between tiles; when it answers true, nothing more is done, the
  /// frame is not touched and false comes back.
  bool render_exact(const DesignState& state, Rgb8Image& frame, FrameReport& report,
                    const std::function<bool()>& abandon = {});

  /// The same image as linear radiance, composited, before exposure and tone mapping (for .exr output).
  void render_radiance(const DesignState& state, RgbImage& image, FrameReport& report);

  /// Makes one more environment known beside the bake's own (a file given to `rimlight render --light`);
  /// its exposure_scale is found by one full product (auto_exposure_scale over the covered receivers).
  /// A name that exists already is replaced.
  void add_environment(std::shared_ptr<const Environment> environment);

  const Bake& bake() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace rimlight
