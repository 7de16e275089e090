// `rimlight token` and the door's part of the server's configuration.
#include <gtest/gtest.h>

#include <CLI/CLI.hpp>
#include <fstream>

#include "cli/command.h"
#include "cli/serve_config.h"
#include "server/access/access_token.h"
#include "tests/server/command_output.h"
#include "tests/support/error_of.h"
#include "tests/support/temporary_folder.h"

namespace rimlight {
namespace {

using server::WallClock;
using test::error_of;

std::string run_token(const std::string& arguments) {
  return rimlight::test::command_output(add_token_command, "token " + arguments);
}

TEST(TokenCommand, PrintsATokenThatTheKeyFileOfTheSameCommandBelieves) {
  const test::TemporaryFolder folder;
  const std::string file = folder / "keys.json";
  EXPECT_EQ(run_token("--new-key " + file + " --key-id k1"), "");
  std::string token =
      run_token("--key " + file + " --role viewer --session lobby --hours 0.5 --name Ann");
  ASSERT_TRUE(token.ends_with('\n'));
  token.pop_back();
  const server::SigningKeys keys = server::read_signing_keys(file);
  EXPECT_EQ(keys.newest().id, "k1");
  const auto checked = server::check_token(token, keys, WallClock::now());
  ASSERT_TRUE(std::holds_alternative<server::Access>(checked));
  const auto& access = std::get<server::Access>(checked);
  EXPECT_EQ(access.role, server::Role::viewer);
  EXPECT_EQ(access.session, "lobby");
  EXPECT_EQ(access.name, "Ann");
  const auto left = access.expires - WallClock::now();
  EXPECT_GT(left, std::chrono::minutes(29));
  EXPECT_LE(left, std::chrono::minutes(30));
}

TEST(TokenCommand, RefusesWhatMakesNoToken) {
  const test::TemporaryFolder folder;
  const std::string file = folder / "keys.json";
  run_token("--new-key " + file);
  const std::string key = "--key " + file;
  EXPECT_NE(error_of([&] { run_token(key + " --role editor"); }).find("--session"),
            std::string::npos);
  for (const char* const more :
       {" --session a --role god", " --session ../a", " --session a --hours 0",
        " --session a --hours -1", " --session a --hours nan", " --session a --hours 1e9"}) {
    EXPECT_NE(error_of([&] { run_token(key + more); }), "no error") << more;
  }
  EXPECT_NE(error_of([&] { run_token("--new-key " + file); }).find("exists"), std::string::npos);
  EXPECT_THROW(run_token(""), CLI::ParseError);
  EXPECT_THROW(run_token("--role editor --session a"), CLI::ParseError);
}

TEST(DoorConfiguration, IsReadAndItsBoundsAreKept) {
  const test::TemporaryFolder folder;
  const auto read = [&](const std::string& text) {
    std::ofstream(folder / "server.json") << text;
    return read_serve_config(folder / "server.json");
  };
  const ServeConfig config = read(R"({"key_file": "keys.json", "host_names": ["a.example"],
    "origins": ["https://b.example"], "most_connections_per_address": 3,
    "messages_per_second": 20, "handshake_timeout_seconds": 4})");
  EXPECT_EQ(config.key_file, folder / "keys.json");
  EXPECT_EQ(config.network.host_names, std::vector<std::string>{"a.example"});
  EXPECT_EQ(config.network.origins, std::vector<std::string>{"https://b.example"});
  EXPECT_EQ(config.network.most_connections_per_address, std::size_t{3});
  EXPECT_EQ(config.network.messages_per_second, 20);
  EXPECT_EQ(config.network.handshake_timeout, std::chrono::seconds(4));
  for (const char* const text :
       {R"({"most_connections_per_address": 0})", R"({"messages_per_second": 0})",
        R"({"messages_per_second": "many"})", R"({"host_names": "a"})", R"({"origins": [1]})",
        R"({"handshake_timeout_seconds": 0})", R"({"key_file": 1})", R"({"key": "x"})"}) {
    EXPECT_NE(error_of([&] { read(text); }), "no error") << text;
  }
}

}  // namespace
}  // namespace rimlight
