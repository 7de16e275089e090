#include "core/report/timed_run.h"

#include <algorithm>
#include <array>
#include <utility>

#include "core/base/check.h"
#include "core/base/parallel.h"
#include "core/base/stopwatch.h"
#include "core/image/codec.h"
#include "core/image/metrics.h"
#include "core/relight/display.h"
#include "core/relight/error_estimate.h"
#include "core/relight/policy.h"
#include "core/relight/recent_times.h"
#include "core/report/light_study.h"

namespace rimlight {
namespace {

constexpr int kJpegQuality = 80;
constexpr std::size_t kReferencesAtOnce = 8;

/// Coefficients of texels; these are scratch then.
void transform(const CubeHaar& haar, CubeLight& texels, CubeLight& coefficients) {
  parallel_for(3, [&](std::size_t c) {
    haar.forward(texels.channel(static_cast<int>(c)), coefficients.channel(static_cast<int>(c)));
  });
}

/// One policy at work on one sequence.
class Player {
 public:
  Player(const Bake& bake, const MeasuredReceivers& receivers, const TimedPolicy& policy,
         LitSequence& sequence)
      : receivers_(receivers),
        policy_(policy),
        sequence_(sequence),
        haar_(bake.manifest().cube_size),
        relighter_(bake.transport(), bake.reflectance(), haar_, held_images_for(policy.policy)),
        updater_(bake, haar_, policy.policy, relighter_),
        display_(bake.manifest().pixels, bake.manifest().camera, bake.coverage()),
        estimator_(bake.sketch()),
        target_(haar_.size()),
        shares_(layer_shares(bake.sketch())) {
    RIMLIGHT_CHECK(relighter_.apply_exact(sequence.frames.front().target, {}));
    // What displaying and encoding take is known before the first deadline.
    FrameRow ignored;
    show(0, ignored);
  }

  FrameRow play(int index, std::vector<std::uint32_t>& chosen) {
    FrameRow row;
    row.light = sequence_.light;
    row.run = policy_.name();
    row.policy = policy_name(policy_.policy);
    row.budget = budget_name(policy_.budget);
    row.frame = index;
    row.moving = sequence_.frames[static_cast<std::size_t>(index)].moving;
    still_frames_ = row.moving ? 0 : still_frames_ + 1;
    row.frames_since_edit = index == 0 ? still_frames_ = 0 : still_frames_;
    for (std::size_t layer = 0; layer < kLayers; ++layer) {
      before_[layer] = relighter_.held().layer(layer);
    }
    move(index, row);
    show(index, row);
    find_chosen(row, chosen);
    measure(row);
    return row;
  }

 private:
  void move(int index, FrameRow& row) {
    Stopwatch watch;
    texels_ = sequence_.player.at(index).light;
    transform(haar_, texels_, target_);
    row.ms.light = watch.lap_ms();
    const UpdateReport update = updater_.update(
        target_, reduce_deadline(policy_.budget, row.ms.light + showing_.typical_ms()));
    row.ms.plan = update.plan_ms;
    row.ms.apply = std::max(0.0, watch.lap_ms() - update.plan_ms);
    row.columns = update.columns;
    row.bytes = update.bytes;
    row.reset_bands = update.reset_bands;
  }

  void show(int index, FrameRow& row) {
    std::optional<BackgroundMap> own;
    const BackgroundMap* map = sequence_.background.get();
    Quaternion rotation;
    if (map == nullptr) {
      map = &own.emplace(sequence_.player.at(index).light);
    } else {
      rotation = *sequence_.player.sequence().rotation_at(index);
    }
    Stopwatch watch;
    image_norm_ = display_.show(Display::tiles_of(relighter_, nullptr), {*map, rotation},
                                exposure(), picture_);
    row.ms.display = watch.lap_ms();
    encoder_.encode(picture_, kJpegQuality, jpeg_);
    row.ms.encode = watch.lap_ms();
    showing_.add(row.ms.display + row.ms.encode);
  }

  float exposure() const { return static_cast<float>(sequence_.frames.front().exposure); }

  /// Columns that the update wrote, in any layer: whose held value moved, or that a reset band now
  /// has.
  void find_chosen(FrameRow& row, std::vector<std::uint32_t>& chosen) {
    row.columns_of_band.resize(static_cast<std::size_t>(haar_.band_count()));
    for (int band = 0; band < haar_.band_count(); ++band) {
      const bool reset = (row.reset_bands >> band & 1) != 0;
      for (std::size_t i = haar_.band_begin(band); i < haar_.band_begin(band + 1); ++i) {
        if (!was_written(i, reset)) continue;
        chosen.push_back(static_cast<std::uint32_t>(i));
        ++row.columns_of_band[static_cast<std::size_t>(band)];
      }
    }
  }

  bool was_written(std::size_t column, bool reset) const {
    for (std::size_t layer = 0; layer < kLayers; ++layer) {
      const Vec3f before = reset ? Vec3f{} : before_[layer].at(column);
      if (relighter_.held().layer(layer).at(column) != before) return true;
    }
    return false;
  }

  void measure(FrameRow& row) {
    const ReferenceFrame& frame = sequence_.frames[static_cast<std::size_t>(row.frame)];
    receivers_.gather(relighter_, image_);
    row.relative_l2 = rimlight::relative_l2(image_, frame.truth());
    row.psnr_db = display_psnr(image_, frame.truth(), frame.exposure);
    row.time_l2 = rimlight::relative_l2(image_, frame.exact);
    row.psnr_time_db = display_psnr(image_, frame.exact, frame.exposure);
    row.compression_l2 = frame.compression_l2;
    row.of_transport = frame.of_transport;
    const double size = weighted_size(haar_, frame.target);
    if (size > 0) {
      row.lighting_error =
          weighted_distance(haar_, frame.target, relighter_.held(), shares_) / size;
    }
    find_mean(relighter_.held(), shares_, mean_held_);
    if (image_norm_ > 0) {
      row.estimate = estimator_.estimate(frame.target, relighter_.held()).error / image_norm_;
    }
    const GhostEnergy ghosts = find_ghosts(haar_, frame.target, mean_held_);
    row.ghost = ghosts.held;
    row.ghost_of_target = ghosts.target;
  }

  const MeasuredReceivers& receivers_;
  const TimedPolicy& policy_;
  LitSequence& sequence_;
  CubeHaar haar_;
  Relighter relighter_;
  FrameUpdater updater_;
  Display display_;
  ErrorEstimator estimator_;
  JpegEncoder encoder_;
  CubeLight texels_, target_, mean_held_;
  std::array<CubeLight, kLayers> before_;  // the frame
  std::array<float, kLayers> shares_;
  Rgb8Image picture_;
  std::vector<std::uint8_t> jpeg_;
  std::vector<Vec3f> image_;
  RecentTimes showing_;
  double image_norm_ = 0;
  int still_frames_ = 0;
};

CubeLight coefficients_of(const CubeHaar& haar, CubeLight texels) {
  CubeLight coefficients(haar.size());
  transform(haar, texels, coefficients);
  return coefficients;
}

/// What the reference rows tell of frames in these lights.
void add_references(const MeasuredReceivers& receivers, const TransportErrors& errors,
                    std::span<const CubeLight> lights, std::span<const CubeLight> finer_lights,
                    std::span<ReferenceFrame> frames) {
  if (!receivers.has_rows()) return;
  auto images = receivers.reference(lights);
  const auto of_transport = errors.find(lights, finer_lights);
  for (std::size_t i = 0; i < frames.size(); ++i) {
    frames[i].reference = std::move(images[i]);
    frames[i].of_transport = of_transport[i];
  }
}

/// Fills what is known of a frame once its images are.
void finish(ReferenceFrame& frame) {
  frame.exposure = auto_exposure_scale(frame.truth());
  frame.compression_l2 = relative_l2(frame.exact, frame.truth());
}

}  // namespace

void find_references(const Bake& bake, const MeasuredReceivers& receivers,
                     const TransportErrors& errors, int count,
                     const std::function<void(double)>& progress, LitSequence& sequence) {
  const CubeHaar haar(bake.manifest().cube_size);
  Relighter relighter(bake.transport(), bake.reflectance(), haar);
  std::vector<CubeLight> batch, finer_batch;
  for (int index = 0; index < count; ++index) {
    ReferenceFrame& frame = sequence.frames.emplace_back();
    const LightFrame& lit = sequence.player.at(index);
    frame.moving = lit.moving;
    frame.target = coefficients_of(haar, lit.light);
    RIMLIGHT_CHECK(relighter.apply_exact(frame.target, {}));
    receivers.gather(relighter, frame.exact);
    batch.push_back(frame.target);
    if (errors.finer_size() > 0) {
      finer_batch.push_back(coefficients_of(CubeHaar(errors.finer_size()),
                                            sequence.finer_player.value().at(index).light));
    }
    if (batch.size() < kReferencesAtOnce && index + 1 < count) continue;
    add_references(receivers, errors, batch, finer_batch,
                   std::span(sequence.frames).last(batch.size()));
    batch.clear();
    finer_batch.clear();
    progress(static_cast<double>(index + 1) / count);
  }
  for (ReferenceFrame& frame : sequence.frames) finish(frame);
}

TimedRun play(const Bake& bake, const MeasuredReceivers& receivers, const TimedPolicy& policy,
              LitSequence& sequence) {
  Player player(bake, receivers, policy, sequence);
  TimedRun run;
  run.chosen.resize(sequence.frames.size());
  for (std::size_t i = 0; i < sequence.frames.size(); ++i) {
    run.rows.push_back(player.play(static_cast<int>(i), run.chosen[i]));
  }
  return run;
}

}  // namespace rimlight
