#pragma once

#include <functional>
#include <memory>

#include "core/base/error.h"
#include "core/light/environment.h"
#include "core/relight/frame_renderer.h"

namespace rimlight::server {

/// What a session draws with: the part of FrameRenderer that it uses, and all that it knows of
/// relighting. One thread at a time; errors as FrameRenderer's.
class FrameSource {
 public:
  virtual ~FrameSource() = default;
  /// Of a budget in milliseconds, what later moving frames may take: above 0, at most 1. Other
  /// budgets stay: they promise the same image for the same edits. Sources without one need not
  /// have it.
  virtual void set_budget_share(double /*share*/) {}
  virtual FrameReport render_moving(const DesignState& state, Rgb8Image& frame) = 0;
  /// False when `abandon` answered true: the frame was not touched.
  virtual bool render_exact(const DesignState& state, Rgb8Image& frame, FrameReport& report,
                            const std::function<bool()>& abandon) = 0;
  /// One besides the scene's, to be shown from now on. Throws Error for a source that can show no
  /// others. Takes a second or so.
  virtual void add_environment(const std::shared_ptr<const Environment>& environment) {
    throw Error("environment", quote(environment->name()), "one of the scene's own");
  }
  /// Makes later frames of the state that was shown last better, until `abandon` answers true; what
  /// there is still to do. Sources whose frames leave nothing unfinished need not have it.
  virtual Unfinished improve(const std::function<bool()>& /*abandon*/) {
    return Unfinished::nothing;
  }
};

}  // namespace rimlight::server
