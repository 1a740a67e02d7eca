#include "libslam/study/stress_charts.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "libslam/core/error.h"

namespace slam::study {
namespace {

using ::testing::HasSubstr;

template <class Work>
std::string inputErrorOf(Work work) {
  try {
    work();
  } catch (const core::InputError& e) {
    return e.what();
  }
  return "no error";
}

TEST(StressCharts, HaveALinePerMethodAndWhiskersWhereIntervalsEnd) {
  const auto table = table::fromCsv(
      "key,value,method,runs,failed,failure_rate,failure_rate_low,failure_rate_high,ate_final_m,ate_final_m_"
      "low,"
      "ate_final_m_high,broken\n"
      "lidar.fov_deg,30,graph,5,1,0.2,0.1,0.7,0.5,0.4,inf,no\n"
      "lidar.fov_deg,30,icp,5,5,1,0.5,1,inf,inf,inf,yes\n"
      "lidar.fov_deg,360,graph,5,0,0,0,0.5,0.1,0.05,0.2,no\n",
      "s.csv");
  const auto charts = stressCharts(table, "s.csv");
  ASSERT_EQ(charts.size(), 2U);
  EXPECT_EQ(charts[0].x_title, "lidar.fov (deg)");
  EXPECT_EQ(charts[0].y_title, "median ATE final (m)");
  EXPECT_FALSE(charts[0].x_log);
  // Lines of graph and icp, and graph's whiskers: one among the failed runs, one that has two ends.
  ASSERT_EQ(charts[0].curves.size(), 4U);
  EXPECT_EQ(charts[0].curves[0].points.size(), 2U);
  EXPECT_TRUE(std::isnan(charts[0].curves[1].points[0].y));
  EXPECT_EQ(charts[0].curves[2].points[0].y, 0.4);
  EXPECT_TRUE(std::isinf(charts[0].curves[2].points[1].y));
  EXPECT_EQ(charts[0].curves[3].points[0].y, 0.05);
  EXPECT_EQ(charts[1].curves.size(), 5U);
  EXPECT_THAT(
      inputErrorOf([&] { stressCharts(table::fromCsv("world,method\nflat,icp\n", "r.csv"), "r.csv"); }),
      HasSubstr("r.csv:1: names no column 'value'"));
}

}  // namespace
}  // namespace slam::study
