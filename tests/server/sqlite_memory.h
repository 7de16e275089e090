#pragma once

#include <sqlite3.h>

namespace rimlight::server::test {

/// As long as it lives, SQLite's allocations count as those of FailingAllocation, and fail as they
/// do. Made and destroyed while no database is open; one at a time.
class SqliteMemory {
 public:
  SqliteMemory();
  ~SqliteMemory();
  SqliteMemory(const SqliteMemory&) = delete;
  SqliteMemory& operator=(const SqliteMemory&) = delete;
};

}  // namespace rimlight::server::test
