// The folders' dependency order, read from the top CMakeLists.txt, holds for every #include.
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <optional>
#include <regex>
#include <string>
#include <vector>

namespace rimlight {
namespace {

namespace fs = std::filesystem;

/// core/base, core/math, …, server, cli: in the order of the add_subdirectory lines.
std::vector<std::string> folders_in_order() {
  std::ifstream file("CMakeLists.txt");
  const std::regex line_form(R"(^add_subdirectory\(((?:core/\w+|server|cli))\)\s*$)");
  std::vector<std::string> folders;
  for (std::string line; std::getline(file, line);) {
    std::smatch match;
    if (std::regex_match(line, match, line_form)) folders.push_back(match[1]);
  }
  return folders;
}

/// The position of the folder that a path from the root lies in.
std::optional<std::size_t> place_of(const std::string& path,
                                    const std::vector<std::string>& folders) {
  for (std::size_t i = 0; i < folders.size(); ++i) {
    if (path.starts_with(folders[i] + "/")) return i;
  }
  return std::nullopt;
}

/// What is wrong with an include line of a file, or nothing.
std::optional<std::string> complaint(const std::string& file, const std::string& line,
                                     const std::vector<std::string>& folders) {
  static const std::regex kIncludeForm(R"re(^\s*#\s*include\s+"([^"]+)".*$)re");
  std::smatch match;
  if (!std::regex_match(line, match, kIncludeForm)) return std::nullopt;
  const std::string included = match[1];
  const auto to = place_of(included, folders);
  if (!to) return file + " includes \"" + included + "\", which is no path from the root";
  if (*to > *place_of(file, folders)) return file + " includes upward: " + included;
  return std::nullopt;
}

std::vector<std::string> source_files(const std::vector<std::string>& folders) {
  std::vector<std::string> files;
  for (const std::string& folder : folders) {
    for (const auto& entry : fs::recursive_directory_iterator(folder)) {
      const std::string ending = entry.path().extension().string();
      if (ending == ".h" || ending == ".cpp") files.push_back(entry.path().generic_string());
    }
  }
  std::sort(files.begin(), files.end());
  return files;
}

TEST(IncludeDirection, EveryIncludeOfTheTreeRunsDownTheList) {
  const auto folders = folders_in_order();
  ASSERT_GE(folders.size(), 12u);
  int includes = 0;
  for (const std::string& file : source_files(folders)) {
    std::ifstream source(file);
    for (std::string line; std::getline(source, line);) {
      if (line.find("#include \"") != std::string::npos) ++includes;
      const auto wrong = complaint(file, line, folders);
      EXPECT_FALSE(wrong.has_value()) << wrong.value_or("");
    }
  }
  EXPECT_GT(includes, 200);
}

TEST(IncludeDirection, AnIncludeThatRunsUpwardIsFound) {
  const auto folders = folders_in_order();
  EXPECT_TRUE(complaint("core/math/vec.h", "#include \"core/light/cube_light.h\"", folders));
  EXPECT_TRUE(complaint("core/relight/policy.h", "  #  include \"server/x.h\"", folders));
  EXPECT_TRUE(complaint("server/x.cpp", "#include \"cli/command.h\"", folders));
  EXPECT_TRUE(complaint("core/math/vec.h", "#include \"rotation.h\"", folders));
  EXPECT_FALSE(complaint("core/light/environment.h", "#include \"core/math/vec.h\"", folders));
  EXPECT_FALSE(complaint("core/light/environment.h", "#include <vector>", folders));
}

/// CMake links one way too: a folder's target uses only targets of folders above it.
TEST(IncludeDirection, EveryLinkedTargetLiesAbove) {
  const auto folders = folders_in_order();
  int links = 0;
  for (std::size_t i = 0; i < folders.size(); ++i) {
    std::ifstream file(folders[i] + "/CMakeLists.txt");
    ASSERT_TRUE(file.is_open()) << folders[i];
    const std::string text((std::istreambuf_iterator<char>(file)), {});
    const std::regex uses_form(R"(\b(core_\w+)\b)");
    for (std::sregex_iterator at(text.begin(), text.end(), uses_form), end; at != end; ++at) {
      const std::string name = std::regex_replace(at->str(), std::regex("^core_"), "core/");
      const auto found = std::find(folders.begin(), folders.end(), name);
      if (found == folders.end()) continue;
      ++links;
      EXPECT_LE(static_cast<std::size_t>(found - folders.begin()), i)
          << folders[i] << " links " << at->str();
    }
  }
  EXPECT_GT(links, 20);
}

}  // namespace
}  // namespace rimlight
