// What a session's users do besides editing: undo, snapshots, import; who they are and who is
// there.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>
#include <iterator>

#include "server/access/resume_token.h"
#include "server/session/session_registry.h"
#include "server/store/sqlite_store.h"
#include "tests/server/design_session_case.h"
#include "tests/support/error_of.h"
#include "tests/support/temporary_folder.h"

namespace rimlight::server {
namespace {

using nlohmann::json;
using rimlight::test::error_of;
using test::DesignSessionTest;
using test::KeepingClient;
using ::testing::HasSubstr;
using Action = SnapshotCommand::Action;
using Direction = Travel::Direction;

class SessionCommands : public DesignSessionTest {
 protected:
  std::shared_ptr<KeepingClient> enter(const Visitor& visitor) {
    auto client = std::make_shared<KeepingClient>();
    session->join(client, now, visitor);
    return client;
  }
  void expose(const KeepingClient& client, double stops, const std::string& gesture = "") {
    Edit change;
    change.exposure_stops = stops;
    change.gesture = gesture;
    session->apply(client, change, now);
  }
  void travel(const KeepingClient& client, Direction direction) {
    session->apply(client, Travel{"t", direction}, now);
  }
  void snapshot(const KeepingClient& client, Action action, const std::string& name) {
    session->apply(client, SnapshotCommand{"s", action, name}, now);
  }
  json state_now() { return join()->texts[0]["state"]; }
};

TEST_F(SessionCommands, EachUserUndoesTheirOwnAndIsToldHowMuchThereIs) {
  const auto ann = enter({.name = "Ann"}), guest = enter({});
  expose(*ann, 1);
  Edit night;
  night.environment = "night";
  session->apply(*guest, night, now);
  EXPECT_EQ(ann->states.back()["by"], json({{"id", 2}, {"name", "guest 2"}}));
  travel(*ann, Direction::undo);
  EXPECT_EQ(ann->texts.back()["state"]["exposure"], 0.0);
  EXPECT_EQ(ann->texts.back()["state"]["environment"], "night");
  EXPECT_EQ(ann->texts.back()["by"], json({{"id", 1}, {"name", "Ann"}}));
  EXPECT_EQ(ann->texts.back()["history"], json({{"undo", 0}, {"redo", 1}}));
  EXPECT_EQ(ann->texts.back()["revision"], 3);
  EXPECT_EQ(guest->states.back()["state"]["exposure"], 0.0);
  EXPECT_THAT(error_of([&] { travel(*ann, Direction::undo); }), HasSubstr("found an undo"));
  EXPECT_THAT(error_of([&] { travel(*guest, Direction::redo); }), HasSubstr("found a redo"));
  travel(*ann, Direction::redo);
  EXPECT_EQ(ann->texts.back()["state"]["exposure"], 1.0);
  for (int i = 2; i < 9; ++i) expose(*ann, i, "drag");
  EXPECT_EQ(ann->texts.back()["history"], json({{"undo", 2}, {"redo", 0}}));
}

TEST_F(SessionCommands, ASnapshotIsRestoredByAStepThatCanBeUndone) {
  const auto owner = enter({});
  const auto other = enter({});
  expose(*owner, 1);
  snapshot(*owner, Action::make, "warm");
  for (const auto& client : {owner, other}) {
    ASSERT_EQ(client->snapshots.size(), 1u);
    const json label = client->snapshots[0]["snapshots"][0];
    EXPECT_EQ(label["name"], "warm");
    EXPECT_EQ(label["by"]["name"], "guest 1");
    EXPECT_EQ(label["revision"], 1);
  }
  const json kept = state_now();
  Edit change;
  change.exposure_stops = 5;
  change.materials["brass"].set.exponent = 3;
  session->apply(*other, change, now);
  const json changed = state_now();
  snapshot(*owner, Action::restore, "warm");
  EXPECT_EQ(state_now(), kept);
  travel(*owner, Direction::undo);
  EXPECT_EQ(state_now(), changed);
  EXPECT_EQ(join()->texts[0]["snapshots"].size(), 1u);
  EXPECT_THAT(error_of([&] { snapshot(*owner, Action::make, "warm"); }),
              HasSubstr("not there yet"));
  snapshot(*owner, Action::remove, "warm");
  EXPECT_EQ(other->snapshots.back()["snapshots"], json::array());
  for (const Action action : {Action::restore, Action::remove}) {
    EXPECT_THAT(error_of([&] { snapshot(*owner, action, "warm"); }), HasSubstr("no snapshot"));
  }
}

TEST_F(SessionCommands, SnapshotsAndThoseWhoseStepsAreKeptAreBounded) {
  const auto owner = enter({});
  for (std::size_t i = 0; i < SessionVersion::kMostSnapshots; ++i) {
    snapshot(*owner, Action::make, std::to_string(i));
  }
  EXPECT_THAT(error_of([&] { snapshot(*owner, Action::make, "more"); }), HasSubstr("delete one"));
  for (std::size_t i = 0; i < SessionVersion::kMostEditors; ++i)
    expose(*enter({}), 0.1 * static_cast<double>(i));
  EXPECT_THAT(error_of([&] { travel(*owner, Direction::undo); }), HasSubstr("found an undo"));
}

TEST_F(SessionCommands, AnImportSetsWhatAnExportHas) {
  const auto owner = enter({});
  Edit change;
  change.rotation = axis_angle({0.6, 0.8, 0}, 1.1);
  change.environment = "night";
  change.view = Camera{{1, 2, 3}, {0, 0, 0}, {0, 1, 0}, 40};
  change.materials["brass"].set.exponent = 3;
  session->apply(*owner, change, now);
  const json file = json::parse(session->export_state());
  EXPECT_EQ(file["scene"], "sphere");
  EXPECT_EQ(file["revision"], 1);
  travel(*owner, Direction::undo);
  const auto read = [&](const json& state) {
    return std::get<Import>(parse_client_message(
        json{{"type", "import"}, {"id", "i"}, {"state", state}}.dump(), scene.environments));
  };
  session->apply(*owner, read(file["state"]), now);
  EXPECT_EQ(owner->texts.back()["state"], file["state"]);  // to the last bit
  travel(*owner, Direction::undo);
  EXPECT_EQ(state_now()["environment"], "day");
  for (const auto& [field, value] :
       std::vector<std::pair<std::string, json>>{{"environment", "dusk"},
                                                 {"exposure", 21},
                                                 {"rotation", {0, 0, 0, 0}},
                                                 {"view", nullptr},
                                                 {"material", {{"load", 1}}},
                                                 {"other", 1}}) {
    json wrong = file["state"];
    wrong[field] = value;
    EXPECT_THAT(error_of([&] { read(wrong); }), HasSubstr("/state")) << field;
  }
}

TEST_F(SessionCommands, WhoIsThereIsToldToAllWhenItChanges) {
  const auto ann = enter({.name = "Ann", .role = Role::owner});
  const auto bob = enter({.name = "Bob", .role = Role::viewer});
  EXPECT_EQ(bob->texts[0]["you"], json({{"id", 2}, {"name", "Bob"}, {"role", "viewer"}}));
  EXPECT_EQ(bob->texts[0]["present"].size(), 2u);
  EXPECT_TRUE(bob->presences.empty());
  ASSERT_EQ(ann->presences.size(), 1u);
  EXPECT_EQ(ann->presences[0]["present"], bob->texts[0]["present"]);
  const auto again = enter(
      {.name = "Bob", .role = Role::viewer, .resume = bob->texts[0]["resume"].get<std::string>()});
  EXPECT_EQ(ann->presences.size(), 1u);  // the same user in another window
  session->leave(*bob, now);
  EXPECT_EQ(ann->presences.size(), 1u);
  session->leave(*again, now);
  ASSERT_EQ(ann->presences.size(), 2u);
  EXPECT_EQ(ann->presences[1]["present"].size(), 1u);
  std::vector<std::shared_ptr<KeepingClient>> crowd;
  for (std::size_t i = 0; i < kMostPresent + 5; ++i) crowd.push_back(enter({}));
  EXPECT_EQ(ann->presences.back()["present"].size(), kMostPresent);
  EXPECT_EQ(ann->presences.back()["more"], 6);
}

TEST_F(SessionCommands, AResumeTokenMakesAClientTheSameUserAgain) {
  const auto first = enter({.name = "Ann"});
  const auto token = first->texts[0]["resume"].get<std::string>();
  EXPECT_TRUE(is_resume_token(token));
  EXPECT_FALSE(first->texts[0]["resumed"].get<bool>());
  expose(*first, 1);
  session->leave(*first, now);
  expose(*enter({}), 2);
  const auto back = enter({.name = "Ann", .resume = token, .seen = 1});
  EXPECT_TRUE(back->texts[0]["resumed"].get<bool>());
  EXPECT_EQ(back->texts[0]["resume"], token);
  EXPECT_EQ(back->texts[0]["you"]["id"], 1);
  EXPECT_EQ(back->texts[0]["missed"], 1);
  EXPECT_EQ(back->texts[0]["history"], json({{"undo", 1}, {"redo", 0}}));
  EXPECT_EQ(back->texts[0]["by"]["name"], "guest 2");
  for (const Visitor& stranger : {Visitor{.name = "Eve", .resume = token},
                                  Visitor{.name = "Ann", .resume = make_resume_token()},
                                  Visitor{.name = "Ann", .resume = resume_token_hash(token)},
                                  Visitor{.name = "Ann", .resume = "short"}}) {
    const auto other = enter(stranger);
    EXPECT_FALSE(other->texts[0]["resumed"].get<bool>());
    EXPECT_NE(other->texts[0]["you"]["id"], 1);
    EXPECT_NE(other->texts[0]["resume"], token);
  }
}

TEST_F(SessionCommands, OfThoseWhoLeftTheFirstAreForgottenAndNobodyWhoIsThere) {
  const auto stays = enter({});
  std::string first;
  for (std::size_t i = 0; i <= SessionUsers::kMostKnown; ++i) {
    const auto client = enter({});
    if (i == 0) first = client->texts[0]["resume"];
    session->leave(*client, now);
  }
  EXPECT_FALSE(enter({.resume = first})->texts[0]["resumed"].get<bool>());
  EXPECT_TRUE(enter({.resume = stays->texts[0]["resume"].get<std::string>()})
                  ->texts[0]["resumed"]
                  .get<bool>());
}

TEST(ResumeToken, IsTwoHundredFiftySixBitsAndOnlyItsHashIsKept) {
  const std::string one = make_resume_token(), other = make_resume_token();
  EXPECT_NE(one, other);
  EXPECT_TRUE(is_resume_token(one));
  EXPECT_FALSE(is_resume_token(one + "0"));
  EXPECT_FALSE(is_resume_token(std::string(64, 'A')));
  EXPECT_EQ(resume_token_hash("abc"),  // FIPS 180-2, B.1
            "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad");
}

/// What commands leave in a store, over a restart of all.
class RestartedCommands : public SessionCommands {
 protected:
  RestartedCommands() { start(); }
  void start() {
    session.reset();
    registry.reset();
    store.reset();
    store = std::make_unique<SqliteStore>(SqliteStoreSettings{.file = folder / "s.sqlite"});
    registry = std::make_unique<SessionRegistry>(scenes, queue, RegistrySettings{}, store.get());
  }
  std::shared_ptr<KeepingClient> open(const Visitor& visitor = {}) {
    auto client = std::make_shared<KeepingClient>();
    session = registry->join("a", "", client, now, visitor);
    return client;
  }
  void settle() { ASSERT_TRUE(store->drain(std::chrono::seconds(10))); }

  rimlight::test::TemporaryFolder folder;
  SceneCatalog scenes{{test::sphere_scene("sphere", 32, 24, probe)}};
  std::unique_ptr<SqliteStore> store;
  std::unique_ptr<SessionRegistry> registry;
};

TEST_F(RestartedCommands, AfterARestartAUserIsTheSameAndUndoesAndRedoesAsBefore) {
  auto ann = open({.name = "Ann"}), guest = open();
  const auto token = guest->texts[0]["resume"].get<std::string>();
  for (int i = 1; i <= 3; ++i) expose(*ann, i);
  Edit change;
  for (const double roughness : {0.1, 0.2, 0.3}) {
    change.materials["brass"].set.roughness = roughness;
    change.gesture = roughness > 0.15 ? "drag" : "";
    session->apply(*guest, change, now);
  }
  travel(*guest, Direction::undo);
  snapshot(*guest, Action::make, "kept");
  settle();
  const json last = guest->texts.back();
  ASSERT_EQ(last["type"], "ack");

  start();
  guest = open({.resume = token, .seen = last["revision"].get<std::int64_t>()});
  const json welcome = guest->texts[0];
  EXPECT_TRUE(welcome["resumed"].get<bool>());
  EXPECT_EQ(welcome["you"]["name"], "guest 2");
  EXPECT_EQ(welcome["by"], last["by"]);
  EXPECT_EQ(welcome["missed"], 0);
  EXPECT_EQ(welcome["state"], last["state"]);
  EXPECT_EQ(welcome["history"], last["history"]);
  EXPECT_EQ(welcome["history"], json({{"undo", 1}, {"redo", 1}}));
  EXPECT_EQ(welcome["snapshots"][0]["name"], "kept");
  travel(*guest, Direction::redo);
  settle();
  EXPECT_EQ(guest->texts.back()["state"]["material"]["parameter"]["brass"]["roughness"], 0.3);
  travel(*guest, Direction::undo);
  travel(*guest, Direction::undo);
  settle();
  EXPECT_EQ(guest->texts.back()["state"]["material"]["parameter"], json::object());
  EXPECT_EQ(guest->texts.back()["state"]["exposure"], 3.0);
  EXPECT_EQ(open({})->texts[0]["you"]["id"], 3);  // no number is given twice
}

TEST_F(RestartedCommands, NoResumeTokenIsInTheFile) {
  const auto client = open();
  expose(*client, 1);
  settle();
  const auto token = client->texts[0]["resume"].get<std::string>();
  start();
  int files = 0;
  for (const auto& file : std::filesystem::directory_iterator(folder.path())) {
    std::ifstream stream(file.path(), std::ios::binary);
    const std::string bytes{std::istreambuf_iterator<char>(stream), {}};
    EXPECT_EQ(bytes.find(token), std::string::npos) << file.path();
    files += bytes.find(resume_token_hash(token)) != std::string::npos;
  }
  EXPECT_GE(files, 1);
}

TEST_F(RestartedCommands, AStateIsExportedWhetherItsSessionIsOpenOrNot) {
  EXPECT_FALSE(registry->export_state("a", ""));
  expose(*open(), 2);
  settle();
  const json open_one = json::parse(registry->export_state("a", "").value());
  EXPECT_EQ(open_one["state"]["exposure"], 2.0);
  start();
  EXPECT_EQ(json::parse(registry->export_state("a", "").value())["state"], open_one["state"]);
  EXPECT_FALSE(registry->export_state("a", "other"));
  EXPECT_FALSE(registry->export_state("b", ""));
}

TEST(Roles, ViewersWatchEditorsEditAndOwnersReplaceAll) {
  const Command edit = Edit{}, undo = Travel{}, import = Import{};
  const auto with = [](Action action) { return Command(SnapshotCommand{"", action, "a"}); };
  const auto allows = [](Role role, const Command& command) {
    return error_of([&] { check_role(command, role); }) == "no error";
  };
  for (const Command& one : {edit, undo, with(Action::make)}) {
    EXPECT_FALSE(allows(Role::viewer, one));
    EXPECT_TRUE(allows(Role::editor, one));
    EXPECT_TRUE(allows(Role::owner, one));
  }
  for (const Command& one : {import, with(Action::restore), with(Action::remove)}) {
    EXPECT_FALSE(allows(Role::viewer, one));
    EXPECT_FALSE(allows(Role::editor, one));
    EXPECT_TRUE(allows(Role::owner, one));
  }
}

}  // namespace
}  // namespace rimlight::server
