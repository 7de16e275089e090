#include "core/vertices/moving_view.h"

#include <algorithm>

#include "core/base/stopwatch.h"

namespace rimlight {

MovingView::MovingView(const VertexScene& scene, const std::shared_ptr<const TriangleTree>& tree,
                       const FrameBudget& budget, double view_ms)
    : shown_(scene, tree, {PixelPoint{}}, 1),
      deadline_(budget, view_ms),
      plan_(*scene.mesh, scene.transport.visibility_degree),
      layout_{scene.width, scene.height},
      results_(layout_.tile_count()) {}

void MovingView::look(const Camera& camera) {
  const GBufferDetail known = shown_.view.detail_of(camera);
  const GBufferDetail detail = deadline_.detail(known);
  const Stopwatch watch;
  if (shown_.look(camera, detail)) is_planned_ = false;
  if (deadline_.is_kept() && !is_planned_) {
    plan_.find(shown_.view);
    is_planned_ = true;
  }
  if (known < detail) deadline_.looked(known, detail, watch.elapsed_ms());
}

void MovingView::look_whole(const Camera& camera) {
  if (shown_.look(camera, GBufferDetail::full)) is_planned_ = false;
}

std::span<const std::uint32_t> MovingView::choose_vertices(const VertexLighting& lighting) {
  if (!deadline_.is_kept()) return shown_.view.highlight_vertices();
  std::array<std::size_t, kHighlightRates> missing{};
  for (const HighlightRate rate :
       {HighlightRate::every, HighlightRate::quarter, HighlightRate::sixteenth}) {
    missing[index_of(rate)] = lighting.missing(plan_.vertices(rate));
  }
  rate_ = deadline_.choose_rate(plan_, missing);
  missing_ = missing[index_of(rate_)];
  lit_from_ms_ = deadline_.elapsed_ms();
  return plan_.vertices(rate_);
}

void MovingView::lit() {
  if (deadline_.is_kept()) deadline_.lit(missing_, deadline_.elapsed_ms() - lit_from_ms_);
}

Display::FillTile MovingView::tiles(const VertexShading& shading) {
  if (deadline_.is_kept()) deadline_.start_tiles(plan_, rate_);
  return [this, &shading](std::size_t tile, TileImage& image) {
    const auto [left, top] = layout_.pixel(tile * kTileReceivers);
    TileResult& result = results_[tile];
    result = {};
    const HighlightRate rate =
        deadline_.is_kept() ? deadline_.rate_of_tile() : HighlightRate::every;
    result.square = rate == HighlightRate::every
                        ? shade_tile(shading, left, top, image)
                        : shade_tile(shading, plan_, rate, left, top, image, result.error);
    if (shown_.view.step() == 2) {
      result.variation = variation_of(image, std::min(PixelLayout::kTileSide, layout_.width - left),
                                      std::min(PixelLayout::kTileSide, layout_.height - top));
    }
    if (deadline_.is_kept()) deadline_.finish_tile(tile, rate);
    return result.square;
  };
}

MovingSquares MovingView::finish() {
  if (deadline_.is_kept()) deadline_.finish();
  MovingSquares squares;
  MeasuredError error;
  TileVariation variation;
  for (const TileResult& result : results_) {
    squares.image += result.square;
    error += result.error;
    variation += result.variation;
  }
  // Each pixel that a coarse view knows is shown four times.
  const int step = shown_.view.step();
  squares.highlights = error.square_of_all() * step * step;
  if (step == 2) squares.view = variation.square_of_missing();
  return squares;
}

}  // namespace rimlight
