#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdio>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "cli/command.h"
#include "cli/load_report.h"
#include "cli/load_run.h"
#include "cli/number_range.h"
#include "core/base/error.h"
#include "core/base/files.h"
#include "core/light/light_sequence_source.h"
#include "server/session/baked_scene.h"

namespace rimlight {
namespace {

constexpr double kDefaultSeconds = 5;

struct LoadOptions {
  std::string url = "ws://127.0.0.1:8080";
  std::string token;
  std::string token_file;
  std::string authority;
  std::string scene;
  std::string bake;
  std::string script;
  std::string sequence;
  std::string window;  // empty: the default
  int clients = 1;
  std::optional<double> seconds;
  bool shared_session = false;
  std::string codec = "jpeg";
  double slow_kBps = 0;
  bool json = false;
};

/// What all clients play together, and for how long.
struct Plan {
  LoadScript script;
  double seconds = kDefaultSeconds;
};

Plan plan_of(const LoadOptions& options) {
  if (!options.sequence.empty()) {
    const LightSequence sequence = find_light_sequence(options.sequence, "--sequence");
    Plan plan{sequence_script(sequence), sequence.seconds(sequence.frame_count())};
    plan.seconds = options.seconds.value_or(plan.seconds);
    return plan;
  }
  const double seconds = options.seconds.value_or(kDefaultSeconds);
  return {options.script.empty() ? default_script(seconds) : read_script(options.script, seconds),
          seconds};
}

LoadCodec codec_of(const LoadOptions& options) {
  return options.codec == "vp8" ? LoadCodec::vp8 : LoadCodec::jpeg;
}

/// The token of the file, the option or the environment, in that order.
StreamPass pass_of(const LoadOptions& options) {
  constexpr std::size_t kLargest = 16 * 1024;
  StreamPass pass{options.token, options.authority};
  if (!options.token_file.empty()) {
    pass.token = read_file(options.token_file, kLargest);
    pass.token.erase(std::min(pass.token.find_first_of("\r\n \t"), pass.token.size()));
    if (pass.token.empty()) throw Error(options.token_file, "nothing", "an access token");
  }
  return pass;
}

int load(LoadOptions options) {
  if (!options.bake.empty() && options.scene.empty()) {
    options.scene = server::scene_name(options.bake);
  }
  VertexSettings vertices;
  if (!options.window.empty()) vertices.window = parse_window(options.window, "--window");
  const Plan plan = plan_of(options);
  const std::vector<LoadRecord> records = play_run({.url = parse_stream_url(options.url),
                                                    .pass = pass_of(options),
                                                    .scene = options.scene,
                                                    .script = plan.script,
                                                    .seconds = plan.seconds,
                                                    .clients = options.clients,
                                                    .shared_session = options.shared_session,
                                                    .codec = codec_of(options),
                                                    .slow_kBps = options.slow_kBps});
  const bool is_default = options.script.empty() && options.sequence.empty();
  LoadReport report =
      summarize(records, is_default ? ScriptKind::every_edit_changes : ScriptKind::any);
  report.checks.push_back(compare_with_bake(records, options.bake, vertices));
  const std::string text = options.json ? report.to_json().dump() + "\n" : report.to_text();
  std::fputs(text.c_str(), stdout);
  return report.passed() ? 0 : 1;
}

}  // namespace

void add_load_command(CLI::App& app, Action& chosen) {
  const auto options = std::make_shared<LoadOptions>();
  CLI::App* const command = app.add_subcommand(
      "load", "Play scripted clients against a server, measure, and check what they get");
  command->add_option("--url", options->url, "The server")->capture_default_str();
  command
      ->add_option("--token", options->token,
                   "An access token; better by --token-file or RIMLIGHT_TOKEN, since other users "
                   "see arguments")
      ->envname("RIMLIGHT_TOKEN");
  command->add_option("--token-file", options->token_file,
                      "A file that holds an access token; it goes first");
  command->add_option("--certificate-authority", options->authority,
                      "Whom to believe who the server of a wss:// URL is, in PEM [this machine's]");
  command->add_option("--clients", options->clients, "How many")
      ->check(CLI::Range(1, 1000))
      ->capture_default_str();
  command
      ->add_option("--seconds", options->seconds,
                   "How long the script plays [5, or the sequence's own length]")
      ->check(number_range(0.1, 3600));
  command->add_flag("--shared-session", options->shared_session,
                    "All clients open one session and play the script together");
  command->add_option("--codec", options->codec, "What clients say that they decode")
      ->check(CLI::IsMember({"jpeg", "vp8"}))
      ->capture_default_str();
  command
      ->add_option(
          "--slow-kBps", options->slow_kBps,
          "The last client only watches (a single one edits), and takes so many kB a second")
      ->check(number_range(1, 1e6));
  command->add_option("--scene", options->scene, "The scene to open [the server's default]");
  command->add_option("--bake", options->bake,
                      "The bake that is served: the last frame must equal its render");
  command->add_option("--window", options->window,
                      "The server's --window, for the comparison with --bake [fitted]");
  CLI::Option* const script = command->add_option(
      "--script", options->script, "A JSON file of timed edits [a turn about y, ever faster]");
  command
      ->add_option("--sequence", options->sequence,
                   "A light sequence that only rotates: \"rotation\" or a .json file")
      ->excludes(script);
  command->add_flag("--json", options->json, "Print one JSON object");
  command->callback([options, &chosen] { chosen = [options] { return load(*options); }; });
}

}  // namespace rimlight
