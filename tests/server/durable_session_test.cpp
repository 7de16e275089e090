// Design sessions with a store: what is told and shown before and after an edit is durable, and
// sessions that come back.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <future>

#include "server/session/session_registry.h"
#include "server/store/sqlite_store.h"
#include "tests/server/design_session_case.h"
#include "tests/server/stored_edits.h"
#include "tests/support/error_of.h"
#include "tests/support/temporary_folder.h"

namespace rimlight::server {
namespace {

using nlohmann::json;
using rimlight::test::error_of;
using std::chrono::milliseconds;
using std::chrono::seconds;
using test::DesignSessionTest;
using test::KeepingClient;
using test::sphere_scene;
using ::testing::HasSubstr;

/// A disk that answers when the test says so.
class SlowStore final : public SessionStore {
 public:
  std::optional<StoredSession> load(const std::string&, const std::string&) override { return {}; }
  void append(StoredEdit edit, Answer answer) override {
    if (is_full) throw StoreError("disk", "too many", "fewer");
    edits.push_back(std::move(edit));
    answers.push_back(std::move(answer));
  }
  void remove(const std::string&, const std::string&, Answer answer) override {
    answers.push_back(std::move(answer));
  }
  bool drain(milliseconds) override { return answers.empty(); }

  void answer(const std::optional<StoreError>& refusal = {}) {
    const Answer first = std::move(answers.front());
    answers.erase(answers.begin());
    first(refusal);
  }
  void refuse() { answer(StoreError("disk", "smoke", "a disk")); }

  bool is_full = false;
  std::vector<StoredEdit> edits;
  std::vector<Answer> answers;
};

class DurableSession : public DesignSessionTest {
 protected:
  DurableSession() {
    session = std::make_shared<DesignSession>("s", scene, 5, SessionSettings{}, queue,
                                              KeptSession{.store = &store});
  }
  void expose(const KeepingClient& client, double stops, const std::string& id) {
    Edit change;
    change.id = id;
    change.exposure_stops = stops;
    session->apply(client, change, now);
  }

  SlowStore store;
};

TEST_F(DurableSession, AnEditIsToldAndShownWhenItIsDurableAndNotBefore) {
  const auto one = join();
  const auto other = join();
  work();
  acknowledge(*one);
  acknowledge(*other);
  expose(*one, 2, "x");
  pass(milliseconds(100));
  EXPECT_EQ(one->texts.size(), 1u);  // the welcome
  EXPECT_TRUE(other->states.empty());
  EXPECT_EQ(one->frames.size(), 1u);
  EXPECT_EQ(join()->texts[0]["state"]["exposure"], 0.0);  // who comes now sees what is durable
  store.answer();
  ASSERT_EQ(one->texts.size(), 2u);
  EXPECT_EQ(one->texts[1]["type"], "ack");
  EXPECT_EQ(one->texts[1]["id"], "x");
  EXPECT_EQ(one->texts[1]["revision"], 1);
  ASSERT_EQ(other->states.size(), 1u);
  EXPECT_EQ(other->states[0]["state"]["exposure"], 2.0);
  work();
  ASSERT_EQ(one->frames.size(), 2u);
  EXPECT_EQ(one->last().revision, (Revision{5, 1}));
}

TEST_F(DurableSession, TheStoreGetsEachStateWithWhoChangedWhat) {
  const auto one = join();
  const auto other = join();
  expose(*one, 2, "x");
  Edit night;
  night.environment = "night";
  session->apply(*other, night, now);
  ASSERT_EQ(store.edits.size(), 2u);
  const StoredEdit& second = store.edits[1];
  EXPECT_EQ(second.scene + second.session, "spheres");
  EXPECT_EQ(second.before, (Revision{5, 1}));
  EXPECT_EQ(second.revision, (Revision{5, 2}));
  EXPECT_EQ(second.author, "guest 2");
  EXPECT_EQ(second.user, 2);
  EXPECT_GT(second.at_ms, 1'500'000'000'000);
  const json before = json::parse(store.edits[0].state), after = json::parse(second.state);
  EXPECT_EQ(after["exposure"], 2.0);
  EXPECT_EQ(after["environment"], "night");
  EXPECT_EQ(before.patch(json::parse(second.change)), after);
  EXPECT_EQ(json::parse(second.change).size(), 1u);
}

TEST_F(DurableSession, ARefusedEditIsToldWithTheReasonAndNothingOfItStays) {
  const auto one = join();
  const auto other = join();
  expose(*one, 2, "x");
  store.refuse();
  ASSERT_EQ(one->texts.size(), 2u);
  EXPECT_EQ(one->texts[1]["type"], "error");
  EXPECT_EQ(one->texts[1]["id"], "x");
  EXPECT_THAT(one->texts[1]["reason"].get<std::string>(), HasSubstr("smoke"));
  EXPECT_TRUE(other->states.empty());
  EXPECT_EQ(join()->texts[0]["state"]["exposure"], 0.0);
  Edit night;
  night.environment = "night";
  session->apply(*one, night, now);
  EXPECT_EQ(store.edits.back().before.number, 0);
  store.answer();
  EXPECT_EQ(one->texts.back()["revision"], 1);
  EXPECT_EQ(one->texts.back()["state"]["exposure"], 0.0);
  EXPECT_EQ(one->texts.back()["state"]["environment"], "night");
}

TEST_F(DurableSession, EditsMadeOnARefusedOneFallWithItAndNoneIsTakenMeanwhile) {
  const auto client = join();
  expose(*client, 1, "1");
  expose(*client, 2, "2");
  expose(*client, 3, "3");
  store.answer();
  store.refuse();
  EXPECT_THAT(error_of([&] { expose(*client, 4, "4"); }), HasSubstr("an edit before it"));
  store.refuse();
  EXPECT_EQ(store.edits.size(), 3u);
  expose(*client, 5, "5");
  EXPECT_EQ(store.edits.back().before, (Revision{5, 1}));
  EXPECT_EQ(store.edits.back().revision, (Revision{5, 2}));
  store.answer();
  ASSERT_EQ(client->texts.size(), 5u);
  EXPECT_EQ(client->texts[1]["type"], "ack");
  EXPECT_EQ(client->texts[2]["id"], "2");
  EXPECT_EQ(client->texts[2]["type"], "error");
  EXPECT_EQ(client->texts[3]["type"], "error");
  EXPECT_EQ(client->texts[4]["type"], "ack");
  EXPECT_EQ(client->texts[4]["state"]["exposure"], 5.0);
}

TEST_F(DurableSession, AnEditThatTheStoreDoesNotTakeChangesNothing) {
  const auto client = join();
  store.is_full = true;
  EXPECT_THAT(error_of([&] { expose(*client, 1, "1"); }), HasSubstr("too many"));
  store.is_full = false;
  expose(*client, 2, "2");
  EXPECT_EQ(store.edits.back().revision.number, 1);
  EXPECT_EQ(json::parse(store.edits.back().state)["exposure"], 2.0);
}

TEST_F(DurableSession, ItIsNotIdleWhileAnEditOfAClientThatLeftIsOnItsWay) {
  const auto client = join();
  expose(*client, 1, "1");
  session->leave(*client, now);
  EXPECT_FALSE(session->idle_since());
  store.answer();
  EXPECT_EQ(session->idle_since(), now);
  EXPECT_EQ(client->texts.size(), 1u);  // it left: nobody is told
  EXPECT_EQ(join()->texts[0]["state"]["exposure"], 1.0);
}

/// A server's sessions in one file, which can be started anew.
class RestartedSessions : public testing::Test {
 protected:
  RestartedSessions() { start({sphere_scene("one", 8, 8), sphere_scene("two", 8, 8)}); }

  void start(std::vector<ServedScene> served) {
    registry.reset();
    scenes.reset();
    store.reset();
    scenes = std::make_unique<SceneCatalog>(std::move(served));
    store = std::make_unique<SqliteStore>(settings);
    registry = std::make_unique<SessionRegistry>(*scenes, queue, RegistrySettings{}, store.get());
  }
  std::shared_ptr<KeepingClient> join(const std::string& name, const std::string& scene = "") {
    auto client = std::make_shared<KeepingClient>();
    session = registry->join(name, scene, client, Clock::now());
    return client;
  }
  void apply(const KeepingClient& client, const Edit& edit) {
    session->apply(client, edit, Clock::now());
    ASSERT_TRUE(store->drain(seconds(10)));
  }

  rimlight::test::TemporaryFolder folder;
  SqliteStoreSettings settings{.file = folder / "sessions.sqlite"};
  RenderQueue queue;
  std::unique_ptr<SceneCatalog> scenes;
  std::unique_ptr<SqliteStore> store;
  std::unique_ptr<SessionRegistry> registry;
  std::shared_ptr<DesignSession> session;
};

TEST_F(RestartedSessions, ComeBackWithTheSameStateAndRevisionInALaterEpochAndGoOn) {
  auto client = join("a");
  Edit change;
  change.rotation = axis_angle({0.6, 0.8, 0}, 1.1);
  change.environment = "night";
  change.view = Camera{{1, 2, 3}, {0, 0, 0}, {0, 1, 0}, 40};
  change.materials["brass"].set.exponent = 3;
  apply(*client, change);
  Edit second;
  second.exposure_stops = 0.1;
  apply(*client, second);
  const json last = client->texts.back();
  ASSERT_EQ(last["type"], "ack");

  start({sphere_scene("one", 8, 8)});
  client = join("a");
  EXPECT_EQ(client->texts[0]["state"], last["state"]);  // to the last bit of every number
  EXPECT_EQ(client->texts[0]["revision"], 2);
  EXPECT_GT(client->texts[0]["epoch"], last["epoch"]);
  while (queue.run_one(Clock::now())) {
  }
  ASSERT_EQ(client->frames.size(), 1u);
  EXPECT_TRUE(client->last().exact);
  EXPECT_EQ(client->last().revision.number, 2);
  apply(*client, second);
  EXPECT_EQ(client->texts.back()["revision"], 3);
  EXPECT_EQ(join("b")->texts[0]["revision"], 0);
}

TEST_F(RestartedSessions, AnIdleSessionThatWasForgottenComesBackToo) {
  const auto client = join("a");
  Edit change;
  change.exposure_stops = 3;
  apply(*client, change);
  session->leave(*client, Clock::now());
  registry->drop_idle(Clock::now() + seconds(1000));
  ASSERT_EQ(registry->size(), 0u);
  EXPECT_EQ(join("a")->texts[0]["state"]["exposure"], 3.0);
}

TEST_F(RestartedSessions, OfWhatIsNotServedAnyMoreSaySoAndStayKept) {
  Edit change;
  change.environment = "night";
  apply(*join("a", "two"), change);
  start({sphere_scene("one", 8, 8)});
  EXPECT_THAT(error_of([&] { join("a", "two"); }),
              HasSubstr("found a session of the scene \"two\", expected a scene that is served"));
  EXPECT_THAT(error_of([&] { join("b", "two"); }), HasSubstr("found the scene \"two\""));
  ServedScene day = sphere_scene("two", 8, 8);
  day.environments = {"day"};
  start({day});
  EXPECT_THAT(error_of([&] { join("a", "two"); }), HasSubstr("/environment: found \"night\""));
  start({sphere_scene("two", 8, 8)});
  EXPECT_EQ(join("a")->texts[0]["state"]["environment"], "night");
}

TEST_F(RestartedSessions, AStateThatCannotBeReadIsAnErrorOfItsSessionAlone) {
  apply(*join("a"), Edit{.id = "1", .rotation = {}, .environment = "night", .exposure_stops = {}});
  registry.reset();
  session.reset();
  store.reset();
  for (const char* const damage : {"state = '{'", "state = '[]'",
                                   "state = replace(state, '\"exposure\":0.0', '\"exposure\":99')",
                                   "revision = -1", "epoch = 9223372036854775807"}) {
    const std::string copy = (folder / "damaged.sqlite").string();
    std::filesystem::copy_file(folder / "sessions.sqlite", copy,
                               std::filesystem::copy_options::overwrite_existing);
    test::run_sql(copy, std::string("UPDATE sessions SET ") + damage);
    settings.file = copy;
    start({sphere_scene("one", 8, 8)});
    EXPECT_THAT(error_of([&] { join("a"); }), HasSubstr("session \"a\"")) << damage;
    EXPECT_EQ(join("b")->texts[0]["revision"], 0);
    registry.reset();
    session.reset();
    store.reset();
  }
}

/// A store that takes its time to read one session.
class StuckStore final : public SessionStore {
 public:
  std::optional<StoredSession> load(const std::string&, const std::string& session) override {
    if (session == "stuck") {
      reading.set_value();
      go.get_future().wait();
    }
    return {};
  }
  void append(StoredEdit, Answer answer) override { answer({}); }
  void remove(const std::string&, const std::string&, Answer answer) override { answer({}); }
  bool drain(milliseconds) override { return true; }

  std::promise<void> reading, go;
};

TEST(Registry, ASessionThatIsReadFromTheStoreHoldsUpNoOther) {
  RenderQueue queue;
  const SceneCatalog scenes({sphere_scene("one", 8, 8)});
  StuckStore store;
  SessionRegistry registry(scenes, queue, RegistrySettings{}, &store);
  const auto join = [&](const std::string& name) {
    return registry.join(name, "", std::make_shared<KeepingClient>(), Clock::now());
  };
  const auto open = join("a");
  auto stuck = std::async(std::launch::async, [&] { return join("stuck"); });
  ASSERT_EQ(store.reading.get_future().wait_for(seconds(10)), std::future_status::ready);
  auto others = std::async(std::launch::async, [&] { return std::pair(join("a"), join("b")); });
  const auto in_time = others.wait_for(seconds(10));
  EXPECT_EQ(in_time, std::future_status::ready);
  EXPECT_EQ(registry.join_open("stuck", "", std::make_shared<KeepingClient>(), Clock::now()),
            nullptr);
  store.go.set_value();
  EXPECT_EQ(others.get().first, open);
  EXPECT_EQ(stuck.get()->name(), "stuck");
  EXPECT_EQ(registry.size(), 3u);
}

}  // namespace
}  // namespace rimlight::server
