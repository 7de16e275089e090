#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdio>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "cli/command.h"
#include "cli/number_range.h"
#include "core/base/error.h"
#include "core/base/files.h"
#include "core/base/parallel.h"
#include "core/curves/curve_layer.h"
#include "core/image/codec.h"
#include "core/image/image_file.h"
#include "core/relight/frame_renderer.h"
#include "core/vertices/vertex_renderer.h"

namespace rimlight {
namespace {

struct RenderOptions {
  std::string folder;
  std::string light;
  std::vector<double> rotation{0, 0, 0, 1};
  std::vector<double> view;  // position and target; empty: the bake's own
  double exposure = 0;
  std::string window;  // empty: the default
  std::string output = "rimlight.png";
  int threads = 0;
  bool json = false;
};

using Environments = std::vector<BakedEnvironment>;

bool has_environment(const Environments& all, const std::string& name) {
  return std::any_of(all.begin(), all.end(),
                     [&](const auto& one) { return one.environment->name() == name; });
}

Quaternion unit_rotation(const std::vector<double>& numbers) {
  const Quaternion given{numbers[0], numbers[1], numbers[2], numbers[3]};
  const double size = norm(given);
  if (!(size > 1e-6 && size < 1e6)) {
    throw Error("--rotation", "a quaternion of length " + std::to_string(size),
                "four finite numbers x,y,z,w that are not all 0");
  }
  return normalized(given);
}

/// The camera that --view asks for, if it does, with the rest of the bake's own.
std::optional<Camera> chosen_view(const RenderOptions& options, Camera camera) {
  const std::vector<double>& v = options.view;
  if (v.empty()) return std::nullopt;
  camera.position = {v[0], v[1], v[2]};
  camera.target = {v[3], v[4], v[5]};
  check_camera(camera, "--view");
  return camera;
}

/// The bake's environment of that name, or a file's, added to the renderer: a FrameRenderer or a
/// VertexRenderer.
template <typename Renderer>
std::string choose_light(const RenderOptions& options, const Environments& environments,
                         Renderer& renderer) {
  if (options.light.empty()) return environments.front().environment->name();
  if (has_environment(environments, options.light)) return options.light;
  const std::filesystem::path file(options.light);
  if (!file.has_extension()) {
    std::string names;
    for (const auto& one : environments) names += " " + quote(one.environment->name());
    throw Error("--light", quote(options.light), "one of" + names + ", or a .hdr or .exr file");
  }
  auto environment = std::make_shared<const Environment>(load_environment(file));
  renderer.add_environment(environment);
  return environment->name();
}

/// Writes the picture of a state; answers how it came about.
template <typename Renderer>
FrameReport render(const RenderOptions& options, const DesignState& state, Renderer& renderer) {
  const std::filesystem::path output(options.output);
  FrameReport report;
  if (output.extension() == ".exr") {
    RgbImage image;
    renderer.render_radiance(state, image, report);
    write_exr(output, image);
  } else {
    Rgb8Image frame;
    renderer.render_exact(state, frame, report);
    std::vector<std::uint8_t> png;
    encode_png(frame, png);
    write_file_atomically(output, {reinterpret_cast<const char*>(png.data()), png.size()});
  }
  return report;
}

DesignState state_of(const RenderOptions& options, const std::string& light) {
  return {light, unit_rotation(options.rotation), options.exposure};
}

void render_image_bake(const RenderOptions& options, DesignState& state, FrameReport& report) {
  if (!options.view.empty() || !options.window.empty()) {
    throw Error(options.view.empty() ? "--window" : "--view",
                "a bake of kind image_haar, the image of one camera", "a bake of kind vertex_sh");
  }
  const auto bake = std::make_shared<const Bake>(options.folder);
  FrameRenderer renderer(bake, {}, curve_layer_of(bake));
  state = state_of(options, choose_light(options, renderer.bake().environments(), renderer));
  report = render(options, state, renderer);
}

void render_vertex_bake(const RenderOptions& options, DesignState& state, FrameReport& report) {
  const auto scene = std::make_shared<const VertexScene>(
      vertex_scene_of(std::make_shared<const VertexBake>(options.folder)));
  VertexSettings settings;
  if (!options.window.empty()) settings.window = parse_window(options.window, "--window");
  VertexRenderer renderer(scene, settings);
  state = state_of(options, choose_light(options, scene->environments, renderer));
  state.view = chosen_view(options, scene->camera);
  report = render(options, state, renderer);
}

int run(const RenderOptions& options) {
  if (options.threads > 0) set_thread_count(options.threads);
  const std::filesystem::path output(options.output);
  const std::string ending = output.extension().string();
  if (ending != ".png" && ending != ".exr") {
    throw Error("--output", quote(options.output), "a name that ends in .png or .exr");
  }
  DesignState state;
  FrameReport report;
  if (bake_kind(options.folder) == kVertexKind) {
    render_vertex_bake(options, state, report);
  } else {
    render_image_bake(options, state, report);
  }
  for (const std::string& words : report.unshown) {
    std::fprintf(stderr, "rimlight render: not shown: %s\n", words.c_str());
  }
  if (options.json) {
    const nlohmann::json result = {
        {"image", output.string()},      {"light", state.environment},
        {"terms", report.terms},         {"rotate_ms", report.rotate_ms},
        {"update_ms", report.update_ms}, {"display_ms", report.display_ms}};
    std::printf("%s\n", result.dump().c_str());
  }
  return 0;
}

}  // namespace

void add_render_command(CLI::App& app, Action& chosen) {
  auto options = std::make_shared<RenderOptions>();
  CLI::App* const command =
      app.add_subcommand("render", "Relight a bake once, exactly, to a .png or .exr file");
  command->add_option("bake", options->folder, "Bake, a NAME.bake folder")->required();
  command->add_option("--light", options->light,
                      "An environment of the bake by name, or a .hdr or .exr file (default: the "
                      "bake's first)");
  command->add_option("--rotation", options->rotation, "Quaternion x,y,z,w that turns the light")
      ->delimiter(',')
      ->expected(4);
  command
      ->add_option("--view", options->view,
                   "Position and target x,y,z,x,y,z of the camera; for bakes of kind vertex_sh "
                   "(default: the bake's own)")
      ->delimiter(',')
      ->expected(6);
  command->add_option("--window", options->window,
                      "Against dark rings about highlights: none, hann, lanczos or fitted; for "
                      "bakes of kind vertex_sh (default: fitted)");
  command->add_option("--exposure", options->exposure, "Stops; 0 is the bake's own exposure")
      ->check(number_range(-20, 20));
  command->add_option("-o,--output", options->output, "Picture to write")->capture_default_str();
  command->add_option("--threads", options->threads, "Threads to use (default: all cores)")
      ->check(CLI::Range(1, 1024));
  command->add_flag("--json", options->json, "Print the result as one JSON object");
  command->callback([options, &chosen] { chosen = [options] { return run(*options); }; });
}

}  // namespace rimlight
