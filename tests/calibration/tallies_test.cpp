#include <gtest/gtest.h>

#include "libslam/calibration/motion_series.h"
#include "libslam/calibration/range_tally.h"
#include "libslam/calibration/stamp_tally.h"
#include "libslam/calibration/thinned_sample.h"
#include "tests/doctor/drive.h"

namespace slam::calibration {
namespace {

TEST(ThinnedSample, IsExactForShortSeriesAndCloseForLongOnes) {
  ThinnedSample sample;
  EXPECT_EQ(sample.median(), 0);
  for (const double value : {5.0, 1.0, 3.0}) sample.add(value);
  EXPECT_EQ(sample.median(), 3);
  EXPECT_EQ(sample.quantile(0), 1);
  EXPECT_EQ(sample.quantile(1), 5);
  ThinnedSample ramp;
  for (int i = 0; i < 1'000'000; ++i) ramp.add(i);
  EXPECT_EQ(ramp.count(), 1'000'000U);
  EXPECT_NEAR(ramp.median(), 500'000, 50) << "32 values of a ramp lie between two that are kept";
  EXPECT_NEAR(ramp.quantile(0.95), 950'000, 100);
}

TEST(StampTally, CountsEachFaultOfAStream) {
  StampTally tally;
  for (const double time_s : {10.0, 11.0, 12.0, 11.5, 11.5, 11.5, 12.5, 42.5, 43.5}) tally.add(time_s);
  tally.add(std::nullopt);
  const auto figures = tally.figures();
  EXPECT_EQ(figures.count, 10U);
  EXPECT_EQ(figures.unstamped, 1U);
  EXPECT_EQ(figures.backward, 1U);
  EXPECT_DOUBLE_EQ(figures.largest_backward_s, 0.5);
  EXPECT_DOUBLE_EQ(figures.backward_at_s, 12);
  EXPECT_EQ(figures.repeated, 2U);
  EXPECT_DOUBLE_EQ(figures.median_period_s, 1);
  EXPECT_DOUBLE_EQ(figures.first_s, 10);
  EXPECT_DOUBLE_EQ(figures.last_s, 43.5);
  EXPECT_EQ(figures.gap_count, 0U) << "30 s are less than ten mean periods of this short stream";
}

TEST(StampTally, NamesTheLongestGapsAndCountsAll) {
  StampTally tally;
  double time_s = 0;
  for (int i = 0; i < 2000; ++i) {
    const int gap_s = 2 + i / 100;
    tally.add(time_s += i % 100 == 99 ? gap_s : 0.05);
  }
  const auto figures = tally.figures();
  EXPECT_EQ(figures.gap_count, 20U);
  ASSERT_EQ(figures.gaps.size(), 5U);
  EXPECT_NEAR(figures.gaps[0].length_s, 21, 1e-9);
  EXPECT_NEAR(figures.gaps[4].length_s, 17, 1e-9);
}

/// 20 beams; the last one reads `far_m`.
mrpt::obs::CObservation2DRangeScan plainScan(float near_m, float far_m) {
  auto scan = logs::rawScan(logs::kStart_s, "L", 20);
  scan.maxRange = 100;
  for (size_t i = 0; i < 20; ++i) scan.setScanRange(i, near_m + 0.05F * static_cast<float>(i));
  scan.setScanRange(19, far_m);
  return scan;
}

TEST(RangeTally, TakesAPileInManyBeamsForNoReturnsAndOneInFewForAWall) {
  for (const bool is_wall : {true, false}) {
    RangeTally tally;
    for (int i = 0; i < 200; ++i) {
      auto scan = plainScan(1.0F + 0.01F * static_cast<float>(i), 9.0F);
      if (!is_wall) scan.setScanRange(static_cast<size_t>(i) % 20, 9.0F);
      tally.add(scan);
    }
    EXPECT_EQ(tally.figures().spike.has_value(), !is_wall);
  }
}

TEST(RangeTally, FindsNoPileInReadingsThatThinOut) {
  RangeTally tally;
  core::RandomStream random(3, "ranges");
  for (int i = 0; i < 500; ++i) {
    auto scan = plainScan(1, 2);
    for (size_t k = 0; k < 20; ++k)
      scan.setScanRange(k, static_cast<float>(0.2 + 3 * std::abs(random.normal())));
    tally.add(scan);
  }
  EXPECT_FALSE(tally.figures().spike);
}

TEST(RangeTally, TakesAPileThatIsSpreadOverSeveralCentimetres) {
  RangeTally tally;
  for (int i = 0; i < 200; ++i) {
    auto scan = plainScan(1.0F + 0.01F * static_cast<float>(i), 3);
    for (size_t k = 0; k < 20; k += 4) scan.setScanRange(k, k % 8 == 0 ? 51.11F : 51.06F);
    tally.add(scan);
  }
  const auto spike = tally.figures().spike;
  ASSERT_TRUE(spike);
  EXPECT_NEAR(spike->low_m, 51.06, 1e-9);
  EXPECT_NEAR(spike->high_m, 51.11, 1e-9);
  EXPECT_EQ(spike->readings, 1000U);
  EXPECT_LT(spike->threshold_m, 51.06);
}

TEST(MotionSeries, MatchesABoundedNumberOfScansOfALongLog) {
  const std::uint64_t scans = 3 * MotionSeries::kMostSteps;
  MotionSeries series(scans, 0);
  lidar::Scan scan;
  scan.step_rad = 1;
  scan.ranges_m = {1, 1};
  std::uint64_t steps = 0;
  for (std::uint64_t i = 0; i < scans; ++i) {
    scan.time_s = static_cast<double>(i);
    series.addOdometry("o", {scan.time_s, {}});
    steps += series.addScan(scan) != nullptr;
  }
  series.finish();
  EXPECT_EQ(series.stretches().size(), 40U);
  EXPECT_EQ(steps, MotionSeries::kMostSteps - 40) << "the first scan of each stretch has nothing before it";
  std::size_t readings = 0;
  for (const auto& stretch : series.stretches()) readings += stretch.odometry.at("o").size();
  EXPECT_LE(readings, MotionSeries::kMostSteps + 80);
  EXPECT_GT(series.stretches().back().steps.back().to_s, 0.97 * static_cast<double>(scans));
}

TEST(OdometryCurve, IsStraightBetweenReadingsAndEndsAtGaps) {
  Stretch stretch;
  stretch.odometry["o"] = {{0, {0, 0, 3.0}}, {1, {1, 2, -3.0}}, {5, {2, 2, -3.0}}, {6, {3, 2, -3}}};
  const OdometryCurve curve(stretch, "o");
  const auto middle = curve.at(0.5);
  ASSERT_TRUE(middle);
  EXPECT_DOUBLE_EQ(middle->x, 0.5);
  EXPECT_DOUBLE_EQ(middle->y, 1);
  EXPECT_NEAR(middle->phi, core::kPi, 1e-12) << "through the back, not through zero";
  EXPECT_FALSE(curve.at(-0.1));
  EXPECT_FALSE(curve.at(6.1));
  EXPECT_FALSE(curve.at(3)) << "4 s without a reading";
  EXPECT_TRUE(curve.at(5.5));
  EXPECT_TRUE(curve.at(0.2)) << "going back in time is allowed";
  EXPECT_FALSE(OdometryCurve(stretch, "other").at(0.5));
}

}  // namespace
}  // namespace slam::calibration
