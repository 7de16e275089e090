// Scripts of timed edits, and the messages that they become.

#include "cli/load_script.h"

#include <gtest/gtest.h>

#include "core/base/files.h"
#include "tests/support/error_of.h"
#include "tests/support/temporary_folder.h"

namespace rimlight {
namespace {

using nlohmann::json;
using test::error_of;

class LoadScriptTest : public testing::Test {
 protected:
  LoadScript read(const json& script, double seconds = 10) {
    write_file_atomically(folder / "script.json", script.dump());
    return read_script(folder / "script.json", seconds);
  }
  std::string error(const json& script) {
    return error_of([&] { read(script); });
  }

  test::TemporaryFolder folder;
};

TEST_F(LoadScriptTest, EveryPartOfAnEditReachesItsMessage) {
  const json material = {{"curve", {{"gold", {{"half_angle", nullptr}}}}}};
  const json view = {{"camera", nullptr}};
  const LoadScript script = read({{"edits",
                                   {{{"at_ms", 5},
                                     {"rotation", {0, 0, 0, 2}},
                                     {"environment", "sky"},
                                     {"exposure", 1},
                                     {"view", view},
                                     {"material", material}}}}});
  ASSERT_EQ(script.edits.size(), 1u);
  const json expected = {
      {"type", "edit"},       {"id", "7"},       {"rotation", {0.0, 0.0, 0.0, 1.0}},
      {"environment", "sky"}, {"exposure", 1.0}, {"view", view},
      {"material", material}};
  EXPECT_EQ(json::parse(edit_message(script.edits[0], "7")), expected);
}

TEST_F(LoadScriptTest, RepeatsUntilTheTimeIsOver) {
  const json edit = {{"at_ms", 400}, {"material", {{"load", {{"gold", nullptr}}}}}};
  const LoadScript script = read({{"repeat_ms", 1000}, {"edits", {edit}}}, 3);
  ASSERT_EQ(script.edits.size(), 3u);
  EXPECT_EQ(script.edits[2].at_ms, 2400);
  EXPECT_EQ(script.edits[2].material, edit["material"]);
}

TEST_F(LoadScriptTest, MistakesAreNamed) {
  EXPECT_NE(error({{"edits", {{{"at_ms", 0}}}}}).find("/edits/0"), std::string::npos);
  EXPECT_NE(error({{"edits", {{{"at_ms", 0}, {"material", 3}}}}}).find("/edits/0/material"),
            std::string::npos);
  EXPECT_NE(error({{"edits", {{{"at_ms", 0}, {"curve", json::object()}}}}}).find("curve"),
            std::string::npos);
  const json one = {{"at_ms", 10}, {"exposure", 0}}, earlier = {{"at_ms", 5}, {"exposure", 0}};
  EXPECT_NE(error({{"edits", {one, earlier}}}).find("/edits/1/at_ms"), std::string::npos);
}

TEST(DefaultScript, HasNoTwoEditsOfOneLight) {
  const LoadScript script = default_script(5);
  ASSERT_EQ(script.edits.size(), 300u);
  for (std::size_t i = 1; i < script.edits.size(); ++i) {
    EXPECT_NE(script.edits[i].rotation, script.edits[i - 1].rotation);
  }
}

}  // namespace
}  // namespace rimlight
