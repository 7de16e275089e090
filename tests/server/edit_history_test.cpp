// Undo and redo of one user among others, against a model that knows every field's every value.
#include "server/session/edit_history.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdio>
#include <random>

#include "server/protocol/messages.h"
#include "tests/support/error_of.h"

namespace rimlight::server {
namespace {

using nlohmann::json;

json start_state() {
  DesignState state;
  state.environment = "day";
  return state_to_json(state);
}

/// Sets fields by the user's hand.
void set(json& state, EditHistory& history, const std::map<std::string, json>& fields,
         const std::string& gesture = "") {
  const json before = state;
  for (const auto& [field, value] : fields) set_field(state, field, value);
  history.record(changed_fields(before, state), gesture);
}

TEST(FieldChanges, AreTheFieldsThatDifferAndSettingThemLeadsFromOneStateToTheOther) {
  DesignState one, other;
  one.environment = other.environment = "day";
  other.exposure_stops = 2;
  other.view = Camera{};
  one.materials["a/b~c"].albedo = Vec3f{0.1F, 0.2F, 0.3F};
  one.materials["12"].exponent = 4;
  one.materials["gold"].measured = "old";
  other.materials["12"].exponent = 4;
  other.materials["12"].roughness = 0.5;
  other.materials["0"].half_angle = CurveEdit{CurveScale::linear, {}, std::vector<Vec3f>(256)};
  other.materials["gold"].measured = "new";
  const json from = state_to_json(one), to = state_to_json(other);
  const FieldChanges changes = changed_fields(from, to);
  std::vector<std::string> names;
  for (const auto& [field, change] : changes) names.push_back(field);
  EXPECT_EQ(names,
            (std::vector<std::string>{"/exposure", "/material/curve/0/half_angle",
                                      "/material/load/gold", "/material/parameter/12/roughness",
                                      "/material/parameter/a~1b~0c/albedo", "/view"}));
  json there = from, back = to;
  for (const auto& [field, change] : changes) {
    set_field(there, field, change.after);
    set_field(back, field, change.before);
  }
  EXPECT_EQ(there, to);
  EXPECT_EQ(back, from);
  EXPECT_TRUE(changed_fields(from, from).empty());
}

TEST(EditHistory, UndoSetsBackWhatTheStepSetAndNothingThatOthersDid) {
  json state = start_state();
  EditHistory mine;
  set(state, mine, {{"/exposure", 1.0}, {"/environment", "night"}});
  set_field(state, "/rotation", {0, 1, 0, 0});  // somebody else
  set_field(state, "/environment", "dusk");     // this too
  ASSERT_TRUE(mine.undo(state));
  EXPECT_EQ(state["exposure"], 0.0);
  EXPECT_EQ(state["environment"], "dusk");
  EXPECT_EQ(state["rotation"], json({0, 1, 0, 0}));
  EXPECT_FALSE(mine.undo(state));
  set_field(state, "/environment", "day");  // what it was before: still not the step's any more
  ASSERT_TRUE(mine.redo(state));
  EXPECT_EQ(state["exposure"], 1.0);
  EXPECT_EQ(state["environment"], "day");
}

TEST(EditHistory, AStepThatOthersHaveOverwrittenWaitsAndAnOlderOneIsUndone) {
  json state = start_state();
  EditHistory mine;
  set(state, mine, {{"/rotation", {1, 0, 0, 0}}});
  set(state, mine, {{"/exposure", 1.0}});
  set_field(state, "/exposure", 5.0);
  ASSERT_TRUE(mine.undo(state));
  EXPECT_EQ(state["rotation"], start_state()["rotation"]);
  EXPECT_EQ(state["exposure"], 5.0);
  EXPECT_FALSE(mine.undo(state));
  set_field(state, "/exposure", 1.0);  // they took theirs back
  ASSERT_TRUE(mine.undo(state));
  EXPECT_EQ(state["exposure"], 0.0);
}

TEST(EditHistory, AGestureIsOneStepToWhatWasBeforeIt) {
  json state = start_state();
  EditHistory mine;
  for (int i = 1; i <= 50; ++i) set(state, mine, {{"/exposure", 0.1 * i}}, "drag");
  set(state, mine, {{"/environment", "night"}}, "drag");
  EXPECT_EQ(mine.done().size(), 1u);
  set(state, mine, {{"/exposure", -1.0}}, "other");
  EXPECT_EQ(mine.done().size(), 2u);
  ASSERT_TRUE(mine.undo(state));
  EXPECT_EQ(state["exposure"], 5.0);
  set(state, mine, {{"/exposure", 6.0}}, "drag");  // of what was undone, nothing goes on
  EXPECT_EQ(mine.done().size(), 2u);
  EXPECT_TRUE(mine.undone().empty());
  ASSERT_TRUE(mine.undo(state));
  ASSERT_TRUE(mine.undo(state));
  EXPECT_EQ(state, start_state());
}

TEST(EditHistory, AGestureOverSomebodyElsesEditGoesBackToThatOne) {
  json state = start_state();
  EditHistory mine;
  set(state, mine, {{"/exposure", 1.0}}, "drag");
  set_field(state, "/exposure", 7.0);
  set(state, mine, {{"/exposure", 2.0}}, "drag");
  ASSERT_TRUE(mine.undo(state));
  EXPECT_EQ(state["exposure"], 7.0);
}

TEST(EditHistory, AGestureThatEndsWhereItBeganIsNoStep) {
  json state = start_state();
  EditHistory mine;
  set(state, mine, {{"/exposure", 1.0}}, "drag");
  set(state, mine, {{"/exposure", 0.0}}, "drag");
  EXPECT_TRUE(mine.done().empty());
  set(state, mine, {{"/exposure", 0.0}}, "nothing");
  EXPECT_TRUE(mine.done().empty());
}

TEST(EditHistory, KeepsItsNewestStepsAndBytes) {
  json state = start_state();
  EditHistory mine;
  for (int i = 1; i <= 500; ++i) set(state, mine, {{"/exposure", 0.01 * i}});
  EXPECT_EQ(mine.done().size(), EditHistory::kMostSteps);
  std::size_t undone = 0;
  while (mine.undo(state)) ++undone;
  EXPECT_EQ(undone, EditHistory::kMostSteps);
  EXPECT_EQ(state["exposure"], 0.01 * 400);
  EditHistory large;
  for (int i = 1; i <= 20; ++i) {
    set(state, large,
        {{"/material/load/gold",
          std::string(EditHistory::kMostBytes / 7, static_cast<char>('a' + i))}});
  }
  EXPECT_GE(large.done().size(), 2u);
  EXPECT_LE(large.done().size(), 3u);
  set(state, large, {{"/material/load/gold", std::string(2 * EditHistory::kMostBytes, 'z')}});
  EXPECT_EQ(large.done().size(), 1u);
}

TEST(EditHistory, StepsAreReadAsTheyWereWrittenAndNothingElseIs) {
  json state = start_state();
  EditHistory mine;
  set(state, mine, {{"/exposure", 0.1}, {"/material/parameter/a~1b/eta", {1.5, 1.5, 1.6}}}, "g");
  const EditStep& step = *mine.done().back();
  EXPECT_EQ(*read_step(write_step(step), step.ordinal, "store"), step);
  for (const char* const wrong :
       {"{", "[]", "{}", R"({"gesture":"","fields":{}})",
        R"({"gesture":1,"fields":{"/view":[1,2]}})", R"({"gesture":"","fields":{"/view":[1]}})",
        R"({"gesture":"","fields":{"a":[1,2]}})",
        R"({"gesture":"","fields":{"/exposure/a":[1,2]}})", R"({"gesture":"","fields":{"":[1,2]}})",
        R"({"gesture":"","fields":{"/material/load/a~2":[1,2]}})",
        R"({"gesture":"","fields":{"/material/parameter/a":[1,2]}})"}) {
    EXPECT_NE(rimlight::test::error_of([&] { read_step(wrong, 1, "store"); }), "no error") << wrong;
  }
}

/// The same rules over plain numbers, in the most direct words.
struct Model {
  using Values = std::map<std::string, int>;  // a field that is not there: 0
  struct Step {
    std::string gesture;
    std::map<std::string, std::pair<int, int>> fields;
  };
  struct User {
    std::vector<Step> done, undone;
  };

  static int at(const Values& values, const std::string& field) {
    const auto found = values.find(field);
    return found == values.end() ? 0 : found->second;
  }
  void edit(User& user, const Values& sets, const std::string& gesture) {
    Step step{gesture, {}};
    for (const auto& [field, value] : sets) {
      if (at(now, field) != value) step.fields[field] = {at(now, field), value};
      now[field] = value;
    }
    if (step.fields.empty()) return;
    const bool goes_on = !gesture.empty() && user.undone.empty() && !user.done.empty() &&
                         user.done.back().gesture == gesture;
    user.undone.clear();
    if (!goes_on) {
      user.done.push_back(step);
      return;
    }
    Step& last = user.done.back();
    for (const auto& [field, change] : step.fields) {
      const bool had = last.fields.contains(field) && last.fields[field].second == change.first;
      last.fields[field] = {had ? last.fields[field].first : change.first, change.second};
      if (last.fields[field].first == last.fields[field].second) last.fields.erase(field);
    }
    if (last.fields.empty()) user.done.pop_back();
  }
  bool travel(std::vector<Step>& from, std::vector<Step>& to, bool back) {
    for (std::size_t i = from.size(); i-- > 0;) {
      Step moved;
      for (const auto& [field, change] : from[i].fields) {
        if (at(now, field) != (back ? change.second : change.first)) continue;
        moved.fields[field] = change;
        now[field] = back ? change.first : change.second;
      }
      if (moved.fields.empty()) continue;
      to.push_back(moved);
      from.erase(from.begin() + static_cast<std::ptrdiff_t>(i));
      return true;
    }
    return false;
  }

  Values now;
};

const std::vector<std::string> kFields{"/exposure",
                                       "/view",
                                       "/material/parameter/gold/exponent",
                                       "/material/parameter/gold/roughness",
                                       "/material/curve/1/half_angle",
                                       "/material/load/gold"};

json value_of(int value) { return value == 0 ? json() : json(value); }

TEST(EditHistory, AgreesWithTheModelOverRandomEditsOfSeveralUsers) {
  int undone = 0, in_vain = 0, merged = 0;
  for (unsigned seed = 1; seed <= 200; ++seed) {
    std::mt19937 random(seed);
    const auto below = [&](int end) {
      return static_cast<int>(random() % static_cast<unsigned>(end));
    };
    json state = start_state();
    for (const char* const field : {"exposure", "view"}) state.erase(field);  // 0 in the model
    Model model;
    std::vector<EditHistory> histories(3);
    std::vector<Model::User> users(3);
    for (int i = 0; i < 200; ++i) {
      const auto who = static_cast<std::size_t>(below(3));
      EditHistory& history = histories[who];
      Model::User& user = users[who];
      const int what = below(10);
      if (what < 6) {
        Model::Values sets;
        for (int n = 1 + below(3); n > 0; --n) {
          sets[kFields[static_cast<std::size_t>(below(6))]] = below(4);
        }
        const std::string gesture =
            below(2) == 0 ? "" : std::string(1, static_cast<char>('a' + below(2)));
        std::map<std::string, json> fields;
        for (const auto& [field, value] : sets) fields[field] = value_of(value);
        merged += !gesture.empty() && !user.done.empty() && user.done.back().gesture == gesture;
        set(state, history, fields, gesture);
        model.edit(user, sets, gesture);
      } else if (what < 9) {
        const json before = state;
        const bool did = history.undo(state);
        ASSERT_EQ(did, model.travel(user.done, user.undone, true)) << "seed " << seed;
        (did ? undone : in_vain) += 1;
        if (did && below(2) == 0) {  // there and back changes nothing
          const json after = state;
          ASSERT_TRUE(history.redo(state) && model.travel(user.undone, user.done, false));
          ASSERT_EQ(state, before) << "seed " << seed;
          ASSERT_TRUE(history.undo(state) && model.travel(user.done, user.undone, true));
          ASSERT_EQ(state, after) << "seed " << seed;
        }
      } else {
        ASSERT_EQ(history.redo(state), model.travel(user.undone, user.done, false));
      }
      for (const std::string& field : kFields) {
        ASSERT_EQ(field_of(state, field), value_of(Model::at(model.now, field)))
            << "seed " << seed << ", edit " << i << ", " << field;
      }
      ASSERT_EQ(history.done().size(), std::min(user.done.size(), EditHistory::kMostSteps));
      ASSERT_EQ(history.undone().size(), user.undone.size());
      for (const auto* const list : {&history.done(), &history.undone()}) {
        ASSERT_TRUE(std::is_sorted(list->begin(), list->end(), [](const auto& a, const auto& b) {
          return a->ordinal < b->ordinal;
        }));
      }
    }
  }
  std::printf("%d undone, %d in vain, %d gone on\n", undone, in_vain, merged);
  EXPECT_GT(undone, 1000);
  EXPECT_GT(in_vain, 100);
  EXPECT_GT(merged, 1000);
}

TEST(EditHistory, UndoOfAllAfterAnyInterleavingOnFieldsOfTheirOwnGivesEachTheirsBack) {
  std::mt19937 random(7);
  json state = start_state();
  std::vector<EditHistory> histories(3);
  const std::vector<std::string> own{"/exposure", "/material/load/gold", "/environment"};
  for (int i = 0; i < 90; ++i) {
    const std::size_t who = random() % 3;
    set(state, histories[who], {{own[who], static_cast<int>(random() % 5) + 1}});
  }
  const json last = state;
  std::vector<std::size_t> steps(3, 0);
  for (const std::size_t who : {2u, 0u, 1u}) {
    while (histories[who].undo(state)) ++steps[who];
  }
  EXPECT_EQ(state, start_state());
  EXPECT_GT(*std::ranges::min_element(steps), 10u);
  for (const std::size_t who : {1u, 0u, 2u}) {
    while (histories[who].redo(state)) {
    }
  }
  EXPECT_EQ(state, last);
}

}  // namespace
}  // namespace rimlight::server
