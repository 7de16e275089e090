#pragma once

#include <memory>

#include "core/curves/curve_updater.h"
#include "core/relight/image_layer.h"
#include "core/transport/bake_folder.h"

namespace rimlight {

struct CurveLayerSettings {
  CurvePolicy policy = CurvePolicy::benefit;
  /// Texels of a light that has just changed that are summed exactly; the rest goes by means.
  std::size_t strongest_texels = 128;
  /// Rows whose exact value tells the error of such an image.
  std::size_t sampled_rows = 256;
  /// So long does a frame under the light of the frame before make T′ where it is stale, so that it
  /// becomes fresh even where edits follow each other without a pause.
  double rebuild_ms = 40;
};

/// Direct light of a bake's editable materials under their curves, as a layer of its FrameRenderer.
///
/// Each material is shown on one axis: that of the curve that was edited last. While its T′ is
/// fresh, an edit of that curve costs some columns of it. What makes T′ stale (another light, the
/// other curve, a parameter that is in no curve) shows the quick image until improve() or settle()
/// has made T′ again, panel by panel, and frames in which only materials change make some; from
/// then on a panel is exact. When all is fresh, improve()
/// makes the other axis' T′ as well.
///
/// Light that comes by way of other surfaces stays as it was baked, and so does the sky behind.
class CurveLayer final : public ImageLayer {
 public:
  /// Of a bake with curves (CheckFailure).
  CurveLayer(std::shared_ptr<const Bake> bake, const CurveLayerSettings& settings);
  ~CurveLayer() override;

  void check(const DesignState& state) const override;
  LayerReport move(const Request& request, const FrameBudget& budget) override;
  Unfinished improve(const std::function<bool()>& abandon) override;
  [[nodiscard]] bool settle(const Request& request, const std::function<bool()>& abandon,
                            LayerReport& report) override;
  bool add(std::size_t tile, TileImage& image) const override;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

/// The layer of a bake's frames; nothing for a bake without curves.
std::unique_ptr<ImageLayer> curve_layer_of(const std::shared_ptr<const Bake>& bake);

}  // namespace rimlight
