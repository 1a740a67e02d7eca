// What a lidar's readings are counted as, one scan after the other.
#include "libslam/calibration/range_tally.h"

#include <gtest/gtest.h>

#include "tests/doctor/drive.h"

namespace slam::calibration {
namespace {

/// 40 beams of so many metres, 10 m at most.
mrpt::obs::CObservation2DRangeScan scanOf(float range_m) {
  auto scan = logs::rawScan(logs::kStart_s, "L", 40);
  scan.maxRange = 10;
  for (size_t i = 0; i < 40; ++i) scan.setScanRange(i, range_m), scan.setScanRangeValidity(i, true);
  return scan;
}

TEST(RangeTally, EveryReadingIsCountedAsOneThing) {
  auto scan = scanOf(3);
  const auto set = [&](size_t beam, float range_m, bool is_valid) {
    scan.setScanRange(beam, range_m), scan.setScanRangeValidity(beam, is_valid);
  };
  set(0, 0, false), set(1, -1, true);
  set(2, std::numeric_limits<float>::quiet_NaN(), false),
      set(3, std::numeric_limits<float>::infinity(), true);
  set(4, 10, true), set(5, 12, false);
  set(6, 9.95F, false);  // flagged, and nearly as far as it sees: it met nothing
  set(7, 9.95F, true);
  set(8, 4, false);
  RangeTally tally;
  tally.add(scan);
  const auto figures = tally.figures();
  EXPECT_EQ(figures.scans, 1U);
  EXPECT_EQ(figures.readings, 40U);
  EXPECT_EQ(figures.zeros, 2U);
  EXPECT_EQ(figures.not_finite, 2U);
  EXPECT_EQ(figures.no_returns, 3U);
  EXPECT_EQ(figures.other_invalid, 1U);
  EXPECT_EQ(figures.returns, 32U);
  EXPECT_FLOAT_EQ(static_cast<float>(figures.largest_m), 12);
  EXPECT_FLOAT_EQ(static_cast<float>(figures.median_m), 3);
}

TEST(RangeTally, RunsOfEqualScansAreCountedWithLostReadings) {
  RangeTally tally;
  auto lost = scanOf(2);
  lost.setScanRange(5, std::numeric_limits<float>::quiet_NaN());
  for (const auto& scan : {scanOf(2), scanOf(2), scanOf(3), lost, lost, lost, lost, scanOf(2), scanOf(2)})
    tally.add(scan);
  EXPECT_EQ(tally.figures().duplicates, 5U);
  EXPECT_EQ(tally.figures().longest_duplicate_run, 3U);
  RangeTally shorter;  // the same readings of fewer beams are another scan
  shorter.add(scanOf(2));
  auto few = logs::rawScan(logs::kStart_s, "L", 20);
  for (size_t i = 0; i < 20; ++i) few.setScanRange(i, 2);
  shorter.add(few);
  EXPECT_EQ(shorter.figures().duplicates, 0U);
}

TEST(RangeTally, AChangeOfGeometryCountsOnceForEveryChange) {
  RangeTally tally;
  auto scan = scanOf(2);
  tally.add(scan), tally.add(scan);
  scan.sensorPose = mrpt::poses::CPose3D(0.1, 0.2, 0.5, 0.3, 0.02, -0.04);
  tally.add(scan), tally.add(scan);
  scan.maxRange = 20;
  tally.add(scan);
  const auto figures = tally.figures();
  EXPECT_EQ(figures.geometry_changes, 2U);
  EXPECT_EQ(figures.max_range_m, 10) << "of the first scan";
  EXPECT_EQ(figures.T_robot_lidar.x, 0);
  RangeTally tilted;
  scan.sensorPose = mrpt::poses::CPose3D(0.1, 0.2, 0.5, 0.3, 0.02, -0.04);
  tilted.add(scan);
  EXPECT_NEAR(tilted.figures().mount_tilt_rad, 0.04, 1e-9);
  EXPECT_NEAR(tilted.figures().mount_z_m, 0.5, 1e-9);
  EXPECT_NEAR(tilted.figures().T_robot_lidar.phi, 0.3, 1e-9);
}

TEST(RangeTally, NamesBeamsThatSayNothingNewInAllScans) {
  RangeTally tally, brief;
  for (int i = 0; i < 60; ++i) {
    auto scan = scanOf(2 + 0.05F * static_cast<float>(i));
    scan.setScanRange(3, 0), scan.setScanRangeValidity(3, false);
    scan.setScanRange(11, 10), scan.setScanRangeValidity(11, false);
    scan.setScanRange(20, 1.5F + 0.01F * static_cast<float>(i % 2));
    if (i != 30) scan.setScanRange(25, 0), scan.setScanRangeValidity(25, false);
    tally.add(scan);
    if (i < 19) brief.add(scan);
  }
  const auto figures = tally.figures();
  EXPECT_EQ(figures.dead_beams, std::vector<int>{3}) << "beam 25 gave one return";
  EXPECT_EQ(figures.silent_beams, std::vector<int>{11});
  EXPECT_EQ(figures.stuck_beams, std::vector<int>{20});
  EXPECT_TRUE(brief.figures().dead_beams.empty()) << "too few scans to say always";
  // A robot at rest: all beams are as still as that one.
  RangeTally still;
  for (int i = 0; i < 60; ++i) still.add(scanOf(2 + 0.01F * static_cast<float>(i % 3)));
  EXPECT_TRUE(still.figures().stuck_beams.empty());
  // Outdoors, where nearly nothing is met, silence says nothing of a beam.
  RangeTally open;
  for (int i = 0; i < 60; ++i) {
    auto scan = scanOf(10);
    for (size_t beam = 0; beam < 10; ++beam) scan.setScanRange(beam, 3);
    open.add(scan);
  }
  EXPECT_TRUE(open.figures().silent_beams.empty());
}

}  // namespace
}  // namespace slam::calibration
