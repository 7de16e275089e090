// What clients and sessions that are gone leave in memory: nothing that grows.
#include <gtest/gtest.h>
#include <sqlite3.h>

#include <algorithm>
#include <cstdio>
#include <thread>

#include "server/session/session_users.h"
#include "tests/server/loopback_server.h"
#include "tests/support/allocation_count.h"
#include "tests/support/temporary_folder.h"

namespace rimlight::server {
namespace {

using std::chrono::milliseconds;
using test::LoopbackServer;

/// Of SQLite's cache, which fills up with pages of the store (PRAGMA cache_size: 2 MiB), and a
/// little beside it.
constexpr sqlite3_int64 kMostOfSqlite = 4 << 20;

double bytes_in_use() { return static_cast<double>(rimlight::test::live_bytes()); }

/// Each edits, and is gone without a goodbye.
void vanish(const LoopbackServer& server, std::size_t count) {
  for (std::size_t i = 0; i < count; ++i) {
    const auto client = server.open(i % 2 == 0 ? "one" : "two");
    (void)client->send_text(R"({"type":"edit","id":"1","exposure":)" + std::to_string(i % 7) + "}");
    (void)client->receive(Clock::now() + std::chrono::seconds(5));
  }
}

/// What is in use when all that is under way has ended: the least of some looks.
double settled_bytes() {
  double least = bytes_in_use();
  for (int i = 0; i < 30; ++i) {
    std::this_thread::sleep_for(milliseconds(20));
    least = std::min(least, bytes_in_use());
  }
  return least;
}

TEST(Memory, IsFlatOverClientsThatConnectEditAndVanish) {
  if (!rimlight::test::kCountsAllocations) GTEST_SKIP() << "ThreadSanitizer's own operator new";
  const rimlight::test::TemporaryFolder folder;
  LoopbackServer::Settings settings;
  settings.store = folder / "sessions.sqlite";
  const LoopbackServer server(settings);
  // Until all that is bounded is full: the users that sessions know.
  vanish(server, 2 * SessionUsers::kMostKnown + 40);
  const double before = settled_bytes();
  constexpr std::size_t kMore = 1000;
  vanish(server, kMore);
  const double grown = settled_bytes() - before;
  std::printf("%.0f bytes in use, %+.0f after %zu clients\n", before, grown, kMore);
  RecordProperty("grown", static_cast<int>(grown));
  // Names and numbers may have a digit more; a record that stays has some hundred bytes.
  EXPECT_LT(grown / kMore, 20);
  EXPECT_LT(sqlite3_memory_used(), kMostOfSqlite);
}

}  // namespace
}  // namespace rimlight::server
