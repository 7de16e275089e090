#include <CLI/CLI.hpp>
#include <cstdio>
#include <map>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>

#include "cli/command.h"
#include "cli/measured_report.h"
#include "cli/number_range.h"
#include "cli/progress_bar.h"
#include "core/bake/image_bake.h"
#include "core/bake/vertex_sh_bake.h"
#include "core/base/error.h"
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
  std::string kind;
  std::vector<std::string> editable;
  std::optional<int> degree;
  std::optional<double> error;
  std::string transfer;
  int most_rays = 0;
  bool keep_bands = false;
  std::optional<double> longest_edge;
  std::size_t reference_receivers = 0;
  int threads = 0;
  bool json = false;
};

const std::map<std::string, BakeKind> kKinds = {{"image_haar", BakeKind::image_haar},
                                                {"vertex_sh", BakeKind::vertex_sh},
                                                {"brdf_curve", BakeKind::brdf_curve}};
const std::map<std::string, VertexTransfer> kTransfers = {
    {"unshadowed", VertexTransfer::unshadowed},
    {"shadowed", VertexTransfer::shadowed},
    {"interreflected", VertexTransfer::interreflected}};

/// The scene's file name with .bake for its ending, in the current folder.
std::filesystem::path output_folder(const BakeOptions& options) {
  if (!options.output.empty()) return options.output;
  return std::filesystem::path(options.scene).stem().string() + ".bake";
}

/// The scene's settings, with the command's in their place.
void override_settings(const BakeOptions& options, BakeSettings& bake) {
  if (!options.kind.empty()) bake.kind = kKinds.at(options.kind);
  if (options.width > 0) bake.width = options.width;
  if (options.height > 0) bake.height = options.height;
  if (options.cube_size > 0) bake.cube_size = options.cube_size;
  if (options.psnr_db > 0) bake.psnr_db = options.psnr_db;
  if (!options.editable.empty()) bake.editable = options.editable;
  bake.reference_receivers = options.reference_receivers;
  if (options.degree) bake.vertex.degree = *options.degree;
  if (options.error) bake.vertex.error = *options.error;
  if (!options.transfer.empty()) bake.vertex.transfer = kTransfers.at(options.transfer);
  if (options.most_rays > 0) bake.vertex.most_rays = options.most_rays;
  if (options.keep_bands) bake.vertex.keep_bands = true;
  if (options.longest_edge) bake.vertex.longest_edge = *options.longest_edge;
}

/// Options that the bake's kind does not have are a mistake, not to be passed over.
void check_options(const BakeOptions& options, BakeKind kind) {
  const bool of_images =
      options.cube_size > 0 || options.psnr_db > 0 || options.reference_receivers > 0;
  const bool of_vertices = options.degree || options.error || !options.transfer.empty() ||
                           options.most_rays > 0 || options.keep_bands || options.longest_edge;
  if (kind == BakeKind::vertex_sh && of_images) {
    throw Error("options", "--cube-size, --psnr or --reference for kind vertex_sh",
                "those of vertices, or --kind image_haar");
  }
  if (kind != BakeKind::brdf_curve && !options.editable.empty()) {
    throw Error("options", "--editable for another kind", "--kind brdf_curve");
  }
  if (kind != BakeKind::vertex_sh && of_vertices) {
    throw Error(
        "options",
        "--degree, --error, --transfer, --most-rays, --keep-bands or --longest-edge for kind "
        "image_haar or brdf_curve",
        "those of images, or --kind vertex_sh");
  }
}

/// `measured` as describe_measured() gives it.
void print_result(const BakeSummary& summary, const Scene& scene, const nlohmann::json& measured,
                  const std::string& folder, bool json) {
  if (json) {
    const nlohmann::json result = {{"bake", folder},
                                   {"seconds", summary.seconds},
                                   {"resumed_tiles", summary.resumed_tiles},
                                   {"transport_bytes", summary.bytes},
                                   {"worst_psnr_db", summary.worst_psnr_db},
                                   {"worst_light", summary.worst_light},
                                   {"measured", measured},
                                   {"dropped_triangles", scene.dropped_triangles}};
    std::printf("%s\n", result.dump().c_str());
    return;
  }
  std::fprintf(stderr,
               "%s: %.0f s, %.1f MiB of transport, %.1f dB under its worst check light (%s)\n",
               folder.c_str(), summary.seconds, static_cast<double>(summary.bytes) / (1 << 20),
               summary.worst_psnr_db, summary.worst_light.c_str());
}

void print_result(const VertexBakeSummary& summary, const std::string& folder, bool json) {
  if (json) {
    const nlohmann::json result = {{"bake", folder},
                                   {"seconds", summary.seconds},
                                   {"transport_bytes", summary.bytes},
                                   {"vertices", summary.vertices},
                                   {"triangles", summary.triangles},
                                   {"highlight_vertices", summary.highlight_vertices},
                                   {"irradiance_degree", summary.irradiance_degree},
                                   {"irradiance_channels", summary.irradiance_channels},
                                   {"visibility_degree", summary.visibility_degree},
                                   {"rays", summary.rays},
                                   {"worst_error", summary.worst_error},
                                   {"capped_vertices", summary.capped_vertices},
                                   {"computed_normals", summary.computed_normals},
                                   {"unused_vertices", summary.unused_vertices},
                                   {"dropped_triangles", summary.dropped_triangles}};
    std::printf("%s\n", result.dump().c_str());
    return;
  }
  if (summary.computed_normals > 0) {
    std::fprintf(stderr, "rimlight bake: %zu vertices had no normal: computed\n",
                 summary.computed_normals);
  }
  if (summary.unused_vertices > 0) {
    std::fprintf(stderr, "rimlight bake: dropped %zu vertices that no triangle has\n",
                 summary.unused_vertices);
  }
  if (summary.capped_vertices > 0) {
    std::fprintf(stderr, "rimlight bake: %zu vertices took the most rays allowed, error to %.3g\n",
                 summary.capped_vertices, summary.worst_error);
  }
  std::fprintf(stderr,
               "%s: %.0f s, %zu vertices, degree %d in %zu channel(s), %.1f MiB of transport, "
               "%.1f million rays\n",
               folder.c_str(), summary.seconds, summary.vertices, summary.irradiance_degree,
               summary.irradiance_channels, static_cast<double>(summary.bytes) / (1 << 20),
               static_cast<double>(summary.rays) * 1e-6);
}

int run(const BakeOptions& options) {
  if (options.threads > 0) set_thread_count(options.threads);
  Scene read = read_scene(options.scene);
  override_settings(options, read.bake);
  check_options(options, read.bake.kind);
  if (read.dropped_triangles > 0) {
    std::fprintf(stderr, "rimlight bake: %s: dropped %zu degenerate triangles\n",
                 options.scene.c_str(), read.dropped_triangles);
  }
  const nlohmann::json measured = describe_measured(read);
  print_measured(measured);
  const auto scene = std::make_shared<const Scene>(std::move(read));
  const auto folder = output_folder(options);
  const auto with_bar = [&scene](const auto& bake) {
    ProgressBar bar("baking " + scene->name);
    return bake([&bar](const BakeProgress& progress) {
      bar.show(progress.stage, progress.fraction, !progress.resumed);
    });
  };
  if (scene->bake.kind == BakeKind::vertex_sh) {
    print_result(with_bar([&](const auto& show) { return bake_vertices(scene, folder, show); }),
                 folder.string(), options.json);
  } else {
    const auto bake = scene->bake.kind == BakeKind::brdf_curve ? bake_curves : bake_image;
    print_result(with_bar([&](const auto& show) { return bake(scene, folder, show); }), *scene,
                 measured, folder.string(), options.json);
  }
  return 0;
}

void add_kind_options(CLI::App& command, BakeOptions& options) {
  command
      .add_option(
          "--kind", options.kind,
          "image_haar (pixels of one view), brdf_curve (the same, with materials whose BRDF "
          "curves are edited) or vertex_sh (vertices in spherical harmonics, for any view), "
          "instead of the scene's")
      ->check(CLI::IsMember({"image_haar", "brdf_curve", "vertex_sh"}));
  command.add_option("--editable", options.editable,
                     "brdf_curve: materials to edit, instead of the scene's (default: all with a "
                     "gloss)");
}

void add_vertex_options(CLI::App& command, BakeOptions& options) {
  command
      .add_option("--degree", options.degree,
                  "vertex_sh: of the spherical harmonics, instead of the scene's")
      ->check(CLI::Range(0, VertexBakeSettings::kLargestDegree));
  command
      .add_option("--error", options.error,
                  "vertex_sh: standard error of a vertex' coefficients, instead of the scene's")
      ->check(number_range(1e-4, 1));
  command
      .add_option("--transfer", options.transfer,
                  "vertex_sh: what transport holds, instead of the scene's")
      ->check(CLI::IsMember({"unshadowed", "shadowed", "interreflected"}));
  command
      .add_option("--most-rays", options.most_rays,
                  "vertex_sh: rays from a vertex at most, instead of the scene's")
      ->check(CLI::Range(64, 1 << 20));
  command.add_flag("--keep-bands", options.keep_bands,
                   "vertex_sh: store bands that the error does not need, too");
  command
      .add_option(
          "--longest-edge", options.longest_edge,
          "vertex_sh: split longer edges, as a share of the longest side of the scene's box "
          "(0: none), instead of the scene's")
      ->check(number_range(0, 1));
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
  add_kind_options(*command, *options);
  add_vertex_options(*command, *options);
  command->add_option("--threads", options->threads, "Threads to use (default: all cores)")
      ->check(CLI::Range(1, 1024));
  command->add_flag("--json", options->json, "Print the result as one JSON object");
  command->footer(
      "An interrupted bake resumes where it stopped when it is started again; one of kind "
      "vertex_sh "
      "starts over.");
  command->callback([options, &chosen] { chosen = [options] { return run(*options); }; });
}

}  // namespace rimlight
