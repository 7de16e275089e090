// Every operation on the disk fails in turn: the old state or the new one is there afterwards, as
// its edit was answered, and never anything else.
#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <atomic>
#include <cstdio>
#include <future>
#include <memory>
#include <optional>

#include "server/store/sqlite_store.h"
#include "tests/server/faulty_disk.h"
#include "tests/server/stored_edits.h"
#include "tests/support/error_of.h"
#include "tests/support/temporary_folder.h"

namespace rimlight::server {
namespace {

using rimlight::test::error_of;
using std::chrono::milliseconds;
using std::chrono::seconds;
using test::FaultyDisk;
using test::numbered_edit;
using test::store_one;
using Lasting = FaultyDisk::Lasting;

/// Edits that a run stores, one by one: enough for logs to be compacted and moved into the file.
constexpr int kEdits = 70;
/// After this a disk that has failed for good is not waited for any more.
constexpr milliseconds kNoAnswer{10};

class StoreFaults : public testing::TestWithParam<Lasting> {
 protected:
  /// The edit of that number, with a state that takes several pages.
  static StoredEdit large_edit(int number) {
    StoredEdit edit = numbered_edit(number);
    edit.state.insert(edit.state.size() - 1, std::string(10000, ' '));
    edit.rows = test::numbered_rows(number);
    return edit;
  }
  /// What a server that starts now finds: the revision, 0 when there is none.
  int found_by_restart() {
    SqliteStoreSettings plain = settings;
    plain.vfs.clear();
    SqliteStore store(plain);
    const auto session = store.load("terrace", "a");
    if (!session) return 0;
    const auto number = static_cast<int>(session->revision.number);
    EXPECT_EQ(session->state, large_edit(number).state);
    test::expect_rows_of(number, *session);
    return number;
  }
  enum class End { all_stored, refused, unknown };
  struct Answers {
    int acknowledged = 0;
    End end = End::all_stored;  // of the edit after those
  };
  /// Stores edits one by one, until one is not.
  Answers store_until_fault() {
    SqliteStore store(settings);
    Answers answers;
    for (; answers.acknowledged < kEdits; ++answers.acknowledged) {
      const auto end = std::make_shared<std::atomic<End>>(End::unknown);
      store.append(large_edit(answers.acknowledged + 1),
                   [end](const auto& refusal) { *end = refusal ? End::refused : End::all_stored; });
      // Where the disk does not come back there may be no answer at all.
      (void)store.drain(GetParam() == Lasting::once ? seconds(10) : kNoAnswer);
      answers.end = *end;
      if (answers.end != End::all_stored) break;
    }
    return answers;
  }
  void start_afresh() {
    for (const char* const ending : {"", "-wal", "-journal"}) {
      std::filesystem::remove(settings.file.string() + ending);
    }
  }

  rimlight::test::TemporaryFolder folder;
  FaultyDisk disk;
  SqliteStoreSettings settings{
      .file = folder / "sessions.sqlite", .kept_edits = 10, .vfs = FaultyDisk::name()};
};

TEST_P(StoreFaults, LeaveTheStateThatWasAnsweredAtEveryWriteFlushAndOpening) {
  int faults_seen = 0;
  bool reached_end = false;
  // Each of the first hundred operations, then every 37th, until the run has fewer.
  for (std::int64_t n = 0; !reached_end; n += n < 100 ? 1 : 37) {
    start_afresh();
    disk.fail(n, GetParam());
    Answers answers;
    const std::string at_start = error_of([&] { answers = store_until_fault(); });
    reached_end = disk.operations() <= n;
    faults_seen += at_start != "no error" || answers.end == End::refused ? 1 : 0;
    ASSERT_TRUE(answers.end != End::unknown || GetParam() != Lasting::once ||
                at_start != "no error")
        << "operation " << n;
    disk.mend();
    const int found = found_by_restart();
    ASSERT_GE(found, answers.acknowledged) << "operation " << n;
    ASSERT_LE(found, answers.acknowledged + (answers.end == End::unknown ? 1 : 0))
        << "operation " << n;
  }
  std::printf("%d faults were seen as refusals\n", faults_seen);
  EXPECT_GT(faults_seen, 20);
}

INSTANTIATE_TEST_SUITE_P(Faults, StoreFaults,
                         testing::Values(Lasting::once, Lasting::from_then_on));

/// Stores edits until it is killed, and writes a byte to `pipe` for each that is acknowledged.
[[noreturn]] void store_until_killed(const SqliteStoreSettings& settings,
                                     StoredEdit (*edit_of)(int), int pipe) {
  SqliteStore store(settings);
  for (int i = 1; i <= kEdits; ++i) {
    store.append(edit_of(i), [pipe](const auto& refusal) {
      if (!refusal && ::write(pipe, "a", 1) != 1) ::_exit(1);
    });
    if (i % 3 == 0 && !store.drain(seconds(10))) ::_exit(1);
  }
  ::_exit(store.drain(seconds(10)) ? 0 : 1);  // the end was reached
}

TEST_F(StoreFaults, AServerThatIsKilledAtAnyOperationHasAllThatItAcknowledged) {
  int kills = 0, last_acknowledged = 0;
  for (std::int64_t n = 0;; n += n < 100 ? 1 : 37) {
    start_afresh();
    int ends[2];
    ASSERT_EQ(::pipe(ends), 0);
    disk.kill(n);
    const pid_t child = ::fork();
    ASSERT_GE(child, 0);
    if (child == 0) store_until_killed(settings, large_edit, ends[1]);
    ::close(ends[1]);
    int status = 0;
    ASSERT_EQ(::waitpid(child, &status, 0), child);
    disk.mend();
    int acknowledged = 0;
    for (char byte = 0; ::read(ends[0], &byte, 1) == 1;) ++acknowledged;
    ::close(ends[0]);
    const int found = found_by_restart();
    ASSERT_GE(found, acknowledged) << "operation " << n;
    ASSERT_LE(found, acknowledged + 3) << "operation " << n;
    last_acknowledged = acknowledged;
    if (WIFEXITED(status)) {
      ASSERT_EQ(WEXITSTATUS(status), 0);
      break;
    }
    ASSERT_EQ(WTERMSIG(status), SIGKILL);
    ++kills;
  }
  std::printf("killed at %d operations\n", kills);
  EXPECT_GT(kills, 100);
  EXPECT_EQ(last_acknowledged, kEdits);
}

TEST_F(StoreFaults, AnEditWhoseFlushFailedHasNoAnswerUntilItCannotComeBack) {
  std::promise<std::string> answered;
  std::future<std::string> answer = answered.get_future();
  SqliteStore store(settings);
  ASSERT_EQ(store_one(store, large_edit(1)), "");
  disk.fail_flushes();
  store.append(large_edit(2),
               [&](const auto& refusal) { answered.set_value(refusal ? refusal->what() : ""); });
  EXPECT_EQ(answer.wait_for(milliseconds(200)), std::future_status::timeout);
  EXPECT_NE(store_one(store, large_edit(2)), "");  // at once
  disk.mend();
  ASSERT_EQ(answer.wait_for(seconds(10)), std::future_status::ready);
  EXPECT_NE(answer.get(), "");
  // What a restart would find: a copy of what the disk has, as after a crash.
  for (const char* const ending : {"", "-wal"}) {
    std::filesystem::copy_file(settings.file.string() + ending,
                               (folder / "crashed.sqlite").string() + ending);
  }
  ASSERT_TRUE(store.drain(seconds(10)));
  settings.file = folder / "crashed.sqlite";
  EXPECT_EQ(found_by_restart(), 1);
  EXPECT_EQ(store_one(store, large_edit(2)), "");
}

}  // namespace
}  // namespace rimlight::server
