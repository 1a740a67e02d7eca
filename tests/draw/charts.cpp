#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "libslam/core/error.h"
#include "libslam/core/numbers.h"
#include "libslam/draw/box_plot.h"
#include "libslam/draw/chart_axes.h"
#include "libslam/draw/curves.h"
#include "libslam/files/files.h"
#include "libslam/testing/temp_folder.h"

namespace slam::draw {
namespace {

using ::testing::DoubleNear;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::Not;
using testing::TempFolder;

using core::kNaN;

std::vector<::testing::Matcher<double>> near(const std::vector<double>& values) {
  std::vector<::testing::Matcher<double>> matchers;
  matchers.reserve(values.size());
  for (const double value : values) matchers.push_back(DoubleNear(value, 1e-9 * std::abs(value) + 1e-12));
  return matchers;
}

TEST(Axis, FromZeroEndsAtAWholeStep) {
  const auto axis = axisFromZero(0.93);
  EXPECT_EQ(axis.low, 0);
  EXPECT_DOUBLE_EQ(axis.high, 1);
  EXPECT_EQ(axis.ticks.size(), 6U);
  EXPECT_DOUBLE_EQ(axisFromZero(93, 100).high, 100);
  EXPECT_DOUBLE_EQ(axisFromZero(0).high, 1);
  EXPECT_DOUBLE_EQ(axisFromZero(INFINITY).high, 1);
}

TEST(Axis, OfLogarithmsEndsAtRoundNumbersAndHasNoPlaceForZero) {
  const auto wide = logAxis({0.0031, 0.17, kNaN, 0, -1});
  EXPECT_DOUBLE_EQ(wide.low, 0.002);
  EXPECT_DOUBLE_EQ(wide.high, 0.2);
  EXPECT_THAT(wide.ticks, ElementsAreArray(near({0.002, 0.005, 0.01, 0.02, 0.05, 0.1, 0.2})));
  EXPECT_THAT(logAxis({0.5, 900}).ticks, ElementsAreArray(near({1, 10, 100, 1000})));
  EXPECT_THAT(logAxis({10, 10}).ticks.size(), ::testing::Ge(2U));
  EXPECT_THAT(logAxis({1, 10}).ticks, ElementsAreArray(near({1, 2, 5, 10})));
  EXPECT_DOUBLE_EQ(logAxis({1, 100}).place(10), 0.5);
  EXPECT_FALSE(std::isfinite(wide.place(0)));
  EXPECT_TRUE(std::isnan(wide.place(-1)));
}

TEST(Axis, AroundValuesFarFromZeroDoesNotReachIt) {
  const auto axis = axisAround({98, 99, kNaN});
  EXPECT_GT(axis.low, 97);
  EXPECT_LT(axis.high, 100);
  EXPECT_EQ(axisAround({1, 9}).low, 0);
  EXPECT_LT(axisAround({-3, 4}).low, -3);
  EXPECT_LT(axisAround({5}).low, 5);
}

TEST(Charts, BreakLinesDrawWhiskersAndNameEveryLabelOnce) {
  const TempFolder folder;
  const Chart chart{"time (s)",
                    "error (m)",
                    {{"icp", {{0, 0.1}, {1, 0.2}, {2, kNaN}, {3, 0.3}, {4, 0.4}}},
                     {"graph", {{0, 0.3}, {4, 0.1}}, Curve::Style::kMarked},
                     {"graph", {{0, 0.2}, {0, 0.4}}, Curve::Style::kWhisker}}};
  drawCharts({chart}, "", folder / "chart.svg");
  const auto svg = files::readTextFile(folder / "chart.svg");
  const auto count = [&](const std::string& what) {
    size_t found = 0;
    for (auto at = svg.find(what); at != std::string::npos; at = svg.find(what, at + 1)) ++found;
    return found;
  };
  EXPECT_EQ(count(">icp</text>"), 1U);
  EXPECT_EQ(count(">graph</text>"), 1U);
  EXPECT_EQ(count("stroke=\"#cc79a7\""), 3U);  // two pieces, a sample in the legend
  EXPECT_EQ(count("<circle"), 2U);
  EXPECT_EQ(count("stroke=\"#0072b2\""), 5U);  // line, whisker and its ends, sample
  EXPECT_THAT(svg, HasSubstr(">time (s)</text>"));
  EXPECT_THAT(svg, HasSubstr(">error (m)</text>"));
}

// The widest interval of all is the one that must not be left out.
TEST(Charts, AWhiskerWithoutAnUpperEndLeavesTheChartAsAnArrow) {
  const TempFolder folder;
  const Chart chart{
      "x",
      "y",
      {{"icp", {{0, 0.2}, {0, std::numeric_limits<double>::infinity()}}, Curve::Style::kWhisker},
       {"graph", {{0, 1}, {1, 1}}}}};
  drawCharts({chart}, "", folder / "open.svg");
  const auto svg = files::readTextFile(folder / "open.svg");
  EXPECT_EQ(svg.find("inf"), std::string::npos);
  EXPECT_EQ(svg.find("nan"), std::string::npos);
  size_t strokes = 0;
  for (auto at = svg.find("stroke=\"#cc79a7\""); at != std::string::npos;
       at = svg.find("stroke=\"#cc79a7\"", at + 1))
    ++strokes;
  EXPECT_EQ(strokes, 5U);  // the whisker, its foot, a head of two strokes, the legend's sample
}

TEST(Charts, LongLinesKeepTheirHighestAndLowest) {
  const TempFolder folder;
  Chart chart{"x", "y", {{"a", {}}}};
  for (int i = 0; i < 100000; ++i)
    chart.curves[0].points.push_back({1.0 * i, i == 50000 ? 10.0 : 1 + 0.1 * (i % 2)});
  drawCharts({chart}, "", folder / "long.svg");
  const auto svg = files::readTextFile(folder / "long.svg");
  EXPECT_LT(svg.size(), 100000U);
  EXPECT_THAT(svg, HasSubstr(" 50 "));  // the frame begins at 20 + 30; the axis ends at 10
}

TEST(Charts, StandUnderOneAnotherOnANarrowPage) {
  const TempFolder folder;
  const Chart chart{"x", "y", {{"a", {{0, 0}, {1, 1}}}}};
  Paper column, page;
  column.width_mm = 85, page.width_mm = 170;
  drawCharts({chart, chart}, "", folder / "column.svg", column);
  drawCharts({chart, chart}, "", folder / "page.svg", page);
  const auto heightOf = [&](const std::string& name) {
    const auto svg = files::readTextFile(folder / name);
    return std::stod(svg.substr(svg.find("height=\"") + 8));
  };
  EXPECT_GT(heightOf("column.svg"), 1.5 * heightOf("page.svg"));
  EXPECT_THROW(drawCharts({}, "", folder / "none.svg"), core::ContractError);
}

TEST(BoxFigures, AreThoseOfHand) {
  // 1 2 3 4 5 6 7 8 9 30: quartiles at ranks 2.25 and 6.75 from 0, reach 1.5 * 4.5.
  const auto figures = boxFigures({9, 30, 1, 2, 8, 3, 7, 4, 6, 5, kNaN});
  EXPECT_DOUBLE_EQ(figures.lower_quartile, 3.25);
  EXPECT_DOUBLE_EQ(figures.median, 5.5);
  EXPECT_DOUBLE_EQ(figures.upper_quartile, 7.75);
  EXPECT_DOUBLE_EQ(figures.low, 1);
  EXPECT_DOUBLE_EQ(figures.high, 9);
  EXPECT_THAT(figures.beyond, ElementsAre(30));
  EXPECT_DOUBLE_EQ(boxFigures({4}).median, 4);
  EXPECT_THROW(boxFigures({kNaN}), core::ContractError);
}

TEST(Boxes, ShowCountsAndFailuresAndFewValuesAsDots) {
  const TempFolder folder;
  const std::vector<BoxChart> charts = {
      {"flat", {{"icp", {0.1, 0.2, 0.3, 0.4, 0.5}, 0}, {"graph", {0.1, kNaN, 0.2}, 2}}},
      {"office", {{"icp", {}, 5}, {"graph", {0.1}, 0}}}};
  drawBoxes(charts, "error (m)", true, "", folder / "boxes.svg");
  const auto svg = files::readTextFile(folder / "boxes.svg");
  EXPECT_THAT(svg, HasSubstr(">n 5</text>"));
  EXPECT_THAT(svg, HasSubstr(">n 2</text>"));
  EXPECT_THAT(svg, HasSubstr(">+2 failed</text>"));
  EXPECT_THAT(svg, HasSubstr(">n 0</text>"));
  EXPECT_THAT(svg, HasSubstr(">office</text>"));
  EXPECT_THAT(svg, Not(HasSubstr("nan")));
  EXPECT_THROW(drawBoxes({}, "", false, "", folder / "none.svg"), core::ContractError);
  EXPECT_THROW(drawBoxes({{"empty", {}}}, "", false, "", folder / "none.svg"), core::ContractError);
}

}  // namespace
}  // namespace slam::draw
