#include "core/base/json_reader.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "tests/support/error_of.h"

namespace rimlight {
namespace {

using nlohmann::json;
using test::error_of;
using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::StartsWith;

std::string error_of_text(std::string_view text) {
  return error_of([&] { parse_json(text, "a.json"); });
}

/// Every accessor's error stands at /a, whatever it finds there.
template <typename Access>
std::string error_at_a(const json& value, Access&& access) {
  const json document = {{"a", value}};
  return error_of([&] { access(JsonReader(document, "a.json").member("a")); });
}

TEST(ParseJson, CommentsAreAllowed) {
  EXPECT_EQ(parse_json("// one\n{ /* two */ \"a\": 1 }", "a.json"), json({{"a", 1}}));
}

TEST(ParseJson, MalformedTextIsNamedWithLineAndColumn) {
  EXPECT_EQ(error_of_text("{\n  \"a\": 1,\n  \"b\" 2\n}"),
            "a.json: line 3, column 7: found malformed JSON, expected valid JSON");
  EXPECT_THAT(error_of_text(""), StartsWith("a.json: line 1, column 1"));
  EXPECT_THAT(error_of_text("{\"a\": 1"), StartsWith("a.json: line 1, column 7"));
  EXPECT_THAT(error_of_text("[1, 2] 3"), StartsWith("a.json: line 1, column 8"));
  EXPECT_THAT(error_of_text("[1,]"), HasSubstr("malformed"));
  EXPECT_THAT(error_of_text("[\"\xff\"]"), HasSubstr("malformed"));
  EXPECT_THAT(error_of_text("/* open"), HasSubstr("malformed"));
  EXPECT_THAT(error_of_text(std::string_view("[\0]", 3)), HasSubstr("malformed"));
}

TEST(ParseJson, NanInfinityAndNumbersThatAreTooLargeAreErrors) {
  for (const char* const text :
       {"NaN", "Infinity", "-Infinity", "[nan]", "+1", "0x10", ".5", "01"}) {
    EXPECT_THAT(error_of_text(text), HasSubstr("malformed JSON")) << text;
  }
  EXPECT_THAT(error_of_text("[1e999]"), AllOf(StartsWith("a.json"), HasSubstr("1e999")));
  EXPECT_EQ(parse_json("1e-999", "a.json"), json(0.0));
}

TEST(ParseJson, AKeyThatIsGivenTwiceIsRefusedAtAnyDepth) {
  EXPECT_EQ(error_of_text(R"({"a": 1, "b": 2, "a": 3})"),
            R"(a.json: found the key "a" twice, expected each key once in an object)");
  EXPECT_THAT(error_of_text(R"([{"x": {"k": 1, "k": 1}}])"), HasSubstr("\"k\" twice"));
  EXPECT_THAT(error_of_text(R"({"a": 1, "\u0061": 3})"), HasSubstr("\"a\" twice"));
  EXPECT_EQ(error_of_text(R"({"a": {"a": 1}, "b": [{"a": 1}, {"a": 1}]})"), "no error");
}

TEST(ParseJson, DeepNestingDoesNotExhaustTheStack) {
  constexpr std::size_t kDepth = 100'000;
  const std::string open(kDepth, '[');
  EXPECT_EQ(error_of_text(open + std::string(kDepth, ']')), "no error");
  EXPECT_THAT(error_of_text(open), HasSubstr("malformed JSON"));
  std::string objects;
  for (std::size_t i = 0; i < kDepth; ++i) objects += "{\"a\":";
  EXPECT_EQ(error_of_text(objects + "1" + std::string(kDepth, '}')), "no error");
  EXPECT_THAT(error_of_text(objects), HasSubstr("malformed JSON"));
  // And the error about such a value does not print it.
  const json deep = parse_json(open + std::string(kDepth, ']'), "a.json");
  EXPECT_EQ(error_of([&] { JsonReader(deep, "a.json").string(); }),
            "a.json: found an array, expected a string");
}

TEST(JsonReader, PointersNameTheWayAndEscapeItsSigns) {
  const json document = {{"objects", {1, {{"a/b~c", "brass"}}}}};
  const JsonReader reader(document, "a.json");
  const JsonReader member = reader.member("objects").elements()[1].member("a/b~c");
  EXPECT_EQ(member.pointer(), "/objects/1/a~1b~0c");
  EXPECT_EQ(document.at(json::json_pointer(member.pointer())), "brass");
  EXPECT_EQ(member.where(), "a.json: /objects/1/a~1b~0c");
  EXPECT_EQ(reader.where(), "a.json");
  EXPECT_EQ(error_of([&] {
              member.one_of({"copper", "gold"});
            }),
            R"(a.json: /objects/1/a~1b~0c: found "brass", expected one of "copper" "gold")");
}

TEST(JsonReader, MembersAreFoundOrTheirAbsenceIsTold) {
  const json document = {{"b", 2}, {"a", nullptr}};
  const JsonReader reader(document, "a.json");
  EXPECT_TRUE(reader.has("a"));
  EXPECT_FALSE(reader.has("c"));
  EXPECT_FALSE(reader.optional_member("c"));
  EXPECT_EQ(reader.optional_member("b")->integer(0, 9), 2);
  EXPECT_EQ(error_of([&] { reader.member("c"); }),
            R"(a.json: found no "c", expected the field "c")");
  std::vector<std::string> names;
  for (const auto& [name, member] : reader.members()) {
    names.push_back(name);
    EXPECT_EQ(member.pointer(), "/" + name);
  }
  EXPECT_THAT(names, ElementsAre("a", "b"));
}

TEST(JsonReader, WhatIsNoObjectHasNoMembers) {
  const auto expect = [](auto&& access) {
    EXPECT_EQ(error_at_a(3, access), "a.json: /a: found 3, expected an object");
    EXPECT_EQ(error_at_a(json::array(), access), "a.json: /a: found an array, expected an object");
  };
  expect([](const JsonReader& a) { a.has("x"); });
  expect([](const JsonReader& a) { a.member("x"); });
  expect([](const JsonReader& a) { a.optional_member("x"); });
  expect([](const JsonReader& a) { a.members(); });
  expect([](const JsonReader& a) { a.allow_only({"x"}); });
}

TEST(JsonReader, MisspeltFieldsAreNamed) {
  const auto allow = [](const JsonReader& a) { a.allow_only({"width", "height"}); };
  EXPECT_EQ(error_at_a({{"width", 1}}, allow), "no error");
  EXPECT_EQ(error_at_a({{"width", 1}, {"heigth", 1}}, allow),
            R"(a.json: /a: found the unknown field "heigth", expected one of "width" "height")");
}

TEST(JsonReader, ElementsAreCounted) {
  const auto two_or_three = [](const JsonReader& a) { a.elements(2, 3); };
  EXPECT_EQ(error_at_a({1, 2}, two_or_three), "no error");
  EXPECT_EQ(error_at_a({1, 2, 3}, two_or_three), "no error");
  EXPECT_EQ(error_at_a(json::array({1}), two_or_three),
            "a.json: /a: found 1 elements, expected at least 2");
  EXPECT_EQ(error_at_a({1, 2, 3, 4}, two_or_three),
            "a.json: /a: found 4 elements, expected at most 3");
  EXPECT_EQ(error_at_a({1, 2}, [](const JsonReader& a) { a.elements(3, 3); }),
            "a.json: /a: found 2 elements, expected 3");
  EXPECT_EQ(error_at_a("x", two_or_three), R"(a.json: /a: found "x", expected an array)");
}

TEST(JsonReader, BooleansAndStringsAreNotConverted) {
  const json document = {true, "text"};
  const auto elements = JsonReader(document, "a.json").elements();
  EXPECT_TRUE(elements[0].boolean());
  EXPECT_EQ(elements[1].string(), "text");
  EXPECT_EQ(error_at_a(1, [](const JsonReader& a) { a.boolean(); }),
            "a.json: /a: found 1, expected true or false");
  EXPECT_EQ(error_at_a(nullptr, [](const JsonReader& a) { a.string(); }),
            "a.json: /a: found null, expected a string");
  EXPECT_EQ(error_at_a(false, [](const JsonReader& a) { a.string(); }),
            "a.json: /a: found false, expected a string");
}

TEST(JsonReader, NumbersStayInTheirRangeAndNanIsInNone) {
  const auto unit = [](const JsonReader& a) { a.number(0, 1); };
  EXPECT_EQ(error_at_a(0, unit), "no error");
  EXPECT_EQ(error_at_a(1.0, unit), "no error");
  EXPECT_EQ(error_at_a(1.5, unit), "a.json: /a: found 1.5, expected a number from 0.0 to 1.0");
  EXPECT_EQ(error_at_a(-1e-300, unit),
            "a.json: /a: found -1e-300, expected a number from 0.0 to 1.0");
  EXPECT_EQ(error_at_a("1", unit), R"(a.json: /a: found "1", expected a number)");
  EXPECT_EQ(error_at_a(true, unit), "a.json: /a: found true, expected a number");
  const auto any = [](const JsonReader& a) { a.number(); };
  EXPECT_NE(error_at_a(std::nan(""), any), "no error");
  EXPECT_NE(error_at_a(std::numeric_limits<double>::infinity(), any), "no error");
  EXPECT_EQ(error_at_a(1e300, any), "no error");
}

TEST(JsonReader, WholeNumbersAreExactHoweverTheyAreWritten) {
  const auto read = [](std::string_view text, std::int64_t low, std::int64_t high) {
    const json document = parse_json(text, "a.json");
    return JsonReader(document, "a.json").integer(low, high);
  };
  for (const char* const text : {"2", "2.0", "2e0", "20e-1"})
    EXPECT_EQ(read(text, 0, 9), 2) << text;
  EXPECT_EQ(read("-0", 0, 9), 0);
  EXPECT_EQ(read("9223372036854775807", 0, INT64_MAX), INT64_MAX);
  EXPECT_EQ(read("-9223372036854775808", INT64_MIN, 0), INT64_MIN);
  constexpr std::int64_t k2To53 = std::int64_t{1} << 53;
  EXPECT_EQ(read("9007199254740993", 0, k2To53 + 1), k2To53 + 1);
  EXPECT_NE(error_of([&] { read("9007199254740993", 0, k2To53); }), "no error");
  for (const char* const text : {"9223372036854775808", "18446744073709551615", "1e19", "-1e19",
                                 "1e300", "0.5", "10", "-1"}) {
    EXPECT_THAT(error_of([&] { read(text, 0, 9); }), HasSubstr("a whole number from 0 to 9"))
        << text;
    if (std::string_view(text).size() > 3) {
      EXPECT_NE(error_of([&] { read(text, INT64_MIN, INT64_MAX); }), "no error") << text;
    }
  }
}

TEST(JsonReader, NumbersInAnArrayAreNamedOneByOne) {
  const auto direction = [](const JsonReader& a) { a.numbers(3, -1, 1); };
  EXPECT_EQ(error_at_a({0, 0.5, -1}, direction), "no error");
  EXPECT_EQ(error_at_a({0, 0.5}, direction), "a.json: /a: found 2 elements, expected 3");
  EXPECT_EQ(error_at_a({0, 0.5, 2}, direction),
            "a.json: /a/2: found 2, expected a number from -1.0 to 1.0");
  EXPECT_EQ(error_at_a({0, nullptr, 2}, direction), "a.json: /a/1: found null, expected a number");
}

TEST(JsonReader, NamesGiveTheirPosition) {
  const json document = "gold";
  EXPECT_EQ(JsonReader(document, "a.json").one_of({"copper", "gold"}), 1u);
  EXPECT_EQ(error_at_a(5, [](const JsonReader& a) { a.one_of({"copper"}); }),
            R"(a.json: /a: found 5, expected one of "copper")");
}

}  // namespace
}  // namespace rimlight
