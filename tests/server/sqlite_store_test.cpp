#include "server/store/sqlite_store.h"

#include <gtest/gtest.h>
#include <sqlite3.h>

#include <atomic>
#include <cstdio>
#include <fstream>
#include <future>

#include "tests/server/stored_edits.h"
#include "tests/support/error_of.h"
#include "tests/support/temporary_folder.h"

namespace rimlight::server {
namespace {

using rimlight::test::error_of;
using std::chrono::seconds;
using test::numbered_edit;
using test::run_sql;
using test::store_one;

constexpr seconds kPatience{10};

class SqliteStoreTest : public testing::Test {
 protected:
  rimlight::test::TemporaryFolder folder;
  SqliteStoreSettings settings{.file = folder / "sessions.sqlite"};
};

TEST_F(SqliteStoreTest, WhatWasKeptIsThereAfterItIsOpenedAgain) {
  {
    SqliteStore store(settings);
    EXPECT_FALSE(store.load("terrace", "a"));
    for (int i = 1; i <= 3; ++i) EXPECT_EQ(store_one(store, numbered_edit(i)), "");
    EXPECT_EQ(store_one(store, numbered_edit(1, "b")), "");
  }
  SqliteStore store(settings);
  const auto a = store.load("terrace", "a");
  ASSERT_TRUE(a);
  EXPECT_EQ(a->revision, (Revision{7, 3}));
  EXPECT_EQ(a->state, numbered_edit(3).state);
  EXPECT_EQ(store.load("terrace", "b")->revision.number, 1);
  EXPECT_FALSE(store.load("other", "a"));
}

TEST_F(SqliteStoreTest, AnEditOfARevisionThatIsNotTheSessionsIsRefusedAndTheOthersAreKept) {
  SqliteStore store(settings);
  EXPECT_NE(store_one(store, numbered_edit(2)), "");  // 1 is not there
  EXPECT_FALSE(store.load("terrace", "a"));
  EXPECT_EQ(store_one(store, numbered_edit(1)), "");
  EXPECT_NE(store_one(store, numbered_edit(1)), "");  // twice
  EXPECT_NE(store_one(store, numbered_edit(3)), "");
  StoredEdit other_life = numbered_edit(2);
  other_life.before.epoch = 6;
  EXPECT_NE(store_one(store, other_life), "");
  EXPECT_EQ(store.load("terrace", "a")->revision, (Revision{7, 1}));
  EXPECT_EQ(store_one(store, numbered_edit(2)), "");
}

TEST_F(SqliteStoreTest, ManyEditsThatComeTogetherCostFewCommitsAndAreAnsweredInOrder) {
  SqliteStore store(settings);
  constexpr int kEdits = 2000;
  std::vector<int> answered;
  for (int i = 1; i <= kEdits; ++i) {
    store.append(numbered_edit(i), [&answered, i](const auto& refusal) {
      if (!refusal) answered.push_back(i);
    });
  }
  ASSERT_TRUE(store.drain(kPatience));
  ASSERT_EQ(answered.size(), static_cast<std::size_t>(kEdits));
  EXPECT_TRUE(std::is_sorted(answered.begin(), answered.end()));
  std::printf("%d edits, %d commits\n", kEdits, static_cast<int>(store.commits()));
  EXPECT_LT(store.commits(), kEdits / 10);
  EXPECT_EQ(store.load("terrace", "a")->revision.number, kEdits);
}

TEST_F(SqliteStoreTest, TooManyThatWaitAreRefusedAtOnceAndTheRestIsKept) {
  settings.most_waiting = 3;
  SqliteStore store(settings);
  std::promise<void> go;
  const std::shared_future<void> gone = go.get_future().share();
  store.append(numbered_edit(1), [gone](const auto&) { gone.wait(); });  // the disk hangs
  for (int i = 2; i <= 3; ++i) store.append(numbered_edit(i), [](const auto&) {});
  const std::string refusal = error_of([&] { store.append(numbered_edit(4), {}); });
  EXPECT_NE(refusal.find("3 edits that wait for the disk"), std::string::npos) << refusal;
  EXPECT_FALSE(store.drain(std::chrono::milliseconds(20)));
  go.set_value();
  ASSERT_TRUE(store.drain(kPatience));
  EXPECT_EQ(store.load("terrace", "a")->revision.number, 3);
  EXPECT_EQ(store_one(store, numbered_edit(4)), "");
}

TEST_F(SqliteStoreTest, TooManyBytesThatWaitAreRefusedToo) {
  settings.most_waiting_bytes = 10000;
  SqliteStore store(settings);
  StoredEdit large = numbered_edit(1);
  large.state.resize(10000, ' ');
  EXPECT_NE(error_of([&] { store.append(large, {}); }), "no error");
  EXPECT_EQ(store_one(store, numbered_edit(1)), "");
}

TEST_F(SqliteStoreTest, AFullDiskRefusesWithTheReasonAndKeepsWhatItHas) {
  settings.most_pages = 12;
  int kept = 0;
  {
    SqliteStore store(settings);
    std::string refusal;
    for (int i = 1; i <= 1000 && refusal.empty(); ++i) {
      refusal = store_one(store, numbered_edit(i));
      if (refusal.empty()) kept = i;
    }
    EXPECT_NE(refusal.find("full"), std::string::npos) << refusal;
    EXPECT_NE(refusal.find("sessions.sqlite"), std::string::npos) << refusal;
    ASSERT_GT(kept, 1);
    EXPECT_EQ(store.load("terrace", "a")->revision.number, kept);
  }
  settings.most_pages = 0;  // room again
  SqliteStore store(settings);
  EXPECT_EQ(store.load("terrace", "a")->revision.number, kept);
  EXPECT_EQ(store.load("terrace", "a")->state, numbered_edit(kept).state);
  EXPECT_EQ(store_one(store, numbered_edit(kept + 1)), "");
}

TEST_F(SqliteStoreTest, TheLogSaysWhoDidWhatAndKeepsTheLastEdits) {
  settings.kept_edits = 100;
  {
    SqliteStore store(settings);
    for (int i = 1; i <= 400; ++i) store.append(numbered_edit(i), [](const auto&) {});
    ASSERT_TRUE(store.drain(kPatience));
  }
  const std::string file = settings.file.string();
  const int rows = std::stoi(run_sql(file, "SELECT count(*) FROM edits"));
  EXPECT_GE(rows, 100);
  EXPECT_LE(rows, 164);
  EXPECT_EQ(run_sql(file, "SELECT max(revision) - min(revision) + 1 FROM edits"),
            std::to_string(rows));
  EXPECT_EQ(run_sql(file, "SELECT author FROM edits WHERE revision = 400"), "client 1");
  EXPECT_EQ(run_sql(file, "SELECT change FROM edits WHERE revision = 399"),
            numbered_edit(399).change);
  EXPECT_EQ(run_sql(file, "SELECT at_ms FROM edits WHERE revision = 399"), "1399");
}

TEST_F(SqliteStoreTest, ASecondServerIsTurnedAway) {
  const SqliteStore store(settings);
  const std::string refusal = error_of([&] { SqliteStore second(settings); });
  EXPECT_NE(refusal.find("sessions.sqlite"), std::string::npos) << refusal;
  EXPECT_NE(refusal.find("no other server"), std::string::npos) << refusal;
}

TEST_F(SqliteStoreTest, ANewerStoreAndOneOfAnotherProgramAreRefusedAndLeftAsTheyWere) {
  { const SqliteStore store(settings); }
  run_sql(settings.file.string(), "PRAGMA user_version = 3");
  const std::string newer = error_of([&] { SqliteStore store(settings); });
  EXPECT_NE(newer.find("sessions.sqlite: found version 3"), std::string::npos) << newer;
  EXPECT_EQ(run_sql(settings.file.string(), "PRAGMA user_version"), "3");

  settings.file = folder / "other.sqlite";
  run_sql(settings.file.string(), "CREATE TABLE notes (text)");
  const std::string other = error_of([&] { SqliteStore store(settings); });
  EXPECT_NE(other.find("other.sqlite: found a database of another program"), std::string::npos);
  EXPECT_EQ(run_sql(settings.file.string(), "PRAGMA journal_mode"), "delete");
}

TEST_F(SqliteStoreTest, AFileThatIsNoStoreOrIsDamagedIsNamedAtTheStart) {
  std::ofstream(settings.file) << std::string(5000, 'x');
  EXPECT_NE(error_of([&] { SqliteStore store(settings); }).find("sessions.sqlite: found file is"),
            std::string::npos);
  std::filesystem::remove(settings.file);
  {
    SqliteStore store(settings);
    for (int i = 1; i <= 200; ++i) store.append(numbered_edit(i), [](const auto&) {});
    ASSERT_TRUE(store.drain(kPatience));
  }
  std::fstream file(settings.file, std::ios::in | std::ios::out | std::ios::binary);
  file.seekp(4096);
  file << std::string(16384, '\xff');  // the tables' pages
  file.close();
  EXPECT_NE(error_of([&] { SqliteStore store(settings); }).find("sessions.sqlite"),
            std::string::npos);
  settings.file = folder / "missing" / "sessions.sqlite";
  EXPECT_NE(error_of([&] { SqliteStore store(settings); }).find("sessions.sqlite"),
            std::string::npos);
}

}  // namespace
}  // namespace rimlight::server
