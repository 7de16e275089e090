#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdio>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "cli/command.h"
#include "cli/number_range.h"
#include "core/base/error.h"
#include "core/base/files.h"
#include "core/base/parallel.h"
#include "core/image/codec.h"
#include "core/image/image_file.h"
#include "core/relight/frame_renderer.h"

namespace rimlight {
namespace {

struct RenderOptions {
  std::string folder;
  std::string light;
  std::vector<double> rotation{0, 0, 0, 1};
  double exposure = 0;
  std::string output = "rimlight.png";
  int threads = 0;
  bool json = false;
};

bool has_environment(const Bake& bake, const std::string& name) {
  const auto& all = bake.environments();
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

/// The bake's environment of that name, or a file's, added to the renderer.
std::string choose_light(const RenderOptions& options, FrameRenderer& renderer) {
  const Bake& bake = renderer.bake();
  if (options.light.empty()) return bake.environments().front().environment->name();
  if (has_environment(bake, options.light)) return options.light;
  const std::filesystem::path file(options.light);
  if (!file.has_extension()) {
    std::string names;
    for (const auto& one : bake.environments()) names += " " + quote(one.environment->name());
    throw Error("--light", quote(options.light), "one of" + names + ", or a .hdr or .exr file");
  }
  auto environment = std::make_shared<const Environment>(load_environment(file));
  renderer.add_environment(environment);
  return environment->name();
}

int run(const RenderOptions& options) {
  if (options.threads > 0) set_thread_count(options.threads);
  const std::filesystem::path output(options.output);
  const std::string ending = output.extension().string();
  if (ending != ".png" && ending != ".exr") {
    throw Error("--output", quote(options.output), "a name that ends in .png or .exr");
  }
  FrameRenderer renderer(std::make_shared<const Bake>(options.folder), {});
  const DesignState state{choose_light(options, renderer), unit_rotation(options.rotation),
                          options.exposure};
  FrameReport report;
  if (ending == ".exr") {
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
  command->add_option("--exposure", options->exposure, "Stops; 0 is the bake's own exposure")
      ->check(number_range(-20, 20));
  command->add_option("-o,--output", options->output, "Picture to write")->capture_default_str();
  command->add_option("--threads", options->threads, "Threads to use (default: all cores)")
      ->check(CLI::Range(1, 1024));
  command->add_flag("--json", options->json, "Print the result as one JSON object");
  command->callback([options, &chosen] { chosen = [options] { return run(*options); }; });
}

}  // namespace rimlight
