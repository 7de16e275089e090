#include "core/report/stale_curves.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "core/base/check.h"
#include "core/base/parallel.h"
#include "core/base/stopwatch.h"
#include "core/curves/curve_layer.h"
#include "core/light/light_rotation.h"

namespace rimlight {
namespace {

constexpr double kFrameMs = 16;
constexpr double kDegree = std::numbers::pi / 180;

using Tiles = std::vector<TileImage>;

double distance(const Tiles& a, const Tiles* b) {
  std::vector<double> sums(a.size());
  parallel_for(a.size(), [&](std::size_t t) {
    for (std::size_t c = 0; c < 3; ++c) {
      for (std::size_t i = 0; i < a[t].channel[c].size(); ++i) {
        const double difference =
            b == nullptr ? a[t].channel[c][i] : double{a[t].channel[c][i]} - (*b)[t].channel[c][i];
        sums[t] += difference * difference;
      }
    }
  });
  double sum = 0;
  for (const double each : sums) sum += each;
  return std::sqrt(sum);
}

/// A layer that is exact, and is then asked for something else.
class Stale {
 public:
  explicit Stale(const std::shared_ptr<const Bake>& bake)
      : layer_(bake, {}), tile_count_(bake->manifest().pixels.tile_count()) {}

  StaleCurveRow change(const std::string& cause, const std::string& light, const DesignState& state,
                       const CubeLight& texels) {
    StaleCurveRow row;
    row.cause = cause;
    row.light = light;
    const ImageLayer::Request request{state, texels};
    Stopwatch watch;
    LayerReport report = layer_.move(request, {FrameBudget::Unit::milliseconds, kFrameMs});
    row.quick_ms = watch.lap_ms();
    const Tiles quick = gather();
    const double estimated = std::sqrt(report.squared_error);
    watch.lap_ms();
    RIMLIGHT_CHECK(layer_.settle(request, {}, report));
    row.exact_ms = row.quick_ms + watch.lap_ms();
    const Tiles exact = gather();
    const double size = distance(exact, nullptr);
    row.error_l2 = size > 0 ? distance(quick, &exact) / size : 0;
    row.estimate = size > 0 ? estimated / size : 0;
    watch.lap_ms();
    layer_.improve({});
    row.all_ms = row.exact_ms + watch.lap_ms();
    return row;
  }

  /// An edit whose T′ is fresh; what it leaves stale stays so.
  void edit(const DesignState& state, const CubeLight& texels) {
    layer_.move({state, texels}, {FrameBudget::Unit::milliseconds, kFrameMs});
  }

 private:
  Tiles gather() const {
    Tiles tiles(tile_count_);
    parallel_for(tile_count_, [&](std::size_t tile) { layer_.add(tile, tiles[tile]); });
    return tiles;
  }

  CurveLayer layer_;
  std::size_t tile_count_;
};

CurveEdit darker(const BrdfCurve& curve) {
  CurveEdit edit;
  for (const Vec3f& value : curve.values) edit.values.push_back(value * 0.8f);
  return edit;
}

/// The session's last curves.
DesignState last_state(const CurveSession& session) {
  DesignState state;
  for (const CurveStroke& stroke : session.strokes) {
    MaterialEdit& edit = state.materials[stroke.material];
    (stroke.axis == CurveAxis::half_angle ? edit.half_angle : edit.difference_angle) = stroke.to;
  }
  return state;
}

/// An edit over θ_d, and then one over θ_h, whose T′ the first left stale.
void change_axis(const Bake& bake, DesignState state, const std::string& light,
                 const CubeLight& texels, Stale& stale, std::vector<StaleCurveRow>& rows) {
  for (const CurveMaterial& material : bake.manifest().materials) {
    MaterialEdit& edit = state.materials[material.name];
    const auto shown = resolve(material, edit, {}, material.name);
    if (!shown.half_angle || !shown.difference_angle) continue;
    edit.difference_angle = darker(*shown.difference_angle);
    stale.edit(state, texels);
    edit.half_angle = darker(*shown.half_angle);
    rows.push_back(stale.change("other axis", light, state, texels));
    return;
  }
}

}  // namespace

std::vector<StaleCurveRow> measure_stale_curves(const std::shared_ptr<const Bake>& bake,
                                                const CurveSession& session,
                                                const std::shared_ptr<const Environment>& light,
                                                const std::function<void(double share)>& progress) {
  std::vector<StaleCurveRow> rows;
  const DesignState state = last_state(session);
  const int size = bake->manifest().cube_size;
  std::vector<std::shared_ptr<const Environment>> lights;
  for (const auto& one : bake->environments()) {
    if (one.environment->name() != light->name()) lights.push_back(one.environment);
  }
  if (!lights.empty()) lights.push_back(light);  // another one again
  constexpr double kTurns[] = {1, 10, 90};
  const double steps = static_cast<double>(lights.size() + std::size(kTurns)) + 2;
  const auto tell = [&](std::size_t done) { progress(static_cast<double>(done) / steps); };
  Stale stale(bake);
  LightRotator rotator(light->project(size));
  // A first light, so that all that follow are changes.
  (void)stale.change("start", light->name(), state, rotator.source());
  for (const auto& each : lights) {
    tell(rows.size() + 1);
    rows.push_back(stale.change("environment", each->name(), state, each->project(size)));
  }
  CubeLight turned;
  for (const double degrees : kTurns) {
    tell(rows.size() + 1);
    rotator.rotate(axis_angle({0, 1, 0}, degrees * kDegree), turned);
    rows.push_back(stale.change("rotation", light->name(), state, turned));
  }
  change_axis(*bake, state, light->name(), turned, stale, rows);
  tell(rows.size() + 1);
  return rows;
}

}  // namespace rimlight
