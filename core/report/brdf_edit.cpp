#include "core/report/brdf_edit.h"

#include <algorithm>
#include <cmath>

#include "core/base/check.h"
#include "core/base/parallel.h"
#include "core/report/edited_curves.h"

namespace rimlight {
namespace {

/// Rows whose sums over all texels stand for all.
constexpr std::size_t kSampledRows = 256;

/// √ Σ (a − b)² over all panels; without `b` √ Σ a². Sums in double, panel by panel in order.
double distance(const CurveUpdater& a, const CurveUpdater* b, std::size_t panels) {
  std::vector<double> sums(panels);
  parallel_for(panels, [&](std::size_t panel) {
    const auto left = a.image(panel);
    const auto right = b == nullptr ? std::span<const float>() : b->image(panel);
    for (std::size_t i = 0; i < left.size(); ++i) {
      const double difference = right.empty() ? left[i] : double{left[i]} - right[i];
      sums[panel] += difference * difference;
    }
  });
  double sum = 0;
  for (const double each : sums) sum += each;
  return std::sqrt(sum);
}

class Player {
 public:
  Player(EditedCurves& curves, const std::vector<CurveRun>& runs)
      : curves_(curves), runs_(runs), exact_(curves.transport(), CurvePolicy::bi) {
    for (const CurveRun& run : runs) {
      updaters_.push_back(std::make_unique<CurveUpdater>(curves.transport(), run.policy));
    }
    rows_.resize(runs.size());
  }

  void start(std::vector<StrokeReport>& strokes) {
    const auto made = curves_.make_all();
    for (const auto& each : made) show(each.material);
    for (std::size_t s = 0; s < strokes.size(); ++s) {
      const std::uint32_t m = curves_.material_of(s);
      if (std::ranges::count(first_strokes_, m) > 0) continue;
      first_strokes_.push_back(m);
      add(made[m], strokes[s]);
    }
  }

  void play(int frame, std::vector<StrokeReport>& strokes) {
    const CurveSession::Place place = curves_.session().place(frame);
    const std::uint32_t material = curves_.material_of(place.stroke);
    StrokeReport& stroke = strokes[place.stroke];
    if (place.step == 0) begin(place.stroke, frame, stroke);
    if (place.is_moving) {
      curves_.go_to(place);
      exact_.set_target(material, curves_.target(material));
      RIMLIGHT_CHECK(exact_.apply_exact({}));
      size_ = distance(exact_, nullptr, panel_count());
    }
    frames_since_edit_ = place.is_moving ? 0 : frames_since_edit_ + 1;
    for (std::size_t r = 0; r < runs_.size(); ++r) {
      // Not always the same one after the other.
      const std::size_t run = (r + static_cast<std::size_t>(frame)) % runs_.size();
      rows_[run].push_back(update(run, frame, place));
    }
    const int last = curves_.session().strokes[place.stroke].frame_count() - 1;
    if (place.step == last) stroke.stored_l2 = relative(stored_distance());
  }

  std::vector<CurveFrameRow> take_rows() {
    std::vector<CurveFrameRow> all;
    for (auto& rows : rows_) all.insert(all.end(), rows.begin(), rows.end());
    return all;
  }

 private:
  std::size_t panel_count() const { return curves_.transport().panels().size(); }
  double relative(double error) const { return size_ > 0 ? error / size_ : 0; }

  static void add(const EditedCurves::Made& made, StrokeReport& stroke) {
    stroke.transport_ms = made.transport_ms;
    stroke.norms_ms = made.norms_ms;
  }

  void show(std::uint32_t material) {
    const CurveCoefficients held = curves_.target(material);
    exact_.show(material, curves_.axis(material), held);
    for (auto& updater : updaters_) updater->show(material, curves_.axis(material), held);
  }

  void begin(std::size_t index, int frame, StrokeReport& stroke) {
    stroke.first_frame = frame;
    const auto made = curves_.make_for(index);
    if (!made) return;
    show(made->material);
    add(*made, stroke);
  }

  CurveFrameRow update(std::size_t run, int frame, const CurveSession::Place& place) {
    CurveUpdater& updater = *updaters_[run];
    const std::uint32_t material = curves_.material_of(place.stroke);
    if (place.is_moving) updater.set_target(material, exact_.target(material));
    const CurveUpdateReport update = updater.update(runs_[run].budget);
    CurveFrameRow row;
    row.run = runs_[run].name();
    row.policy = curve_policy_name(runs_[run].policy);
    row.budget = budget_name(runs_[run].budget);
    row.stroke = place.stroke;
    row.frame = frame;
    row.moving = place.is_moving;
    row.frames_since_edit = frames_since_edit_;
    row.plan_ms = update.plan_ms;
    row.apply_ms = update.apply_ms;
    row.terms = update.columns;
    row.bytes = update.bytes;
    row.error_l2 = relative(distance(updater, &exact_, panel_count()));
    row.estimate = relative(std::sqrt(updater.squared_error()));
    row.exact = true;
    for (std::uint32_t m = 0; m < curves_.transport().material_count(); ++m) {
      row.exact = row.exact && updater.is_at_target(m);
    }
    return row;
  }

  double stored_distance() const {
    std::vector<float> image;
    for (std::size_t panel = 0; panel < panel_count(); ++panel) {
      const auto rows = exact_.image(panel);
      image.insert(image.end(), rows.begin(), rows.end());
    }
    return curves_.distance_to_sums(image, kSampledRows);
  }

  EditedCurves& curves_;
  const std::vector<CurveRun>& runs_;
  CurveUpdater exact_;
  double size_ = 0;  // ‖exact image‖
  int frames_since_edit_ = 0;
  std::vector<std::unique_ptr<CurveUpdater>> updaters_;  // [run]
  std::vector<std::vector<CurveFrameRow>> rows_;         // [run]
  std::vector<std::uint32_t> first_strokes_;             // materials whose first stroke is known
};

void play_session(EditedCurves& curves, const BrdfEditSettings& settings, BrdfEditReport& report,
                  const BrdfEditProgress& progress) {
  const int all = settings.session.frame_count();
  const int frames = settings.most_frames > 0 ? std::min(settings.most_frames, all) : all;
  report.row_count = curves.row_count();
  report.panel_count = curves.transport().panels().size();
  report.strokes.resize(settings.session.strokes.size());
  Player player(curves, report.runs);
  if (progress) progress("making T'", 0);
  player.start(report.strokes);
  for (int frame = 0; frame < frames; ++frame) {
    player.play(frame, report.strokes);
    if (progress) progress("editing", (frame + 1.0) / frames);
  }
  report.strokes.resize(settings.session.place(frames - 1).stroke + 1);
  report.rows = player.take_rows();
}

}  // namespace

BrdfEditReport measure_brdf_edit(const std::shared_ptr<const Bake>& bake,
                                 const BrdfEditSettings& settings,
                                 const BrdfEditProgress& progress) {
  const auto light = settings.light ? settings.light : bake->environments().front().environment;
  BrdfEditReport report;
  report.scene = bake->manifest().scene;
  report.light = light->name();
  report.session = settings.session;
  report.cube_size = bake->manifest().cube_size;
  report.runs = settings.runs;
  {
    EditedCurves curves(*bake, report.session, light->project(report.cube_size));
    play_session(curves, settings, report, progress);
  }  // its T′ makes room
  report.stale = measure_stale_curves(bake, report.session, light, [&](double share) {
    if (progress) progress("stale T'", share);
  });
  return report;
}

}  // namespace rimlight
