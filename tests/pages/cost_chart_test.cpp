#include "libslam/pages/cost_chart.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "libslam/core/error.h"
#include "libslam/testing/error_of.h"
#include "tests/pages/curve_of.h"

namespace slam::pages {
namespace {

/// Scan by scan 1 ms, in the second half 3 ms, and every fiftieth ten times that.
report::ReportPage pageOf(const std::string& method, std::size_t scans) {
  report::ReportPage page;
  report::ReportRun run;
  run.method = method;
  for (std::size_t i = 0; i < scans; ++i) {
    run.scan_time_s.push_back(0.2 * static_cast<double>(i));
    run.scan_ms.push_back((i < scans / 2 ? 1 : 3) * (i % 50 == 49 ? 10 : 1));
  }
  page.runs.push_back(run);
  return page;
}

TEST(CostChart, DrawsTheMeanAndTheQuantileOfEachHundredthOfTheScans) {
  const auto chart = costChart({pageOf("graph", 10000)}, {"runs/out"}, false);
  const auto& mean = curveOf(chart, "graph, mean").points;
  ASSERT_EQ(mean.size(), 100U);
  EXPECT_EQ(mean.front().x, 50);
  EXPECT_EQ(mean.back().x, 9950);
  EXPECT_DOUBLE_EQ(mean.front().y, 1.18);  // 2 of 100 take 10 ms
  EXPECT_DOUBLE_EQ(mean.back().y, 3 * 1.18);
  EXPECT_EQ(curveOf(chart, "graph, 99 %").points[10].y, 10);
  EXPECT_EQ(curveOf(chart, "graph, 99 %").points[90].y, 30);
  EXPECT_FALSE(chart.y_log);
}

TEST(CostChart, CountsManyScansInThousands) {
  const auto chart = costChart({pageOf("graph", 20000)}, {"out"}, false);
  EXPECT_EQ(chart.x_title, "scan (thousands)");
  EXPECT_EQ(curveOf(chart, "graph, mean").points.back().x, 19.9);
  EXPECT_EQ(costChart({pageOf("graph", 10000)}, {"out"}, false).x_title, "scan");
}

TEST(CostChart, OfAShortLogHasAtLeastTenScansToAPoint) {
  EXPECT_EQ(curveOf(costChart({pageOf("icp", 45)}, {"o"}, true), "icp, mean").points.size(), 4U);
  const auto three = costChart({pageOf("icp", 3)}, {"o"}, true);
  EXPECT_EQ(curveOf(three, "icp, mean").points.size(), 1U);
  EXPECT_TRUE(three.y_log);
}

TEST(CostChart, OfSeveralFoldersNamesThem) {
  const auto chart =
      costChart({pageOf("graph", 100), pageOf("graph", 100)}, {"runs/monday/", "./tuesday"}, false);
  EXPECT_EQ(chart.curves.size(), 4U);
  curveOf(chart, "graph monday, mean");
  curveOf(chart, "graph tuesday, 99 %");
}

TEST(CostChart, SaysWhichFolderHasNoTimes) {
  EXPECT_THAT(testing::errorOf([] { costChart({pageOf("x", 0)}, {"out"}, false); }),
              ::testing::StartsWith("out: has no times to draw"));
  EXPECT_THROW(costChart({pageOf("x", 9)}, {}, false), core::ContractError);
}

}  // namespace
}  // namespace slam::pages
