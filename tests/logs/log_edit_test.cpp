#include "libslam/logs/log_edit.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <mrpt/obs/CActionRobotMovement3D.h>
#include <mrpt/obs/CObservationComment.h>
#include <mrpt/obs/CObservationRobotPose.h>
#include <mrpt/poses/CPosePDFGaussian.h>

#include "libslam/logs/log_format.h"
#include "libslam/objects/object_stream.h"
#include "libslam/testing/error_of.h"
#include "libslam/testing/temp_folder.h"
#include "tests/logs/log_fixtures.h"

namespace slam::logs {
namespace {

using mrpt::obs::CActionCollection;
using mrpt::obs::CActionRobotMovement2D;
using mrpt::obs::CObservation;
using mrpt::obs::CObservation2DRangeScan;
using mrpt::obs::CSensoryFrame;
using testing::errorOf;
using ::testing::HasSubstr;

using Objects = std::vector<std::shared_ptr<mrpt::serialization::CSerializable>>;

Objects objectsOf(const std::string& path) {
  Objects objects;
  const auto source = openLog(path);
  while (auto object = source->next()) objects.push_back(object);
  return objects;
}

template <class Class>
const Class& as(const std::shared_ptr<mrpt::serialization::CSerializable>& object) {
  return dynamic_cast<const Class&>(*object);
}

/// "LASER 0.2" per observation, seconds after kStart_s; frames and actions by name.
std::vector<std::string> outline(const std::string& path) {
  std::vector<std::string> lines;
  const auto describe = [](const CObservation& observation) {
    const auto ticks = observation.timestamp.time_since_epoch().count();
    if (ticks == objects::kNoStamp) return observation.sensorLabel;
    char text[64];
    std::snprintf(text, sizeof(text), "%s %.1f", observation.sensorLabel.c_str(),
                  objects::secondsFromMrptTicks(ticks) - kStart_s);
    return std::string(text);
  };
  for (const auto& object : objectsOf(path)) {
    if (const auto* frame = dynamic_cast<const CSensoryFrame*>(object.get())) {
      std::string line = "frame";
      for (const auto& observation : *frame) line += " [" + describe(*observation) + "]";
      lines.push_back(line);
    } else if (const auto* observation = dynamic_cast<const CObservation*>(object.get())) {
      lines.push_back(describe(*observation));
    } else {
      lines.push_back("actions");
    }
  }
  return lines;
}

/// "" in an outline: MRPT does not store the label of a comment.
mrpt::obs::CObservationComment unstampedRemark() {
  mrpt::obs::CObservationComment remark;
  remark.timestamp = {};
  return remark;
}

/// Odometry and scan at 0, 1, 2 ... s.
std::string bareLog(const testing::TempFolder& folder, const std::string& name, int seconds,
                    const std::string& label = "LASER", double first_s = 0) {
  RawObjects log(folder / name);
  for (int i = 0; i < seconds; ++i)
    log << rawOdometry(kStart_s + first_s + i, i) << rawScan(kStart_s + first_s + i, label);
  return folder / name;
}

std::string actionLog(const testing::TempFolder& folder, const std::string& name, int steps) {
  writeLog(sampleEntries(steps), folder / name, RawlogForm::kActionFrame);
  return folder / name;
}

EditCounts cut(const std::string& path, const std::string& output, CutOptions options) {
  return cutLog(path, output, options, core::silentProgress());
}
EditCounts filter(const std::string& path, const std::string& output, const FilterOptions& options) {
  return filterLog(path, output, options, core::silentProgress());
}

TEST(CutLog, KeepsTheObjectsBetweenTwoMomentsByteForByte) {
  const testing::TempFolder folder;
  const auto path = bareLog(folder, "a.rawlog", 10);
  const auto counts = cut(path, folder / "b.rawlog", {LogMoment{3, false}, LogMoment{5, false}});
  EXPECT_EQ(outline(folder / "b.rawlog"),
            (std::vector<std::string>{"ODOMETRY 3.0", "LASER 3.0", "ODOMETRY 4.0", "LASER 4.0"}));
  EXPECT_EQ(counts.read, 20U);
  EXPECT_EQ(counts.unchanged, 4U);
  EXPECT_EQ(counts.changed, 0U);
  EXPECT_EQ(counts.dropped, 16U);
  EXPECT_THAT(unpacked(path), HasSubstr(unpacked(folder / "b.rawlog")));
  // The same moments, said in the other way.
  cut(path, folder / "c.rawlog", {LogMoment{kStart_s + 3, true}, LogMoment{kStart_s + 5, true}});
  EXPECT_EQ(readBytes(folder / "b.rawlog"), readBytes(folder / "c.rawlog"));
}

TEST(CutLog, TwoPiecesMakeTheWholeAgain) {
  const testing::TempFolder folder;
  const auto path = actionLog(folder, "a.rawlog", 12);
  cut(path, folder / "b.rawlog", {std::nullopt, LogMoment{1.3, false}});
  cut(path, folder / "c.rawlog", {LogMoment{1.3, false}, std::nullopt});
  EXPECT_EQ(unpacked(folder / "b.rawlog") + unpacked(folder / "c.rawlog"), unpacked(path));
}

TEST(CutLog, LeavesOldAndUnknownDigitsAlone) {
  const std::string old = "/usr/share/mrpt/datasets/2006-01ENE-21-SENA_Telecom Faculty_one_loop_only.rawlog";
  if (!std::filesystem::exists(old)) GTEST_SKIP() << "mrpt-common's datasets are not installed";
  const testing::TempFolder folder;
  // Of 2006: MRPT itself would write all of its classes in newer versions.
  const auto counts = cut(old, folder / "all.rawlog", {LogMoment{0, false}, std::nullopt});
  EXPECT_EQ(counts.unchanged, 449U);
  EXPECT_EQ(unpacked(folder / "all.rawlog"), unpacked(old));
}

TEST(CutLog, AnActionStaysWithItsFrameAndObjectsWithoutAStampWithTheOneBefore) {
  const testing::TempFolder folder;
  {
    RawObjects log(folder / "a.rawlog");
    const auto remark = unstampedRemark();
    log << remark;
    for (int i = 0; i < 4; ++i) {
      // The action is stamped before the cut, its frame after.
      log << collection(wheelAction(kStart_s + i - 0.5, 1)) << frame(rawScan(kStart_s + i, "L")) << remark;
    }
  }
  cut(folder / "a.rawlog", folder / "b.rawlog", {LogMoment{2, false}, LogMoment{3, false}});
  EXPECT_EQ(outline(folder / "b.rawlog"), (std::vector<std::string>{"", "actions", "frame [L 2.0]", ""}));
}

TEST(CutLog, KeepsTheFilesOrderWhereStampsRunBack) {
  const testing::TempFolder folder;
  {
    RawObjects log(folder / "a.rawlog");
    for (const double time_s : {0.0, 2.0, 1.0, 3.0}) log << rawScan(kStart_s + time_s, "L");
  }
  cut(folder / "a.rawlog", folder / "b.rawlog", {LogMoment{1, false}, LogMoment{3, false}});
  EXPECT_EQ(outline(folder / "b.rawlog"), (std::vector<std::string>{"L 2.0", "L 1.0"}));
}

TEST(CutLog, SalvagesWhatComesBeforeDamage) {
  const testing::TempFolder folder;
  const auto path = bareLog(folder, "a.rawlog", 30);
  const std::string bytes = unpacked(path);
  writeBytes(bytes.substr(0, bytes.size() - 20), path);
  EXPECT_THAT(errorOf([&] {
                cut(path, folder / "b.rawlog", {LogMoment{0, false}, std::nullopt});
              }),
              HasSubstr("truncated"));
  EXPECT_FALSE(std::filesystem::exists(folder / "b.rawlog"));
  EXPECT_THAT(testing::leftoversIn(folder.path()), ::testing::IsEmpty());
  const auto counts = cut(path, folder / "b.rawlog", {std::nullopt, std::nullopt, true});
  EXPECT_EQ(counts.unchanged, 59U);
  EXPECT_THAT(counts.damage, HasSubstr("truncated"));
  EXPECT_EQ(unpacked(folder / "b.rawlog"), bytes.substr(0, unpacked(folder / "b.rawlog").size()));
}

TEST(CutLog, RefusesToWriteNothing) {
  const testing::TempFolder folder;
  const auto path = bareLog(folder, "a.rawlog", 3);
  EXPECT_EQ(errorOf([&] {
              cut(path, folder / "b.rawlog", {LogMoment{100, false}, std::nullopt});
            }),
            (folder / "b.rawlog") + ": nothing would be left of 6 objects, expected at least one");
  EXPECT_THAT(testing::leftoversIn(folder.path()), ::testing::IsEmpty());
}

TEST(CutLog, AnInterruptLeavesNothing) {
  struct Impatient : core::Progress {
    void update(double, double) override { throw core::Interrupted(); }
  } impatient;
  const testing::TempFolder folder;
  const auto path = bareLog(folder, "a.rawlog", 200);
  EXPECT_THROW(cutLog(path, folder / "b.rawlog", {LogMoment{0, false}, std::nullopt}, impatient),
               core::Interrupted);
  EXPECT_FALSE(std::filesystem::exists(folder / "b.rawlog"));
  EXPECT_THAT(testing::leftoversIn(folder.path()), ::testing::IsEmpty());
}

TEST(CutLog, ReadsOtherFormats) {
  const testing::TempFolder folder;
  std::string text = "PARAM robot_frontlaser_offset 0.1 nohost 0\n";
  for (int i = 0; i < 4; ++i)
    text += "FLASER 3 1 2 3 0 0 0 0 0 0 " + std::to_string(100 + i) + " nohost " + std::to_string(i) + "\n";
  writeBytes(text, folder / "a.log");
  cut(folder / "a.log", folder / "b.rawlog", {LogMoment{1, false}, LogMoment{2, false}});
  EXPECT_EQ(LogReader(folder / "b.rawlog").next()->scan.T_robot_lidar.x,
            LogReader(folder / "a.log").next()->scan.T_robot_lidar.x);
  EXPECT_EQ(inspectLog(folder / "b.rawlog").scans, 1U);
}

TEST(MergeLogs, SortsByStampAndPrefersTheFirstLog) {
  const testing::TempFolder folder;
  const auto front = bareLog(folder, "a.rawlog", 3, "FRONT");
  {
    RawObjects log(folder / "b.rawlog");
    for (const double time_s : {0.0, 0.5, 7.0}) log << rawScan(kStart_s + time_s, "REAR");
  }
  const auto counts = mergeLogs(front, folder / "b.rawlog", folder / "c.rawlog", core::silentProgress());
  EXPECT_EQ(outline(folder / "c.rawlog"),
            (std::vector<std::string>{"ODOMETRY 0.0", "FRONT 0.0", "REAR 0.0", "REAR 0.5", "ODOMETRY 1.0",
                                      "FRONT 1.0", "ODOMETRY 2.0", "FRONT 2.0", "REAR 7.0"}));
  EXPECT_EQ(counts.read, 9U);
  EXPECT_EQ(counts.unchanged, 9U);
  EXPECT_EQ(unpacked(folder / "c.rawlog").size(),
            unpacked(front).size() + unpacked(folder / "b.rawlog").size());
}

TEST(MergeLogs, KeepsEachLogsOwnOrder) {
  const testing::TempFolder folder;
  {
    RawObjects a(folder / "a.rawlog"), b(folder / "b.rawlog");
    for (const double time_s : {1.0, 5.0, 4.0}) a << rawScan(kStart_s + time_s, "A");
    const auto remark = unstampedRemark();
    b << remark << rawScan(kStart_s + 2, "B") << remark << rawScan(kStart_s + 4.5, "B");
  }
  mergeLogs(folder / "a.rawlog", folder / "b.rawlog", folder / "c.rawlog", core::silentProgress());
  EXPECT_EQ(outline(folder / "c.rawlog"),
            (std::vector<std::string>{"", "A 1.0", "B 2.0", "", "B 4.5", "A 5.0", "A 4.0"}));
}

TEST(MergeLogs, RefusesTwoRobotsAtATime) {
  const testing::TempFolder folder;
  const auto path = actionLog(folder, "a.rawlog", 12);
  cut(path, folder / "b.rawlog", {std::nullopt, LogMoment{1, false}});
  cut(path, folder / "c.rawlog", {LogMoment{1, false}, std::nullopt});
  const auto merge = [&](const char* first, const char* second) {
    mergeLogs(folder / first, folder / second, folder / "d.rawlog", core::silentProgress());
  };
  EXPECT_THAT(errorOf([&] { merge("a.rawlog", "b.rawlog"); }), HasSubstr("holds actions at the same time"));
  EXPECT_FALSE(std::filesystem::exists(folder / "d.rawlog"));
  merge("c.rawlog", "b.rawlog");
  EXPECT_EQ(unpacked(folder / "d.rawlog"), unpacked(path)) << "one after the other is one drive";
  bareLog(folder, "e.rawlog", 2, "REAR");
  merge("a.rawlog", "e.rawlog");
  EXPECT_EQ(inspectLog(folder / "d.rawlog").form, "mixed");
}

TEST(FilterLog, DropsByLabelAndTouchesNothingElse) {
  const testing::TempFolder folder;
  {
    RawObjects log(folder / "a.rawlog");
    for (int i = 0; i < 3; ++i)
      log << rawOdometry(kStart_s + i, i) << rawScan(kStart_s + i, "FRONT") << rawScan(kStart_s + i, "REAR");
  }
  FilterOptions options;
  options.drop_labels = {"REAR"};
  filter(folder / "a.rawlog", folder / "b.rawlog", options);
  EXPECT_EQ(unpacked(folder / "b.rawlog"), unpacked(bareLog(folder, "front.rawlog", 3, "FRONT")));
  options = {};
  options.keep_labels = {"ODOMETRY", "FRONT"};
  filter(folder / "a.rawlog", folder / "c.rawlog", options);
  EXPECT_EQ(readBytes(folder / "b.rawlog"), readBytes(folder / "c.rawlog"));
  options.keep_labels = {"ODOMETRY", "TOP"};
  EXPECT_EQ(errorOf([&] { filter(folder / "a.rawlog", folder / "d.rawlog", options); }),
            (folder / "a.rawlog") +
                ": no observation with the sensor label 'TOP', found 'FRONT', 'ODOMETRY', 'REAR'");
}

TEST(FilterLog, TakesSensorsOutOfFrames) {
  const testing::TempFolder folder;
  {
    RawObjects log(folder / "a.rawlog");
    log << collection(wheelAction(kStart_s, 1))
        << frame(rawScan(kStart_s, "FRONT"), rawScan(kStart_s, "REAR"))
        << collection(wheelAction(kStart_s + 1, 2)) << frame(rawScan(kStart_s + 1, "REAR"))
        << collection(wheelAction(kStart_s + 2, 4)) << frame(rawScan(kStart_s + 2, "FRONT"));
  }
  FilterOptions options;
  options.drop_labels = {"REAR"};
  const auto counts = filter(folder / "a.rawlog", folder / "b.rawlog", options);
  EXPECT_EQ(outline(folder / "b.rawlog"),
            (std::vector<std::string>{"actions", "frame [FRONT 0.0]", "actions", "frame [FRONT 2.0]"}));
  EXPECT_EQ(counts.unchanged, 2U);
  EXPECT_EQ(counts.changed, 2U) << "a frame, and the action that took up another";
  EXPECT_EQ(counts.composed, 1U);
  EXPECT_EQ(counts.dropped, 2U);
  EXPECT_NEAR(readLog(folder / "b.rawlog")[1].T_previous_robot.x, 6, 1e-9);
}

TEST(FilterLog, EveryThirdScanOfEachLidarOfABareLog) {
  const testing::TempFolder folder;
  {
    RawObjects log(folder / "a.rawlog");
    for (int i = 0; i < 7; ++i) {
      log << rawOdometry(kStart_s + i, i) << rawScan(kStart_s + i, "FRONT");
      if (i % 2 == 0) log << rawScan(kStart_s + i, "REAR");
    }
  }
  FilterOptions options;
  options.every = 3;
  filter(folder / "a.rawlog", folder / "b.rawlog", options);
  EXPECT_EQ(outline(folder / "b.rawlog"),
            (std::vector<std::string>{"ODOMETRY 0.0", "FRONT 0.0", "REAR 0.0", "ODOMETRY 1.0", "ODOMETRY 2.0",
                                      "ODOMETRY 3.0", "FRONT 3.0", "ODOMETRY 4.0", "ODOMETRY 5.0",
                                      "ODOMETRY 6.0", "FRONT 6.0", "REAR 6.0"}));
}

TEST(FilterLog, DecimatingAnActionLogKeepsTheWayOfTheRobot) {
  const testing::TempFolder folder;
  const auto path = actionLog(folder, "a.rawlog", 10);
  FilterOptions options;
  options.every = 3;
  const auto counts = filter(path, folder / "b.rawlog", options);
  const auto all = readLog(path), some = readLog(folder / "b.rawlog");
  ASSERT_EQ(some.size(), 4U);
  for (size_t i = 0; i < 4; ++i) {
    EXPECT_EQ(some[i].scan.time_s, all[3 * i].scan.time_s);
    EXPECT_NEAR(some[i].T_odom_robot.x, all[3 * i].T_odom_robot.x, 1e-6)
        << "MRPT's odometry readings are doubles";
    EXPECT_NEAR(some[i].T_odom_robot.y, all[3 * i].T_odom_robot.y, 1e-6);
    EXPECT_NEAR(core::angleDifference(some[i].T_odom_robot.phi, all[3 * i].T_odom_robot.phi), 0, 1e-6);
  }
  EXPECT_EQ(counts.composed, 3U);
  EXPECT_EQ(counts.read, 20U);
  EXPECT_EQ(counts.unchanged, 5U) << "the first step and three frames";
}

TEST(FilterLog, ComposesEveryWayOfMeasuringTheMotion) {
  using mrpt::poses::CPose2D;
  using mrpt::poses::CPosePDFGaussian;
  const auto matched = [](double x_m, double turn_rad, double variance) {
    CActionRobotMovement2D action;
    mrpt::math::CMatrixDouble33 covariance;
    covariance.setIdentity();
    covariance *= variance;
    action.estimationMethod = CActionRobotMovement2D::emScan2DMatching;
    action.poseChange = CPosePDFGaussian::Create(CPose2D(x_m, 0, turn_rad), covariance);
    return action;
  };
  const auto spatial = [](double x_m) {
    mrpt::obs::CActionRobotMovement3D action;
    action.poseChange.mean = mrpt::poses::CPose3D(x_m, 0, 0, 0, 0, 0);
    action.poseChange.cov.setIdentity();
    action.estimationMethod = mrpt::obs::CActionRobotMovement3D::emVisualOdometry;
    return action;
  };
  auto wheels = wheelAction(kStart_s, 1);
  wheels.hasEncodersInfo = true;
  wheels.encoderLeftTicks = 5;
  wheels.encoderRightTicks = 7;
  wheels.motionModelConfiguration.gaussianModel.a1 = 0.25;
  const testing::TempFolder folder;
  {
    RawObjects log(folder / "a.rawlog");
    log << collection(wheels) << frame(rawScan(kStart_s, "L"));
    for (int i = 1; i < 3; ++i)
      log << collection(wheels, matched(2, core::kPi / 2, 0.01), spatial(3))
          << frame(rawScan(kStart_s + i, "L"));
  }
  FilterOptions options;
  options.every = 2;
  filter(folder / "a.rawlog", folder / "b.rawlog", options);
  const auto objects = objectsOf(folder / "b.rawlog");
  ASSERT_EQ(objects.size(), 4U);
  const auto& actions = as<CActionCollection>(objects[2]);
  ASSERT_EQ(actions.size(), 3U);
  const auto sum = actions.getActionByClass<CActionRobotMovement2D>(0);
  EXPECT_EQ(sum->rawOdometryIncrementReading.x(), 2);
  EXPECT_TRUE(sum->hasEncodersInfo);
  EXPECT_EQ(sum->encoderLeftTicks, 10);
  EXPECT_EQ(sum->encoderRightTicks, 14);
  EXPECT_NEAR(sum->motionModelConfiguration.gaussianModel.a1, 0.25, 1e-9);
  const auto scans = actions.getActionByClass<CActionRobotMovement2D>(1);
  const auto mean = scans->poseChange->getMeanVal();
  EXPECT_NEAR(mean.x(), 2, 1e-6);
  EXPECT_NEAR(mean.y(), 2, 1e-6);
  EXPECT_NEAR(std::abs(mean.phi()), core::kPi, 1e-6);
  // By hand: the turn's variance adds up; that of y takes 2 m times the first turn's.
  const auto covariance = scans->poseChange->getCovariance();
  EXPECT_NEAR(covariance(2, 2), 0.02, 1e-6);
  EXPECT_NEAR(covariance(0, 0), 0.02 + 4 * 0.01, 1e-6);
  const auto full = actions.getActionByClass<mrpt::obs::CActionRobotMovement3D>(0);
  EXPECT_NEAR(full->poseChange.mean.x(), 6, 1e-6);
  EXPECT_EQ(full->estimationMethod, mrpt::obs::CActionRobotMovement3D::emVisualOdometry);
}

TEST(FilterLog, StepsWithoutAnIncrementAddNone) {
  const testing::TempFolder folder;
  {
    RawObjects log(folder / "a.rawlog");
    log << collection(wheelAction(kStart_s, 1)) << frame(rawScan(kStart_s, "L"));
    log << collection(wheelAction(kStart_s + 1, 2)) << frame(rawScan(kStart_s + 1, "L"));
    log << CActionCollection() << frame(rawScan(kStart_s + 2, "L"));
  }
  FilterOptions options;
  options.every = 2;
  filter(folder / "a.rawlog", folder / "b.rawlog", options);
  EXPECT_NEAR(readLog(folder / "b.rawlog")[1].T_previous_robot.x, 2, 1e-9);
}

TEST(FilterLog, DropsTheTruth) {
  const testing::TempFolder folder;
  {
    RawObjects log(folder / "a.rawlog");
    mrpt::obs::CObservationRobotPose truth;
    truth.sensorLabel = objects::kTruthLabel;
    truth.timestamp = mrptTime(kStart_s);
    log << truth << rawOdometry(kStart_s, 0) << rawScan(kStart_s, "LASER");
  }
  FilterOptions options;
  options.drop_truth = true;
  filter(folder / "a.rawlog", folder / "b.rawlog", options);
  EXPECT_EQ(outline(folder / "b.rawlog"), (std::vector<std::string>{"ODOMETRY 0.0", "LASER 0.0"}));
}

TEST(FilterLog, MendsWhatTheLogSaysWrongly) {
  const testing::TempFolder folder;
  {
    RawObjects log(folder / "a.rawlog");
    auto scan = rawScan(kStart_s, "L");
    scan.maxRange = 100;
    scan.setScanRange(1, 81.83F);
    scan.setScanRange(2, 81.82F);
    scan.sensorPose.setFromValues(1, 2, 0.5, 0.3, 0.1, 0);
    log << rawOdometry(kStart_s, 0) << scan;
  }
  FilterOptions options;
  options.no_return_m = 81.825;
  options.step_rad = core::degToRad(1);
  options.mount = core::Pose2{0.1, -0.2, core::degToRad(90)};
  options.shift_s = {{"ODOMETRY", -0.25}};
  const auto counts = filter(folder / "a.rawlog", folder / "b.rawlog", options);
  EXPECT_EQ(counts.changed, 2U);
  EXPECT_EQ(outline(folder / "b.rawlog"), (std::vector<std::string>{"ODOMETRY -0.2", "L 0.0"}));
  const auto objects = objectsOf(folder / "b.rawlog");
  const auto& scan = as<CObservation2DRangeScan>(objects[1]);
  EXPECT_FALSE(scan.getScanRangeValidity(1));
  EXPECT_EQ(scan.getScanRange(1), 81.83F) << "marked, not altered";
  EXPECT_TRUE(scan.getScanRangeValidity(2));
  EXPECT_FLOAT_EQ(scan.maxRange, 81.825F);
  EXPECT_NEAR(scan.aperture, core::degToRad(4), 1e-7);
  EXPECT_NEAR(scan.sensorPose.x(), 0.1, 1e-12);
  EXPECT_NEAR(scan.sensorPose.yaw(), core::kPi / 2, 1e-12);
  EXPECT_NEAR(scan.sensorPose.z(), 0.5, 1e-12) << "what the plane does not know stays";
  EXPECT_NEAR(scan.sensorPose.pitch(), 0.1, 1e-12);
  options = {};
  options.step_rad = core::degToRad(100);
  EXPECT_THAT(errorOf([&] { filter(folder / "a.rawlog", folder / "c.rawlog", options); }),
              HasSubstr("5 readings 100 deg apart go round more than once"));
}

TEST(FilterLog, AShiftMovesStampsByWholeTicks) {
  const testing::TempFolder folder;
  const auto path = bareLog(folder, "a.rawlog", 2);
  FilterOptions options;
  options.shift_s = {{"LASER", 0.6289}};
  filter(path, folder / "b.rawlog", options);
  options.shift_s = {{"LASER", -0.6289}};
  filter(folder / "b.rawlog", folder / "c.rawlog", options);
  EXPECT_NE(unpacked(folder / "b.rawlog"), unpacked(path));
  EXPECT_EQ(unpacked(folder / "c.rawlog"), unpacked(path));
}

TEST(EditLog, SameInputSameBytes) {
  const testing::TempFolder folder;
  const auto path = actionLog(folder, "a.rawlog", 10);
  FilterOptions options;
  options.every = 4;
  filter(path, folder / "b.rawlog", options);
  filter(path, folder / "c.rawlog", options);
  EXPECT_EQ(readBytes(folder / "b.rawlog"), readBytes(folder / "c.rawlog"));
}

}  // namespace
}  // namespace slam::logs
