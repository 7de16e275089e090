// `rimlight bake` killed at every kind of moment: named operations on the disk, with and without a
// loss of power, and any time. There is never a bake that is neither the older nor the new one, and
// the next `rimlight bake` ends in the bytes of one that was never killed.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <map>
#include <random>
#include <set>
#include <thread>

#include "core/base/error.h"
#include "core/base/files.h"
#include "core/image/image_file.h"
#include "core/transport/bake_files.h"
#include "tests/support/killed_program.h"
#include "tests/support/temporary_folder.h"

namespace rimlight {
namespace {

namespace fs = std::filesystem;

using test::DiskOperation;
using test::KillPoint;
using test::WatchedProgram;
using Phase = KillPoint::Phase;

constexpr std::size_t kMostBytes = std::size_t{1} << 26;
constexpr int kKilled = 128 + 9;

/// Of kind, with a part of all points.
struct Case {
  const char* kind;
  const char* bake;
  double share;
};

/// Four tiles, of which three are mostly empty; some hundred vertices; one tile and three curves.
constexpr Case kCases[] = {
    {"image_haar", R"("width": 72, "height": 66, "cube_size": 4, "bounces": 0, "psnr_db": 30,
                      "primary_rays": 1)",
     0.4},
    {"vertex_sh", R"("kind": "vertex_sh", "degree": 2, "error": 0.1, "longest_edge": 0)", 0.4},
    {"brdf_curve", R"("kind": "brdf_curve", "width": 16, "height": 16, "cube_size": 8,
                      "bounces": 0, "psnr_db": 30, "primary_rays": 1)",
     0.2}};

std::string scene_text(const std::string& bake, double albedo) {
  return R"({ "name": "box",
    "camera": { "position": [0, 1.5, 4], "target": [0, 0.5, 0], "field_of_view": 35 },
    "materials": { "clay": { "model": "lambert", "albedo": )" +
         std::to_string(albedo) + R"( },
                   "gold": { "model": "cook_torrance", "roughness": 0.3,
                             "eta": [0.2, 0.5, 1.3], "k": [3.3, 2.3, 1.9] } },
    "objects": [ { "shape": "box", "size": [1.5, 0.8, 0.5], "translate": [0, 0.6, 0],
                   "material": "clay" },
                 { "shape": "box", "size": [0.5, 0.8, 0.5], "translate": [0.7, 1.4, 0],
                   "material": "gold" } ],
    "environments": [{ "file": "grey.exr", "name": "grey" }], "bake": { )" +
         bake + " } }";
}

using Bytes = std::map<std::string, std::string>;

/// Of a bake's files; the lock of who was killed is none of them.
Bytes bytes_of(const fs::path& folder) {
  Bytes bytes;
  for (const auto& entry : fs::directory_iterator(folder)) {
    const std::string name = entry.path().filename().string();
    if (entry.is_regular_file() && name != ".lock") {
      bytes[name] = read_file(entry.path(), kMostBytes);
    }
  }
  return bytes;
}

int points() {
  const char* const asked = std::getenv("RIMLIGHT_KILL_POINTS");
  return asked == nullptr ? 20 : std::atoi(asked);
}

class KilledBake : public testing::TestWithParam<Case> {
 protected:
  /// The older bake is of vertices, since that takes least. What a whole bake over it does to the
  /// disk is counted.
  void SetUp() override {
    RgbImage grey(32, 16);
    for (Vec3f& pixel : grey.pixels) pixel = {1, 1, 1};
    write_exr(folder_ / "grey.exr", grey);
    std::ofstream(folder_ / "old.json") << scene_text(kCases[1].bake, 0.3);
    std::ofstream(folder_ / "new.json") << scene_text(GetParam().bake, 0.6);
    const auto older = test::run_program(
        {"bake", (folder_ / "old.json").string(), "-o", (folder_ / "old.bake").string()});
    ASSERT_EQ(older.status, 0) << older.errors;
    old_ = bytes_of(folder_ / "old.bake");
    start_afresh(Before::old_bake);
    const auto start = std::chrono::steady_clock::now();
    const auto newer = WatchedProgram::run(program_.counting(command()));
    takes_ = std::chrono::steady_clock::now() - start;
    ASSERT_EQ(newer.status, 0) << newer.errors;
    operations_ = program_.operations();
    new_ = bytes_of(target());
    ASSERT_NE(old_, new_);
  }

  enum class Before { nothing, old_bake };
  void start_afresh(Before before) const {
    fs::remove_all(work());
    fs::create_directories(work());
    if (before == Before::old_bake)
      fs::copy(folder_ / "old.bake", target(), fs::copy_options::recursive);
  }
  fs::path work() const { return folder_ / "work"; }
  fs::path target() const { return work() / "a.bake"; }
  std::vector<std::string> command() const {
    return {"bake", (folder_ / "new.json").string(), "-o", target().string()};
  }
  /// What opens as a bake is one.
  void expect_whole_if_it_opens(const fs::path& folder) const {
    try {
      BakeFiles(folder).verify();
    } catch (const Error&) {
      return;
    }
    EXPECT_THAT(bytes_of(folder), testing::AnyOf(old_, new_)) << folder;
  }
  void expect_nothing_corrupt(Before before) const {
    if (before == Before::old_bake) {
      ASSERT_TRUE(fs::exists(target())) << "the older bake is gone";
    }
    if (fs::exists(target())) {
      ASSERT_THAT(bytes_of(target()), testing::AnyOf(old_, new_));
      BakeFiles(target()).verify();
    }
    expect_whole_if_it_opens(work() / "a.bake.partial");
  }
  void expect_resumes_to_the_same_bytes() const {
    const auto resumed = test::run_program(command());
    ASSERT_EQ(resumed.status, 0) << resumed.errors;
    EXPECT_EQ(bytes_of(target()), new_);
    for (const auto& entry : fs::directory_iterator(work())) {
      EXPECT_EQ(entry.path().filename(), "a.bake") << "left behind";
    }
  }

  test::TemporaryFolder folder_;
  WatchedProgram program_{folder_ / "work"};
  Bytes old_, new_;
  std::vector<DiskOperation> operations_;
  std::chrono::duration<double> takes_{};
};

/// "before fsync".
std::string name_of(Phase phase, const DiskOperation& operation) {
  return std::string(to_string(phase)) + " " + operation.kind;
}

using NamedPoints = std::map<std::string, std::vector<KillPoint>>;

NamedPoints points_of(const std::vector<DiskOperation>& operations) {
  NamedPoints named;
  for (std::size_t i = 0; i < operations.size(); ++i) {
    for (const Phase phase : {Phase::before, Phase::half, Phase::after}) {
      if (phase == Phase::half && operations[i].kind != "write") continue;
      named[name_of(phase, operations[i])].push_back(
          {.number = static_cast<long>(i), .kind = "", .phase = phase});
    }
  }
  std::mt19937 random(20260103);
  for (auto& [name, points] : named) std::ranges::shuffle(points, random);
  return named;
}

/// That many: those of the commit, and of each other name as many, the most telling first.
std::vector<KillPoint> choose(const std::vector<DiskOperation>& operations, std::size_t count) {
  NamedPoints named = points_of(operations);
  std::vector<KillPoint> chosen;
  const auto take = [&](const std::string& name) {
    auto& points = named[name];
    if (points.empty() || chosen.size() >= count) return;
    chosen.push_back(points.back());
    points.pop_back();
  };
  for (std::size_t round = 0; round < operations.size(); ++round) {
    for (const char* const name :
         {"before commit", "after commit", "after rename", "half write", "before fsync",
          "before rename", "after fsync", "before write", "after write"}) {
      take(name);
    }
    for (const char* const kind : {"open", "remove", "mkdir"}) {
      for (const Phase phase : {Phase::before, Phase::after}) take(name_of(phase, {kind, ""}));
    }
  }
  return chosen;
}

void expect_every_name(const std::set<std::string>& names) {
  for (const char* const kind : {"write", "fsync", "rename", "commit"}) {
    EXPECT_TRUE(names.contains(std::string("before ") + kind)) << kind;
    EXPECT_TRUE(names.contains(std::string("after ") + kind)) << kind;
  }
  EXPECT_TRUE(names.contains("half write"));
}

TEST_P(KilledBake, AtNamedOperationsLeavesTheOldBakeOrTheNewOneAndIsResumed) {
  const int named = static_cast<int>(std::lround(points() * GetParam().share / 2));
  const auto is_commit = [](const DiskOperation& operation) { return operation.kind == "commit"; };
  const auto commit = std::ranges::find_if(operations_, is_commit) - operations_.begin();
  std::set<std::string> names;
  int kills = 0;
  for (KillPoint point : choose(operations_, static_cast<std::size_t>(named))) {
    point.loses_power = kills % 2 == 1;
    // Where there is no older bake, all is the same until it would be removed.
    const Before before =
        point.number > commit || kills % 4 < 2 ? Before::old_bake : Before::nothing;
    start_afresh(before);
    const auto result = WatchedProgram::run(program_.killed(point, command()));
    ASSERT_EQ(result.status, kKilled) << result.errors;
    const auto last = program_.operations();
    ASSERT_EQ(last.size(), 1u);
    const std::string name = name_of(point.phase, last[0]);
    SCOPED_TRACE(name + " " + last[0].name + (point.loses_power ? ", power lost" : ""));
    ASSERT_NO_FATAL_FAILURE(expect_nothing_corrupt(before));
    ASSERT_NO_FATAL_FAILURE(expect_resumes_to_the_same_bytes());
    names.insert(name);
    ++kills;
  }
  std::printf("%s: killed at %d of %zu operations:", GetParam().kind, kills, operations_.size());
  for (const std::string& name : names) std::printf(" %s,", name.c_str());
  std::printf("\n");
  EXPECT_GE(kills, named);
  EXPECT_TRUE(names.contains("before commit") && names.contains("after commit"));
  if (named >= 20) expect_every_name(names);
}

TEST_P(KilledBake, AtAnyTimeAndAgainLeavesTheOldBakeOrTheNewOneAndIsResumed) {
  const int random_points = static_cast<int>(std::lround(points() * GetParam().share / 2));
  ASSERT_GT(random_points, 0);
  std::mt19937 random(20260102);
  std::uniform_real_distribution<double> share(0, 1.1);
  int kills = 0;
  for (int i = 0; i < random_points; ++i) {
    const Before before = i % 4 < 2 ? Before::nothing : Before::old_bake;
    // Up to three times in a row before it may end.
    if (i % 3 == 0) start_afresh(before);
    const bool had_bake = fs::exists(target());
    test::RunningProgram baking(command());
    std::this_thread::sleep_for(takes_ * share(random));
    baking.kill();
    kills += baking.wait().status == kKilled ? 1 : 0;
    SCOPED_TRACE("kill " + std::to_string(i));
    ASSERT_NO_FATAL_FAILURE(expect_nothing_corrupt(had_bake ? Before::old_bake : Before::nothing));
    if (i % 3 == 2 || i + 1 == random_points) {
      ASSERT_NO_FATAL_FAILURE(expect_resumes_to_the_same_bytes());
    }
  }
  std::printf("%s: killed %d times of %d, at any time; one bake takes %.0f ms\n", GetParam().kind,
              kills, random_points, takes_.count() * 1e3);
  EXPECT_GT(kills, 0);
}

/// On file systems that cannot exchange two names the older bake is moved aside first.
using KilledExchange = KilledBake;

TEST_P(KilledExchange, IsResumedWhereNamesCannotBeExchanged) {
  const WatchedProgram program(work(), {"RIMLIGHT_FAULT_NO_EXCHANGE=1"});
  const std::vector<KillPoint> between = {
      {.number = 1, .kind = "commit", .phase = Phase::before},  // 0 is the exchange that fails
      {.number = 1, .kind = "commit", .phase = Phase::after}};
  for (const KillPoint& point : between) {
    SCOPED_TRACE(to_string(point.phase));
    start_afresh(Before::old_bake);
    ASSERT_EQ(WatchedProgram::run(program.killed(point, command())).status, kKilled);
    ASSERT_EQ(bytes_of(work() / "a.bake.replaced"), old_);
    ASSERT_EQ(fs::exists(target()), point.phase == Phase::after);
    if (fs::exists(target())) {
      EXPECT_EQ(bytes_of(target()), new_);
    }
    const auto resumed = WatchedProgram::run(program.counting(command()));
    ASSERT_EQ(resumed.status, 0) << resumed.errors;
    EXPECT_EQ(bytes_of(target()), new_);
    EXPECT_FALSE(fs::exists(work() / "a.bake.replaced"));
  }
}

INSTANTIATE_TEST_SUITE_P(Kinds, KilledExchange, testing::Values(kCases[1]),
                         [](const auto& tested) { return std::string(tested.param.kind); });
INSTANTIATE_TEST_SUITE_P(Kinds, KilledBake, testing::ValuesIn(kCases),
                         [](const auto& tested) { return std::string(tested.param.kind); });

}  // namespace
}  // namespace rimlight
