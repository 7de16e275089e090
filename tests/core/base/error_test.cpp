#include "core/base/error.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <sstream>

#include "core/base/check.h"
#include "core/base/checked.h"
#include "core/math/random.h"

namespace rimlight {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

TEST(Error, SaysWhereWhatAndWhatInstead) {
  const Error error("scene.json: /a", "3", "a string");
  EXPECT_STREQ(error.what(), "scene.json: /a: found 3, expected a string");
  EXPECT_EQ(error.where(), "scene.json: /a");
  EXPECT_EQ(error.found(), "3");
  EXPECT_EQ(error.expected(), "a string");
}

TEST(Quote, EscapesWhatATerminalOrAQuoteWouldTakeForItself) {
  EXPECT_EQ(quote("brass"), R"("brass")");
  EXPECT_EQ(quote(""), R"("")");
  EXPECT_EQ(quote(R"(a"b\c)"), R"("a\"b\\c")");
  EXPECT_EQ(quote("a\nb\x1b[2J\x7f"), R"("a\x0ab\x1b[2J\x7f")");
  EXPECT_EQ(quote(std::string_view("\0", 1)), R"("\x00")");
  EXPECT_EQ(quote("Größe 日本 🙂"), "\"Größe 日本 🙂\"");
}

TEST(Quote, EscapesWhatIsNotUtf8) {
  EXPECT_EQ(quote("\xff"), R"("\xff")");
  EXPECT_EQ(quote("a\xc3"), R"("a\xc3")");                        // cut character
  EXPECT_EQ(quote("\xc0\xaf"), R"("\xc0\xaf")");                  // overlong
  EXPECT_EQ(quote("\xe0\x80\x80"), R"("\xe0\x80\x80")");          // overlong
  EXPECT_EQ(quote("\xed\xa0\x80"), R"("\xed\xa0\x80")");          // surrogate
  EXPECT_EQ(quote("\xf4\x90\x80\x80"), R"("\xf4\x90\x80\x80")");  // above U+10FFFF
}

TEST(Quote, CutsLongTextBetweenCharacters) {
  EXPECT_EQ(quote(std::string(80, 'a')), "\"" + std::string(80, 'a') + "\"");
  EXPECT_EQ(quote(std::string(81, 'a')), "\"" + std::string(80, 'a') + "…\"");
  EXPECT_EQ(quote(std::string(79, 'a') + "é"), "\"" + std::string(79, 'a') + "…\"");
  EXPECT_EQ(quote(std::string(78, 'a') + "é"), "\"" + std::string(78, 'a') + "é\"");
}

// Messages to clients are JSON: its writer throws at what is not UTF-8.
TEST(Quote, OfAnyBytesCanBeSentAsJson) {
  Random random(1);
  for (int trial = 0; trial < 20000; ++trial) {
    std::string text(random.below(100), '\0');
    for (char& c : text) c = static_cast<char>(random.below(2) == 0 ? random.below(256) : 'a');
    ASSERT_NO_THROW(static_cast<void>(nlohmann::json(quote(text)).dump()));
  }
}

TEST(Check, NamesTheConditionThePlaceAndBothValues) {
  try {
    RIMLIGHT_CHECK(1 + 1 == 3);
    FAIL();
  } catch (const CheckFailure& failure) {
    EXPECT_THAT(failure.what(), AllOf(HasSubstr("error_test.cpp:"), HasSubstr("1 + 1 == 3")));
  }
  try {
    const int columns = 7;
    RIMLIGHT_CHECK_EQ(columns, 8);
    FAIL();
  } catch (const CheckFailure& failure) {
    EXPECT_THAT(failure.what(), HasSubstr("columns == 8 with 7 and 8"));
  }
}

TEST(Check, PassesWhenItHolds) {
  int evaluations = 0;
  RIMLIGHT_CHECK(++evaluations == 1);
  RIMLIGHT_CHECK_EQ(++evaluations, 2);
  EXPECT_EQ(evaluations, 2);
}

TEST(Checked, ProductsAndSumsThatDoNotFitAreNothing) {
  EXPECT_EQ(checked_product(6, 7), 42u);
  EXPECT_EQ(checked_product(0, SIZE_MAX), 0u);
  EXPECT_EQ(checked_product(SIZE_MAX, 1), SIZE_MAX);
  EXPECT_EQ(checked_product(SIZE_MAX, 2), std::nullopt);
  EXPECT_EQ(checked_product(std::size_t{1} << 32, std::size_t{1} << 32), std::nullopt);
  EXPECT_EQ(checked_product((std::size_t{1} << 32) - 1, (std::size_t{1} << 32) + 1), SIZE_MAX);
  EXPECT_EQ(checked_sum(SIZE_MAX - 1, 1), SIZE_MAX);
  EXPECT_EQ(checked_sum(SIZE_MAX, 1), std::nullopt);
}

}  // namespace
}  // namespace rimlight
