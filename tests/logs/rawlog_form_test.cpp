#include "libslam/rawlogs/rawlog_form.h"
#include "libslam/logs/log_format.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <mrpt/obs/CObservationComment.h>
#include <mrpt/obs/CObservationIMU.h>

#include "libslam/edit/convert.h"
#include "libslam/testing/temp_folder.h"
#include "tests/logs/carmen_fixtures.h"
#include "tests/logs/log_fixtures.h"

namespace slam::logs {
namespace {

using mrpt::obs::CActionCollection;
using mrpt::obs::CObservation;
using mrpt::obs::CSensoryFrame;
using ::testing::ElementsAre;

mrpt::obs::CObservationComment comment(const std::string& text) {
  mrpt::obs::CObservationComment observation;
  observation.text = text;
  return observation;
}

mrpt::obs::CObservationIMU imu() {
  mrpt::obs::CObservationIMU observation;
  observation.sensorLabel = "IMU";
  observation.timestamp = mrptTime(kStart_s);
  return observation;
}

/// "A(increment)" or "A", "F(labels)", or a label, per object.
std::vector<std::string> shape(const std::vector<Object>& objects) {
  std::vector<std::string> words;
  for (const auto& object : objects) {
    if (const auto* actions = dynamic_cast<const CActionCollection*>(object.get())) {
      const auto movement = actions->getBestMovementEstimation();
      words.push_back(
          movement ? "A(" + std::to_string(movement->rawOdometryIncrementReading.x()).substr(0, 4) + ")"
                   : "A");
    } else if (const auto* frame = dynamic_cast<const CSensoryFrame*>(object.get())) {
      std::string labels;
      for (const auto& observation : *frame) labels += (labels.empty() ? "" : " ") + observation->sensorLabel;
      words.push_back("F(" + labels + ")");
    } else {
      words.push_back(dynamic_cast<const CObservation&>(*object).sensorLabel);
    }
  }
  return words;
}

std::vector<Object> inForm(const std::string& path, rawlogs::RawlogForm form) {
  const auto source = rawlogs::inForm(openLog(path), form, path);
  std::vector<Object> objects;
  while (auto object = source->next()) objects.push_back(object);
  EXPECT_EQ(source->count(), objects.size());
  return objects;
}

TEST(ToFrames, GivesOneFrameAScanWithTheMotionSinceTheScanBefore) {
  const testing::TempFolder folder;
  {
    RawObjects log(folder / "a.rawlog");
    log << rawOdometry(kStart_s, 5) << imu() << rawScan(kStart_s, "L") << rawOdometry(kStart_s + 0.5, 6)
        << rawOdometry(kStart_s + 1, 8) << rawScan(kStart_s + 1, "L") << rawScan(kStart_s + 1, "R")
        << rawOdometry(kStart_s + 3, 9) << rawScan(kStart_s + 2, "L") << imu();
  }
  const auto objects = inForm(folder / "a.rawlog", rawlogs::RawlogForm::kActionFrame);
  EXPECT_THAT(shape(objects),
              ElementsAre("A(0.00)", "F(IMU L)", "A(3.00)", "F(L)", "A", "F(R)", "A", "F(L)", "A", "F(IMU)"));
  const auto actions = std::dynamic_pointer_cast<CActionCollection>(objects[2]);
  EXPECT_EQ((*actions->begin())->timestamp, mrptTime(kStart_s + 1));
}

TEST(ToFrames, BeginWithoutTheMotionBeforeTheFirstScan) {
  const testing::TempFolder folder;
  {
    RawObjects log(folder / "a.rawlog");
    log << rawOdometry(kStart_s - 1, 5) << rawOdometry(kStart_s - 0.5, 7) << rawOdometry(kStart_s, 8)
        << rawScan(kStart_s, "L") << rawOdometry(kStart_s + 1, 9) << rawScan(kStart_s + 1, "L");
  }
  EXPECT_THAT(shape(inForm(folder / "a.rawlog", rawlogs::RawlogForm::kActionFrame)),
              ElementsAre("A(0.00)", "F(L)", "A(1.00)", "F(L)"));
}

TEST(ToFrames, LetsActionsAndFramesPassAndTakesBareOnesIn) {
  const testing::TempFolder folder;
  {
    RawObjects log(folder / "a.rawlog");
    log << comment("c") << collection(wheelAction(kStart_s, 1)) << frame(rawScan(kStart_s, "L"))
        << rawOdometry(kStart_s + 1, 100) << imu() << collection(wheelAction(kStart_s + 1, 2))
        << frame(rawScan(kStart_s + 1, "L")) << rawScan(kStart_s + 2, "R");
  }
  EXPECT_THAT(shape(inForm(folder / "a.rawlog", rawlogs::RawlogForm::kActionFrame)),
              ElementsAre("A(1.00)", "F(L )", "A(2.00)", "F(L IMU)", "A", "F(R)"));
}

TEST(ToFrames, BeginsNoFrameWithWhatHasNoStamp) {
  const testing::TempFolder folder;
  {
    RawObjects log(folder / "a.rawlog");
    auto unstamped = imu();
    unstamped.timestamp = mrpt::Clock::time_point();
    log << unstamped << imu() << rawScan(kStart_s, "L") << imu() << unstamped << rawScan(kStart_s, "L");
  }
  const auto objects = inForm(folder / "a.rawlog", rawlogs::RawlogForm::kActionFrame);
  EXPECT_THAT(shape(objects), ElementsAre("A", "F(L IMU IMU)", "A", "F(IMU IMU L)"));
}

TEST(ToFrames, KeepsMemorySmallWithoutScans) {
  const testing::TempFolder folder;
  {
    RawObjects log(folder / "a.rawlog");
    for (int i = 0; i < 2500; ++i) log << imu();
  }
  EXPECT_EQ(inForm(folder / "a.rawlog", rawlogs::RawlogForm::kActionFrame).size(), 6U);
}

TEST(ToObservations, IntegratesActionsAndKeepsEverythingElse) {
  const testing::TempFolder folder;
  {
    RawObjects log(folder / "a.rawlog");
    log << comment("c") << collection(wheelAction(kStart_s, 1))
        << frame(imu(), rawScan(kStart_s + 0.25, "L"), rawScan(kStart_s + 0.5, "R"))
        << collection(wheelAction(kStart_s + 1, 2)) << collection(wheelAction(kStart_s + 1, 3))
        << frame(rawScan(kStart_s + 1.25, "L"), rawOdometry(kStart_s + 1, 77)) << collection()
        << frame(rawScan(kStart_s + 2, "L")) << imu() << collection(wheelAction(kStart_s + 3, 4));
  }
  const auto objects = inForm(folder / "a.rawlog", rawlogs::RawlogForm::kObservationOnly);
  EXPECT_THAT(shape(objects),
              ElementsAre("", "ODOMETRY", "IMU", "L", "R", "ODOMETRY", "L", "L", "IMU", "ODOMETRY"));
  const auto odometry = all<mrpt::obs::CObservationOdometry>(objects);
  EXPECT_EQ(odometry[0]->odometry.x(), 1);
  EXPECT_EQ(odometry[1]->odometry.x(), 6);
  EXPECT_EQ(odometry[2]->odometry.x(), 10);
  EXPECT_EQ(odometry[0]->timestamp, mrptTime(kStart_s + 0.25)) << "of the first scan";
  EXPECT_EQ(odometry[2]->timestamp, mrptTime(kStart_s + 3)) << "of the action, where no frame follows";
}

TEST(RawlogForms, ReadTheSameInBothFormsAndBack) {
  const testing::TempFolder folder;
  writeLog(sampleEntries(50), folder / "observations.rawlog", rawlogs::RawlogForm::kObservationOnly);
  edit::LogConversion to_actions, to_observations;
  to_actions.form = rawlogs::RawlogForm::kActionFrame;
  to_observations.form = rawlogs::RawlogForm::kObservationOnly;
  edit::convertLog(folder / "observations.rawlog", folder / "actions.rawlog", to_actions,
                   core::silentProgress());
  edit::convertLog(folder / "actions.rawlog", folder / "back.rawlog", to_observations,
                   core::silentProgress());
  EXPECT_EQ(inspectLog(folder / "actions.rawlog").form, "action / sensory frame");
  EXPECT_EQ(inspectLog(folder / "back.rawlog").form, "observation only");
  const auto expected = readLog(folder / "observations.rawlog");
  for (const auto* name : {"actions.rawlog", "back.rawlog"}) {
    const auto entries = readLog(folder / name);
    ASSERT_EQ(entries.size(), expected.size());
    for (size_t i = 0; i < entries.size(); ++i) {
      EXPECT_EQ(entries[i].scan.time_s, expected[i].scan.time_s);
      EXPECT_EQ(entries[i].has_odometry, expected[i].has_odometry);
      EXPECT_EQ(entries[i].scan.ranges_m[0], expected[i].scan.ranges_m[0]);
      // Composed in another order: rounding.
      EXPECT_NEAR(entries[i].T_odom_robot.x, expected[i].T_odom_robot.x, 1e-9);
      EXPECT_NEAR(entries[i].T_odom_robot.phi, expected[i].T_odom_robot.phi, 1e-9);
    }
  }
}

TEST(RawlogForms, NamesTheEntryOfOdometryThatIsNotFinite) {
  const testing::TempFolder folder;
  {
    RawObjects log(folder / "a.rawlog");
    log << rawScan(kStart_s, "L") << rawOdometry(kStart_s, std::nan(""));
  }
  const auto source =
      rawlogs::inForm(openLog(folder / "a.rawlog"), rawlogs::RawlogForm::kActionFrame, "a.rawlog");
  source->next();
  source->next();
  try {
    source->next();
    FAIL();
  } catch (const core::InputError& error) {
    EXPECT_STREQ(error.what(), "a.rawlog: entry 2: odometry that is not finite");
  }
}

}  // namespace
}  // namespace slam::logs
