#pragma once

#include <functional>

namespace CLI {
class App;
}

namespace rimlight {

/// What the chosen subcommand does; returns the exit status. Throws Error.
using Action = std::function<int()>;

// Each adds its subcommand to the program's; parsing the arguments sets `chosen`.
void add_bake_command(CLI::App& app, Action& chosen);
void add_import_command(CLI::App& app, Action& chosen);
void add_inspect_command(CLI::App& app, Action& chosen);
void add_render_command(CLI::App& app, Action& chosen);
void add_report_command(CLI::App& app, Action& chosen);
void add_serve_command(CLI::App& app, Action& chosen);
void add_sessions_command(CLI::App& app, Action& chosen);
void add_token_command(CLI::App& app, Action& chosen);
void add_decode_command(CLI::App& app, Action& chosen);
void add_load_command(CLI::App& app, Action& chosen);

}  // namespace rimlight
