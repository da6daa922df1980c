#include "deltadyn/io/csv.hpp"

#include <cmath>
#include <gmock/gmock.h>

#include "deltadyn/runtime/error.hpp"

#include "io/temporary_folder.hpp"

namespace deltadyn {
namespace {

using ::deltadyn::testing_support::TemporaryFolder;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

TEST(Csv, ReadsCommentsBlanksByteOrderMarkAndWindowsLineEnds) {
  const TemporaryFolder folder;
  const std::string path = folder.write(
      "a.csv", "\xEF\xBB\xBF# made by hand\r\nname, value ,unit\r\n\r\na, +1.5e-3 ,kg\r\n# note\r\nb,-2,\r\n");
  const CsvTable table = read_csv(path);
  EXPECT_THAT(table.columns(), ElementsAre("name", "value", "unit"));
  ASSERT_EQ(table.rows(), 2u);
  EXPECT_EQ(table.text(0, 0), "a");
  EXPECT_EQ(table.text(1, 2), "");
  EXPECT_EQ(table.number(0, 1), 1.5e-3);
  EXPECT_EQ(table.number(1, 1), -2.0);
  EXPECT_EQ(table.line(0), 4);
  EXPECT_EQ(table.line(1), 6);
}

TEST(Csv, TellsTheCommentsAboveTheHeader) {
  const TemporaryFolder folder;
  const std::string path = folder.write("a.csv", "\xEF\xBB\xBF# made by hand\n\n#  version 2 \nx\n# below: 3\n1\n");
  EXPECT_EQ(read_csv(path).comment("version"), "2");
  EXPECT_EQ(CsvReader(path).comment("made"), "by hand");
  EXPECT_EQ(CsvReader(path).comment("by hand"), std::nullopt);
  EXPECT_EQ(read_csv(path).comment("below:"), std::nullopt);
}

TEST(Csv, ReadsEveryNumberExactlyAndTheLastLineWithoutLineFeed) {
  const TemporaryFolder folder;
  const CsvTable table = read_csv(folder.write("a.csv", "x\n0.1\n1e308\n4.9e-324\n-0\n1e-400\n123456789.123456789"));
  const Eigen::VectorXd x = table.numbers("x");
  ASSERT_EQ(x.size(), 6);
  EXPECT_EQ(x(0), 0.1);
  EXPECT_EQ(x(1), 1e308);
  EXPECT_EQ(x(2), 4.9e-324);
  EXPECT_TRUE(std::signbit(x(3)));
  EXPECT_EQ(x(4), 0.0);
  EXPECT_EQ(x(5), 123456789.123456789);
}

TEST(Csv, ReadsAFileLargerThanTheLineBuffer) {
  const TemporaryFolder folder;
  std::string text = "i,x\n";
  constexpr int kRows = 2500000;
  for (int i = 0; i < kRows; ++i) text += std::to_string(i) + ",0.123456789\n";
  text.pop_back();  // the last line ends without a line feed
  ASSERT_GT(text.size(), std::size_t{1} << 25);
  CsvReader reader(folder.write("big.csv", text));
  int count = 0;
  while (reader.next_row()) {
    ASSERT_EQ(reader.number(0), count);
    ++count;
    ASSERT_EQ(reader.line(), count + 1);
  }
  EXPECT_EQ(count, kRows);
}

struct BadCsv {
  const char* name;
  std::string text;
  std::vector<const char*> message;
};

class BadCsvTest : public ::testing::TestWithParam<BadCsv> {};

TEST_P(BadCsvTest, IsRefusedWithItsPlace) {
  const TemporaryFolder folder;
  const std::string path = folder.write("bad.csv", GetParam().text);
  try {
    (void)read_csv(path).numbers("x");
    FAIL() << "no error";
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ExitCode::bad_input);
    EXPECT_THAT(error.what(), HasSubstr("bad.csv"));
    for (const char* part : GetParam().message) EXPECT_THAT(error.what(), HasSubstr(part));
  }
}

INSTANTIATE_TEST_SUITE_P(
    Table, BadCsvTest,
    ::testing::Values(BadCsv{"Empty", "", {"empty"}}, BadCsv{"OnlyComments", "# a\n# b\n", {"empty"}},
                      BadCsv{"NoRows", "t,x\n# nothing\n", {"no data rows"}},
                      BadCsv{"NoHeader", "1,2\n3,4\n", {"line 1", "header line is missing"}},
                      BadCsv{"TooFewFields", "t,x\n1,2\n3\n", {"line 3", "1 fields where the header has 2"}},
                      BadCsv{"TooManyFields", "t,x\n1,2,\n", {"line 2", "3 fields where the header has 2"}},
                      BadCsv{"Text", "t,x\n1,2\n1,three\n", {"line 3", "column x", "'three' is not a number"}},
                      BadCsv{"NumberWithUnit", "t,x\n1,2 rad\n", {"line 2", "column x", "'2 rad'"}},
                      BadCsv{"DecimalComma", "t;x\n1,5;2\n", {"line 2"}},
                      BadCsv{"EmptyField", "t,x\n1,\n", {"line 2", "column x", "empty"}},
                      BadCsv{"NotANumber", "t,x\n1,nan\n", {"line 2", "column x", "'nan' is not a finite number"}},
                      BadCsv{"Infinite", "t,x\n1,-inf\n", {"line 2", "column x", "finite"}},
                      BadCsv{"TooLarge", "t,x\n1,1e999\n", {"line 2", "column x", "finite"}},
                      BadCsv{"ColumnTwice", "x,x\n1,2\n", {"line 1", "x occurs twice"}},
                      BadCsv{"ColumnWithoutName", "x,,y\n1,2,3\n", {"line 1", "column 2 has no name"}},
                      BadCsv{"ColumnMissing", "t,y\n1,2\n", {"column x is missing", "t, y"}},
                      BadCsv{"Binary", std::string("x\n1\0\n2\n", 8), {"not a text file"}}),
    [](const auto& information) { return std::string(information.param.name); });

TEST(Csv, NamesTheMissingFileAndTheFolder) {
  const TemporaryFolder folder;
  for (const std::string& path : {folder.path("missing.csv"), folder.path("")}) {
    try {
      (void)read_csv(path);
      FAIL();
    } catch (const Error& error) {
      EXPECT_EQ(error.where(), path);
      EXPECT_EQ(error.code(), ExitCode::bad_input);
    }
  }
}

}  // namespace
}  // namespace deltadyn
