#include "tests/server/sqlite_memory.h"

#include "core/base/check.h"
#include "tests/support/allocation_count.h"

namespace rimlight::server::test {
namespace {

using rimlight::test::FailingAllocation;

sqlite3_mem_methods real{};

void* allocate(int size) { return FailingAllocation::fails_now() ? nullptr : real.xMalloc(size); }
void* grow(void* memory, int size) {
  return FailingAllocation::fails_now() ? nullptr : real.xRealloc(memory, size);
}

void use(sqlite3_mem_methods& methods) {
  sqlite3_shutdown();
  RIMLIGHT_CHECK_EQ(sqlite3_config(SQLITE_CONFIG_MALLOC, &methods), SQLITE_OK);
  RIMLIGHT_CHECK_EQ(sqlite3_initialize(), SQLITE_OK);
}

}  // namespace

SqliteMemory::SqliteMemory() {
  sqlite3_shutdown();
  RIMLIGHT_CHECK_EQ(sqlite3_config(SQLITE_CONFIG_GETMALLOC, &real), SQLITE_OK);
  sqlite3_mem_methods failing = real;
  failing.xMalloc = allocate;
  failing.xRealloc = grow;
  use(failing);
}
SqliteMemory::~SqliteMemory() { use(real); }

}  // namespace rimlight::server::test
