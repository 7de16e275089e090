// The tables of a store: those of version 1 that become those of version 2, lists, and deletion.
#include "server/store/session_tables.h"

#include <gtest/gtest.h>

#include "server/store/sqlite_store.h"
#include "tests/server/stored_edits.h"
#include "tests/support/error_of.h"
#include "tests/support/temporary_folder.h"

namespace rimlight::server {
namespace {

using test::numbered_edit;
using test::run_sql;
using test::store_one;

/// As the first version made them, with a session of two edits.
constexpr const char* kVersionOne = R"(
PRAGMA application_id = 1382894708; PRAGMA user_version = 1; PRAGMA journal_mode = WAL;
CREATE TABLE sessions (
  id INTEGER PRIMARY KEY, scene TEXT NOT NULL, name TEXT NOT NULL,
  epoch INTEGER NOT NULL, revision INTEGER NOT NULL,
  state TEXT NOT NULL, changed_ms INTEGER NOT NULL, UNIQUE (scene, name)) STRICT;
CREATE TABLE edits (
  session INTEGER NOT NULL REFERENCES sessions (id), revision INTEGER NOT NULL,
  epoch INTEGER NOT NULL, author TEXT NOT NULL, at_ms INTEGER NOT NULL, change TEXT NOT NULL,
  PRIMARY KEY (session, revision)) STRICT, WITHOUT ROWID;
CREATE TABLE failed_commits (overwritten INTEGER NOT NULL) STRICT;
INSERT INTO failed_commits VALUES (0);
INSERT INTO sessions VALUES (1, 'terrace', 'a', 7, 2, '{"exposure":2}', 1002);
INSERT INTO edits VALUES (1, 1, 7, 'client 1', 1001, '[]'), (1, 2, 7, 'client 4', 1002, '[]');
)";

class SessionTablesTest : public testing::Test {
 protected:
  StoredEdit edit_with_rows(int number, const std::string& session = "a") {
    StoredEdit edit = numbered_edit(number, session);
    edit.user = 1 + number % 2;
    edit.rows = test::numbered_rows(number);
    return edit;
  }

  rimlight::test::TemporaryFolder folder;
  SqliteStoreSettings settings{.file = folder / "sessions.sqlite"};
};

TEST_F(SessionTablesTest, OfTheFirstVersionKeepWhatTheyHaveAndTakeTheNewRows) {
  run_sql(settings.file.string(), kVersionOne);
  {
    SqliteStore store(settings);
    const auto session = store.load("terrace", "a");
    ASSERT_TRUE(session);
    EXPECT_EQ(session->revision, (Revision{7, 2}));
    EXPECT_EQ(session->state, R"({"exposure":2})");
    EXPECT_EQ(session->author, (Author{0, "client 4"}));
    EXPECT_TRUE(session->users.empty() && session->steps.empty() && session->snapshots.empty());
    for (int i = 3; i <= 6; ++i) EXPECT_EQ(store_one(store, edit_with_rows(i)), "");
  }
  EXPECT_EQ(run_sql(settings.file.string(), "PRAGMA user_version"), "2");
  SqliteStore store(settings);
  const auto session = store.load("terrace", "a");
  EXPECT_EQ(session->author, (Author{1, "client 1"}));
  EXPECT_EQ(session->steps.size(), 4u);
  EXPECT_EQ(session->snapshots.size(), 1u);
}

TEST_F(SessionTablesTest, AChangeOfVersionThatFailsLeavesTheOldOne) {
  run_sql(settings.file.string(), std::string(kVersionOne) + "CREATE TABLE snapshots (other);");
  EXPECT_NE(rimlight::test::error_of([&] { SqliteStore store(settings); }), "no error");
  EXPECT_EQ(run_sql(settings.file.string(), "PRAGMA user_version"), "1");
  EXPECT_EQ(run_sql(settings.file.string(), "SELECT count(*) FROM edits WHERE author != ''"), "2");
  EXPECT_EQ(run_sql(settings.file.string(),
                    "SELECT count(*) FROM pragma_table_info('edits') WHERE name = 'user'"),
            "0");
}

TEST_F(SessionTablesTest, GiveBackUsersStepsAndSnapshotsAsTheyWere) {
  {
    SqliteStore store(settings);
    for (int i = 1; i <= 47; ++i) {
      ASSERT_EQ(store_one(store, edit_with_rows(i)), "");
      test::expect_rows_of(i, *store.load("terrace", "a"));
    }
  }
  SqliteStore store(settings);
  test::expect_rows_of(47, *store.load("terrace", "a"));
  StoredEdit last = numbered_edit(48);
  last.rows.forgotten_users = {1};
  ASSERT_EQ(store_one(store, last), "");
  const auto session = store.load("terrace", "a");
  ASSERT_EQ(session->users.size(), 1u);
  for (const StoredStep& step : session->steps) EXPECT_EQ(step.user, 2);
  EXPECT_EQ(session->steps.size(), 5u);
}

TEST_F(SessionTablesTest, AreListedAndASessionIsDeletedWithAllThatBelongsToIt) {
  {
    SqliteStore store(settings);
    for (int i = 1; i <= 20; ++i) {
      ASSERT_EQ(store_one(store, edit_with_rows(i, "a")), "");
      ASSERT_EQ(store_one(store, edit_with_rows(i, "b")), "");
    }
  }
  {
    SessionTables tables(settings);
    const std::vector<ListedSession> all = tables.list();
    ASSERT_EQ(all.size(), 2u);
    EXPECT_EQ(all[1].scene + "/" + all[1].name, "terrace/b");
    EXPECT_EQ(all[1].revision, 20);
    EXPECT_EQ(all[1].changed_ms, 1020);
    EXPECT_EQ(all[1].snapshots, 2);
    EXPECT_FALSE(tables.remove("terrace", "c"));
    EXPECT_TRUE(tables.remove("terrace", "a"));
    EXPECT_FALSE(tables.load("terrace", "a"));
    test::expect_rows_of(20, *tables.load("terrace", "b"));
  }
  for (const char* const table : {"edits", "users", "steps", "snapshots"}) {
    EXPECT_EQ(run_sql(settings.file.string(),
                      std::string("SELECT count(*) FROM ") + table + " WHERE session = 1"),
              "0")
        << table;
  }
}

}  // namespace
}  // namespace rimlight::server
