#include <spdlog/sinks/stdout_color_sinks.h>
#include <spdlog/spdlog.h>
#include <CLI/CLI.hpp>

#include <exception>
#include <new>
#include <string>

#include "cli/command.h"
#include "cli/version.h"
#include "core/base/error.h"
#include "core/base/parallel.h"

namespace {

constexpr int kDone = 0;
constexpr int kFailed = 1;
constexpr int kWrongUsage = 2;

int run(int argc, char** argv) {
  CLI::App program("Bakes a scene's light transport once and relights it at once, again and again.",
                   "rimlight");
  program.set_version_flag("--version", rimlight::version());
  program.require_subcommand(1);
  program.footer(
      "A first picture:\n"
      "  rimlight bake configs/scenes/terrace.json -o terrace.bake\n"
      "  rimlight render terrace.bake --light sunny -o terrace.png\n"
      "  rimlight serve terrace.bake\n"
      "`rimlight COMMAND --help` explains a command.");
  rimlight::Action chosen;
  rimlight::add_bake_command(program, chosen);
  rimlight::add_import_command(program, chosen);
  rimlight::add_inspect_command(program, chosen);
  rimlight::add_render_command(program, chosen);
  rimlight::add_report_command(program, chosen);
  rimlight::add_serve_command(program, chosen);
  rimlight::add_sessions_command(program, chosen);
  rimlight::add_token_command(program, chosen);
  rimlight::add_load_command(program, chosen);
  rimlight::add_decode_command(program, chosen);
  try {
    program.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    // CLI11 has exit codes of its own; help and version end well, anything else is wrong usage.
    return program.exit(error) == 0 ? kDone : kWrongUsage;
  }
  return chosen();
}

}  // namespace

int main(int argc, char** argv) {
  // Standard output belongs to results; everything said on the way goes to standard error.
  spdlog::set_default_logger(spdlog::stderr_color_mt("rimlight"));
  spdlog::set_pattern("%Y-%m-%d %H:%M:%S.%e %^%l%$ %v");
  rimlight::flush_denormals();
  try {
    return run(argc, argv);
  } catch (const rimlight::Error& error) {
    std::fprintf(stderr, "rimlight: %s\n", error.what());
  } catch (const std::bad_alloc&) {
    std::fprintf(stderr, "rimlight: found too little memory, expected more\n");
  } catch (const std::exception& error) {
    std::fprintf(stderr, "rimlight: %s\n", error.what());
  }
  return kFailed;
}
