#include "libslam/pages/coverage_chart.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>

#include "libslam/core/error.h"
#include "libslam/stats/consistency.h"
#include "libslam/testing/error_of.h"
#include "tests/pages/curve_of.h"

namespace slam::pages {
namespace {

using slam::testing::errorOf;
using ::testing::HasSubstr;

/// NEES as true covariances leave it: the quantiles of the chi-squared distribution.
std::vector<double> trueNees(int count, double times = 1) {
  std::vector<double> nees;
  nees.reserve(static_cast<size_t>(count));
  for (int i = 0; i < count; ++i) nees.push_back(times * stats::chiSquaredQuantile((i + 0.5) / count, 3));
  return nees;
}

report::ReportPage pageWith(const std::string& method, std::vector<double> online,
                            std::vector<double> final_poses = {}) {
  report::ReportPage page;
  report::ReportRun run;
  run.method = method;
  run.nees = std::move(online), run.nees_final = std::move(final_poses);
  page.runs.push_back(run);
  return page;
}

TEST(CoverageChart, TrueCovariancesLieOnTheDiagonal) {
  const auto chart = coverageChart({pageWith("graph", trueNees(1000), trueNees(1000, 4))}, "out");
  for (const auto& p : curveOf(chart, "graph online").points) EXPECT_NEAR(p.y, p.x, 1e-3);
  // Errors of twice the size are overconfident: below it.
  for (const auto& p : curveOf(chart, "graph final").points)
    EXPECT_LT(p.y, p.x > 0.1 && p.x < 0.95 ? p.x - 0.05 : p.x + 1e-3);
  EXPECT_EQ(curveOf(chart, "consistent").points.size(), 2U);
}

TEST(CoverageChart, ErrorsThatASingularCovarianceExcludesAreInNoEllipsoid) {
  auto nees = trueNees(50);
  nees.insert(nees.end(), 50, std::numeric_limits<double>::infinity());
  const auto chart = coverageChart({pageWith("icp", nees)}, "out");
  const auto& points = curveOf(chart, "icp online").points;
  EXPECT_NEAR(points[points.size() - 2].y, 0.49, 0.02);
  EXPECT_EQ(points.back().y, 1);
}

TEST(CoverageChart, RunsOfOneMethodAreOneLineWithIntervals) {
  std::vector<report::ReportPage> pages;
  const auto whiskers = [&] {
    int count = 0;
    for (const auto& curve : coverageChart(pages, "out").curves)
      count += curve.style == draw::Curve::Style::kWhisker;
    return count;
  };
  pages = {pageWith("graph", trueNees(100)), pageWith("graph", trueNees(100, 0.5))};
  EXPECT_EQ(coverageChart(pages, "out").curves.size(), 2U);
  EXPECT_EQ(whiskers(), 0);
  pages.push_back(pageWith("graph", trueNees(100, 0.8)));
  EXPECT_EQ(whiskers(), 2);
}

TEST(CoverageChart, NeedsCovariancesAndATruth) {
  EXPECT_THAT(errorOf([] { coverageChart({pageWith("naive", {})}, "out"); }),
              HasSubstr("out: has no covariances to draw"));
}

}  // namespace
}  // namespace slam::pages
