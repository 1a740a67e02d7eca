#include "libslam/files/csv.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "libslam/files/files.h"
#include "libslam/testing/error_of.h"
#include "libslam/testing/temp_folder.h"

namespace slam::files {
namespace {

using slam::testing::errorOf;
using ::testing::ElementsAre;

using Records = std::vector<std::vector<std::string>>;

const std::string kPath = "t.csv";

Records recordsOf(const std::string& text) {
  CsvReader reader(text, kPath);
  Records records;
  for (std::vector<std::string> fields; reader.next(fields);) records.push_back(fields);
  return records;
}

std::string quoted(const std::string& field) {
  std::string text = "\"";
  for (const char c : field) text += c == '"' ? "\"\"" : std::string(1, c);
  return text + "\"";
}

TEST(CsvReader, FieldsStandBetweenCommas) {
  EXPECT_EQ(recordsOf("a,b\n1, 2 \n"), (Records{{"a", "b"}, {"1", " 2 "}}));
  EXPECT_EQ(recordsOf("a,,\n,"), (Records{{"a", "", ""}, {"", ""}}));
}

TEST(CsvReader, AnEmptyTextHasNoRecordAndAnEmptyLineHasOneEmptyField) {
  EXPECT_EQ(recordsOf(""), Records{});
  EXPECT_EQ(recordsOf("\n\r\na"), (Records{{""}, {""}, {"a"}}));
}

TEST(CsvReader, LinesEndAsTheyLikeAndTheLastNeedsNoEnd) {
  EXPECT_EQ(recordsOf("a,b\r\n1,2\n3,4"), (Records{{"a", "b"}, {"1", "2"}, {"3", "4"}}));
  EXPECT_EQ(recordsOf("\"a\"\r\n1\r"), (Records{{"a"}, {"1"}}));
  EXPECT_EQ(recordsOf("a\rb,c"), (Records{{"a\rb", "c"}}));
}

TEST(CsvReader, QuotesHoldCommasLineEndsAndQuotes) {
  EXPECT_EQ(recordsOf("\"a,b\",\"c\nd\",\"say \"\"e\"\"\"\n1,2,3\n"),
            (Records{{"a,b", "c\nd", "say \"e\""}, {"1", "2", "3"}}));
  EXPECT_EQ(recordsOf("\"\",\"\"\"\""), (Records{{"", "\""}}));
}

// A message of somebody else's library in a journal, which nobody quoted.
TEST(CsvReader, AQuoteInsideOfAFieldIsItself) {
  EXPECT_EQ(recordsOf("5\" long,no \"end\n1,2\n"), (Records{{"5\" long", "no \"end"}, {"1", "2"}}));
}

TEST(CsvReader, WhatIsQuotedComesBack) {
  for (const std::string field : {"", "a", ",", "\n", "\"", "\"\"", "a\r\nb", "\",\"", " x "}) {
    const Records records = recordsOf(quoted(field) + "," + quoted(field) + "\r\nend\n");
    EXPECT_EQ(records, (Records{{field, field}, {"end"}}));
  }
}

TEST(CsvReader, SaysWhereARecordBeginsAndHowItStoodThere) {
  const std::string text = "a,\"b\nc\"\r\nd\n";
  CsvReader reader(text, kPath);
  std::vector<std::string> fields;
  ASSERT_TRUE(reader.next(fields));
  EXPECT_EQ(reader.place(), "t.csv:1");
  EXPECT_EQ(reader.record(), "a,\"b\nc\"");
  ASSERT_TRUE(reader.next(fields));
  EXPECT_EQ(reader.line(), 3);
  EXPECT_EQ(reader.record(), "d");
  EXPECT_FALSE(reader.next(fields));
  CsvReader part("\nx", kPath, 7);
  part.next(fields), part.next(fields);
  EXPECT_EQ(part.place(), "t.csv:8");
}

TEST(CsvReader, AQuotedFieldWithoutAnEndIsBadInput) {
  EXPECT_EQ(errorOf([] { recordsOf("a\nb,\"c\nd"); }), "t.csv:2: a quoted field has no end, expected '\"'");
}

TEST(CsvNumber, IsFinite) {
  EXPECT_EQ(csvNumber("-1.5e3", "t.csv:2"), -1500);
  for (const std::string field : {"", "x", "1 ", "nan", "inf"})
    EXPECT_EQ(errorOf([&] { csvNumber(field, "t.csv:2"); }),
              "t.csv:2: found '" + field + "', expected a number");
}

TEST(CsvTable, GivesColumnsByTheirNames) {
  const CsvTable table("time_s,why,x_m\n1,left,\n\n2.5,\"a, b\",-3\n", kPath);
  EXPECT_THAT(table.names(), ElementsAre("time_s", "why", "x_m"));
  EXPECT_EQ(table.rows().size(), 2U);
  EXPECT_THAT(table.numbers("time_s"), ElementsAre(1, 2.5));
  EXPECT_THAT(table.texts("why"), ElementsAre("left", "a, b"));
  const auto x_m = table.numbersOrNan("x_m");
  EXPECT_TRUE(std::isnan(x_m.at(0)));
  EXPECT_EQ(x_m.at(1), -3);
  EXPECT_TRUE(table.has("why"));
  EXPECT_FALSE(table.has("y_m"));
}

TEST(CsvTable, NeedsNoRows) {
  EXPECT_THAT(CsvTable("a,b", kPath).numbers("b"), ElementsAre());
}

TEST(CsvTable, ReadsAFile) {
  const testing::TempFolder folder;
  writeFileAtomically(folder / "t.csv", "a\n1\n");
  EXPECT_THAT(CsvTable::read(folder / "t.csv").numbers("a"), ElementsAre(1));
}

TEST(CsvTable, SaysWhereItIsBroken) {
  const auto error = [](const std::string& text, const std::string& column) {
    return errorOf([&] { CsvTable(text, kPath).numbers(column); });
  };
  EXPECT_EQ(error("", "a"), "t.csv: is empty, expected a header and rows");
  EXPECT_EQ(error("a,b\n\n1\n", "a"), "t.csv:3: found 1 fields, expected 2 as in the header");
  EXPECT_EQ(error("a,b\n1,2,3\n", "a"), "t.csv:2: found 3 fields, expected 2 as in the header");
  EXPECT_EQ(error("speed,b\n", "sped"), "t.csv:1: names no column 'sped'; did you mean 'speed'?");
  EXPECT_EQ(error("a\n\n1\nx\n", "a"), "t.csv:4: a: found 'x', expected a number");
  EXPECT_EQ(error("a,b\n,1\n", "a"), "t.csv:2: a: found '', expected a number");
  EXPECT_EQ(errorOf([] { CsvTable("a\nx\n", kPath).numbersOrNan("a"); }),
            "t.csv:2: a: found 'x', expected a number");
}

}  // namespace
}  // namespace slam::files
