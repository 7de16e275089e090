#include "core/relight/policy_settings.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <regex>
#include <set>
#include <string>
#include <vector>

#include "core/base/error.h"
#include "core/base/files.h"
#include "tests/support/error_of.h"
#include "tests/support/policy_case.h"

namespace rimlight {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

std::string fault_of(const std::string& text) {
  return test::error_of([&] { parse_policy(text, "config.json: /policy"); });
}

/// Every row of up to three words that mean something somewhere, and some that do not.
std::vector<std::string> rows_of_words() {
  const std::vector<std::string> words = {
      "linear",     "nwa",        "bi",   "pbi",       "benefit", "simple", "dealer",
      "exhaustive", "unweighted", "area", "transport", "",        "PBI",    "pbi "};
  std::vector<std::string> rows;
  for (const std::string& a : words) {
    rows.push_back(a);
    for (const std::string& b : words) {
      rows.push_back(a + ":" + b);
      for (const std::string& c : words) rows.push_back(a + ":" + b + ":" + c);
    }
  }
  rows.push_back("pbi:dealer:area:area");
  return rows;
}

TEST(PolicySettings, TextSaysKindThenBandTestThenSelection) {
  EXPECT_EQ(parse_policy("pbi", "x"), PolicySettings{});
  EXPECT_EQ(parse_policy("linear", "x"), (PolicySettings{.kind = PolicyKind::linear}));
  EXPECT_EQ(parse_policy("benefit", "x"), (PolicySettings{.kind = PolicyKind::benefit}));
  EXPECT_EQ(parse_policy("nwa:unweighted", "x"),
            (PolicySettings{.kind = PolicyKind::nwa, .selection = Selection::unweighted}));
  EXPECT_EQ(parse_policy("bi:transport", "x"),
            (PolicySettings{.kind = PolicyKind::bi, .selection = Selection::transport}));
  EXPECT_EQ(parse_policy("pbi:dealer", "x"), (PolicySettings{.band_test = BandTest::dealer}));
  EXPECT_EQ(
      parse_policy("pbi:exhaustive:unweighted", "x"),
      (PolicySettings{.band_test = BandTest::exhaustive, .selection = Selection::unweighted}));
}

TEST(PolicySettings, TheNameReadsBackAsTheSettings) {
  std::set<std::string> names;
  for (const std::string& text : test::every_policy()) {
    const PolicySettings settings = parse_policy(text, "x");
    names.insert(policy_name(settings));
    EXPECT_EQ(parse_policy(policy_name(settings), "x"), settings) << text;
    EXPECT_NE(make_policy(settings), nullptr);
  }
  EXPECT_EQ(names.size(), 17u);
  EXPECT_EQ(policy_name({}), "pbi");
  EXPECT_EQ(policy_name({PolicyKind::pbi, BandTest::dealer, Selection::transport}),
            "pbi:dealer:transport");
}

TEST(PolicySettings, ErrorsSayWhereAndListTheNames) {
  EXPECT_THAT(fault_of("pbj"),
              AllOf(HasSubstr("config.json: /policy: found \"pbj\""), HasSubstr("\"linear\""),
                    HasSubstr("\"nwa\""), HasSubstr("\"bi\""), HasSubstr("\"pbi\""),
                    HasSubstr("\"benefit\"")));
  EXPECT_THAT(fault_of("pbi:deal"), AllOf(HasSubstr("\"simple\""), HasSubstr("\"dealer\""),
                                          HasSubstr("\"exhaustive\""), HasSubstr("\"unweighted\""),
                                          HasSubstr("\"area\""), HasSubstr("\"transport\"")));
  EXPECT_THAT(fault_of("nwa:dealer"), AllOf(HasSubstr("after \"nwa\""), HasSubstr("\"area\""),
                                            ::testing::Not(HasSubstr("\"simple\""))));
  EXPECT_THAT(fault_of("benefit:area"), HasSubstr("\"benefit\" alone"));
}

/// What the schema of the server's configuration takes is what the program takes.
TEST(PolicySettings, TheSchemaTakesTheSameTexts) {
  const auto schema = nlohmann::json::parse(
      read_file("docs/protocol/schema/server_config.schema.json", std::size_t{1} << 20));
  const std::regex pattern(schema.at("properties").at("policy").at("pattern").get<std::string>());
  int taken = 0;
  for (const std::string& text : rows_of_words()) {
    const bool takes = fault_of(text) == "no error";
    EXPECT_EQ(std::regex_match(text, pattern), takes) << text;
    taken += takes;
  }
  // linear, benefit; nwa and bi with 4 selections (one of them left out); pbi with 4 tests, too.
  EXPECT_EQ(taken, 2 + 2 * 4 + 4 * 4);
}

}  // namespace
}  // namespace rimlight
