#include <CLI/CLI.hpp>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <memory>
#include <string>

#include "cli/command.h"
#include "core/base/error.h"
#include "server/access/access_token.h"

namespace rimlight {
namespace {

struct TokenOptions {
  std::string key;
  std::string new_key;
  std::string key_id = "first";
  std::string role = "editor";
  std::string session;
  std::string name;
  double hours = 8;
};

int make_key(const TokenOptions& options) {
  server::make_key_file(options.new_key, options.key_id);
  std::fprintf(stderr, "made a signing key in %s: keep it secret\n", options.new_key.c_str());
  return 0;
}

int issue(const TokenOptions& options) {
  constexpr double kMostHours =
      std::chrono::duration<double, std::ratio<3600>>(server::kLongestLife).count();
  if (!(options.hours > 0 && options.hours <= kMostHours)) {
    throw Error("--hours", std::to_string(options.hours), "more than 0, at most 8784");
  }
  if (options.session.empty()) throw Error("--session", "none", "a session's name, or * for any");
  const server::SigningKeys keys = server::read_signing_keys(options.key);
  const auto now = server::WallClock::now();
  const std::chrono::seconds life(std::llround(std::ceil(options.hours * 3600)));
  const server::Access access{server::parse_role(options.role, "--role"), options.session,
                              options.name, now + life};
  std::printf("%s\n", server::issue_token(access, keys, now).c_str());
  return 0;
}

}  // namespace

void add_token_command(CLI::App& app, Action& chosen) {
  const auto options = std::make_shared<TokenOptions>();
  CLI::App* const command = app.add_subcommand(
      "token", "Print an access token for `rimlight serve --key`, or make a key");
  CLI::Option* const key =
      command->add_option("--key", options->key, "The file of signing keys; its first one signs");
  CLI::Option* const new_key = command->add_option(
      "--new-key", options->new_key, "Make this file with one new key, and print no token");
  key->excludes(new_key);
  command->add_option("--key-id", options->key_id, "The new key's id [first]")->needs(new_key);
  command->add_option("--role", options->role, "owner, editor or viewer [editor]")->needs(key);
  command->add_option("--session", options->session, "The session's name; * for any")->needs(key);
  command->add_option("--name", options->name, "Whose token it is, for attribution")->needs(key);
  command->add_option("--hours", options->hours, "How long it is valid [8]")->needs(key);
  command->require_option(1, 0);
  command->callback([options, &chosen] {
    chosen = [options] { return options->new_key.empty() ? issue(*options) : make_key(*options); };
  });
}

}  // namespace rimlight
