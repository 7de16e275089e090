// `rimlight sessions`.
#include <gtest/gtest.h>

#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include "cli/command.h"
#include "server/store/sqlite_store.h"
#include "tests/server/command_output.h"
#include "tests/server/stored_edits.h"
#include "tests/support/error_of.h"
#include "tests/support/temporary_folder.h"

namespace rimlight::server {
namespace {

using nlohmann::json;
using rimlight::test::error_of;

std::string run_sessions(const std::string& arguments) {
  return rimlight::test::command_output(add_sessions_command, "sessions " + arguments);
}

class SessionsCommand : public testing::Test {
 protected:
  SessionsCommand() {
    SqliteStore store({.file = file});
    for (int i = 1; i <= 3; ++i) EXPECT_EQ(test::store_one(store, test::numbered_edit(i)), "");
    EXPECT_EQ(test::store_one(store, test::numbered_edit(1, "b")), "");
  }
  json listed() { return json::parse(run_sessions("list --json " + file))["sessions"]; }

  rimlight::test::TemporaryFolder folder;
  const std::string file = folder / "sessions.sqlite";
};

TEST_F(SessionsCommand, ListsAndDeletes) {
  ASSERT_EQ(listed().size(), 2u);
  EXPECT_EQ(listed()[0], json({{"scene", "terrace"},
                               {"name", "a"},
                               {"revision", 3},
                               {"changed_ms", 1003},
                               {"snapshots", 0}}));
  const std::string lines = run_sessions("list " + file);
  EXPECT_EQ(std::count(lines.begin(), lines.end(), '\n'), 2);
  EXPECT_EQ(run_sessions("delete " + file + " terrace a"), "");
  ASSERT_EQ(listed().size(), 1u);
  EXPECT_EQ(listed()[0]["name"], "b");
}

TEST_F(SessionsCommand, SaysWhatIsNotThereAndMakesNoStore) {
  EXPECT_NE(error_of([&] { run_sessions("delete " + file + " terrace c"); }).find("\"c\""),
            std::string::npos);
  const std::string missing = folder / "missing.sqlite";
  EXPECT_NE(error_of([&] { run_sessions("list " + missing); }).find("missing.sqlite"),
            std::string::npos);
  EXPECT_FALSE(std::filesystem::exists(missing));
}

TEST_F(SessionsCommand, DoesNotTouchAStoreThatAServerHasOpen) {
  const SqliteStore store({.file = file});
  EXPECT_NE(error_of([&] { run_sessions("delete " + file + " terrace a"); }), "no error");
}

}  // namespace
}  // namespace rimlight::server
