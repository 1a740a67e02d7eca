#include "libslam/run/scan_odometry_log.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <mrpt/obs/CActionCollection.h>
#include <mrpt/obs/CActionRobotMovement2D.h>
#include <mrpt/obs/CObservation2DRangeScan.h>
#include <mrpt/obs/CObservationComment.h>
#include <mrpt/obs/CObservationIMU.h>
#include <mrpt/obs/CObservationOdometry.h>
#include <mrpt/obs/CSensoryFrame.h>
#include <mrpt/poses/CPosePDFGaussian.h>

#include "libslam/core/error.h"
#include "libslam/files/files.h"
#include "libslam/lidar/mrpt_types.h"
#include "libslam/logs/log_format.h"
#include "libslam/logs/log_reader.h"
#include "libslam/logs/log_writer.h"
#include "libslam/objects/object_stream.h"
#include "libslam/testing/temp_folder.h"
#include "tests/mapping/small_room.h"

namespace slam::run {
namespace {

using mapping::test::driveThroughRoom;
using mrpt::obs::CActionCollection;
using mrpt::obs::CActionRobotMovement2D;
using mrpt::obs::CObservationOdometry;
using mrpt::obs::CSensoryFrame;
using rawlogs::RawlogForm;
using ::testing::HasSubstr;
using Objects = std::vector<std::shared_ptr<mrpt::serialization::CSerializable>>;

std::string writeDrive(const testing::TempFolder& folder, RawlogForm form, bool with_odometry) {
  std::string path = folder / "in.rawlog";
  logs::LogWriter writer(path, form);
  for (auto entry : driveThroughRoom().entries) {
    entry.has_odometry = with_odometry;
    writer.write(entry);
  }
  writer.close();
  return path;
}

void writeObjects(const std::string& path, const Objects& objects) {
  const auto sink = logs::createLog(path, logs::LogFormat::kRawlog);
  for (const auto& object : objects) sink->write(*object);
  sink->close();
}

Objects readObjects(const std::string& path) {
  Objects objects;
  const auto source = logs::openLog(path);
  while (auto object = source->next()) objects.push_back(object);
  return objects;
}

ScanOdometryLogOptions optionsOf(const std::string& method) {
  ScanOdometryLogOptions options;
  options.odometry.method = method;
  return options;
}

ScanOdometryLogReport write(const std::string& in, const std::string& out,
                            const ScanOdometryLogOptions& options) {
  return writeScanOdometry(in, out, options, core::silentProgress());
}

core::Pose2 endOf(const std::string& path) {
  logs::LogReader log(path);
  core::Pose2 end;
  while (const auto entry = log.next()) end = entry->T_odom_robot;
  return end;
}

class EveryForm : public ::testing::TestWithParam<std::tuple<RawlogForm, bool>> {};

TEST_P(EveryForm, ReplacesTheOdometryByOneThatIsBetterThanTheWheels) {
  const auto [form, with_odometry] = GetParam();
  const testing::TempFolder folder;
  const auto in = writeDrive(folder, form, with_odometry);
  const auto drive = driveThroughRoom();
  for (const std::string method : {"correlation", "range_flow", "plicp"}) {
    const auto report = write(in, folder / "out.rawlog", optionsOf(method));
    EXPECT_EQ(report.label, "LASER");
    EXPECT_EQ(report.motions, drive.entries.size());
    EXPECT_EQ(report.unreliable, 0U);
    EXPECT_EQ(report.replaced, with_odometry ? drive.entries.size() : 0U);
    const auto end = endOf(folder / "out.rawlog");
    // 3.5 m and turns of 2 rad to and fro; the wheels end 8 cm off. The scans are exact.
    EXPECT_LT(core::distance(end, drive.truth.back()), 0.03) << method;
    const auto info = logs::inspectLog(folder / "out.rawlog");
    EXPECT_EQ(info.odometry_readings, drive.entries.size());
    EXPECT_EQ(info.form, logs::inspectLog(in).form);
  }
}

INSTANTIATE_TEST_SUITE_P(FormsWithAndWithoutOdometry, EveryForm,
                         ::testing::Combine(::testing::Values(RawlogForm::kActionFrame,
                                                              RawlogForm::kObservationOnly),
                                            ::testing::Bool()));

TEST(ScanOdometryLog, AnActionCarriesMeanCovarianceAndAModelThatAFileHolds) {
  const testing::TempFolder folder;
  const auto in = writeDrive(folder, RawlogForm::kActionFrame, true);
  write(in, folder / "out.rawlog", optionsOf("plicp"));
  const auto objects = readObjects(folder / "out.rawlog");
  ASSERT_EQ(objects.size(), 120U);
  const auto twin = odometry::makeScanOdometry(optionsOf("plicp").odometry);
  for (size_t i = 0; i < objects.size(); i += 2) {
    const auto actions = std::dynamic_pointer_cast<CActionCollection>(objects[i]);
    const auto frame = std::dynamic_pointer_cast<CSensoryFrame>(objects[i + 1]);
    ASSERT_TRUE(actions && frame);
    ASSERT_EQ(actions->size(), 2U);
    const auto scan = frame->getObservationByClass<mrpt::obs::CObservation2DRangeScan>();
    const auto motion = twin->update(lidar::fromMrpt(*scan));
    const auto best = actions->getBestMovementEstimation();
    EXPECT_EQ(best->estimationMethod, CActionRobotMovement2D::emScan2DMatching);
    EXPECT_EQ(best->timestamp, scan->timestamp);
    mrpt::poses::CPosePDFGaussian pdf;
    pdf.copyFrom(*best->poseChange);
    EXPECT_NEAR(pdf.mean.x(), motion.T_previous_current.x, 1e-12);
    EXPECT_NEAR(pdf.cov(0, 0), motion.covariance[0], 1e-12);
    EXPECT_NEAR(pdf.cov(0, 2), motion.covariance[2], 1e-12);
    const auto first = actions->getActionByClass<CActionRobotMovement2D>();  // what rbpf-slam takes
    EXPECT_EQ(first->estimationMethod, CActionRobotMovement2D::emOdometry);
    EXPECT_NEAR(first->rawOdometryIncrementReading.x(), motion.T_previous_current.x, 1e-6);
    EXPECT_NEAR(first->motionModelConfiguration.gaussianModel.minStdPHI, std::sqrt(motion.covariance[8]),
                1e-6);
  }
}

TEST(ScanOdometryLog, KeepsEverythingElse) {
  const testing::TempFolder folder;
  const auto drive = driveThroughRoom(4);
  Objects objects;
  for (size_t i = 0; i < 4; ++i) {
    auto actions = std::make_shared<CActionCollection>();
    CActionRobotMovement2D wheels;
    wheels.timestamp = mrpt::Clock::fromDouble(drive.entries[i].scan.time_s);
    wheels.computeFromOdometry({5, 5, 1}, {});
    actions->insert(wheels);
    auto frame = std::make_shared<CSensoryFrame>();
    auto comment = mrpt::obs::CObservationComment::Create();
    comment->text = "step " + std::to_string(i);
    frame->insert(comment);
    auto reading = CObservationOdometry::Create();
    reading->odometry = {9, 9, 0};
    frame->insert(reading);
    auto scan = lidar::toMrpt(drive.entries[i].scan);
    if (i == 2) scan->sensorLabel = "REAR";  // a frame without a scan of the lidar
    frame->insert(scan);
    objects.push_back(actions);
    objects.push_back(frame);
  }
  writeObjects(folder / "in.rawlog", objects);
  const auto report = write(folder / "in.rawlog", folder / "out.rawlog", optionsOf("correlation"));
  EXPECT_EQ(report.motions, 3U);
  EXPECT_EQ(report.replaced, 8U);  // four actions, four readings in frames
  const auto result = readObjects(folder / "out.rawlog");
  ASSERT_EQ(result.size(), 8U);
  for (size_t i = 0; i < 4; ++i) {
    const auto frame = std::dynamic_pointer_cast<CSensoryFrame>(result[2 * i + 1]);
    ASSERT_EQ(frame->size(), 2U);
    EXPECT_EQ(frame->getObservationByClass<mrpt::obs::CObservationComment>()->text,
              "step " + std::to_string(i));
  }
  // No motion before the frame without a scan; all of it before the next one.
  const auto motionAt = [&result](size_t i) {
    return std::dynamic_pointer_cast<CActionCollection>(result[2 * i])
        ->getBestMovementEstimation()
        ->poseChange->getMeanVal();
  };
  EXPECT_EQ(motionAt(2).norm(), 0);
  EXPECT_NEAR(motionAt(3).norm(), core::distance(drive.truth[1], drive.truth[3]), 0.01);
}

TEST(ScanOdometryLog, ObservationsWithoutOdometryBecomeFramesThatRbpfSlamReads) {
  const testing::TempFolder folder;
  const auto in = writeDrive(folder, RawlogForm::kObservationOnly, false);
  auto options = optionsOf("plicp");
  options.form = RawlogForm::kActionFrame;
  write(in, folder / "out.rawlog", options);
  EXPECT_EQ(logs::inspectLog(folder / "out.rawlog").form, "action / sensory frame");
  EXPECT_LT(core::distance(endOf(folder / "out.rawlog"), driveThroughRoom().truth.back()), 0.03);
}

TEST(ScanOdometryLog, AsksForTheKindOfEachMotionAndTellsWhatTheWheelsSaid) {
  const auto drive = driveThroughRoom();
  for (const auto form : {RawlogForm::kActionFrame, RawlogForm::kObservationOnly}) {
    const testing::TempFolder folder;
    const auto in = writeDrive(folder, form, true);
    auto options = optionsOf("argmax");
    std::vector<double> asked_s;
    options.commanded = [&](const lidar::Scan& scan, const std::optional<core::Pose2>& wheels) {
      const auto& entry = drive.entries.at(asked_s.size());
      asked_s.push_back(scan.time_s);
      if (asked_s.size() > 1) {  // the first absolute reading says nothing of what was before
        EXPECT_TRUE(wheels);
        EXPECT_LT(core::distance(wheels.value_or(core::Pose2{9, 9, 9}), entry.T_previous_robot), 1e-4);
      }
      return odometry::Commanded(odometry::MotionKind::kTurn);
    };
    write(in, folder / "out.rawlog", options);
    ASSERT_EQ(asked_s.size(), 60U);
    EXPECT_NEAR(asked_s[5] - asked_s[0], 1.0, 1e-6);
    logs::LogReader log(folder / "out.rawlog");
    while (const auto entry = log.next())  // told that it only turns, argmax never moves
      EXPECT_EQ(core::distance({}, entry->T_odom_robot), 0);
  }
}

TEST(ScanOdometryLog, TheSameLogGivesTheSameBytes) {
  const testing::TempFolder folder;
  const auto in = writeDrive(folder, RawlogForm::kActionFrame, true);
  write(in, folder / "a.rawlog", optionsOf("range_flow"));
  write(in, folder / "b.rawlog", optionsOf("range_flow"));
  EXPECT_EQ(files::readTextFile(folder / "a.rawlog"), files::readTextFile(folder / "b.rawlog"));
}

std::string errorOf(const std::string& in, const std::string& out, const ScanOdometryLogOptions& options) {
  try {
    write(in, out, options);
  } catch (const core::InputError& error) {
    return error.what();
  }
  return "no error";
}

TEST(ScanOdometryLog, RefusesWhatItCannotTakeOdometryFromAndLeavesNothing) {
  const testing::TempFolder folder;
  auto imu = mrpt::obs::CObservationIMU::Create();
  imu->timestamp = mrpt::Clock::fromDouble(1.7e9);
  writeObjects(folder / "no_scan.rawlog", {imu});
  EXPECT_THAT(errorOf(folder / "no_scan.rawlog", folder / "out.rawlog", optionsOf("plicp")),
              HasSubstr("no_scan.rawlog"));

  const auto scan = lidar::toMrpt(driveThroughRoom(1).entries[0].scan);
  auto frame = std::make_shared<CSensoryFrame>();
  frame->insert(scan);
  writeObjects(folder / "mixed.rawlog", {scan, std::make_shared<CActionCollection>(), frame});
  EXPECT_THAT(errorOf(folder / "mixed.rawlog", folder / "out.rawlog", optionsOf("plicp")),
              HasSubstr("frames and bare scans of 'LASER' in one log, expected one form; give --form"));
  EXPECT_THAT(errorOf(folder / "mixed.rawlog", folder / "out.rawlog", optionsOf("plicpp")),
              HasSubstr("did you mean 'plicp'?"));
  EXPECT_THROW(files::requireReadableFile(folder / "out.rawlog"), core::InputError);
}

}  // namespace
}  // namespace slam::run
