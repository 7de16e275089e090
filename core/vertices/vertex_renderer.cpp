#include "core/vertices/vertex_renderer.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <numbers>
#include <numeric>
#include <utility>

#include "core/base/check.h"
#include "core/base/stopwatch.h"
#include "core/image/metrics.h"
#include "core/relight/display.h"
#include "core/relight/prepared_environment.h"
#include "core/relight/shown_environments.h"
#include "core/vertices/moving_view.h"
#include "core/vertices/vertex_estimate.h"
#include "core/vertices/vertex_lights.h"
#include "core/vertices/vertex_shading.h"

namespace rimlight {
namespace {

/// More of the picture than this seen from behind is said.
constexpr double kMostFromBehind = 0.01;

/// What the vertices are lit by.
struct LitBy {
  std::string environment;
  Quaternion rotation;

  friend bool operator==(const LitBy&, const LitBy&) = default;
};

VertexLights::Settings light_settings(const VertexScene& scene, const VertexSettings& settings) {
  return {{settings.light_size, settings.background_size},
          VertexLights::degree_for(scene.transport),
          settings.window,
          settings.sun.value_or(scene.sun)};
}

std::shared_ptr<const TriangleTree> tree_of(const VertexScene& scene) {
  if (scene.tree) return scene.tree;
  return std::make_shared<const TriangleTree>(scene.mesh->positions, scene.mesh->triangles,
                                              scene.name);
}

std::shared_ptr<const VertexScene> checked(std::shared_ptr<const VertexScene> scene) {
  RIMLIGHT_CHECK(scene != nullptr);
  check_vertex_scene(*scene);
  return scene;
}

}  // namespace

struct VertexRenderer::State {
  std::shared_ptr<const VertexScene> scene;
  VertexSettings settings;
  std::shared_ptr<const TriangleTree> tree;
  MovingView quick;  // of one point a pixel
  ShownView smooth;  // of several
  VertexLighting lighting;
  VertexMaterials materials;
  VertexEstimator estimator;
  ShownEnvironments environments;
  VertexLights lights;
  std::optional<LitBy> held;
  std::vector<float> turned;
  std::optional<Sun> sun;      // turned as well, where it is apart
  std::vector<Vec3f> diffuse;  // [vertex]
  Rgb8Image drawn;             // an exact frame, until it is known that nobody abandons it

  State(std::shared_ptr<const VertexScene> scene_, const VertexSettings& settings_)
      : scene(checked(std::move(scene_))),
        settings(settings_),
        tree(tree_of(*scene)),
        quick(*scene, tree, settings.budget, settings.view_ms),
        smooth(*scene, tree, {kSmoothPoints.begin(), kSmoothPoints.end()}, kSmoothSunRays),
        lighting(scene->transport),
        materials(*scene, lighting.stride()),
        estimator(*scene),
        environments(scene->environments),
        lights(light_settings(*scene, settings)),
        diffuse(scene->mesh->positions.size()) {}

  const ShownLight& light(const std::string& name) {
    return lights.at(environments.at(name).environment);
  }

  /// Turns the light and gives it to the vertices, unless they have it.
  void hold(const std::string& environment, const Quaternion& rotation) {
    const LitBy wanted{environment, rotation};
    if (held == wanted) return;
    const ShownLight& source = light(environment);
    turned.resize(source.light.coefficients().size());
    source.light.turn(rotation, turned);
    lighting.set_light(turned);
    sun = source.sun;
    if (sun) sun->direction = rotated(rotation, sun->direction);
    held = wanted;
  }

  /// The light of what the view needs, the arriving one of some of it; from it the vertices'
  /// diffuse radiance, and who sees the sun.
  void light_view(ShownView& shown, std::span<const std::uint32_t> highlight_vertices) {
    shown.find_shadows(sun);
    const VertexView& view = shown.view;
    lighting.light(view.vertices(), highlight_vertices);
    const VertexMesh& mesh = *scene->mesh;
    for (const std::uint32_t vertex : view.vertices()) {
      const Vec3f& albedo = materials.at(mesh.materials[vertex]).albedo;
      diffuse[vertex] =
          mesh.tints[vertex] * albedo * lighting.irradiance(vertex) * std::numbers::inv_pi_v<float>;
    }
  }

  VertexShading shading_of(const ShownView& shown) const {
    return {*scene->mesh,
            shown.view,
            diffuse,
            lighting,
            materials,
            scene->transport.visibility_degree,
            sun ? &*sun : nullptr,
            shown.shadows};
  }

  /// At full rate.
  Display::FillTile tiles_of(const ShownView& shown) const {
    return [this, &shown](std::size_t tile, TileImage& image) {
      const auto [left, top] =
          PixelLayout{scene->width, scene->height}.pixel(tile * kTileReceivers);
      return shade_tile(shading_of(shown), left, top, image);
    };
  }

  void describe(const VertexView& view, FrameReport& report) const {
    report.terms = turned.size() / 3;
    report.unshown = materials.unshown();
    if (view.share_from_behind() > kMostFromBehind) {
      report.unshown.emplace_back("the backs of surfaces (they look like their fronts)");
    }
  }

  Display::Background background(const DesignState& state, const Quaternion& rotation) {
    return {light(state.environment).prepared->background, rotation};
  }

  const Camera& camera_of(const DesignState& state) const {
    if (!state.view) return scene->camera;
    check_camera(*state.view, "view");
    return *state.view;
  }

  /// Says it where the bake does, and in moving frames, whose own part is always known.
  void estimate_error(ShownView& shown, const MovingSquares& squares, FrameReport& report) const {
    if (!(squares.image > 0) || (report.exact && !estimator.is_known())) return;
    shown.find_weights(*scene, estimator.sampling());
    const double of_bake = estimator.square(shown.weights, materials, turned);
    report.estimate = std::sqrt((of_bake + squares.of_time()) / squares.image);
    report.estimate_of_time = std::sqrt(squares.of_time() / squares.image);
  }

  /// A moving frame; `show` makes pixels of tiles and background.
  template <typename Show>
  FrameReport show_moving(const DesignState& state, const Show& show) {
    const Quaternion rotation = checked_rotation(state);
    const Camera& camera = camera_of(state);
    materials.set(state.materials);
    FrameReport report;
    Stopwatch watch;
    quick.start();
    hold(state.environment, rotation);
    report.rotate_ms = watch.lap_ms();
    quick.look(camera);
    ShownView& shown = quick.shown();
    light_view(shown, quick.choose_vertices(lighting));
    quick.lit();
    report.update_ms = watch.lap_ms();
    describe(shown.view, report);
    const VertexShading shading = shading_of(shown);
    show(quick.tiles(shading), background(state, rotation));
    const MovingSquares squares = quick.finish();
    report.display_ms = watch.lap_ms();
    estimate_error(shown, squares, report);
    report.estimate_ms = watch.lap_ms();
    return report;
  }

  /// All that an exact frame is made of, in the smooth view; false when abandoned.
  bool relight_exactly(const DesignState& state, const Quaternion& rotation, FrameReport& report,
                       const std::function<bool()>& abandon) {
    const Camera& camera = camera_of(state);
    materials.set(state.materials);
    const auto abandoned = [&] { return abandon && abandon(); };
    report = {};
    report.exact = true;
    Stopwatch watch;
    hold(state.environment, rotation);
    report.rotate_ms = watch.lap_ms();
    if (abandoned()) return false;
    smooth.look(camera, GBufferDetail::full);
    if (abandoned()) return false;
    light_view(smooth, smooth.view.highlight_vertices());
    report.update_ms = watch.lap_ms();
    describe(smooth.view, report);
    return !abandoned();
  }
};

VertexRenderer::VertexRenderer(std::shared_ptr<const VertexScene> scene,
                               const VertexSettings& settings)
    : state_(std::make_unique<State>(std::move(scene), settings)) {}

VertexRenderer::~VertexRenderer() = default;

const VertexScene& VertexRenderer::scene() const { return *state_->scene; }

void VertexRenderer::prepare(const VertexScene& scene, const VertexSettings& settings) {
  for (const BakedEnvironment& baked : scene.environments) {
    prepare_environment(baked.environment, {settings.light_size, settings.background_size});
  }
}

void VertexRenderer::add_environment(std::shared_ptr<const Environment> environment) {
  const std::string name = environment->name();
  state_->lights.forget(name);
  state_->held.reset();
  state_->environments.set({environment, 1});
  DesignState state;
  state.environment = name;
  state_->materials.set({});
  state_->hold(name, {});
  ShownView& quick = state_->quick.shown();
  state_->quick.look_whole(state_->scene->camera);
  state_->light_view(quick, quick.view.highlight_vertices());
  const auto fill = state_->tiles_of(quick);
  const PixelLayout pixels{state_->scene->width, state_->scene->height};
  const auto coverage = quick.view.coverage();
  std::vector<Vec3f> covered;
  TileImage image;
  for (std::size_t tile = 0; tile < pixels.tile_count(); ++tile) {
    fill(tile, image);
    for (std::size_t i = 0; i < kTileReceivers; ++i) {
      const auto [x, y] = pixels.pixel(tile * kTileReceivers + i);
      if (x >= pixels.width || y >= pixels.height) continue;
      if (!(coverage[static_cast<std::size_t>(y * pixels.width + x)] > 0)) continue;
      const auto at = static_cast<std::size_t>(y % PixelLayout::kTileSide) * TileImage::kSide +
                      static_cast<std::size_t>(x % PixelLayout::kTileSide);
      covered.emplace_back(image.channel[0][at], image.channel[1][at], image.channel[2][at]);
    }
  }
  state_->environments.set({environment, auto_exposure_scale(covered)});
}

void VertexRenderer::set_budget(const FrameBudget& budget) { state_->quick.set_budget(budget); }

FrameReport VertexRenderer::render_moving(const DesignState& state, Rgb8Image& frame) {
  return state_->show_moving(state, [&](const auto& tiles, const auto& background) {
    state_->quick.shown().display.show(tiles, background, state_->environments.exposure_of(state),
                                       frame);
  });
}

FrameReport VertexRenderer::render_moving(const DesignState& state, RgbImage& image) {
  return state_->show_moving(state, [&](const auto& tiles, const auto& background) {
    state_->quick.shown().display.show(tiles, background, image);
  });
}

bool VertexRenderer::render_exact(const DesignState& state, Rgb8Image& frame, FrameReport& report,
                                  const std::function<bool()>& abandon) {
  const Quaternion rotation = checked_rotation(state);
  if (!state_->relight_exactly(state, rotation, report, abandon)) return false;
  Stopwatch watch;
  ShownView& smooth = state_->smooth;
  std::atomic<bool> is_abandoned{false};
  const auto fill = [&, tiles = state_->tiles_of(smooth)](std::size_t tile, TileImage& image) {
    if (abandon && (is_abandoned.load() || abandon())) {
      is_abandoned.store(true);
      for (auto& channel : image.channel) channel.fill(0);
      return 0.0;
    }
    return tiles(tile, image);
  };
  const double norm = smooth.display.show(fill, state_->background(state, rotation),
                                          state_->environments.exposure_of(state), state_->drawn);
  if (is_abandoned.load()) return false;
  std::swap(frame, state_->drawn);
  report.display_ms = watch.lap_ms();
  state_->estimate_error(smooth, {.image = norm * norm}, report);
  report.estimate_ms = watch.lap_ms();
  return true;
}

void VertexRenderer::render_radiance(const DesignState& state, RgbImage& image,
                                     FrameReport& report) {
  const Quaternion rotation = checked_rotation(state);
  RIMLIGHT_CHECK(state_->relight_exactly(state, rotation, report, {}));
  Stopwatch watch;
  ShownView& smooth = state_->smooth;
  std::vector<double> squares(PixelLayout{scene().width, scene().height}.tile_count());
  const auto fill = [&, tiles = state_->tiles_of(smooth)](std::size_t tile, TileImage& part) {
    return squares[tile] = tiles(tile, part);
  };
  smooth.display.show(fill, state_->background(state, rotation), image);
  report.display_ms = watch.lap_ms();
  const double square = std::accumulate(squares.begin(), squares.end(), 0.0);
  state_->estimate_error(smooth, {.image = square}, report);
}

}  // namespace rimlight
