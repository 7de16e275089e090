#include <CLI/CLI.hpp>
#include <algorithm>
#include <memory>
#include <numbers>
#include <string>
#include <vector>

#include "cli/command.h"
#include "cli/import_report.h"
#include "cli/number_range.h"
#include "cli/progress_bar.h"
#include "core/base/error.h"
#include "core/base/parallel.h"
#include "core/import/import_bake.h"
#include "core/import/matrix_source.h"
#include "core/import/picture_files.h"
#include "core/import/picture_source.h"

namespace rimlight {
namespace {

namespace fs = std::filesystem;

struct ImportOptions {
  std::vector<std::string> inputs;
  std::string directions;
  std::string output;
  std::string name;
  std::string axes;
  std::string unit = "irradiance";
  std::vector<double> cap;
  std::string mask;
  std::vector<std::string> environments;
  std::vector<double> camera_position, camera_target;
  double field_of_view = 40;
  int width = 0;
  int height = 0;
  int cube_size = 0;
  double psnr_db = 50;
  int threads = 0;
  bool json = false;
};

bool is_matrix(const ImportOptions& options) {
  return options.inputs.size() == 1 && fs::path(options.inputs[0]).extension() == ".npy";
}

/// The name of what is imported: a folder's, or a file's without its ending.
std::string default_name(const ImportOptions& options) {
  fs::path path = options.inputs[0];
  if (!path.has_filename()) path = path.parent_path();  // "folder/"
  return fs::is_directory(path) ? path.filename().string() : path.stem().string();
}

SphericalCap read_cap(const ImportOptions& options, DirectionAxes axes) {
  if (options.cap.empty()) return {};
  const Vec3d axis = to_world({options.cap[0], options.cap[1], options.cap[2]}, axes);
  const double degrees = options.cap[3];
  if (!(length(axis) > 1e-6 && length(axis) < 1e6)) {
    throw Error("--cap", "an axis of length " + std::to_string(length(axis)),
                "x,y,z that are finite and not all 0");
  }
  if (!(degrees > 0.1 && degrees <= 180)) {
    throw Error("--cap", std::to_string(degrees) + " degrees", "an angle above 0.1 and up to 180");
  }
  return {normalized(axis), degrees * std::numbers::pi / 180};
}

std::vector<Environment> read_environments(const ImportOptions& options) {
  const auto& builtins = builtin_environment_names();
  std::vector<Environment> environments;
  for (const std::string& name : options.environments.empty() ? builtins : options.environments) {
    const bool is_builtin = std::find(builtins.begin(), builtins.end(), name) != builtins.end();
    environments.push_back(is_builtin ? builtin_environment(name) : load_environment(name));
    for (std::size_t i = 0; i + 1 < environments.size(); ++i) {
      if (environments[i].name() != environments.back().name()) continue;
      throw Error("--environment", "the name " + quote(environments.back().name()) + " twice",
                  "a name of its own for each environment");
    }
  }
  return environments;
}

Camera read_camera(const ImportOptions& options) {
  constexpr double kFarthest = 1e6;
  Camera camera;
  const auto point = [](const std::vector<double>& p, const Vec3d& otherwise) {
    return p.empty() ? otherwise : Vec3d(p[0], p[1], p[2]);
  };
  camera.position = point(options.camera_position, camera.position);
  camera.target = point(options.camera_target, camera.target);
  camera.vertical_field_of_view_degrees = options.field_of_view;
  const double along = length(cross(camera.target - camera.position, camera.up));
  if (!(length(camera.position) < kFarthest && length(camera.target) < kFarthest && along > 1e-6)) {
    throw Error("--camera-position, --camera-target", "a camera that cannot stand so",
                "two points apart within 1e6, one not straight above the other");
  }
  return camera;
}

std::optional<DirectionAxes> read_axes(const ImportOptions& options) {
  if (options.axes.empty()) return std::nullopt;
  return options.axes == "y_up" ? DirectionAxes::y_up : DirectionAxes::z_up;
}

ImportSettings read_settings(const ImportOptions& options, const DirectionList& list) {
  ImportSettings settings;
  settings.name = options.name.empty() ? default_name(options) : options.name;
  settings.unit = options.unit == "radiance" ? ColumnUnit::radiance : ColumnUnit::irradiance;
  settings.cap = read_cap(options, list.axes);
  settings.cube_size = options.cube_size;
  settings.psnr_db = options.psnr_db;
  if (!options.mask.empty()) settings.mask = read_mask(options.mask);
  settings.camera = read_camera(options);
  settings.environments = read_environments(options);
  return settings;
}

/// Checks what can be checked before anything is written.
MakeSource prepare_source(const ImportOptions& options, const DirectionList& list,
                          ProgressBar& bar) {
  const bool has_size = options.width > 0 && options.height > 0;
  if (is_matrix(options)) {
    if (!has_size) {
      throw Error("--width, --height", "none", "how a matrix's receivers lie in the picture");
    }
    auto matrix = std::make_shared<std::unique_ptr<TransportSource>>(
        std::make_unique<MatrixSource>(options.inputs[0], options.width, options.height));
    return [matrix](const fs::path&) { return std::move(*matrix); };
  }
  if (options.width > 0 || options.height > 0) {
    throw Error("--width, --height", "a size", "none for pictures, which have their own");
  }
  const std::vector<fs::path> inputs(options.inputs.begin(), options.inputs.end());
  return [&bar, pictures = find_pictures(inputs, list, options.mask)](const fs::path& scratch) {
    return std::make_unique<PictureSource>(pictures, scratch,
                                           [&bar](double share) { bar.show("reading", share); });
  };
}

int run(const ImportOptions& options) {
  if (options.threads > 0) set_thread_count(options.threads);
  const DirectionList list = read_directions(options.directions, read_axes(options));
  const fs::path folder =
      options.output.empty() ? fs::path(default_name(options) + ".bake") : fs::path(options.output);
  ImportSummary summary;
  {
    ProgressBar bar("importing " + default_name(options));
    const MakeSource source = prepare_source(options, list, bar);
    const ImportSettings settings = read_settings(options, list);
    summary = import_bake(source, list, settings, folder, [&bar](const BakeProgress& progress) {
      bar.show(progress.stage, progress.fraction);
    });
  }
  report_import(summary, folder, options.json);
  return 0;
}

constexpr const char* kFooter =
    "A transport matrix, receivers × directions (or × 3 colours), as numpy.save writes it:\n"
    "  rimlight import matrix.npy --directions lights.npy --width 512 --height 512 -o a.bake\n"
    "A light stage: a folder of pictures, each under one light, by name in the order of the list:\n"
    "  rimlight import stage/ --directions lights.txt --cap 0,1,0,90 -o stage.bake\n"
    "\n"
    "A line of lights.txt is x y z, or x y z weight: the direction from the scene towards the "
    "light,\n"
    "right-handed, y up (--axes z_up for z up), of any length. Without weights (solid angles in\n"
    "steradians) a direction has the area of its spherical Voronoi cell.\n"
    "\n"
    "What one column (or picture) is:\n"
    "  --unit irradiance  the scene under one distant lamp that gives irradiance 1 to a surface\n"
    "                     facing it, as one-light-at-a-time pictures are; weights count\n"
    "  --unit radiance    the scene under radiance 1 from all of the directions that the column\n"
    "                     stands for; weights do not count\n"
    "docs/formats/import.md has all of it.";

void add_options(CLI::App& command, ImportOptions& options) {
  command
      .add_option("inputs", options.inputs,
                  "One .npy matrix; or a folder of .exr or .png pictures; or the pictures")
      ->required();
  command
      .add_option("-d,--directions", options.directions,
                  "The lights' directions: .json, .txt, .csv or .npy")
      ->required();
  command.add_option("-o,--output", options.output,
                     "Folder to write (default: the input's name with .bake)");
  command.add_option("--axes", options.axes, "Of a .txt, .csv or .npy list: y_up or z_up [y_up]")
      ->check(CLI::IsMember({"y_up", "z_up"}));
  command.add_option("--unit", options.unit, "What a column is per: irradiance or radiance")
      ->check(CLI::IsMember({"irradiance", "radiance"}))
      ->capture_default_str();
  command
      .add_option("--cap", options.cap,
                  "x,y,z,degrees: the lights cover directions up to so far from this axis (in the "
                  "list's axes); there is no light beyond (default: all directions)")
      ->delimiter(',')
      ->expected(4);
  command
      .add_option("--width", options.width, "Pixels across, for a matrix: receivers go row by row")
      ->check(CLI::Range(1, 8192));
  command.add_option("--height", options.height, "Pixels down, for a matrix")
      ->check(CLI::Range(1, 8192));
  command
      .add_option("--cube-size", options.cube_size,
                  "Texels a side of the light's cube map (default: by the number of directions)")
      ->check(CLI::IsMember({4, 8, 16, 32, 64, 128}));
  command
      .add_option("--psnr", options.psnr_db,
                  "Error that compression may cost, in dB of display-referred PSNR")
      ->check(number_range(20, 90))
      ->capture_default_str();
}

void add_scene_options(CLI::App& command, ImportOptions& options) {
  command.add_option("--name", options.name, "The scene's name (default: the input's)");
  command.add_option("--mask", options.mask,
                     "A .png or .exr picture: where it is black the environment shows");
  command
      .add_option("--environment", options.environments,
                  "sunny, studio, cathedral, or a .hdr or .exr file; may be repeated (default: "
                  "those three)")
      ->allow_extra_args(false);
  command
      .add_option("--camera-position", options.camera_position,
                  "x,y,z: for what shows behind a mask [0,0,5]")
      ->delimiter(',')
      ->expected(3);
  command.add_option("--camera-target", options.camera_target, "x,y,z [0,0,0]")
      ->delimiter(',')
      ->expected(3);
  command.add_option("--field-of-view", options.field_of_view, "Vertical, in degrees")
      ->check(number_range(1, 170))
      ->capture_default_str();
  command.add_option("--threads", options.threads, "Threads to use (default: all cores)")
      ->check(CLI::Range(1, 1024));
  command.add_flag("--json", options.json, "Print the result as one JSON object");
}

}  // namespace

void add_import_command(CLI::App& app, Action& chosen) {
  auto options = std::make_shared<ImportOptions>();
  CLI::App* const command = app.add_subcommand(
      "import",
      "Make a bake from transport made elsewhere: a matrix, one-light-at-a-time pictures");
  add_options(*command, *options);
  add_scene_options(*command, *options);
  command->footer(kFooter);
  command->callback([options, &chosen] { chosen = [options] { return run(*options); }; });
}

}  // namespace rimlight
