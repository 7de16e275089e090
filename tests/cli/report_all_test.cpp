// `rimlight report all` from outside, on a scene as small as scenes are.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>
#include <nlohmann/json.hpp>

#include "cli/time_shares.h"
#include "core/base/files.h"
#include "tests/support/program.h"
#include "tests/support/temporary_folder.h"

namespace rimlight {
namespace {

using nlohmann::json;
using test::run_program;
using test::TemporaryFolder;
using ::testing::HasSubstr;
using ::testing::Not;

/// Built with a sanitizer nothing is done in the time that it would take else.
#if defined(RIMLIGHT_THREAD_SANITIZER) || defined(__SANITIZE_ADDRESS__)
constexpr bool kIsInTime = false;
#elif defined(__has_feature)
#if __has_feature(address_sanitizer)
constexpr bool kIsInTime = false;
#else
constexpr bool kIsInTime = true;
#endif
#else
constexpr bool kIsInTime = true;
#endif

constexpr std::size_t kMostBytes = std::size_t{1} << 26;

TEST(TimeShares, EachGetsItsPartOfWhatIsLeft) {
  const auto now = TimeShares::Clock::now();
  TimeShares shares(std::chrono::seconds(100));
  for (const double weight : {1.0, 3.0, 4.0}) shares.expect(weight);
  shares.begin(now);
  const auto nothing = [](const std::string&, double) {};
  (void)shares.next(1, nothing, now);
  EXPECT_NEAR(shares.share_seconds(), 100.0 / 8, 1e-6);
  (void)shares.next(3, nothing, now + std::chrono::seconds(30));
  EXPECT_NEAR(shares.share_seconds(), 70.0 * 3 / 7, 1e-6);
  (void)shares.next(4, nothing, now + std::chrono::seconds(60));
  EXPECT_NEAR(shares.share_seconds(), 40, 1e-6);
}

TEST(TimeShares, WhatIsToldGoesOnUntilItsTimeIsUp) {
  TimeShares shares(std::chrono::hours(1));
  shares.expect(1);
  shares.begin();
  std::string told;
  const auto progress = shares.next(1, [&](const std::string& stage, double) { told = stage; });
  progress("tracing", 0.5);
  EXPECT_EQ(told, "tracing");
  TimeShares over(std::chrono::hours(1));
  over.expect(1);
  over.begin(TimeShares::Clock::now() - std::chrono::hours(2));
  const auto late = over.next(1, [](const std::string&, double) { FAIL(); });
  EXPECT_EQ(over.share_seconds(), 0);
  EXPECT_THROW(late("tracing", 1), OutOfTime);
}

TEST(ReportAll, WritesOnePageOfAllThatItMeasured) {
  const TemporaryFolder folder;
  std::ofstream(folder / "ball.json") << R"({
    "name": "A <ball>", "camera": { "position": [0, 1, 4], "target": [0, 0.5, 0] },
    "materials": { "white": { "model": "lambert", "albedo": 0.7 } },
    "objects": [ { "shape": "sphere", "radius": 0.6, "translate": [0, 0.6, 0], "material": "white" },
                 { "shape": "plane", "size": [6, 6], "material": "white" } ],
    "environments": ["studio"],
    "bake": { "width": 32, "height": 32, "cube_size": 8, "bounces": 1 } })";
  const auto result =
      run_program({"report", "all", (folder / "ball.json").string(), "-o",
                   (folder / "report").string(), "--minutes", "2", "--light", "studio"});
  ASSERT_EQ(result.status, 0) << result.errors;
  const auto written = folder / "report" / "ball";
  for (const char* const name :
       {"bake", "codecs", "serving", "equal-time", "error-vs-time", "storage"}) {
    const auto file = written / (std::string(name) + ".json");
    if (!kIsInTime && !std::filesystem::exists(file)) continue;
    const json report = json::parse(read_file(file, kMostBytes));
    EXPECT_EQ(report.at("experiment"), name);
    EXPECT_FALSE(report.at("rows").empty()) << name;
  }
  const std::string page = read_file(folder / "report" / "index.html", kMostBytes);
  EXPECT_THAT(page, HasSubstr("Bake: A &lt;ball&gt;"));
  EXPECT_THAT(page, HasSubstr("report all"));
  if (kIsInTime) {
    EXPECT_THAT(page, HasSubstr("benefit@8ms"));
    EXPECT_THAT(page, HasSubstr("Spherical harmonics of vertices: policies"));
  }
  EXPECT_THAT(page, Not(HasSubstr("Failed:")));
}

TEST(ReportAll, WhatItCannotReadEndsItBeforeAnythingIsMeasured) {
  const TemporaryFolder folder;
  const auto result = run_program(
      {"report", "all", (folder / "none.bake").string(), "-o", (folder / "report").string()});
  EXPECT_EQ(result.status, 1);
  EXPECT_THAT(result.errors, HasSubstr("none.bake"));
  EXPECT_FALSE(std::filesystem::exists(folder / "report" / "index.html"));
}

}  // namespace
}  // namespace rimlight
