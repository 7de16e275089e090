#include <CLI/CLI.hpp>

#include "cli/command.h"
#include "server/upload/decoded_environment.h"

namespace rimlight {

/// What the server starts for an upload; of no use to people, and so not in the help.
void add_decode_command(CLI::App& app, Action& chosen) {
  CLI::App* const command = app.add_subcommand(
      "decode-environment", "Decode an environment from standard input, shut in (internal)");
  command->group("");
  command->callback([&chosen] { chosen = server::decode_environment; });
}

}  // namespace rimlight
