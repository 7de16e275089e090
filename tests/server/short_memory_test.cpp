// Every allocation fails in turn, of this program's and of SQLite's, while a session is stored and
// loaded: the old state or the new one is there afterwards, as its edit was answered, nothing waits
// for ever, and where there is memory again all goes on.
#include <gtest/gtest.h>
#include <spdlog/spdlog.h>

#include <array>
#include <atomic>
#include <cstdio>
#include <cstdlib>
#include <memory>
#include <new>
#include <vector>

#include "server/store/sqlite_store.h"
#include "tests/server/faulty_disk.h"
#include "tests/server/sqlite_memory.h"
#include "tests/server/stored_edits.h"
#include "tests/support/allocation_count.h"
#include "tests/support/temporary_folder.h"

namespace rimlight::server {
namespace {

namespace fs = std::filesystem;

using rimlight::test::FailingAllocation;
using std::chrono::milliseconds;
using std::chrono::seconds;
using test::numbered_edit;
using Lasting = FailingAllocation::Lasting;

constexpr int kEdits = 4;
/// After this an answer is not waited for any more where memory stays short.
constexpr milliseconds kNoAnswer{10};

/// Of what takes many allocations every so many fail, unless all are asked for.
std::int64_t stride() { return std::getenv("RIMLIGHT_EVERY_FAULT") == nullptr ? 13 : 1; }

/// Whether it was done; what is refused, and no memory, are not.
template <typename Action>
bool succeeds(const Action& action) {
  try {
    action();
    return true;
  } catch (const Error&) {
    return false;
  } catch (const std::bad_alloc&) {
    return false;
  }
}

class ShortMemory : public testing::TestWithParam<Lasting> {
 protected:
  // The program has its log before it has a store.
  ShortMemory() { (void)spdlog::default_logger_raw(); }

  void remove_store() const {
    for (const char* const ending : {"", "-wal", "-journal"}) {
      fs::remove(settings.file.string() + ending);
    }
  }
  /// The edit of that number, with a state that takes several pages, and what belongs to it.
  static StoredEdit large_edit(int number) {
    StoredEdit edit = numbered_edit(number);
    edit.state.insert(edit.state.size() - 1, std::string(10000, ' '));
    edit.rows = test::numbered_rows(number);
    return edit;
  }
  static void expect_revision(int number, const std::optional<StoredSession>& session) {
    ASSERT_EQ(session ? session->revision.number : 0, number);
    if (!session) return;
    EXPECT_EQ(session->state, large_edit(number).state);
    test::expect_rows_of(number, *session);
  }

  test::FaultyDisk disk;  // of which nothing fails, but which does not wait for flushes
  const test::SqliteMemory memory;
  rimlight::test::TemporaryFolder folder;
  SqliteStoreSettings settings{
      .file = folder / "sessions.sqlite", .kept_edits = 10, .vfs = test::FaultyDisk::name()};
};

enum class End { none, kept, refused };

/// Stores edits until one is not kept, and loads.
struct Attempt {
  std::array<std::atomic<End>, kEdits> ends{};
  int asked = 0;
  bool drained = true;
  std::optional<StoredSession> loaded;
  bool has_loaded = false;

  void store(SqliteStore& store, std::vector<StoredEdit>& edits, Lasting lasting) {
    for (std::size_t i = 0; i < edits.size() && drained; ++i) {
      std::atomic<End>* const end = &ends[i];
      ++asked;
      if (!succeeds([&] {
            store.append(std::move(edits[i]),
                         [end](const auto& refusal) { *end = refusal ? End::refused : End::kept; });
          })) {
        *end = End::refused;
      }
      drained = store.drain(lasting == Lasting::once ? milliseconds(seconds(10)) : kNoAnswer);
      if (*end != End::kept) break;
    }
    has_loaded = succeeds([&] { loaded = store.load("terrace", "a"); });
  }
  int kept() const {
    int count = 0;
    while (count < kEdits && ends[static_cast<std::size_t>(count)] == End::kept) ++count;
    return count;
  }
};

TEST_P(ShortMemory, WhileEditsAreStoredLeavesWhatWasAnswered) {
  std::int64_t n = 0, refused = 0;
  for (bool reached_end = false; !reached_end; ++n) {
    SCOPED_TRACE("allocation " + std::to_string(n));
    remove_store();
    std::vector<StoredEdit> edits;
    for (int i = 1; i <= kEdits; ++i) edits.push_back(large_edit(i));
    Attempt attempt;
    auto store = std::make_unique<SqliteStore>(settings);
    {
      const FailingAllocation failing(n, GetParam());
      attempt.store(*store, edits, GetParam());
      reached_end = FailingAllocation::allocations() <= n;
    }
    const int kept = attempt.kept();
    if (GetParam() == Lasting::once) {
      ASSERT_TRUE(attempt.drained) << "an edit waits for ever";
    }
    refused += kept < kEdits ? 1 : 0;
    // Where there is memory again all is answered, and the next edit is kept.
    ASSERT_TRUE(store->drain(seconds(10)));
    const int known = attempt.kept();
    ASSERT_GE(known, kept);
    if (attempt.has_loaded && attempt.drained) expect_revision(kept, attempt.loaded);
    expect_revision(known, store->load("terrace", "a"));
    ASSERT_EQ(test::store_one(*store, large_edit(known + 1)), "");
    store.reset();
    expect_revision(known + 1, SqliteStore(settings).load("terrace", "a"));
    ASSERT_FALSE(HasFailure());
  }
  std::printf("%d allocations failed, %d refused an edit\n", static_cast<int>(n - 1),
              static_cast<int>(refused));
  EXPECT_GT(refused, 10);
}

TEST_P(ShortMemory, WhileAStoreIsOpenedIsToldAndLeavesItWhole) {
  int refused = 0;
  // Until both have fewer: odd numbers are of the one, even ones of the other.
  for (std::int64_t n = 0, ends = 0; ends < 2; n += stride()) {
    SCOPED_TRACE("allocation " + std::to_string(n));
    const int before = n % 2 == 0 ? 0 : 3;  // a new store, or one with a session
    remove_store();
    if (before > 0) {
      SqliteStore made(settings);
      for (int i = 1; i <= before; ++i) ASSERT_EQ(test::store_one(made, large_edit(i)), "");
    }
    {
      const FailingAllocation failing(n, GetParam());
      std::unique_ptr<SqliteStore> store;
      std::optional<StoredSession> loaded;
      const bool opened = succeeds([&] {
        store = std::make_unique<SqliteStore>(settings);
        loaded = store->load("terrace", "a");
      });
      store.reset();
      const bool reached_end = FailingAllocation::allocations() <= n;
      ends = reached_end ? ends + 1 : 0;
      refused += opened ? 0 : 1;
      if (!opened && reached_end) ADD_FAILURE() << "refused for nothing";
    }
    SqliteStore store(settings);
    expect_revision(before, store.load("terrace", "a"));
    ASSERT_EQ(test::store_one(store, large_edit(before + 1)), "");
    ASSERT_FALSE(HasFailure());
  }
  std::printf("%d of the failed allocations were told\n", refused);
  EXPECT_GT(refused, 20);
}

const auto kLastings = testing::Values(Lasting::once, Lasting::from_then_on);
const auto kName = [](const auto& tested) {
  return std::string(tested.param == Lasting::once ? "Once" : "FromThenOn");
};
INSTANTIATE_TEST_SUITE_P(Allocations, ShortMemory, kLastings, kName);

}  // namespace
}  // namespace rimlight::server
