#include "core/relight/frame_renderer.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <utility>

#include "core/base/check.h"
#include "core/base/parallel.h"
#include "core/base/stopwatch.h"
#include "core/image/metrics.h"
#include "core/light/light_rotation.h"
#include "core/relight/background.h"
#include "core/relight/display.h"
#include "core/relight/error_estimate.h"
#include "core/relight/prepared_environment.h"
#include "core/relight/recent_times.h"
#include "core/relight/relighter.h"
#include "core/relight/shown_environments.h"

namespace rimlight {
namespace {

/// An environment, ready for this renderer's frames.
struct Light {
  std::shared_ptr<const PreparedEnvironment> prepared;
  LightRotator rotator;

  explicit Light(std::shared_ptr<const PreparedEnvironment> prepared_)
      : prepared(std::move(prepared_)), rotator(prepared->texels) {}
};

}  // namespace

struct FrameRenderer::State {
  std::shared_ptr<const Bake> bake;
  RelightSettings settings;
  CubeHaar haar;
  Relighter relighter;
  Display display;
  ErrorEstimator estimator;
  ShownEnvironments environments;
  std::map<std::string, Light> lights;  // of the environments shown so far
  CubeLight texels;                     // of the rotated light; scratch of its transform
  CubeLight target;
  std::array<float, kLayers> shares;  // of the image's energy, by layer
  FrameUpdater updater;
  RecentTimes showing;         // display and estimate: what a deadline has to leave
  int frames_to_estimate = 0;  // until the error is estimated again
  ErrorEstimate estimated;     // when it was
  std::unique_ptr<ImageLayer> layer;
  CubeLight turned;  // texels for it

  State(std::shared_ptr<const Bake> bake_, const RelightSettings& settings_,
        std::unique_ptr<ImageLayer> layer_)
      : bake(std::move(bake_)),
        settings(settings_),
        haar(bake->manifest().cube_size),
        relighter(bake->transport(), bake->reflectance(), haar, held_images_for(settings.policy)),
        display(bake->manifest().pixels, bake->manifest().camera, bake->coverage()),
        estimator(bake->sketch()),
        environments(bake->environments()),
        target(haar.size()),
        shares(layer_shares(bake->sketch())),
        updater(*bake, haar, settings.policy, relighter),
        layer(std::move(layer_)) {}

  const PixelLayout& pixels() const { return bake->manifest().pixels; }

  Light& light(const std::string& name) {
    const auto found = lights.find(name);
    if (found != lights.end()) return found->second;
    return lights
        .try_emplace(name, prepare_environment(environments.at(name).environment,
                                               {haar.size(), settings.background_size}))
        .first->second;
  }

  /// The light's coefficients in this rotation.
  void find_target(LightRotator& rotator, const Quaternion& rotation) {
    rotator.rotate(rotation, texels);
    if (layer) turned = texels;  // the transform uses up its own
    const auto transform = [this](std::size_t c) {
      const int channel = static_cast<int>(c);
      haar.forward(texels.channel(channel), target.channel(channel));
    };
    parallel_for(3, transform);
  }

  /// The budget of the update: a deadline is less what the rest of the frame takes. A layer that
  /// has taken more than half of the time has it: what it has made would be worth little over
  /// light that stayed behind.
  FrameBudget update_budget(double rotate_ms, double layer_ms) const {
    const double half = (settings.budget.amount - rotate_ms - showing.typical_ms()) / 2;
    return reduce_deadline(settings.budget,
                           rotate_ms + std::clamp(half, 0.0, layer_ms) + showing.typical_ms());
  }

  /// Refreshes the estimate, every few frames where it would take more than its share of a frame.
  void estimate_error(double image_norm, const LayerReport& added, FrameReport& report) {
    constexpr double kMostShare = 0.05;
    if (report.exact || --frames_to_estimate <= 0) {
      Stopwatch watch;
      estimated = estimator.estimate(target, relighter.held());
      report.estimate_ms = watch.lap_ms();
      const double frame_ms = report.rotate_ms + report.update_ms + report.display_ms;
      frames_to_estimate = static_cast<int>(
          std::min(10.0, std::ceil(report.estimate_ms / (kMostShare * std::max(frame_ms, 0.1)))));
    }
    if (!(image_norm > 0)) return;
    const auto relative = [image_norm](double error, double squared) {
      return std::sqrt(error * error + squared) / image_norm;
    };
    report.estimate = relative(estimated.error, added.squared_error);
    report.estimate_of_time = relative(estimated.residual, added.squared_error_of_time);
  }

  double residual() const {
    const double size = weighted_size(haar, target);
    return size > 0 ? weighted_distance(haar, target, relighter.held(), shares) / size : 0;
  }

  /// What one camera's image with its materials baked in cannot follow.
  std::vector<std::string> unshown(const DesignState& state) const {
    std::vector<std::string> result;
    if (state.view && *state.view != bake->manifest().camera) {
      result.emplace_back("the moved camera (this bake is the image of one)");
    }
    if (!layer && !state.materials.empty()) {
      result.emplace_back("edits of materials (this bake has them built in)");
    }
    return result;
  }

  /// Makes pixels, and the estimate that the report says.
  void show(const DesignState& state, const Quaternion& rotation, Rgb8Image& frame,
            const LayerReport& added, FrameReport& report) {
    Stopwatch watch;
    const double norm = display.show(Display::tiles_of(relighter, layer.get()),
                                     {light(state.environment).prepared->background, rotation},
                                     environments.exposure_of(state), frame);
    report.display_ms = watch.lap_ms();
    report.terms += added.terms;
    report.unfinished = added.unfinished;
    report.unshown = unshown(state);
    report.unshown.insert(report.unshown.end(), added.unshown.begin(), added.unshown.end());
    estimate_error(norm, added, report);
    showing.add(report.display_ms + report.estimate_ms);
  }

  /// The exact image of a state in the relighter; false when abandoned.
  bool relight_exactly(const DesignState& state, const Quaternion& rotation, FrameReport& report,
                       LayerReport& added, const std::function<bool()>& abandon) {
    if (layer) layer->check(state);
    Stopwatch watch;
    find_target(light(state.environment).rotator, rotation);
    const double rotate_ms = watch.lap_ms();
    if (layer && !layer->settle({state, turned}, abandon, added)) return false;
    if (!relighter.apply_exact(target, abandon)) return false;
    report = {};
    report.exact = true;
    report.terms = relighter.last_terms();
    report.bands_reset = static_cast<std::size_t>(haar.band_count());
    report.rotate_ms = rotate_ms;
    report.update_ms = watch.lap_ms();
    return true;
  }

  /// Radiance of the pixels that geometry covers, for the exposure of an environment.
  std::vector<Vec3f> covered_radiance() const {
    const Display::FillTile fill = Display::tiles_of(relighter, layer.get());
    std::vector<Vec3f> result;
    TileImage image;
    for (std::size_t tile = 0; tile < relighter.tile_count(); ++tile) {
      fill(tile, image);
      const auto [left, top] = pixels().pixel(tile * kTileReceivers);
      for (std::size_t i = 0; i < kTileReceivers; ++i) {
        const auto [x, y] = pixels().pixel(tile * kTileReceivers + i);
        if (x >= pixels().width || y >= pixels().height) continue;
        if (!(bake->coverage()[static_cast<std::size_t>(y * pixels().width + x)] > 0)) continue;
        const auto at = static_cast<std::size_t>(y - top) * TileImage::kSide +
                        static_cast<std::size_t>(x - left);
        result.emplace_back(image.channel[0][at], image.channel[1][at], image.channel[2][at]);
      }
    }
    return result;
  }
};

FrameRenderer::FrameRenderer(std::shared_ptr<const Bake> bake, const RelightSettings& settings,
                             std::unique_ptr<ImageLayer> layer)
    : state_(std::make_unique<State>(std::move(bake), settings, std::move(layer))) {}

FrameRenderer::~FrameRenderer() = default;

const Bake& FrameRenderer::bake() const { return *state_->bake; }

void FrameRenderer::prepare(const Bake& bake, const RelightSettings& settings) {
  for (const BakedEnvironment& baked : bake.environments()) {
    prepare_environment(baked.environment, {bake.manifest().cube_size, settings.background_size});
  }
}

void FrameRenderer::add_environment(std::shared_ptr<const Environment> environment) {
  const std::string name = environment->name();
  state_->lights.erase(name);
  state_->environments.set({environment, 1});
  FrameReport report;
  DesignState state;
  state.environment = name;
  LayerReport added;
  RIMLIGHT_CHECK(state_->relight_exactly(state, {}, report, added, {}));
  state_->environments.set({environment, auto_exposure_scale(state_->covered_radiance())});
}

void FrameRenderer::set_budget(const FrameBudget& budget) { state_->settings.budget = budget; }

FrameReport FrameRenderer::render_moving(const DesignState& state, Rgb8Image& frame) {
  const Quaternion rotation = checked_rotation(state);
  Light& light = state_->light(state.environment);
  if (state_->layer) state_->layer->check(state);
  FrameReport report;
  Stopwatch watch;
  state_->find_target(light.rotator, rotation);
  report.rotate_ms = watch.lap_ms();
  LayerReport added;
  if (state_->layer) {
    added =
        state_->layer->move({state, state_->turned}, state_->update_budget(report.rotate_ms, 0));
    report.update_ms = watch.lap_ms();
  }
  const UpdateReport update = state_->updater.update(
      state_->target, state_->update_budget(report.rotate_ms, report.update_ms));
  report.update_ms += watch.lap_ms();
  report.terms = update.columns;
  report.bands_reset = update.bands_reset;
  report.residual = state_->residual();
  state_->show(state, rotation, frame, added, report);
  return report;
}

bool FrameRenderer::render_exact(const DesignState& state, Rgb8Image& frame, FrameReport& report,
                                 const std::function<bool()>& abandon) {
  const Quaternion rotation = checked_rotation(state);
  LayerReport added;
  if (!state_->relight_exactly(state, rotation, report, added, abandon)) return false;
  state_->show(state, rotation, frame, added, report);
  return true;
}

Unfinished FrameRenderer::improve(const std::function<bool()>& abandon) {
  return state_->layer ? state_->layer->improve(abandon) : Unfinished::nothing;
}

void FrameRenderer::render_radiance(const DesignState& state, RgbImage& image,
                                    FrameReport& report) {
  const Quaternion rotation = checked_rotation(state);
  LayerReport added;
  RIMLIGHT_CHECK(state_->relight_exactly(state, rotation, report, added, {}));
  Stopwatch watch;
  state_->display.show(Display::tiles_of(state_->relighter, state_->layer.get()),
                       {state_->light(state.environment).prepared->background, rotation}, image);
  report.display_ms = watch.lap_ms();
}

}  // namespace rimlight
