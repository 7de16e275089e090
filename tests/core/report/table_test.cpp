#include "core/report/table.h"

#include <gtest/gtest.h>

#include <limits>

#include "core/base/check.h"
#include "core/base/files.h"
#include "core/report/report_page.h"
#include "tests/support/error_of.h"
#include "tests/support/temporary_folder.h"

namespace rimlight {
namespace {

using test::error_of;
using test::TemporaryFolder;

TEST(Table, NumbersAreWrittenWithTheDigitsAskedForAndWhatIsNoneIsADash) {
  EXPECT_EQ(fixed(1.005, 1), "1.0");
  EXPECT_EQ(fixed(-2, 0), "-2");
  EXPECT_EQ(significant(0.00012345, 3), "0.000123");
  EXPECT_EQ(fixed(std::numeric_limits<double>::infinity(), 2), "-");
  EXPECT_EQ(significant(std::numeric_limits<double>::quiet_NaN(), 2), "-");
}

TEST(Table, WordsStandAtTheLeftAndNumbersAtTheRightOfTheirColumns) {
  const Table table{.caption = "Two",
                    .columns = {"light", "ms"},
                    .rows = {{"ciel étoilé", "8.5"}, {"sun", "12%"}, {"-", "-"}}};
  EXPECT_FALSE(is_numeric(table, 0));
  EXPECT_TRUE(is_numeric(table, 1));
  EXPECT_EQ(to_text(table),
            "Two\n"
            "light         ms\n"
            "ciel étoilé  8.5\n"
            "sun          12%\n"
            "-              -\n");
  EXPECT_EQ(to_text({.caption = "", .columns = {"a", "b"}, .rows = {}}), "a  b\n");
  EXPECT_EQ(to_text({.caption = "", .columns = {"a"}, .rows = {{"\x1b[2J"}}}), "a\n?[2J\n");
  const Table ragged{.caption = "", .columns = {"a", "b"}, .rows = {{"1"}}};
  EXPECT_THROW((void)to_text(ragged), CheckFailure);
}

TEST(ReportPage, HoldsAllThatItShowsAndNoTextOfItIsMarkup) {
  const TemporaryFolder folder;
  write_file_atomically(folder / "error.png", std::string("\x89PNG\0\xff", 6));
  const ReportSection section{
      .title = "A <b>",
      .question = "Is \"this\" & that?",
      .remarks = {"<script>alert(1)</script>"},
      .tables = {{.caption = "c", .columns = {"name", "ms"}, .rows = {{"<i>", "1.5"}}}},
      .pictures = {folder / "error.png"}};
  const std::string page = to_html("All", {{"commit", "<u>"}}, {section});
  EXPECT_NE(page.find("<h2>A &lt;b&gt;</h2>"), std::string::npos);
  EXPECT_NE(page.find("Is &quot;this&quot; &amp; that?"), std::string::npos);
  EXPECT_NE(page.find("<td>&lt;i&gt;</td><td class=\"number\">1.5</td>"), std::string::npos);
  EXPECT_NE(page.find("<dd>&lt;u&gt;</dd>"), std::string::npos);
  EXPECT_NE(page.find("src=\"data:image/png;base64,iVBORwD/\""), std::string::npos);
  for (const char* const alien : {"<script", "<b>", "<i>", "<u>", "http:", "https:", "url("}) {
    EXPECT_EQ(page.find(alien), std::string::npos) << alien;
  }
}

TEST(ReportPage, APictureThatIsNotThereIsAnErrorThatNamesIt) {
  const ReportSection section{.pictures = {"/nowhere/error.png"}};
  EXPECT_NE(error_of([&] { (void)to_html("All", {}, {section}); }).find("/nowhere/error.png"),
            std::string::npos);
}

}  // namespace
}  // namespace rimlight
