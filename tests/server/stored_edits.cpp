#include "tests/server/stored_edits.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sqlite3.h>

#include <algorithm>
#include <future>
#include <stdexcept>

#include "tests/support/error_of.h"

namespace rimlight::server::test {

StoredEdit numbered_edit(int number, const std::string& session) {
  const std::string text = std::to_string(number);
  return {"terrace",
          session,
          {7, number - 1},
          {7, number},
          R"({"exposure":)" + text + "}",
          R"([{"op":"replace","path":"/exposure","value":)" + text + "}]",
          "client 1",
          1000 + number};
}

namespace {

std::string hash_of(int user) { return std::string(64, static_cast<char>('a' + user)); }
StoredStep step_of(int number, bool undone) {
  return {1 + number % 2, number, undone, "step " + std::to_string(number) + std::string(500, 's')};
}
StoredSnapshot snapshot_of(int number) {
  return {"snapshot " + std::to_string(number), {1, "Ann"}, 1000 + number, {7, number}, "{}"};
}

}  // namespace

StoredRows numbered_rows(int number) {
  const int user = 1 + number % 2;
  StoredRows rows;
  rows.users.push_back({user, "Ann", hash_of(user), number});
  rows.steps.push_back(step_of(number, number % 3 == 0));
  if (number > 10) rows.forgotten_steps.emplace_back(user, number - 10);
  if (number % 5 == 0) rows.snapshots.push_back(snapshot_of(number));
  if (number % 10 == 0) rows.forgotten_snapshots.push_back(snapshot_of(number - 5).name);
  return rows;
}

void expect_rows_of(int number, const StoredSession& session) {
  std::vector<StoredStep> steps;
  std::vector<StoredSnapshot> snapshots;
  for (int i = number; i > 0 && i > number - 10; --i) steps.push_back(step_of(i, i % 3 == 0));
  for (int i = 1; i <= number; ++i) {
    const bool is_there = i % 10 == 0 || (i % 5 == 0 && i + 5 > number);
    if (is_there) snapshots.push_back(snapshot_of(i));
  }
  EXPECT_THAT(session.steps, testing::UnorderedElementsAreArray(steps));
  EXPECT_THAT(session.snapshots, testing::UnorderedElementsAreArray(snapshots));
  ASSERT_EQ(session.users.size(), static_cast<std::size_t>(std::min(number, 2)));
  for (const StoredUser& user : session.users) {
    const bool made_last = user.number == 1 + number % 2;
    EXPECT_EQ(user.last_revision, made_last ? number : number - 1);
    EXPECT_EQ(user.token_hash, hash_of(static_cast<int>(user.number)));
  }
}

std::string store_one(SessionStore& store, StoredEdit edit) {
  std::promise<std::string> answered;
  const std::string refused = rimlight::test::error_of([&] {
    store.append(std::move(edit), [&](const std::optional<StoreError>& refusal) {
      answered.set_value(refusal ? refusal->what() : "");
    });
  });
  return refused == "no error" ? answered.get_future().get() : refused;
}

std::string run_sql(const std::string& file, const std::string& sql) {
  sqlite3* database = nullptr;
  std::string value;
  const auto keep_first = [](void* kept, int, char** values, char**) {
    auto& text = *static_cast<std::string*>(kept);
    if (text.empty() && values[0] != nullptr) text = values[0];
    return 0;
  };
  int code = sqlite3_open(file.c_str(), &database);
  if (code == SQLITE_OK) code = sqlite3_exec(database, sql.c_str(), keep_first, &value, nullptr);
  sqlite3_close(database);
  if (code != SQLITE_OK) throw std::runtime_error(sqlite3_errstr(code));
  return value;
}

}  // namespace rimlight::server::test
