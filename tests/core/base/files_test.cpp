#include "core/base/files.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/resource.h>

#include <csignal>
#include <cstring>
#include <filesystem>
#include <thread>

#include "tests/support/error_of.h"
#include "tests/support/temporary_folder.h"

namespace rimlight {
namespace {

using test::error_of;
using test::TemporaryFolder;
using ::testing::AllOf;
using ::testing::HasSubstr;

std::string text_of(const MappedFile& file) {
  return {reinterpret_cast<const char*>(file.bytes().data()), file.bytes().size()};
}

std::ptrdiff_t entries(const TemporaryFolder& folder) {
  return std::distance(std::filesystem::directory_iterator(folder.path()), {});
}

TEST(Files, WhatIsWrittenIsRead) {
  const TemporaryFolder folder;
  for (const std::string& text :
       {std::string(), std::string("a\0b\n", 4), std::string(300'000, 'x')}) {
    write_file_atomically(folder / "a", text);
    EXPECT_EQ(read_file(folder / "a", SIZE_MAX), text);
    EXPECT_EQ(text_of(MappedFile(folder / "a")), text);
  }
  EXPECT_EQ(entries(folder), 1);
}

TEST(Files, MoreThanTheMostIsRefused) {
  const TemporaryFolder folder;
  write_file_atomically(folder / "a", "12345");
  EXPECT_EQ(read_file(folder / "a", 5), "12345");
  EXPECT_EQ(text_of(MappedFile(folder / "a", 5)), "12345");
  for (const std::string& error : {error_of([&] { read_file(folder / "a", 4); }),
                                   error_of([&] { MappedFile(folder / "a", 4); })}) {
    EXPECT_THAT(error, AllOf(HasSubstr("a: found 5 bytes"), HasSubstr("at most 4 bytes")));
  }
}

TEST(Files, MissingFilesFoldersAndDevicesAreErrorsThatNameThem) {
  const TemporaryFolder folder;
  EXPECT_THAT(error_of([&] { read_file(folder / "none", 9); }), HasSubstr("none: found No such"));
  EXPECT_THAT(error_of([&] { MappedFile(folder / "none"); }), HasSubstr("none: found No such"));
  EXPECT_THAT(error_of([&] { read_file(folder.path(), 9); }), HasSubstr("regular file"));
  EXPECT_THAT(error_of([&] { MappedFile(folder.path()); }), HasSubstr("regular file"));
  EXPECT_THAT(error_of([&] { MappedFile("/dev/zero"); }), HasSubstr("regular file"));
}

TEST(Files, AFailedWriteKeepsTheOldFileAndLeavesNothingBeside) {
  const TemporaryFolder folder;
  EXPECT_THAT(error_of([&] { write_file_atomically(folder / "none" / "a", "text"); }),
              HasSubstr("No such file"));
  std::filesystem::create_directory(folder / "taken");
  EXPECT_THAT(error_of([&] { write_file_atomically(folder / "taken", "text"); }),
              HasSubstr("taken"));
  EXPECT_EQ(entries(folder), 1);
}

TEST(Files, AFullDiskKeepsTheOldFileAndLeavesNothingBeside) {
  const TemporaryFolder folder;
  write_file_atomically(folder / "a", "old");
  // The stand-in for a full disk: this process may write no file beyond 4,096 bytes.
  std::signal(SIGXFSZ, SIG_IGN);
  rlimit before{};
  ASSERT_EQ(::getrlimit(RLIMIT_FSIZE, &before), 0);
  const rlimit small{4096, before.rlim_max};
  ASSERT_EQ(::setrlimit(RLIMIT_FSIZE, &small), 0);
  const std::string error =
      error_of([&] { write_file_atomically(folder / "a", std::string(10'000, 'x')); });
  ASSERT_EQ(::setrlimit(RLIMIT_FSIZE, &before), 0);
  EXPECT_THAT(error, AllOf(HasSubstr("File too large"), HasSubstr("space to write to")));
  EXPECT_EQ(read_file(folder / "a", 99), "old");
  EXPECT_EQ(entries(folder), 1);
}

TEST(Files, AReaderSeesTheOldOrTheNewFileNeverHalf) {
  const TemporaryFolder folder;
  const std::string old_text(100'000, 'o');
  const std::string new_text(200'000, 'n');
  write_file_atomically(folder / "a", old_text);
  std::jthread writer([&] {
    for (int i = 0; i < 20; ++i) {
      write_file_atomically(folder / "a", i % 2 == 0 ? new_text : old_text);
    }
  });
  for (int i = 0; i < 300; ++i) {
    const std::string text = read_file(folder / "a", SIZE_MAX);
    ASSERT_TRUE(text == old_text || text == new_text) << text.size();
  }
}

TEST(MappedFile, MovesTakeTheMapAlong) {
  const TemporaryFolder folder;
  write_file_atomically(folder / "a", "first");
  write_file_atomically(folder / "b", "second");
  MappedFile a(folder / "a");
  MappedFile taken(std::move(a));
  EXPECT_EQ(text_of(taken), "first");
  EXPECT_TRUE(
      a.bytes().empty());  // NOLINT(bugprone-use-after-move): what a move leaves is promised
  MappedFile b(folder / "b");
  b = std::move(taken);
  EXPECT_EQ(text_of(b), "first");
}

TEST(MappedFile, ARenameOverItLeavesTheOldBytes) {
  const TemporaryFolder folder;
  write_file_atomically(folder / "a", "first");
  const MappedFile file(folder / "a");
  write_file_atomically(folder / "a", "second, longer");
  EXPECT_EQ(text_of(file), "first");
}

TEST(Files, FlushingWhatIsMissingIsAnError) {
  const TemporaryFolder folder;
  EXPECT_NO_THROW(flush_to_disk(folder.path()));
  EXPECT_THAT(error_of([&] { flush_to_disk(folder / "none"); }), HasSubstr("none"));
}

}  // namespace
}  // namespace rimlight
