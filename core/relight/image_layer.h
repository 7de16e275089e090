#pragma once

#include <cstddef>
#include <functional>
#include <string>
#include <vector>

#include "core/light/cube_light.h"
#include "core/relight/design_state.h"
#include "core/relight/frame_report.h"
#include "core/relight/frame_update.h"
#include "core/relight/tile_image.h"

namespace rimlight {

/// How a layer came to show what it shows.
struct LayerReport {
  std::size_t terms = 0;
  /// Absolute squared error of its image, estimated; the part of it that time will mend.
  double squared_error = 0, squared_error_of_time = 0;
  Unfinished unfinished = Unfinished::nothing;
  std::vector<std::string> unshown;  // of the state, in words for people
};

/// Radiance that pixels of a FrameRenderer get beside B = M · V: from what is not linear in the
/// light's coefficients alone, as light that follows edited BRDFs. One thread at a time, but add();
/// computes on all cores.
class ImageLayer {
 public:
  virtual ~ImageLayer() = default;

  /// The light's texels and the state that they are of, exactly turned.
  struct Request {
    const DesignState& state;
    const CubeLight& texels;
  };
  /// Throws Error, and changes nothing, for a state that cannot be shown.
  virtual void check(const DesignState& state) const = 0;
  /// An approximate image, within the budget as far as it can.
  virtual LayerReport move(const Request& request, const FrameBudget& budget) = 0;
  /// Whatever makes later images of this state better, until `abandon` answers true (asked from
  /// several threads at once); what there is still to do. What was done is kept.
  virtual Unfinished improve(const std::function<bool()>& abandon) = 0;
  /// The exact image; false when abandoned.
  [[nodiscard]] virtual bool settle(const Request& request, const std::function<bool()>& abandon,
                                    LayerReport& report) = 0;

  /// Adds the layer to a tile's pixels; whether it has any there. Several threads at once.
  virtual bool add(std::size_t tile, TileImage& image) const = 0;
};

}  // namespace rimlight
