#include "core/curves/curve_layer.h"

#include <algorithm>
#include <atomic>
#include <map>
#include <optional>
#include <string>
#include <utility>

#include "core/base/check.h"
#include "core/base/parallel.h"
#include "core/base/stopwatch.h"
#include "core/curves/panel_freshness.h"
#include "core/curves/quick_image.h"
#include "core/curves/unshown_edits.h"

namespace rimlight {
namespace {

/// The same rows from frame to frame, so that the error moves smoothly.
constexpr std::uint64_t kSampleSeed = 1;

MeasuredLibrary library_of(const CurveReceivers& receivers) {
  MeasuredLibrary library;
  for (const CurveMaterial& each : receivers.measured) library.emplace(each.name, *each.measured);
  return library;
}

}  // namespace

struct CurveLayer::State {
  std::shared_ptr<const Bake> bake;
  CurveLayerSettings settings;
  CurveReceivers receivers;
  MeasuredLibrary library;
  CurveSky sky;
  CurveTransport transport;
  CurveUpdater updater;
  PanelFreshness freshness;
  std::vector<MaterialEdit> edits;         // [material]
  std::vector<CurveMaterialState> states;  // [material]
  QuickShader shader;
  std::optional<CurveLight> light;
  CubeLight texels;                 // that the light is of
  AlignedVector<float> quick;       // [panel][3][kPanelRows]
  std::uint64_t quick_version = 0;  // of freshness, that it shows
  std::vector<std::vector<std::uint32_t>> panels_of_tile;
  std::vector<std::uint32_t> listed;                        // panels to work on
  std::vector<std::uint8_t> is_made;                        // [listed]
  std::optional<decltype(DesignState::materials)> said_of;  // the edits that `unshown` is of
  std::vector<std::string> unshown;

  State(std::shared_ptr<const Bake> bake_, const CurveLayerSettings& settings_)
      : bake(std::move(bake_)),
        settings(settings_),
        receivers(bake->curve_receivers()),
        library(library_of(receivers)),
        sky(bake->manifest().cube_size),
        transport(receivers),
        updater(transport, settings.policy),
        freshness(transport),
        edits(receivers.materials.size()),
        states(start()),
        shader(transport, states),
        quick(transport.panels().size() * kPanelFloats),
        panels_of_tile(bake->manifest().pixels.tile_count()) {
    for (std::uint32_t panel = 0; panel < transport.panels().size(); ++panel) {
      panels_of_tile[transport.panels()[panel].tile].push_back(panel);
    }
  }

  /// The materials as they were baked.
  std::vector<CurveMaterialState> start() {
    std::vector<CurveMaterialState> baked;
    for (std::uint32_t m = 0; m < receivers.materials.size(); ++m) {
      baked.push_back(resolve(m, {}));
      freshness.start(m, baked.back());
    }
    return baked;
  }

  CurveMaterialState resolve(std::uint32_t material, const MaterialEdit& edit) const {
    const CurveMaterial& baked = receivers.materials[material];
    return rimlight::resolve(baked, edit, library, "material " + baked.name);
  }

  CurveCoefficients target(std::uint32_t material, CurveAxis axis) const {
    return transport.basis(axis).coefficients(*states[material].curve(axis));
  }

  /// The light and the materials that are asked for; what that leaves stale is not made yet.
  /// Whether it is another light.
  bool follow(const Request& request) {
    const DesignState& wanted = request.state;
    const bool is_other_light = !light || texels.values != request.texels.values;
    if (is_other_light) {
      if (light) {
        light->set(request.texels);
      } else {
        light.emplace(sky, request.texels,
                      std::min(settings.strongest_texels, request.texels.count()));
      }
      texels = request.texels;
      freshness.change_light();
    }
    for (std::uint32_t m = 0; m < edits.size(); ++m) {
      MaterialEdit edit = edit_of(wanted, receivers.materials[m].name);
      if (edit == edits[m]) continue;
      CurveMaterialState next = resolve(m, edit);
      freshness.change_material(m, change(states[m], next), next);
      states[m] = std::move(next);
      shader.change(m);
      edits[m] = std::move(edit);
    }
    for (std::uint32_t m = 0; m < edits.size(); ++m) aim(m);
    return is_other_light;
  }

  /// Some of what is stale, for a frame under a light that stands still.
  void make_some_fresh() {
    if (!(settings.rebuild_ms > 0)) return;
    const Stopwatch watch;
    const auto is_over = [&] { return watch.elapsed_ms() > settings.rebuild_ms; };
    if (make_fresh(is_over)) {
      for (std::uint32_t m = 0; m < states.size(); ++m) aim(m);
    }
  }

  /// Gives the updater the axis and the curve that a material is to show.
  void aim(std::uint32_t material) {
    const auto axis = freshness.axis(material);
    if (!freshness.all_fresh(material)) {
      if (axis && updater.axis(material) == axis) {
        updater.set_target(material, target(material, *axis));
      }
      return;
    }
    if (!freshness.all_shown(material)) {
      updater.show(material, axis, axis ? target(material, *axis) : CurveCoefficients{});
      freshness.mark_all_shown(material);
    } else if (axis) {
      updater.set_target(material, target(material, *axis));
    }
  }

  /// Makes a stale panel anew; from several threads.
  void rebuild(std::uint32_t panel, std::optional<CurveAxis> axis) {
    const std::uint32_t m = transport.panels()[panel].material;
    if (axis && !freshness.is_fresh(panel, *axis)) {
      transport.rebuild(panel, *light, states[m], *axis, freshness.version());
    } else {
      transport.rebuild_fixed(panel, *light, states[m], freshness.version());
    }
  }

  /// Makes the listed panels anew until abandoned; whether all are.
  template <typename AxisOf>
  bool rebuild_listed(const AxisOf& axis_of, const std::function<bool()>& abandon) {
    std::atomic<bool> is_abandoned{false};
    is_made.assign(listed.size(), 0);
    parallel_for(listed.size(), [&](std::size_t i) {
      if (is_abandoned || (abandon && abandon())) {
        is_abandoned = true;
        return;
      }
      rebuild(listed[i], axis_of(transport.panels()[listed[i]].material));
      is_made[i] = 1;
    });
    for (std::size_t i = 0; i < listed.size(); ++i) {
      if (is_made[i] != 0) show_made(listed[i]);
    }
    return !is_abandoned;
  }

  /// A panel was made: it is shown when it is of the axis that its material shows.
  void show_made(std::uint32_t panel) {
    const std::uint32_t m = transport.panels()[panel].material;
    if (!freshness.is_fresh(panel)) return;
    const auto axis = freshness.axis(m);
    if (updater.axis(m) != axis) {
      updater.show(m, axis, axis ? target(m, *axis) : CurveCoefficients{});
    } else {
      updater.refresh(panel);
    }
    freshness.mark_shown(panel);
  }

  bool make_fresh(const std::function<bool()>& abandon) {
    freshness.list_stale(listed);
    return rebuild_listed([&](std::uint32_t m) { return freshness.axis(m); }, abandon);
  }

  /// Norms of what is fresh, one material after the other.
  void find_norms(const std::function<bool()>& abandon) {
    for (std::uint32_t m = 0; m < states.size(); ++m) {
      const auto axis = freshness.axis(m);
      if (!axis || freshness.has_norms(m) || !freshness.all_fresh(m)) continue;
      if (abandon && abandon()) return;
      transport.find_norms(m, *axis);
      freshness.mark_norms(m);
    }
  }

  void shade_the_rest_quickly() {
    if (quick_version == freshness.version()) return;
    freshness.list_unshown(listed);
    const QuickDetail detail = quick_detail(listed.size() * kPanelRows);
    RIMLIGHT_CHECK(shader.shade(*light, listed, detail, {}, quick));
    quick_version = freshness.version();
  }

  LayerReport describe(const DesignState& state, std::size_t terms) {
    LayerReport report;
    report.terms = terms;
    report.squared_error_of_time = updater.squared_error();
    freshness.list_unshown(listed);
    report.squared_error_of_time +=
        shader.sampled_squared_error(*light, listed, quick, settings.sampled_rows, kSampleSeed);
    report.squared_error = report.squared_error_of_time;
    report.unfinished = freshness.unfinished();
    if (!said_of || *said_of != state.materials) {
      unshown = unshown_edits(receivers, states, state);
      said_of = state.materials;
    }
    report.unshown = unshown;
    return report;
  }
};

CurveLayer::CurveLayer(std::shared_ptr<const Bake> bake, const CurveLayerSettings& settings) {
  RIMLIGHT_CHECK(bake->has_curves());
  state_ = std::make_unique<State>(std::move(bake), settings);
}

CurveLayer::~CurveLayer() = default;

void CurveLayer::check(const DesignState& state) const {
  for (std::uint32_t m = 0; m < state_->edits.size(); ++m) {
    const MaterialEdit edit = edit_of(state, state_->receivers.materials[m].name);
    if (edit != state_->edits[m]) state_->resolve(m, edit);
  }
}

LayerReport CurveLayer::move(const Request& request, const FrameBudget& budget) {
  if (!state_->follow(request)) state_->make_some_fresh();
  state_->shade_the_rest_quickly();
  const CurveUpdateReport update = state_->updater.update(budget);
  return state_->describe(request.state, update.columns);
}

Unfinished CurveLayer::improve(const std::function<bool()>& abandon) {
  State& state = *state_;
  if (!state.light) return Unfinished::nothing;
  if (state.make_fresh(abandon)) {
    state.find_norms(abandon);
    state.freshness.list_stale_of_other_axis(state.listed);
    (void)state.rebuild_listed([&](std::uint32_t m) { return state.freshness.other_axis(m); },
                               abandon);
  }
  return state.freshness.unfinished();
}

bool CurveLayer::settle(const Request& request, const std::function<bool()>& abandon,
                        LayerReport& report) {
  state_->follow(request);
  if (!state_->make_fresh(abandon)) return false;
  for (std::uint32_t m = 0; m < state_->states.size(); ++m) state_->aim(m);
  if (!state_->updater.apply_exact(abandon)) return false;
  report = state_->describe(request.state, 0);
  return true;
}

bool CurveLayer::add(std::size_t tile, TileImage& image) const {
  const State& state = *state_;
  const PixelLayout& pixels = state.bake->manifest().pixels;
  const auto [left, top] = pixels.pixel(tile * kTileReceivers);
  for (const std::uint32_t panel : state.panels_of_tile[tile]) {
    const float* const rows = state.freshness.is_shown(panel)
                                  ? state.updater.image(panel).data()
                                  : state.quick.data() + panel * kPanelFloats;
    const CurvePanel& of = state.transport.panels()[panel];
    for (std::size_t row = 0; row < of.row_count; ++row) {
      const auto [x, y] = pixels.pixel(of.receivers[row]);
      const std::size_t at =
          static_cast<std::size_t>(y - top) * TileImage::kSide + static_cast<std::size_t>(x - left);
      for (std::size_t c = 0; c < 3; ++c) {
        image.channel[c][at] += rows[c * kPanelRows + row];
      }
    }
  }
  return !state.panels_of_tile[tile].empty();
}

std::unique_ptr<ImageLayer> curve_layer_of(const std::shared_ptr<const Bake>& bake) {
  if (!bake->has_curves()) return nullptr;
  return std::make_unique<CurveLayer>(bake, CurveLayerSettings{});
}

}  // namespace rimlight
