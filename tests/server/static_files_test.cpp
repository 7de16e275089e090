#include "server/network/static_files.h"

#include <gtest/gtest.h>

#include <fstream>

#include "tests/support/error_of.h"
#include "tests/support/temporary_folder.h"

namespace rimlight::server {
namespace {

using rimlight::test::error_of;
using rimlight::test::TemporaryFolder;

void write(const std::filesystem::path& path, const std::string& text) {
  std::filesystem::create_directories(path.parent_path());
  std::ofstream(path) << text;
}

TEST(StaticFiles, OnlyFilesOfKnownKindsInsideTheFolderAreServed) {
  const TemporaryFolder outer;
  write(outer / "secret.html", "secret");
  const std::filesystem::path folder = outer / "web";
  write(folder / "index.html", "<p>page");
  write(folder / "js" / "main.js", "1");
  write(folder / ".hidden.html", "hidden");
  write(folder / ".git" / "config.json", "hidden");
  write(folder / "key.pem", "unknown kind");
  std::filesystem::create_symlink(outer / "secret.html", folder / "link.html");
  const StaticFiles files(folder);
  EXPECT_EQ(files.size(), 2u);
  ASSERT_NE(files.find("/"), nullptr);
  EXPECT_EQ(files.find("/"), files.find("/index.html"));
  EXPECT_EQ(files.find("/")->bytes, "<p>page");
  ASSERT_NE(files.find("/js/main.js"), nullptr);
  EXPECT_EQ(files.find("/js/main.js")->content_type, "text/javascript; charset=utf-8");
  for (const char* const path :
       {"", "index.html", "/../secret.html", "/js/../../secret.html", "/%2e%2e/secret.html",
        "/..\\secret.html", "//index.html", "/./index.html", "/js", "/js/", "/link.html",
        "/key.pem", "/.hidden.html", "/.git/config.json", "/index.html/", "/INDEX.HTML"}) {
    EXPECT_EQ(files.find(path), nullptr) << path;
  }
  EXPECT_EQ(files.find(std::string_view("/index.html\0x", 13)), nullptr);
}

TEST(StaticFiles, OtherBytesHaveAnotherEtag) {
  const TemporaryFolder folder;
  write(folder / "index.html", "one");
  const std::string before = StaticFiles(folder.path()).find("/")->etag;
  EXPECT_EQ(StaticFiles(folder.path()).find("/")->etag, before);
  write(folder / "index.html", "two");
  EXPECT_NE(StaticFiles(folder.path()).find("/")->etag, before);
}

TEST(StaticFiles, AFolderWithoutAPageIsAnErrorThatNamesIt) {
  const TemporaryFolder folder;
  const auto open = [](const std::filesystem::path& path) {
    return error_of([&] { StaticFiles files(path); });
  };
  EXPECT_NE(open(folder.path()).find("no index.html"), std::string::npos);
  EXPECT_NE(open(folder / "none").find("none"), std::string::npos);
}

}  // namespace
}  // namespace rimlight::server
