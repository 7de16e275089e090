// Every experiment, bounded in time, to one page.

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdio>
#include <fstream>
#include <iterator>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "cli/codec_report.h"
#include "cli/progress_bar.h"
#include "cli/report_experiments.h"
#include "cli/report_sources.h"
#include "cli/serving_report.h"
#include "cli/time_shares.h"
#include "cli/version.h"
#include "core/base/error.h"
#include "core/base/files.h"
#include "core/base/parallel.h"
#include "core/curves/curve_session_source.h"
#include "core/light/light_sequence_source.h"
#include "core/report/adaptive_sh_report.h"
#include "core/report/bake_report.h"
#include "core/report/brdf_edit_report.h"
#include "core/report/equal_time.h"
#include "core/report/error_vs_time_json.h"
#include "core/report/figures.h"
#include "core/report/report_files.h"
#include "core/report/report_sections.h"
#include "core/report/storage_report.h"
#include "core/scene/default_scene.h"
#include "core/scene/scene_source.h"

namespace rimlight {
namespace {

namespace fs = std::filesystem;
using Lights = std::vector<std::shared_ptr<const Environment>>;
using Progress = TimeShares::Progress;

struct Options {
  ReportOptions report;
  std::vector<std::string> scenes;  // bakes or scene sources; empty: the default scene
  std::vector<std::string> lights;
  std::vector<std::string> meshes = {"vase"};
  double minutes = 20;
};

/// Below this many minutes experiments look at less: fewer frames, one degree, a smaller scene.
constexpr double kShort = 10;
constexpr int kShortFrames = 24;
constexpr int kPictures = 10;
/// About half of all: without its bake a scene has no other experiment. What it leaves is theirs.
constexpr double kBakeWeight = 14;
constexpr double kMostServingSeconds = 8;

/// The default scene as large as there is time for.
Scene sized_default_scene(double minutes) {
  Scene scene = default_scene();
  const bool is_long = minutes >= 60, is_short = minutes < kShort;
  scene.bake.width = scene.bake.height = is_long ? 512 : is_short ? 96 : 192;
  scene.bake.cube_size = is_short ? 16 : 32;
  return scene;
}

void append(ErrorVsTimeReport one, ErrorVsTimeReport& all) {
  all.rows.insert(all.rows.end(), one.rows.begin(), one.rows.end());
  std::ranges::move(one.lights, std::back_inserter(all.lights));
}
void append(EqualTimeReport one, EqualTimeReport& all) {
  std::ranges::move(one.rows, std::back_inserter(all.rows));
}
template <typename Row>
void append(std::vector<Row> one, std::vector<Row>& all) {
  std::ranges::move(one, std::back_inserter(all));
}

/// One light after another, as long as there is time; OutOfTime when there is none for the first.
template <typename Measure>
MeasuredReport light_by_light(const Lights& lights, const Measure& measure) {
  std::optional<decltype(measure(lights.front()))> all;
  std::size_t done = 0;
  try {
    for (; done < lights.size(); ++done) {
      auto one = measure(lights[done]);
      if (all) {
        append(std::move(one), *all);
      } else {
        all = std::move(one);
      }
    }
  } catch (const OutOfTime&) {
    if (!all) throw;
  }
  MeasuredReport report = measured(*std::move(all));
  if (done < lights.size()) {
    report.section.remarks.push_back("Time was up after " + std::to_string(done) + " of " +
                                     std::to_string(lights.size()) + " lights.");
  }
  return report;
}

/// What ends an experiment whose scene's bake was cut off.
struct NoBake {};

/// A scene to measure on. The bake is there once its experiment has been run.
struct MeasuredScene {
  std::shared_ptr<const Scene> scene;  // null: only the bake is known
  std::shared_ptr<const Bake> bake;
  fs::path folder;  // of its reports

  const Bake& baked() const {
    if (!bake) throw NoBake{};
    return *bake;
  }
};

BakeReport measure_bake(MeasuredScene& scene, const std::string& name, const Progress& progress) {
  ReportedBake made =
      bake_for_report(*scene.scene, scene.folder, name,
                      [&progress](const BakeProgress& one) { progress(one.stage, one.fraction); });
  scene.bake = std::move(made.bake);
  return bake_report(*scene.bake, scene.scene->bake.psnr_db, made.summary);
}

/// Its words.
std::string own_command() {
  std::ifstream file("/proc/self/cmdline");  // its size is not known before it is read
  std::string command(std::istreambuf_iterator<char>(file), {});
  while (command.ends_with('\0')) command.pop_back();
  std::ranges::replace(command, '\0', ' ');
  return command;
}

class AllExperiments {
 public:
  explicit AllExperiments(Options options)
      : options_(std::move(options)),
        shares_(std::chrono::duration<double>(60 * options_.minutes)) {}

  int run() {
    for (const std::string& name : options_.scenes) plan_scene(name);
    if (options_.scenes.empty()) {
      plan_scene(std::make_shared<const Scene>(sized_default_scene(options_.minutes)), "default");
    }
    plan_meshes();
    plan("Stability", 3, options_.report.output, [this](const Progress& progress) {
      StabilitySettings settings;
      settings.trial.fast = is_short();
      return measured(measure_stability(settings, progress));
    });
    shares_.begin();
    for (const Planned& one : planned_) run(one);
    write_page();
    return failures_ == 0 ? 0 : 1;
  }

 private:
  struct Planned {
    std::string title;
    double weight;
    fs::path folder;
    std::function<MeasuredReport(const Progress&)> measure;
  };

  bool is_short() const { return options_.minutes < kShort; }

  void plan(const std::string& title, double weight, const fs::path& folder,
            std::function<MeasuredReport(const Progress&)> measure) {
    planned_.push_back({title, weight, folder, std::move(measure)});
    shares_.expect(weight);
  }

  void plan_scene(const std::string& name) {
    const fs::path source(name);
    if (source.extension() == ".json") {
      return plan_scene(std::make_shared<const Scene>(read_scene(source)), source.stem().string());
    }
    auto scene = std::make_shared<MeasuredScene>();
    scene->bake = std::make_shared<const Bake>(source);
    scene->folder = fs::path(options_.report.output) / source.stem();
    plan_experiments(scene, scene->bake->manifest().kind == kImageKind);
  }

  void plan_scene(const std::shared_ptr<const Scene>& source, const std::string& name) {
    if (source->bake.kind == BakeKind::vertex_sh) {
      throw Error(name, "a scene of kind vertex_sh",
                  "one of image_haar or brdf_curve; meshes have --mesh");
    }
    auto scene = std::make_shared<MeasuredScene>();
    scene->scene = source;
    scene->folder = fs::path(options_.report.output) / name;
    plan("Bake: " + source->name, kBakeWeight, scene->folder,
         [scene, name](const Progress& progress) {
           return measured(measure_bake(*scene, name, progress));
         });
    plan_experiments(scene, source->bake.kind == BakeKind::image_haar);
  }

  Lights lights_of(const Bake& bake) const {
    Lights lights;
    for (const std::string& name : options_.lights) lights.push_back(find_light(bake, name));
    if (!lights.empty()) return lights;
    for (const BakedEnvironment& one : bake.environments()) lights.push_back(one.environment);
    return lights;
  }

  void plan_experiments(const std::shared_ptr<MeasuredScene>& scene, bool is_image) {
    plan("Codecs", 0.5, scene->folder, [scene](const Progress& progress) {
      (void)scene->baked();
      return measured(measure_codecs(scene->bake, kPictures, progress));
    });
    plan("Serving", 4, scene->folder, [this, scene](const Progress& progress) {
      // Four crowds, and what it takes until the last exact frames have come.
      const double seconds = std::clamp(shares_.share_seconds() / 8, 1.0, kMostServingSeconds);
      return measured(measure_serving(scene->baked().folder(), seconds, progress));
    });
    if (!is_image) {
      plan("BRDF curve edits", 3, scene->folder,
           [this, scene](const Progress& progress) { return brdf_edit(*scene, progress); });
      return;
    }
    if (scene->scene) {
      plan("Beside a path tracer", 3, scene->folder,
           [this, scene](const Progress& progress) { return equal_time(*scene, progress); });
    }
    plan("Error against time", 4, scene->folder,
         [this, scene](const Progress& progress) { return error_vs_time(*scene, progress); });
    plan("Storage", 1, scene->folder, [scene](const Progress& progress) {
      return measured(compare_storage(scene->baked(), [&progress](double share) {
        progress("pruning the reference rows", share);
      }));
    });
  }

  MeasuredReport error_vs_time(const MeasuredScene& scene, const Progress& progress) const {
    ErrorVsTimeSettings settings;
    settings.sequence = find_light_sequence("rotation", "--sequence");
    settings.most_frames = is_short() ? kShortFrames : 0;
    return light_by_light(lights_of(scene.baked()), [&](const auto& light) {
      settings.lights = {light};
      return measure_error_vs_time(scene.baked(), settings, progress);
    });
  }

  MeasuredReport equal_time(const MeasuredScene& scene, const Progress& progress) const {
    EqualTimeSettings settings;
    for (const char* const policy : {"benefit@8ms", "benefit@16ms"}) {
      settings.policies.push_back(parse_timed_policy(policy, "policy"));
    }
    const Lights lights = lights_of(scene.baked());
    // Each twice, of all light and of direct light: a quarter of the share, so that a busy machine
    // does not cut it off.
    settings.seconds = shares_.share_seconds() / 16 / static_cast<double>(lights.size());
    return light_by_light(lights, [&](const auto& light) {
      settings.lights = {light};
      return measure_equal_time(scene.scene, scene.baked(), settings, progress);
    });
  }

  MeasuredReport brdf_edit(const MeasuredScene& scene, const Progress& progress) const {
    BrdfEditSettings settings{.session = find_curve_session("pearl", "--session"),
                              .light = nullptr,
                              .most_frames = is_short() ? kShortFrames : 0};
    if (!options_.lights.empty()) {
      settings.light = find_light(scene.baked(), options_.lights.front());
    }
    return measured(measure_brdf_edit(scene.bake, settings, progress));
  }

  void plan_meshes() {
    const fs::path folder = fs::path(options_.report.output) / "meshes";
    plan("Adaptive products", 3, folder,
         [this](const Progress& progress) { return adaptive_sh(progress); });
    plan("Policies of spherical harmonics", 1, folder,
         [this](const Progress& progress) { return sh_policies(progress); });
  }

  Lights mesh_lights() const {
    Lights lights;
    for (const std::string& name : options_.lights) lights.push_back(find_light(name));
    if (lights.empty()) lights = {find_light("studio"), find_light("cathedral")};
    return lights;
  }

  std::vector<NamedMesh> meshes() const {
    const Scene builtin = default_scene();
    std::vector<NamedMesh> found;
    for (const std::string& mesh : options_.meshes) found.push_back(find_mesh(mesh, builtin));
    return found;
  }

  MeasuredReport adaptive_sh(const Progress& progress) const {
    AdaptiveShSettings settings;
    settings.meshes = meshes();
    settings.degrees = is_short() ? std::vector<int>{10} : std::vector<int>{4, 6, 8, 10, 13};
    return light_by_light(mesh_lights(), [&](const auto& light) {
      settings.lights = {light};
      return measure_adaptive_sh(settings, progress);
    });
  }

  MeasuredReport sh_policies(const Progress& progress) const {
    constexpr int kDegree = 19;
    const ShPolicySettings settings = {find_light_sequence("rotation", "--sequence"),
                                       is_short() ? kShortFrames : 0, default_sh_policy_runs()};
    const NamedMesh mesh = meshes().front();
    const LitMesh lit = light_mesh(mesh.name, mesh.meshes, kDegree);
    return light_by_light(mesh_lights(), [&](const auto& light) {
      return measure_sh_policies(lit, *light, settings, [&](double share) {
        progress(mesh.name + " under " + light->name(), share);
      });
    });
  }

  void run(const Planned& one) {
    ProgressBar bar(one.title);
    const Progress progress = shares_.next(
        one.weight, [&bar](const std::string& stage, double done) { bar.show(stage, done); });
    try {
      MeasuredReport report = one.measure(progress);
      publish(report, {.scene = {}, .output = one.folder.string(), .threads = 0, .json = false});
      sections_.push_back(std::move(report.section));
    } catch (const OutOfTime&) {
      leave_out(one, "Left out: it was not done in the " + fixed(shares_.share_seconds(), 0) +
                         " seconds that it had; give more --minutes.");
    } catch (const NoBake&) {
      leave_out(one, "Left out: there is no bake of its scene.");
    } catch (const Error& error) {
      ++failures_;
      leave_out(one, std::string("Failed: ") + error.what());
    }
  }

  void leave_out(const Planned& one, const std::string& why) {
    std::fprintf(stderr, "rimlight report: %s: %s\n", one.title.c_str(), why.c_str());
    sections_.push_back({.title = one.title, .remarks = {why}});
  }

  void write_page() const {
    const nlohmann::json machine = describe_machine();
    const fs::path page = fs::path(options_.report.output) / "index.html";
    write_file_atomically(page, to_html("Rimlight: error against run time",
                                        {{"version", version()},
                                         {"commit", source_commit()},
                                         {"processor", machine["processor"].get<std::string>()},
                                         {"threads", machine["threads"].dump()},
                                         {"command", own_command()}},
                                        sections_));
    std::fprintf(stderr, "rimlight report: %s\n", page.c_str());
  }

  const Options options_;
  TimeShares shares_;
  std::vector<Planned> planned_;
  std::vector<ReportSection> sections_;
  int failures_ = 0;
};

}  // namespace

void add_all_report(CLI::App& report, Action& chosen) {
  auto options = std::make_shared<Options>();
  CLI::App* const command = report.add_subcommand(
      "all", "Every experiment on every scene given, within some minutes, to one page");
  command->add_option("--scene,scene", options->scenes,
                      "Bakes, best made with --reference, or scene sources (.json), which are "
                      "baked first (default: the default scene, as large as there is time for)");
  add_output_options(*command, options->report);
  command->add_option("--light", options->lights,
                      "An environment of the bakes or a built-in one by name, or a .hdr or .exr "
                      "file; repeatable (default: the bakes' own)");
  command
      ->add_option("--mesh", options->meshes,
                   "A part of the default scene by name, or a mesh file; repeatable")
      ->capture_default_str();
  command->add_option("--minutes", options->minutes, "For all of it")
      ->check(CLI::Range(0.1, 10'000.0))
      ->capture_default_str();
  command->callback([options, &chosen] {
    chosen = [options] {
      if (options->report.threads > 0) set_thread_count(options->report.threads);
      return AllExperiments(*options).run();
    };
  });
}

}  // namespace rimlight
