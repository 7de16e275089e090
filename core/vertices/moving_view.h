#pragma once

#include <span>
#include <vector>

#include "core/relight/display.h"
#include "core/vertices/coarse_error.h"
#include "core/vertices/frame_deadline.h"
#include "core/vertices/rated_shading.h"
#include "core/vertices/shown_view.h"
#include "core/vertices/vertex_lighting.h"

namespace rimlight {

/// What of a moving frame time will mend, as squares summed over pixels and channels, and what it
/// is compared with.
struct MovingSquares {
  double image = 0;       // of the surfaces' radiance
  double highlights = 0;  // estimated: of highlights that were interpolated
  double view = 0;        // estimated: of the pixels that a coarse view did not trace

  double of_time() const { return highlights + view; }
};

/// How a renderer's moving frames see a scene: one ray a pixel, as much of it as the deadline
/// allows. Call in the order below, once each a frame. One thread at a time; computes on all cores.
class MovingView {
 public:
  MovingView(const VertexScene& scene, const std::shared_ptr<const TriangleTree>& tree,
             const FrameBudget& budget, double view_ms);

  ShownView& shown() { return shown_; }

  void set_budget(const FrameBudget& budget) { deadline_.set_budget(budget); }
  void start() { deadline_.start(); }
  /// Traces the view, as much as there is time for.
  void look(const Camera& camera);
  /// All of it, however long that takes.
  void look_whole(const Camera& camera);
  /// The vertices whose arriving light the frame needs.
  std::span<const std::uint32_t> choose_vertices(const VertexLighting& lighting);
  /// Their light is there.
  void lit();
  /// Shades tiles, at the rate that the deadline asks for. The shading outlives the frame.
  Display::FillTile tiles(const VertexShading& shading);
  /// All tiles are done.
  MovingSquares finish();

 private:
  /// What one tile came to; each is written by one thread.
  struct TileResult {
    double square = 0;
    MeasuredError error;
    TileVariation variation;
  };

  ShownView shown_;
  FrameDeadline deadline_;
  HighlightPlan plan_;
  bool is_planned_ = false;  // for the view
  std::size_t missing_ = 0;  // vertices, at the rate chosen
  double lit_from_ms_ = 0;
  HighlightRate rate_ = HighlightRate::every;
  PixelLayout layout_;
  std::vector<TileResult> results_;  // [tile]
};

}  // namespace rimlight
