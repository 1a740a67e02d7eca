#include "libslam/table/table.h"
#include "libslam/core/numbers.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>
#include <sstream>

#include "libslam/core/error.h"
#include "libslam/table/latex.h"
#include "libslam/table/number_text.h"
#include "libslam/table/text.h"

namespace slam::table {
namespace {

using core::kNaN;

Table comparison() {
  return {"Office",
          {{"method", "Method", 0}, {"ate_rmse_m", "ATE rmse (m)", 3}, {"time_ms", "ms per scan", 1}},
          {{"naive", 3.1, 0.04}, {"icp", 0.1499999, 12.25}, {"rbpf", kNaN, "lost"}},
          {"No truth: - ."}};
}

TEST(NumberText, HasItsDecimalsAndNoMinusBeforeNothing) {
  EXPECT_EQ(fixed(1.25, 1), "1.2");
  EXPECT_EQ(fixed(-0.001, 2), "0.00");
  EXPECT_EQ(fixed(-1.5, 2), "-1.50");
  EXPECT_EQ(fixed(1e6, 0), "1000000");
  EXPECT_EQ(fixed(std::numeric_limits<double>::quiet_NaN(), 2), "-");
  EXPECT_EQ(fixed(std::numeric_limits<double>::infinity(), 2), "inf");
}

TEST(Table, AsTextAlignsDigitsUnderEachOther) {
  EXPECT_EQ(toText(comparison()),
            "Office\n"
            "\n"
            "Method  ATE rmse (m)  ms per scan\n"
            "------  ------------  -----------\n"
            "naive          3.100          0.0\n"
            "icp            0.150         12.2\n"
            "rbpf               -         lost\n"
            "\n"
            "No truth: - .\n");
}

TEST(Table, AsMarkdownIsATableWithNumbersRight) {
  EXPECT_EQ(toMarkdown(comparison()),
            "**Office**\n"
            "\n"
            "| Method | ATE rmse (m) | ms per scan |\n"
            "| --- | ---: | ---: |\n"
            "| naive | 3.100 | 0.0 |\n"
            "| icp | 0.150 | 12.2 |\n"
            "| rbpf | - | lost |\n"
            "\n"
            "No truth: - .\n");
}

TEST(Table, AsLatexIsATableForBooktabsWithNumbersRight) {
  EXPECT_EQ(toLatex(comparison(), {"tab:office", {}}),
            "\\begin{table}\n"
            "\\centering\n"
            "\\caption{Office}\n"
            "\\label{tab:office}\n"
            "\\begin{tabular}{lrr}\n"
            "\\toprule\n"
            "Method & ATE rmse (m) & ms per scan \\\\\n"
            "\\midrule\n"
            "naive & 3.100 & 0.0 \\\\\n"
            "icp & 0.150 & 12.2 \\\\\n"
            "rbpf & -- & lost \\\\\n"
            "\\bottomrule\n"
            "\\end{tabular}\n"
            "\\par\\smallskip\\parbox{\\linewidth}{\\footnotesize No truth: - .}\n"
            "\\end{table}\n");
}

TEST(Table, AsLatexEscapesEveryCommand) {
  const Table odd = {"",
                     {{"a", "50 % & more"}},
                     {{"rbpf_exact"}, {"a\\b{c}$#~^<>|\""}, {"[1]* --plan ---"}, {"Málaga"}},
                     {}};
  EXPECT_EQ(toLatex(odd),
            "\\begin{table}\n"
            "\\centering\n"
            "\\begin{tabular}{l}\n"
            "\\toprule\n"
            "50 \\% \\& more \\\\\n"
            "\\midrule\n"
            "rbpf\\_exact \\\\\n"
            "a\\textbackslash{}b\\{c\\}\\$\\#\\textasciitilde{}\\textasciicircum{}\\textless{}\\textgreater{}"
            "\\textbar{}'' \\\\\n"
            "{[}1{]}{*} -{}-plan -{}-{}- \\\\\n"
            "Málaga \\\\\n"
            "\\bottomrule\n"
            "\\end{tabular}\n"
            "\\end{table}\n");
}

TEST(Table, AsLatexHasTheBestInBoldAsPeopleReadIt) {
  using core::kNaN;
  const Table table{
      "",
      {{"m", "method"}, {"ate_m", "ATE m", 2}, {"f1", "F1", 2}, {"n", "n", 0}, {"x_m", "x m", 0}},
      {{"a", 0.104, 0.5, 7.0, 1.0},
       {"b", 0.101, 0.9, 7.0, 2.0},
       {"c", kNaN, 0.1, 7.0, 3.0},
       {"d", 0.2, INFINITY, 7.0, 4.0}},
      {}};
  const auto text =
      toLatex(table, {"", {{"ate_m", Best::kSmallest}, {"f1", Best::kLargest}, {"n", Best::kLargest}}});
  EXPECT_NE(text.find("method & ATE (m) & F1 & n & x (m)"), std::string::npos) << text;
  // 0.104 and 0.101 are both 0.10; what all have is best in none; x has no better end.
  EXPECT_NE(text.find("a & \\textbf{0.10} & 0.50 & 7 & 1 \\\\\n"
                      "b & \\textbf{0.10} & \\textbf{0.90} & 7 & 2 \\\\\n"
                      "c & -- & 0.10 & 7 & 3 \\\\\n"
                      "d & 0.20 & $\\infty$ & 7 & 4 \\\\\n"),
            std::string::npos)
      << text;
}

TEST(Table, AsLatexFitsAnArticle) {
  Table table{"", {{"method", "method"}}, {{"naive_correlation"}}, {}};
  const auto add = [&](int columns) {
    for (int i = 0; i < columns; ++i) {
      const std::string number = std::to_string(table.columns.size());
      table.columns.push_back({"k" + number, "RPE number" + number + " deg/m", 3});
      table.rows[0].emplace_back(1.234);
    }
  };
  add(2);
  EXPECT_EQ(toLatex(table).find("tabcolsep"), std::string::npos);
  add(3);  // smaller type, titles on several lines
  const auto smaller = toLatex(table);
  EXPECT_NE(smaller.find("\\small\n\\setlength{\\tabcolsep}{4pt}\n"), std::string::npos) << smaller;
  EXPECT_NE(smaller.find("\n & RPE & RPE & RPE & RPE & RPE \\\\\n & number1 & "), std::string::npos)
      << smaller;
  add(10);  // parts, each with the method
  const auto wide = toLatex(table);
  size_t parts = 0, names = 0;
  for (auto at = wide.find("\\begin{tabular}"); at != std::string::npos;
       at = wide.find("\\begin{tabular}", at + 1))
    ++parts;
  for (auto at = wide.find("\nnaive\\_correlation & "); at != std::string::npos;
       at = wide.find("\nnaive\\_correlation & ", at + 1))
    ++names;
  EXPECT_EQ(parts, 3U) << wide;
  EXPECT_EQ(names, parts);
}

TEST(Table, AsLatexHasMathematicalSigns) {
  const Table table{"", {{"v", "v", 2}}, {{-0.001}, {-0.01}, {double(INFINITY)}, {-double(INFINITY)}}, {}};
  EXPECT_NE(toLatex(table).find("\\midrule\n0.00 \\\\\n$-$0.01 \\\\\n$\\infty$ \\\\\n$-$$\\infty$ \\\\\n"),
            std::string::npos);
}

TEST(Table, AsCsvKeepsEveryDigit) {
  EXPECT_EQ(toCsv(comparison()),
            "method,ate_rmse_m,time_ms\r\n"
            "naive,3.1,0.04\r\n"
            "icp,0.1499999,12.25\r\n"
            "rbpf,,lost\r\n");
}

TEST(Table, AsJsonKeepsTheOrderOfColumnsAndWritesNaNAsNull) {
  const auto text = toJson(comparison());
  const auto json = nlohmann::ordered_json::parse(text);
  EXPECT_EQ(json["caption"], "Office");
  EXPECT_EQ(json["columns"][1]["key"], "ate_rmse_m");
  EXPECT_EQ(json["columns"][1]["title"], "ATE rmse (m)");
  EXPECT_EQ(json["rows"][1]["ate_rmse_m"], 0.1499999);
  EXPECT_TRUE(json["rows"][2]["ate_rmse_m"].is_null());
  EXPECT_EQ(json["rows"][2]["time_ms"], "lost");
  EXPECT_EQ(json["notes"][0], "No truth: - .");
  EXPECT_EQ(json["rows"][0].begin().key(), "method");
  EXPECT_EQ(text.back(), '\n');
}

TEST(Table, EscapesWhatEachFormatWouldMisread) {
  const Table odd = {"", {{"a,b", "a|b"}}, {{"x|y"}, {"say \"hi\", you"}, {"two\nlines"}}, {}};
  EXPECT_EQ(toMarkdown(odd),
            "| a\\|b |\n"
            "| --- |\n"
            "| x\\|y |\n"
            "| say \"hi\", you |\n"
            "| two lines |\n");
  EXPECT_EQ(toCsv(odd),
            "\"a,b\"\r\n"
            "x|y\r\n"
            "\"say \"\"hi\"\", you\"\r\n"
            "\"two\nlines\"\r\n");
  EXPECT_EQ(nlohmann::json::parse(toJson(odd))["rows"][2]["a,b"], "two\nlines");
  EXPECT_EQ(nlohmann::json::parse(toJson({"caf\xE9", {}, {}, {}}))["caption"],
            "caf\xEF\xBF\xBD");  // not UTF-8
}

TEST(Table, CountsLettersNotBytes) {
  EXPECT_EQ(toText({"", {{"log", "Log"}, {"n", "n", 0}}, {{"Málaga", 1.0}, {"Intel", 22.0}}, {}}),
            "Log      n\n"
            "------  --\n"
            "Málaga   1\n"
            "Intel   22\n");
}

Table withErrorColumns(int count) {
  Table table{"", {{"m", "Method"}}, {{"icp"}}, {}};
  for (int i = 0; i < count; ++i) {
    table.columns.push_back({"k" + std::to_string(i), "position error", 3});
    table.rows[0].emplace_back(double(i));
  }
  return table;
}

TEST(Table, BreaksTitlesWhereItWouldBeWiderThanATerminal) {
  EXPECT_EQ(toText(withErrorColumns(6)),
            "        position  position  position  position  position  position\n"
            "Method     error     error     error     error     error     error\n"
            "------  --------  --------  --------  --------  --------  --------\n"
            "icp        0.000     1.000     2.000     3.000     4.000     5.000\n");
  EXPECT_EQ(toText(withErrorColumns(1)),
            "Method  position error\n"
            "------  --------------\n"
            "icp              0.000\n");
  EXPECT_EQ(toText({"", {{"m", "Method"}}, {}, {std::string(78, 'x') + " and more"}}),
            "Method\n------\n\n" + std::string(78, 'x') + "\nand more\n");
}

TEST(Table, WiderThanItsPlaceIsSetInBlocksThatNameTheirRows) {
  const Table table{
      "Caption",
      {{"w", "World"}, {"m", "Method"}, {"a", "first", 1}, {"b", "second", 1}, {"c", "third", 1}},
      {{"flat", "icp", 1.0, 2.0, 3.0}, {"flat", "graph", 4.0, 5.0, 6.0}},
      {"A note."}};
  EXPECT_EQ(toTextWithin(table, 30),
            "Caption\n"
            "\n"
            "World  Method  first  second\n"
            "-----  ------  -----  ------\n"
            "flat   icp       1.0     2.0\n"
            "flat   graph     4.0     5.0\n"
            "\n"
            "World  Method  third\n"
            "-----  ------  -----\n"
            "flat   icp       3.0\n"
            "flat   graph     6.0\n"
            "\n"
            "A note.\n");
  EXPECT_EQ(toTextWithin(table, 80), toText(table));
  EXPECT_EQ(toTextWithin(table, 80).find("third\n-----  ------  -----  ------  -----\n"), 39U);
}

TEST(Table, LongTextIsBrokenInsideItsCell) {
  const std::string reason = "the robot was kidnapped and nothing that it saw afterwards fitted the map";
  const Table table{
      "", {{"m", "Method"}, {"r", "Reason"}, {"n", "n", 0}}, {{"icp", reason, 1.0}, {"rbpf", "", 2.0}}, {}};
  EXPECT_EQ(toTextWithin(table, 50),
            "Method  Reason                       n\n"
            "------  ---------------------------  -\n"
            "icp     the robot was kidnapped and  1\n"
            "        nothing that it saw\n"
            "        afterwards fitted the map\n"
            "rbpf                                 2\n");
}

TEST(Table, NoBlockIsWiderThanItsPlaceWhereThatCanBe) {
  auto table = withErrorColumns(12);
  for (const size_t width : {40U, 60U, 80U, 120U, 400U}) {
    std::istringstream lines(toTextWithin(table, width));
    size_t figures = 0;
    for (std::string line; std::getline(lines, line);) {
      EXPECT_LE(line.size(), width);
      if (line.rfind("icp", 0) == 0)
        figures += static_cast<size_t>(std::count(line.begin(), line.end(), '.'));
    }
    EXPECT_EQ(figures, 12U) << width;  // none is lost, none comes twice
  }
  EXPECT_NE(toTextWithin({"", {{"a", std::string(90, 'x')}}, {{"y"}}, {}}, 40), "");
}

TEST(Table, ShowsNoNegativeZeroAndNamesInfinity) {
  const Table table{"", {{"v", "v", 2}}, {{-0.001}, {-0.01}, {double(INFINITY)}, {-double(INFINITY)}}, {}};
  EXPECT_EQ(toText(table), "    v\n-----\n 0.00\n-0.01\n  inf\n -inf\n");
  EXPECT_EQ(toCsv(table), "v\r\n-0.001\r\n-0.01\r\ninf\r\n-inf\r\n");
  EXPECT_TRUE(nlohmann::json::parse(toJson(table))["rows"][2]["v"].is_null());
}

TEST(Table, ShowsThatAPValueIsNotZero) {
  Table table;
  table.columns = {{"p", "p", 3, true}, {"error_m", "error", 3}};
  table.rows = {{0.0004, 0.0004}, {0.0, 0.0}, {0.0006, 1.0}, {std::nan(""), -0.0004}};
  EXPECT_EQ(toMarkdown(table),
            "| p | error |\n| ---: | ---: |\n| <0.001 | 0.000 |\n| 0.000 | 0.000 |\n| 0.001 | 1.000 |\n"
            "| - | 0.000 |\n");
  EXPECT_NE(toLatex(table).find("\\textless{}0.001"), std::string::npos);
  EXPECT_EQ(toCsv(table).find('<'), std::string::npos);
}

TEST(Table, LeavesNoBlanksAtTheEndsOfLines) {
  EXPECT_EQ(toText({"", {{"a", "A"}, {"b", "B"}}, {{"x", "long"}, {"y", "s"}}, {}}),
            "A  B\n-  ----\nx  long\ny  s\n");
}

TEST(Table, WithoutRowsHasItsTitlesOnly) {
  const Table none{"", {{"a", "A"}, {"b", "B"}}, {}, {}};
  EXPECT_EQ(toText(none), "A  B\n-  -\n");
  EXPECT_EQ(toCsv(none), "a,b\r\n");
  EXPECT_EQ(nlohmann::json::parse(toJson(none))["rows"].size(), 0U);
}

TEST(Table, RefusesARaggedRowAndAKeyTwice) {
  auto ragged = comparison();
  ragged.rows[1] = {"icp", 0.15};
  const Table twice{"", {{"a", "A"}, {"a", "B"}}, {}, {}};
  for (const auto format :
       {toText, toMarkdown, static_cast<std::string (*)(const Table&)>(toLatex), toCsv, toJson}) {
    EXPECT_THROW(format(ragged), core::ContractError);
    EXPECT_THROW(format(twice), core::ContractError);
  }
  try {
    toText(ragged);
  } catch (const core::ContractError& e) {
    EXPECT_STREQ(e.what(), "table 'Office': row 1 has 2 cells, expected 3");
  }
}

TEST(Table, MarkdownReadsBackAsItWasSeen) {
  const Table table{"A | B",
                    {{"method", "method"}, {"m", "final | m", 2}},
                    {{std::string("a|b"), 0.125}, {std::string("c"), std::nan("")}},
                    {"First note.", "Second | note."}};
  const auto read = fromMarkdown(toMarkdown(table));
  EXPECT_EQ(toMarkdown(read), [&] {
    auto text = toMarkdown(table);  // read back all is text, on the left
    text.replace(text.find("---:"), 4, "---");
    return text;
  }());
  EXPECT_EQ(read.caption, "A | B");
  EXPECT_EQ(std::get<std::string>(read.rows[1][1]), "-");
  EXPECT_TRUE(fromMarkdown("").rows.empty());
}

TEST(Table, CsvReadsBack) {
  const Table table{
      "", {{"a,b", "a"}, {"n", "n"}}, {{"say \"hi\",\nyou", 0.1}, {"", kNaN}, {"x", INFINITY}}, {}};
  const auto read = fromCsv(toCsv(table), "t.csv");
  EXPECT_EQ(toCsv(read), toCsv(table));
  EXPECT_EQ(read.columns[0].key, "a,b");
  EXPECT_EQ(std::get<std::string>(read.rows[0][0]), "say \"hi\",\nyou");
  EXPECT_EQ(std::get<double>(read.rows[0][1]), 0.1);
  EXPECT_TRUE(std::isnan(std::get<double>(read.rows[1][1])));
  EXPECT_EQ(fromCsv("a\n1\n2", "t.csv").rows.size(), 2U);  // line feeds alone, the last one missing
}

TEST(Table, CsvThatIsBrokenNamesFileAndLine) {
  const auto message = [](const std::string& csv) -> std::string {
    try {
      fromCsv(csv, "t.csv");
    } catch (const core::InputError& e) {
      return e.what();
    }
    return "";
  };
  EXPECT_EQ(message(""), "t.csv: is empty, expected a header and rows");
  EXPECT_EQ(message("a,b\n\"x\ny\",2\n3\n"), "t.csv:4: found 1 fields, expected 2 as in the header");
  EXPECT_EQ(message("a\n\"x"), "t.csv:2: a quoted field has no end, expected '\"'");
}

}  // namespace
}  // namespace slam::table
