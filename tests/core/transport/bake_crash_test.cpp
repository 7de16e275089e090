#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "core/base/error.h"
#include "core/base/files.h"
#include "core/transport/bake_folder.h"
#include "core/transport/part_file.h"
#include "tests/support/small_bake.h"
#include "tests/support/temporary_folder.h"

namespace rimlight {
namespace {

namespace fs = std::filesystem;
using test::TemporaryFolder;

/// Runs `work` in a process of its own, which ends by SIGKILL: at the latest `microseconds` after
/// it began, or when the work is done.
void run_and_kill(const std::function<void()>& work, int microseconds) {
  const pid_t child = ::fork();
  if (child == 0) {
    try {
      work();
    } catch (...) {
      ::_exit(3);
    }
    ::kill(::getpid(), SIGKILL);
  }
  ASSERT_GT(child, 0);
  int status = 0;
  const auto end = std::chrono::steady_clock::now() + std::chrono::microseconds(microseconds);
  while (::waitpid(child, &status, WNOHANG) == 0) {
    if (std::chrono::steady_clock::now() >= end) ::kill(child, SIGKILL);
    ::usleep(50);
  }
  ASSERT_TRUE(WIFSIGNALED(status)) << "ended by itself: " << status;
  ASSERT_EQ(WTERMSIG(status), SIGKILL);
}

TEST(BakeCrash, AWriterKilledBeforeCommitLeavesNoBakeAndItsPartsStay) {
  const TemporaryFolder folder;
  const fs::path path = folder / "a.bake";
  const auto work = [&] {
    BakeWriter writer(path);
    test::fill(writer, {});
    save_part(writer.partial_folder() / "tile-0.part", test::small_tiles({}).front(), 9);
    ::kill(::getpid(), SIGKILL);
  };
  ASSERT_NO_FATAL_FAILURE(run_and_kill(work, 20'000'000));
  EXPECT_FALSE(fs::exists(path));
  EXPECT_THROW(Bake{path}, Error);
  BakeWriter writer(path);  // the dead writer's lock is gone
  EXPECT_TRUE(load_part(writer.partial_folder() / "tile-0.part", 96, 9).has_value());
  test::fill(writer, {});
  writer.commit(test::small_manifest({}));
  Bake(path).verify();
  EXPECT_FALSE(fs::exists(path / "tile-0.part"));
  EXPECT_FALSE(fs::exists(writer.partial_folder()));
}

TEST(BakeCrash, ADestroyedWriterLeavesTheOlderBakeAsItWas) {
  const TemporaryFolder folder;
  const fs::path path = folder / "a.bake";
  test::write_small_bake(path, {.scene = "old"});
  {
    BakeWriter writer(path);
    test::fill(writer, {.seed = 2});
  }
  EXPECT_EQ(Bake(path).manifest().scene, "old");
}

TEST(BakeCrash, CommitReplacesAnOlderBakeAsAWhole) {
  const TemporaryFolder folder;
  const fs::path path = folder / "a.bake";
  test::write_small_bake(path, {.cube_size = 8, .scene = "old"});
  write_file_atomically(path / "left_over", "x");
  test::write_small_bake(path, {.seed = 2, .scene = "new"});
  const Bake bake(path);
  bake.verify();
  EXPECT_EQ(bake.manifest().scene, "new");
  EXPECT_EQ(bake.manifest().cube_size, 4);
  EXPECT_FALSE(fs::exists(path / "left_over"));
  EXPECT_EQ(std::distance(fs::directory_iterator(folder.path()), fs::directory_iterator()), 1);
}

/// Killed at any moment, before, in and after commit: the name holds the older bake or the newer
/// one, whole, and a later writer goes on.
TEST(BakeCrash, KilledAtAnyMomentThereIsTheOldBakeOrTheNewOne) {
  const TemporaryFolder folder;
  const fs::path path = folder / "a.bake";
  const auto start = std::chrono::steady_clock::now();
  test::write_small_bake(path, {.seed = 1, .scene = "0"});
  const std::chrono::duration<double, std::micro> whole = std::chrono::steady_clock::now() - start;
  int replaced = 0;
  constexpr int kKills = 60;
  for (int i = 1; i <= kKills; ++i) {
    const std::string before = Bake(path).manifest().scene;
    const test::SmallBake next{.seed = static_cast<std::uint64_t>(1 + i % 3),
                               .scene = std::to_string(i)};
    // From at once to twice the time it takes; the last one may finish.
    const double delay = i == kKills ? 2e7 : 2 * whole.count() * (i - 1) / kKills;
    ASSERT_NO_FATAL_FAILURE(
        run_and_kill([&] { test::write_small_bake(path, next); }, static_cast<int>(delay)));
    const Bake bake(path);
    bake.verify();
    const std::string scene = bake.manifest().scene;
    EXPECT_THAT(scene, testing::AnyOf(before, next.scene));
    EXPECT_EQ(bake.manifest().settings["seed"], scene == "0" ? 1 : 1 + std::stoi(scene) % 3);
    replaced += scene == next.scene ? 1 : 0;
  }
  RecordProperty("replaced", replaced);
  EXPECT_GE(replaced, 1);
  EXPECT_LT(replaced, kKills);
  test::write_small_bake(path, {.scene = "last"});
  EXPECT_EQ(Bake(path).manifest().scene, "last");
}

/// A commit killed between its rename and the removal of the older bake leaves that one under the
/// partial name; a server may still show it.
TEST(BakeCrash, WhatAKilledCommitLeftIsUnlinkedAndNotOverwritten) {
  const TemporaryFolder folder;
  const fs::path path = folder / "a.bake", partial = folder / "a.bake.partial";
  test::write_small_bake(path, {});
  fs::rename(path, partial);
  const Bake shown(partial);
  const auto& arrays = shown.transport().arrays();
  const std::vector<std::uint64_t> before(arrays.runs.begin(), arrays.runs.end());
  test::write_small_bake(path, {.density = 0.01, .seed = 2});
  EXPECT_TRUE(std::ranges::equal(before, arrays.runs));
  EXPECT_FALSE(fs::exists(partial));
  EXPECT_LT(Bake(path).transport().byte_count(), shown.transport().byte_count());
}

/// The same, killed in the middle of that removal: the manifest is gone already.
TEST(BakeCrash, WhatAKilledRemovalLeftIsUnlinkedAndNotOverwritten) {
  const TemporaryFolder folder;
  const fs::path path = folder / "a.bake", partial = folder / "a.bake.partial";
  test::write_small_bake(path, {});
  fs::rename(path, partial);
  const MappedFile shown(partial / kTransportFile);
  const std::vector<std::byte> before(shown.bytes().begin(), shown.bytes().end());
  fs::remove(partial / kManifestFile);
  // Not of fewer bytes: those that a shorter file lacks cannot even be read.
  test::write_small_bake(path, {.density = 0.2, .seed = 2});
  EXPECT_TRUE(std::ranges::equal(before, shown.bytes()));
  EXPECT_NE(read_file(path / kTransportFile, SIZE_MAX).size(), before.size());
}

TEST(BakeWriter, TwoWritersOfOneBakeAreRefused) {
  const TemporaryFolder folder;
  const BakeWriter first(folder / "a.bake");
  EXPECT_THROW(BakeWriter(folder / "a.bake"), Error);
  EXPECT_NO_THROW(BakeWriter(folder / "b.bake"));
}

TEST(BakeWriter, ReplacesNothingThatIsNotABake) {
  const TemporaryFolder folder;
  fs::create_directories(folder / "photographs");
  write_file_atomically(folder / "photographs" / "one.png", "x");
  EXPECT_THROW(BakeWriter(folder / "photographs"), Error);
  EXPECT_THROW(BakeWriter(folder / "photographs" / "one.png"), Error);
  EXPECT_TRUE(fs::exists(folder / "photographs" / "one.png"));
  fs::create_directories(folder / "empty.bake");
  test::write_small_bake(fs::path((folder / "empty.bake").string() + "/"), {});
  EXPECT_EQ(Bake(folder / "empty.bake").manifest().scene, "small");
}

TEST(BakeWriter, SaysSoWhenTheDiskRefuses) {
  const TemporaryFolder folder;
  write_file_atomically(folder / "file", "x");
  EXPECT_THROW(BakeWriter(folder / "file" / "a.bake"), Error);
}

}  // namespace
}  // namespace rimlight
