#include "libslam/doctor/log_check.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>

#include "tests/doctor/drive.h"

namespace slam::doctor {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;
using ::testing::StartsWith;

TEST(LogCheck, AHealthyLogGetsNotesOnly) {
  const auto& result = healthy();
  EXPECT_EQ(complaints(result.findings), "");
  EXPECT_TRUE(result.isUsable());
  EXPECT_EQ(result.warnings(), 0);
  EXPECT_THAT(said(result.findings, "format"), HasSubstr("MRPT rawlog, observations only, 899 objects"));
  EXPECT_THAT(said(result.findings, "lidar"),
              HasSubstr("300 scans of 181 beams over 180.00 deg (as the log says)"));
  // Everything that the log states is found again from its scans. Tolerances: about three times the scatter
  // seen over seeds of the noise.
  const auto& f = result.figures;
  ASSERT_TRUE(f.view.is_observable);
  EXPECT_NEAR(f.view.factor.value, 1, 0.01);
  ASSERT_EQ(f.best_odometry, 0);
  ASSERT_TRUE(f.odometry[0].clock.is_observable);
  EXPECT_NEAR(f.odometry[0].clock.offset_s.value, 0, 0.02);
  ASSERT_TRUE(f.fit.has_path && f.fit.has_turns && f.fit.has_position);
  EXPECT_NEAR(f.fit.distance_scale.value, 1, 0.02);
  EXPECT_NEAR(f.fit.turn_scale.value, 1, 0.02);
  EXPECT_NEAR(f.fit.drift_rad_per_m.value, 0, core::degToRad(0.5));
  EXPECT_NEAR(f.fit.lidar_x_m.value, 0, 0.01);
  EXPECT_NEAR(f.fit.lidar_y_m.value, 0, 0.01);
  EXPECT_NEAR(f.fit.lidar_yaw_rad.value, 0, core::degToRad(0.5));
  EXPECT_EQ(f.unmatched_pairs, 0U);
}

TEST(LogCheck, SaysTheSameOfEitherForm) {
  Drive drive;
  drive.distance_scale = 1.2;
  const auto bare = check(drive);
  drive.is_action_form = true;
  const auto framed = check(drive);
  EXPECT_THAT(said(framed.findings, "format"), HasSubstr("action / sensory frame"));
  EXPECT_THAT(said(framed.findings, "odometry"), HasSubstr("'actions': 300 readings"));
  EXPECT_NEAR(framed.figures.fit.distance_scale.value, bare.figures.fit.distance_scale.value, 0.01);
  EXPECT_THAT(said(framed.findings, "scale"), StartsWith("warning"));
}

TEST(LogCheck, FindsAFieldOfViewThatIsWrong) {
  for (const double factor : {0.5, 2.0, 1.1}) {
    Drive drive;
    drive.step_factor = factor;
    const auto result = check(drive);
    ASSERT_TRUE(result.figures.view.is_observable) << factor << ", " << result.figures.view.pairs << " pairs";
    EXPECT_NEAR(result.figures.view.factor.value, 1 / factor, 0.02 / factor);
    EXPECT_THAT(said(result.findings, "view"), HasSubstr("error: field of view")) << factor;
    EXPECT_THAT(said(result.findings, "view"), HasSubstr("--step 1 (degrees")) << factor;
    EXPECT_FALSE(result.isUsable());
    EXPECT_THAT(said(result.findings, "mounting"), HasSubstr("cannot tell"));
  }
}

TEST(LogCheck, DoesNotJudgeTheViewOfARobotAtRest) {
  Drive drive;
  drive.scans = 100;
  drive.period_s = 1e-3;  // it moves 5 cm in all
  drive.odometry_period_s = 1e-3;
  const auto result = check(drive);
  EXPECT_FALSE(result.figures.view.is_observable);
  EXPECT_THAT(said(result.findings, "view"), HasSubstr("note: field of view 180.00 deg: not checked"));
  EXPECT_THAT(said(result.findings, "clock"), HasSubstr("cannot be told"));
  EXPECT_THAT(said(result.findings, "scale"), HasSubstr("cannot be told"));
  EXPECT_THAT(said(result.findings, "mounting"), HasSubstr("cannot tell"));
}

TEST(LogCheck, FindsTheClockOffset) {
  for (const double lead_s : {0.35, -0.6}) {
    Drive drive;
    drive.lead_s = lead_s;
    // An odometer cannot report before it is switched on: the curve begins at rest.
    const auto result = check(drive);
    const auto& clock = result.figures.odometry[0].clock;
    ASSERT_TRUE(clock.is_observable);
    EXPECT_NEAR(clock.offset_s.value, lead_s, 0.02);
    EXPECT_TRUE(clock.offset_s.covers(clock.offset_s.value));
    EXPECT_LT(clock.offset_s.width(), 0.1);
    EXPECT_THAT(said(result.findings, "clock"), StartsWith("warning"));
    EXPECT_THAT(said(result.findings, "clock"), HasSubstr(lead_s > 0 ? "leads the scans by" : "lags behind"));
    EXPECT_THAT(said(result.findings, "clock"), HasSubstr("--shift 'ODOMETRY="));
    // With the clocks put right the other figures are as good as ever.
    EXPECT_NEAR(result.figures.fit.turn_scale.value, 1, 0.02);
  }
}

TEST(LogCheck, FindsTheClockOffsetOfIncrementsToo) {
  Drive drive;
  drive.is_action_form = true;
  drive.lead_s = 0.6;
  const auto result = check(drive);
  ASSERT_TRUE(result.figures.odometry[0].clock.is_observable);
  EXPECT_NEAR(result.figures.odometry[0].clock.offset_s.value, 0.6, 0.03);
  EXPECT_THAT(said(result.findings, "clock"), HasSubstr("rasterslam convert")) << "no label to shift";
}

TEST(LogCheck, MeasuresTheOdometryAgainstTheScans) {
  Drive drive;
  drive.distance_scale = 0.8;
  drive.turn_scale = 1.15;
  drive.drift_rad_per_m = core::degToRad(4.0);
  const auto result = check(drive);
  const auto& fit = result.figures.fit;
  EXPECT_NEAR(fit.distance_scale.value, 0.8, 0.02);
  EXPECT_NEAR(fit.turn_scale.value, 1.15, 0.02);
  EXPECT_NEAR(fit.drift_rad_per_m.value, core::degToRad(4.0), core::degToRad(0.5));
  EXPECT_THAT(said(result.findings, "scale"), HasSubstr("warning: 'ODOMETRY' measures "));
  EXPECT_THAT(said(result.findings, "heading"), HasSubstr("warning: it turns 1.1"));
}

TEST(LogCheck, RecognisesOdometryInOtherUnits) {
  Drive drive;
  drive.touch_odometry = [](int, mrpt::obs::CObservationOdometry& odometry) {
    odometry.odometry = mrpt::poses::CPose2D(1000 * odometry.odometry.x(), 1000 * odometry.odometry.y(),
                                             odometry.odometry.phi());
    return true;
  };
  EXPECT_THAT(said(check(drive).findings, "scale"), HasSubstr("in millimetres: divide by 1000"));
}

TEST(LogCheck, FindsWhereTheLidarIs) {
  Drive drive;
  drive.T_robot_lidar = {0.25, -0.1, core::degToRad(6.0)};
  const auto wrong = check(drive);
  EXPECT_NEAR(wrong.figures.fit.lidar_x_m.value, 0.25, 0.02);
  EXPECT_NEAR(wrong.figures.fit.lidar_y_m.value, -0.1, 0.02);
  EXPECT_NEAR(wrong.figures.fit.lidar_yaw_rad.value, core::degToRad(6.0), core::degToRad(0.6));
  EXPECT_THAT(said(wrong.findings, "mounting"), HasSubstr("warning: x 0.000 m, y 0.000 m"));
  EXPECT_THAT(said(wrong.findings, "mounting"), HasSubstr("--mount"));
  drive.T_stated = drive.T_robot_lidar;
  EXPECT_THAT(said(check(drive).findings, "mounting"),
              StartsWith("note: x 0.250 m, y -0.100 m, yaw 6.00 deg"));
}

TEST(LogCheck, DoubtsAMountingOutsideOfTheRobotAndATiltedLidar) {
  Drive drive;
  drive.scans = 40;
  drive.T_stated = {250, 0, 0};  // millimetres
  EXPECT_THAT(said(check(drive).findings, "mounting"), HasSubstr("warning: x 250.000 m"));
  drive.T_stated = {};
  drive.touch_scan = [](int, mrpt::obs::CObservation2DRangeScan& scan) {
    scan.sensorPose.setFromValues(0, 0, 0.3, 0, 0.1, 0);
    return true;
  };
  EXPECT_THAT(said(check(drive).findings, "mounting"), HasSubstr("warning: the lidar is tilted by 5.7 deg"));
}

TEST(LogCheck, FindsTheNoReturnValueWhateverTheLogSaysOfIt) {
  Drive drive;
  drive.no_return_m = 81.83F;
  const auto marked = check(drive);
  EXPECT_THAT(said(marked.findings, "no_return"), HasSubstr("note: no-return value found at 81.83 m"));
  drive.marks_no_returns = false;
  const auto unmarked = check(drive);
  ASSERT_TRUE(unmarked.figures.ranges.spike);
  EXPECT_EQ(unmarked.figures.ranges.spike->readings, unmarked.figures.ranges.spike->as_returns);
  EXPECT_THAT(said(unmarked.findings, "no_return"), HasSubstr("gets walls at 81.83 m"));
  EXPECT_THAT(said(unmarked.findings, "no_return"), HasSubstr("--no-return 81.83"));
  // What is found is used: the walls at 81.83 m do not spoil the matching.
  EXPECT_NEAR(unmarked.figures.fit.distance_scale.value, 1, 0.02);
  EXPECT_TRUE(unmarked.isUsable());
}

TEST(LogCheck, CountsLostReadings) {
  EXPECT_EQ(said(healthy().findings, "lost"), "");
  Drive drive;
  drive.touch_scan = [](int, mrpt::obs::CObservation2DRangeScan& scan) {
    for (size_t i = 0; i < 60; ++i) {
      scan.setScanRange(i, i < 50 ? 0.0F : std::numeric_limits<float>::quiet_NaN());
      scan.setScanRangeValidity(i, false);
    }
    return true;
  };
  const auto result = check(drive);
  EXPECT_EQ(result.figures.ranges.zeros, 300U * 50);
  EXPECT_EQ(result.figures.ranges.not_finite, 300U * 10);
  EXPECT_THAT(said(result.findings, "lost"), HasSubstr("warning: 18000 of 54300 readings (33.1 %) are lost"));
  EXPECT_THAT(said(result.findings, "beams"), HasSubstr("60 of 181 beams never give a reading: 0 to 59"));
}

TEST(LogCheck, FindsBeamsThatAlwaysSayTheSame) {
  EXPECT_EQ(said(healthy().findings, "beams"), "");
  Drive drive;
  drive.touch_scan = [](int number, mrpt::obs::CObservation2DRangeScan& scan) {
    for (const size_t beam : {3, 4, 90})
      scan.setScanRange(beam, 0.3F + 0.01F * static_cast<float>(number % 2));
    scan.setScanRange(7, 30);
    scan.setScanRangeValidity(7, false);
    return true;
  };
  const auto result = check(drive);
  EXPECT_THAT(said(result.findings, "beams"),
              HasSubstr("3 of 181 beams always give the same reading (to 3 cm): 3 to 4, 90"));
  EXPECT_THAT(said(result.findings, "beams"), HasSubstr("1 of 181 beams never meet anything: 7"));
}

TEST(LogCheck, FindsRepeatedScans) {
  EXPECT_EQ(said(healthy().findings, "duplicates"), "");
  Drive drive;
  mrpt::obs::CObservation2DRangeScan before;
  drive.touch_scan = [&before](int number, mrpt::obs::CObservation2DRangeScan& scan) {
    if (number % 3 != 0)
      for (size_t i = 0; i < scan.getScanSize(); ++i) scan.setScanRange(i, before.getScanRange(i));
    before = scan;
    return true;
  };
  EXPECT_THAT(
      said(check(drive).findings, "duplicates"),
      HasSubstr("warning: 200 of 300 scans repeat the scan before reading by reading, up to 2 in a row"));
}

TEST(LogCheck, FindsOdometryThatJumpsOrNeverMoves) {
  Drive drive;
  drive.touch_odometry = [](int number, mrpt::obs::CObservationOdometry& odometry) {
    if (number >= 300) odometry.odometry.x(odometry.odometry.x() + 5);
    return true;
  };
  const auto result = check(drive);
  EXPECT_EQ(result.figures.odometry[0].jumps, 1U);
  EXPECT_THAT(said(result.findings, "jumps"), HasSubstr("1 steps too far for a robot, the largest 4.9"));
  EXPECT_EQ(said(healthy().findings, "jumps"), "");
  EXPECT_THAT(said(result.findings, "disagree"), StartsWith("warning"));
  EXPECT_EQ(said(healthy().findings, "disagree"), "");
  drive.touch_odometry = [](int, mrpt::obs::CObservationOdometry& odometry) {
    odometry.odometry = mrpt::poses::CPose2D(1, 2, 3);
    return true;
  };
  EXPECT_THAT(said(check(drive).findings, "odometry"), HasSubstr("warning: 'ODOMETRY' never moves"));
}

TEST(LogCheck, FindsScansThatFitNowhere) {
  Drive drive;
  core::RandomStream random(1, "elsewhere");
  drive.touch_scan = [&random](int number, mrpt::obs::CObservation2DRangeScan& scan) {
    if (number % 4 == 0)
      for (size_t i = 0; i < scan.getScanSize(); ++i)
        scan.setScanRange(i, static_cast<float>(random.uniform(0.5, 8)));
    return true;
  };
  EXPECT_THAT(said(check(drive).findings, "matching"), HasSubstr("warning: "));
  EXPECT_THAT(said(healthy().findings, "matching"), HasSubstr("note: all of 299 scans fit"));
}

TEST(LogCheck, SuspectsRangesInOtherUnits) {
  for (const float factor : {100.0F, 1000.0F}) {
    Drive drive;
    drive.scans = 40;
    drive.touch_scan = [factor](int, mrpt::obs::CObservation2DRangeScan& scan) {
      scan.maxRange *= factor;
      for (size_t i = 0; i < scan.getScanSize(); ++i) scan.setScanRange(i, factor * scan.getScanRange(i));
      return true;
    };
    const auto result = check(drive);
    EXPECT_THAT(said(result.findings, "units"), HasSubstr(factor > 500 ? "millimetres" : "centimetres"));
    EXPECT_FALSE(result.isUsable());
  }
  EXPECT_EQ(said(healthy().findings, "units"), "");
}

TEST(LogCheck, FindsAGeometryThatChanges) {
  Drive drive;
  drive.scans = 40;
  drive.touch_scan = [](int number, mrpt::obs::CObservation2DRangeScan& scan) {
    if (number >= 20) scan.maxRange = 50;
    return true;
  };
  EXPECT_THAT(said(check(drive).findings, "lidar"), HasSubstr("warning: 1 scan differs from the one before"));
  EXPECT_THAT(said(healthy().findings, "lidar"), Not(HasSubstr("warning")));
}

TEST(LogCheck, FindsAPlaceWhereTheLogBreaksOff) {
  const testing::TempFolder folder;
  const std::string path = folder / "a.rawlog";
  writeDrive({}, path);
  const std::string bytes = logs::readBytes(path);
  logs::writeBytes(bytes.substr(0, bytes.size() / 2), path);
  const auto result = checkLog(path, "", core::silentProgress());
  EXPECT_THAT(said(result.findings, "damage"), HasSubstr("error: " + path + ": truncated"));
  EXPECT_THAT(said(result.findings, "damage"), HasSubstr("--salvage"));
  EXPECT_FALSE(result.isUsable());
  EXPECT_GT(result.figures.ranges.scans, 100U) << "what is whole is looked at";
  EXPECT_EQ(result.figures.matched_pairs, result.figures.ranges.scans - 1) << "and matched";
}

TEST(LogCheck, SaysWhenThereIsNothingToMapFrom) {
  const testing::TempFolder folder;
  const std::string path = folder / "a.rawlog";
  {
    logs::RawObjects log(path);
    log << logs::rawOdometry(logs::kStart_s, 0);
  }
  const auto none = checkLog(path, "", core::silentProgress());
  EXPECT_THAT(said(none.findings, "scans"), HasSubstr("error: no 2D laser scan"));
  {
    logs::RawObjects log(path);
    log << logs::rawScan(logs::kStart_s, "L", 1) << logs::rawScan(logs::kStart_s + 1, "L", 1);
  }
  const auto one_beam = checkLog(path, "", core::silentProgress());
  EXPECT_THAT(said(one_beam.findings, "scans"),
              HasSubstr("error: 2 scans of no use, the first: laser scan with 1"));
  EXPECT_FALSE(one_beam.isUsable());
}

TEST(LogCheck, LooksAtTheLidarThatIsAskedFor) {
  const testing::TempFolder folder;
  const std::string path = folder / "a.rawlog";
  {
    logs::RawObjects log(path);
    log << logs::rawScan(logs::kStart_s, "front") << logs::rawScan(logs::kStart_s + 1, "front")
        << logs::rawScan(logs::kStart_s + 2, "rear", 7);
  }
  EXPECT_EQ(checkLog(path, "", core::silentProgress()).figures.lidar, "front");
  const auto rear = checkLog(path, "rear", core::silentProgress());
  EXPECT_EQ(rear.figures.ranges.beams, 7);
  EXPECT_EQ(rear.figures.streams.size(), 2U);
  EXPECT_EQ(testing::errorOf([&] { checkLog(path, "top", core::silentProgress()); }),
            path + ": no laser scan with the sensor label 'top', found 'front', 'rear'");
}

TEST(LogCheck, TellsThatALogCarriesItsTruth) {
  const testing::TempFolder folder;
  const std::string path = folder / "a.rawlog";
  {
    logs::RawObjects log(path);
    mrpt::obs::CObservationRobotPose truth;
    truth.sensorLabel = objects::kTruthLabel;
    truth.timestamp = logs::mrptTime(logs::kStart_s);
    log << truth << logs::rawScan(logs::kStart_s, "L") << logs::rawScan(logs::kStart_s + 1, "L");
  }
  const auto result = checkLog(path, "", core::silentProgress());
  EXPECT_THAT(said(result.findings, "truth"), HasSubstr("--drop-truth"));
  EXPECT_EQ(said(healthy().findings, "truth"), "");
}

TEST(LogCheck, EveryKeyIsListedOnce) {
  std::vector<std::string> keys;
  for (const auto& key : findingKeys()) keys.push_back(key.key);
  std::sort(keys.begin(), keys.end());
  EXPECT_EQ(std::adjacent_find(keys.begin(), keys.end()), keys.end());
  for (const auto& finding : healthy().findings)
    EXPECT_TRUE(std::binary_search(keys.begin(), keys.end(), finding.key)) << finding.key;
}

}  // namespace
}  // namespace slam::doctor
