// `rimlight load` with an access token from a file, an option or the environment.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <stdlib.h>  // NOLINT: setenv is POSIX

#include <fstream>

#include "server/access/access_token.h"
#include "tests/server/loopback_server.h"
#include "tests/support/program.h"
#include "tests/support/temporary_folder.h"

namespace rimlight::server {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

class LoadToken : public testing::Test {
 protected:
  LoadToken() {
    settings.network.keys =
        std::make_shared<const SigningKeys>(std::vector<SigningKey>{{"key", std::string(32, 'k')}});
    server = std::make_unique<test::LoopbackServer>(settings);
  }
  std::string token(Role role) const {
    const auto now = WallClock::now();
    return issue_token({role, "*", "Ann", now + std::chrono::hours(1)}, *settings.network.keys,
                       now);
  }
  std::string file_of(const std::string& text) const {
    std::ofstream(folder / "token") << text;
    return (folder / "token").string();
  }
  rimlight::test::ProgramResult load(std::vector<std::string> more) const {
    std::vector<std::string> all{
        "load",      "--url", "ws://127.0.0.1:" + std::to_string(server->port()), "--clients", "1",
        "--seconds", "0.5"};
    all.insert(all.end(), more.begin(), more.end());
    return rimlight::test::run_program(all);
  }

  test::LoopbackServer::Settings settings;
  std::unique_ptr<test::LoopbackServer> server;
  rimlight::test::TemporaryFolder folder;
};

TEST_F(LoadToken, IsReadFromAFileWhichGoesFirst) {
  const std::string good = token(Role::editor);
  EXPECT_THAT(load({}).errors, HasSubstr("401"));
  const auto by_file = load({"--token-file", file_of(good + "\r\n")});
  EXPECT_EQ(by_file.status, 0) << by_file.errors;
  const auto over_option = load({"--token-file", file_of(good), "--token", "another"});
  EXPECT_EQ(over_option.status, 0) << over_option.errors;
  const auto by_option = load({"--token", good});
  EXPECT_EQ(by_option.status, 0) << by_option.errors;
  ::setenv("RIMLIGHT_TOKEN", good.c_str(), 1);
  const auto by_environment = load({}), over_environment = load({"--token-file", file_of("none")});
  ::unsetenv("RIMLIGHT_TOKEN");
  EXPECT_EQ(by_environment.status, 0) << by_environment.errors;
  EXPECT_THAT(over_environment.errors, HasSubstr("401"));
}

TEST_F(LoadToken, AFileWithoutOneIsNamedAndNoTokenIsTold) {
  for (const char* const text : {"", "\n", " x"}) {
    const auto result = load({"--token-file", file_of(text)});
    EXPECT_EQ(result.status, 1);
    EXPECT_THAT(result.errors, HasSubstr((folder / "token").string() + ": found nothing"));
  }
  const auto missing = load({"--token-file", (folder / "none").string()});
  EXPECT_EQ(missing.status, 1);
  EXPECT_THAT(missing.errors, HasSubstr((folder / "none").string()));
  const auto large = load({"--token-file", file_of(std::string(20000, 'x'))});
  EXPECT_EQ(large.status, 1);
  EXPECT_THAT(large.errors, HasSubstr("at most"));
  const auto forged = load({"--token-file", file_of("abc.def.ghi")});
  EXPECT_EQ(forged.status, 1);
  EXPECT_THAT(forged.errors, Not(HasSubstr("abc.def.ghi")));
}

}  // namespace
}  // namespace rimlight::server
