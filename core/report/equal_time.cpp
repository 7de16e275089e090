#include "core/report/equal_time.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/base/error.h"
#include "core/base/stopwatch.h"
#include "core/image/metrics.h"
#include "core/relight/prepared_environment.h"
#include "core/report/path_tracer.h"
#include "core/report/timed_run.h"

namespace rimlight {
namespace {

constexpr int kBackgroundSize = 256;  // as a server's
constexpr std::uint64_t kSeed = 0x7ac3, kTruthSeed = 0x7a7e;
constexpr int kMostPasses = 1 << 16;

/// The light turns once, by a quarter, and stays.
LightSequence quarter_turn(int frames) {
  EasedTurn turn;
  turn.peak = std::numbers::pi / 2;
  LightSequence sequence;
  sequence.name = "quarter turn";
  sequence.still_frames = frames;
  sequence.tracks.push_back({EnvironmentSource{std::string(kGivenLight)}, 1, turn, std::nullopt});
  return sequence;
}

double squared_error(double psnr_db) { return std::pow(10, -psnr_db / 10); }

/// PSNR against a truth that has a noise of its own, which is no error of the image.
double without_noise(double psnr_db, double noise) {
  constexpr double kCap = 99;
  const double error = squared_error(psnr_db) - noise;
  return error > 0 ? std::min(kCap, -10 * std::log10(error)) : kCap;
}

/// Two independent pictures in the making, of as many paths.
class TracedTruth {
 public:
  TracedTruth(const PathTracer& tracer, const Scene& scene, const PixelLayout& pixels,
              const MeasuredReceivers& receivers)
      : tracer_(tracer),
        pixels_(pixels),
        receivers_(receivers),
        sum_(scene.bake.width, scene.bake.height),
        other_(scene.bake.width, scene.bake.height) {}

  struct Snapshot {
    int passes = 0;
    double ms = 0;
    std::vector<Vec3f> image;  // at the receivers
  };

  void run(double seconds, const std::function<void(double)>& progress) {
    double ms = 0;
    for (int next = 1; passes_ < kMostPasses && (passes_ == 0 || ms < 1000 * seconds);) {
      Stopwatch watch;
      tracer_.add_pass(kSeed, static_cast<std::uint64_t>(passes_), sum_);
      ms += watch.lap_ms();
      tracer_.add_pass(kTruthSeed, static_cast<std::uint64_t>(passes_), other_);
      ++passes_;
      if (passes_ < next && ms < 1000 * seconds) continue;
      snapshots_.push_back({passes_, ms, at_receivers(sum_)});
      next = std::max(next + 1, next * 5 / 4);
      progress(std::min(1.0, ms / (1000 * seconds)));
    }
    second_ = at_receivers(other_);
    truth_ = snapshots_.back().image;
    for (std::size_t i = 0; i < truth_.size(); ++i) truth_[i] = (truth_[i] + second_[i]) * 0.5f;
    exposure_ = auto_exposure_scale(truth_);
    noise_of_second_ = squared_error(display_psnr(snapshots_.back().image, second_, exposure_)) / 2;
  }

  const std::vector<Vec3f>& truth() const { return truth_; }
  double exposure() const { return exposure_; }
  /// Of the truth, a mean of two pictures.
  double noise() const { return noise_of_second_ / 2; }

  void add_rows(const std::string& light, const char* method, EqualTimeReport& report) const {
    for (const Snapshot& one : snapshots_) {
      const double psnr = display_psnr(one.image, second_, exposure_);
      report.rows.push_back({light, method, kTracedPicture, one.passes, one.ms,
                             without_noise(psnr, noise_of_second_)});
    }
  }

 private:
  std::vector<Vec3f> at_receivers(const RgbImage& sum) const {
    std::vector<Vec3f> image;
    for (const std::size_t receiver : receivers_.indices()) {
      const auto [x, y] = pixels_.pixel(receiver);
      image.push_back(sum.at(x, y) * (1 / static_cast<float>(passes_)));
    }
    return image;
  }

  const PathTracer& tracer_;
  const PixelLayout& pixels_;
  const MeasuredReceivers& receivers_;
  RgbImage sum_, other_;
  int passes_ = 0;
  std::vector<Snapshot> snapshots_;
  std::vector<Vec3f> second_, truth_;
  double exposure_ = 1, noise_of_second_ = 0;
};

class Experiment {
 public:
  Experiment(const std::shared_ptr<const Scene>& scene, const Bake& bake,
             const EqualTimeSettings& settings,
             const std::function<void(const std::string&, double)>& progress)
      : bake_(bake),
        settings_(settings),
        progress_(progress),
        rays_(scene),
        receivers_(bake),
        errors_(bake) {
    const PixelLayout& pixels = bake.manifest().pixels;
    const BakeSettings& wanted = scene->bake;
    if (pixels.width != wanted.width || pixels.height != wanted.height) {
      throw Error(
          bake.folder().string(),
          std::to_string(pixels.width) + " x " + std::to_string(pixels.height) + " pixels",
          "the scene's " + std::to_string(wanted.width) + " x " + std::to_string(wanted.height));
    }
    report_ = {.scene = scene->name,
               .width = pixels.width,
               .height = pixels.height,
               .bounces = wanted.bounces,
               .cube_size = bake.manifest().cube_size,
               .receivers = receivers_.count(),
               .rows = {}};
  }

  EqualTimeReport run() {
    auto lights = settings_.lights;
    if (lights.empty()) {
      for (const BakedEnvironment& one : bake_.environments()) lights.push_back(one.environment);
    }
    for (const auto& light : lights) compare(light);
    return std::move(report_);
  }

 private:
  void compare(const std::shared_ptr<const Environment>& light) {
    const std::string& name = light->name();
    const int size = bake_.manifest().cube_size;
    const LightSequence sequence = quarter_turn(settings_.frames);
    const LightEnvironments environments = load_environments(sequence, light);
    const auto prepared = prepare_environment(light, {size, kBackgroundSize});
    LitSequence lit{name,
                    LightSequencePlayer(sequence, size, environments),
                    {},
                    {},
                    {prepared, &prepared->background}};
    if (errors_.finer_size() > 0) {
      lit.finer_player.emplace(sequence, errors_.finer_size(), environments);
    }
    find_references(
        bake_, receivers_, errors_, settings_.frames + 2, [](double) {}, lit);
    const CubeLight texels = lit.player.at(1).light;
    trace(name, texels, 0);
    const TracedTruth truth = trace(name, texels, rays_.scene().bake.bounces);
    for (const TimedPolicy& policy : settings_.policies) play_policy(policy, kBakedPicture, 0, lit);
    // Frame 0, before the turn, is under another light, and not looked at.
    for (ReferenceFrame& frame : lit.frames) {
      frame.reference = truth.truth();
      frame.exposure = truth.exposure();
    }
    for (const TimedPolicy& policy : settings_.policies) {
      play_policy(policy, kTracedPicture, truth.noise(), lit);
    }
  }

  TracedTruth trace(const std::string& light, const CubeLight& texels, int bounces) {
    const char* const method = bounces == 0 ? kDirectTracing : kPathTracing;
    const PathTracer tracer(rays_, texels, bounces);
    TracedTruth truth(tracer, rays_.scene(), bake_.manifest().pixels, receivers_);
    truth.run(settings_.seconds, [&](double share) { progress_(light + ": " + method, share); });
    truth.add_rows(light, method, report_);
    return truth;
  }

  void play_policy(const TimedPolicy& policy, const char* against, double noise, LitSequence& lit) {
    double ms = 0;
    for (const FrameRow& row : play(bake_, receivers_, policy, lit).rows) {
      if (row.frame == 0) continue;
      ms += row.ms.total();
      report_.rows.push_back(
          {lit.light, policy.name(), against, row.frame, ms, without_noise(row.psnr_db, noise)});
    }
  }

  const Bake& bake_;
  const EqualTimeSettings& settings_;
  const std::function<void(const std::string&, double)>& progress_;
  RayScene rays_;
  MeasuredReceivers receivers_;
  TransportErrors errors_;
  EqualTimeReport report_;
};

}  // namespace

EqualTimeReport measure_equal_time(
    const std::shared_ptr<const Scene>& scene, const Bake& bake, const EqualTimeSettings& settings,
    const std::function<void(const std::string&, double)>& progress) {
  return Experiment(scene, bake, settings, progress).run();
}

std::optional<double> milliseconds_to(const EqualTimeReport& report, const EqualTimeRow& like,
                                      double psnr_db) {
  const EqualTimeRow* before = nullptr;
  for (const EqualTimeRow& row : report.rows) {
    if (row.light != like.light || row.method != like.method || row.against != like.against) {
      continue;
    }
    if (row.psnr_db < psnr_db) {
      before = &row;
      continue;
    }
    if (before == nullptr) return row.ms;
    const double share = (psnr_db - before->psnr_db) / (row.psnr_db - before->psnr_db);
    return std::exp(std::lerp(std::log(before->ms), std::log(row.ms), share));
  }
  return std::nullopt;
}

}  // namespace rimlight
