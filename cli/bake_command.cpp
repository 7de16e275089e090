#include <CLI/CLI.hpp>
#include <cstdio>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>

#include "cli/command.h"
#include "cli/number_range.h"
#include "cli/progress_bar.h"
#include "core/bake/image_bake.h"
#include "core/base/parallel.h"
#include "core/scene/scene_source.h"

namespace rimlight {
namespace {

struct BakeOptions {
  std::string scene;
  std::string output;
  int width = 0;
  int height = 0;
  int cube_size = 0;
  double psnr_db = 0;
  std::size_t reference_receivers = 0;
  int threads = 0;
  bool json = false;
};

/// The scene's file name with .bake for its ending, in the current folder.
std::filesystem::path output_folder(const BakeOptions& options) {
  if (!options.output.empty()) return options.output;
  return std::filesystem::path(options.scene).stem().string() + ".bake";
}

int run(const BakeOptions& options) {
  if (options.threads > 0) set_thread_count(options.threads);
  Scene read = read_scene(options.scene);
  if (options.width > 0) read.bake.width = options.width;
  if (options.height > 0) read.bake.height = options.height;
  if (options.cube_size > 0) read.bake.cube_size = options.cube_size;
  if (options.psnr_db > 0) read.bake.psnr_db = options.psnr_db;
  read.bake.reference_receivers = options.reference_receivers;
  if (read.dropped_triangles > 0) {
    std::fprintf(stderr, "rimlight bake: %s: dropped %zu degenerate triangles\n",
                 options.scene.c_str(), read.dropped_triangles);
  }
  const auto scene = std::make_shared<const Scene>(std::move(read));
  const auto folder = output_folder(options);
  BakeSummary summary;
  {
    ProgressBar bar("baking " + scene->name);
    summary = bake_image(scene, folder, [&bar](const BakeProgress& progress) {
      bar.show(progress.stage, progress.fraction, !progress.resumed);
    });
  }
  if (options.json) {
    const nlohmann::json result = {{"bake", folder.string()},
                                   {"seconds", summary.seconds},
                                   {"resumed_tiles", summary.resumed_tiles},
                                   {"transport_bytes", summary.bytes},
                                   {"worst_psnr_db", summary.worst_psnr_db},
                                   {"worst_light", summary.worst_light},
                                   {"dropped_triangles", scene->dropped_triangles}};
    std::printf("%s\n", result.dump().c_str());
  } else {
    std::fprintf(stderr,
                 "%s: %.0f s, %.1f MiB of transport, %.1f dB under its worst check light (%s)\n",
                 folder.c_str(), summary.seconds, static_cast<double>(summary.bytes) / (1 << 20),
                 summary.worst_psnr_db, summary.worst_light.c_str());
  }
  return 0;
}

}  // namespace

void add_bake_command(CLI::App& app, Action& chosen) {
  auto options = std::make_shared<BakeOptions>();
  CLI::App* const command =
      app.add_subcommand("bake", "Trace a scene's light transport and write it as a bake");
  command->add_option("scene", options->scene, "Scene source, a JSON file")->required();
  command->add_option("-o,--output", options->output,
                      "Folder to write (default: the scene's name with .bake)");
  command->add_option("--width", options->width, "Pixels across, instead of the scene's")
      ->check(CLI::Range(1, 8192));
  command->add_option("--height", options->height, "Pixels down, instead of the scene's")
      ->check(CLI::Range(1, 8192));
  command
      ->add_option("--cube-size", options->cube_size,
                   "Texels a side of the light's cube map, instead of the scene's")
      ->check(CLI::IsMember({4, 8, 16, 32, 64, 128}));
  command
      ->add_option("--psnr", options->psnr_db,
                   "Error that compression may cost under the worst check light, as displayed, "
                   "instead of the scene's")
      ->check(number_range(20, 90));
  command
      ->add_flag("--reference{8192}", options->reference_receivers,
                 "Keep the uncompressed rows of a sample of receivers (8,192, or --reference=N), "
                 "for `rimlight report`: 19 MB for each 64 of them at cube size 64")
      ->check(CLI::Range(1, 1 << 26));
  command->add_option("--threads", options->threads, "Threads to use (default: all cores)")
      ->check(CLI::Range(1, 1024));
  command->add_flag("--json", options->json, "Print the result as one JSON object");
  command->footer("An interrupted bake resumes where it stopped when it is started again.");
  command->callback([options, &chosen] { chosen = [options] { return run(*options); }; });
}

}  // namespace rimlight
