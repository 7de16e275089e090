#include "tests/server/stored_edits.h"

#include <sqlite3.h>

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
