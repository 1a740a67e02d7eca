#include <gtest/gtest.h>
#include <mrpt/io/CFileGZInputStream.h>
#include <mrpt/io/CMemoryStream.h>
#include <mrpt/maps/CSimplePointsMap.h>
#include <mrpt/obs/CActionCollection.h>
#include <mrpt/obs/CActionRobotMovement2D.h>
#include <mrpt/obs/CObservation2DRangeScan.h>
#include <mrpt/obs/CRawlog.h>
#include <mrpt/obs/CSensoryFrame.h>
#include <mrpt/poses/CPosePDFGaussian.h>
#include <mrpt/serialization/CArchive.h>
#include <mrpt/slam/CMetricMapBuilderICP.h>

#include <cmath>
#include <filesystem>
#include <tuple>

#include "libslam/core/error.h"
#include "libslam/lidar/mrpt_types.h"
#include "libslam/odometry/mrpt_action.h"
#include "tests/odometry/scene.h"

namespace slam::odometry {
namespace {

using core::Pose2;
using mrpt::obs::CActionRobotMovement2D;
using mrpt::poses::CPose2D;
using mrpt::poses::CPosePDFGaussian;
using scenes::Lidar;
using scenes::look;
using scenes::oddRoom;

ScanMotion someMotion() {
  ScanMotion motion;
  motion.T_previous_current = {0.12, -0.03, 0.2};
  motion.covariance = {4e-6, 1e-6, 2e-7, 1e-6, 9e-6, -1e-7, 2e-7, -1e-7, 1e-6};
  return motion;
}

TEST(ToMrptAction, CarriesMeanCovarianceAndTime) {
  const auto action = toMrptAction(someMotion(), 1700000000.25);
  EXPECT_EQ(action->estimationMethod, CActionRobotMovement2D::emScan2DMatching);
  EXPECT_NEAR(mrpt::Clock::toDouble(action->timestamp), 1700000000.25, 1e-6);  // MRPT counts 100 ns ticks
  const auto pdf = std::dynamic_pointer_cast<CPosePDFGaussian>(action->poseChange.get_ptr());
  ASSERT_TRUE(pdf);
  EXPECT_EQ(pdf->mean.x(), 0.12);
  EXPECT_EQ(pdf->mean.y(), -0.03);
  EXPECT_NEAR(pdf->mean.phi(), 0.2, 1e-15);  // MRPT wraps it
  for (int r = 0; r < 3; ++r)
    for (int c = 0; c < 3; ++c) {
      const int k = 3 * r + c;
      EXPECT_EQ(pdf->cov(r, c), someMotion().covariance[static_cast<size_t>(k)]);
    }
}

TEST(ToMrptAction, ComesBackFromAStreamTheSame) {
  const auto action = toMrptAction(someMotion(), 1700000000.25);
  mrpt::io::CMemoryStream stream;
  auto archive = mrpt::serialization::archiveFrom(stream);
  archive << *action;
  stream.Seek(0);
  CActionRobotMovement2D read;
  archive >> read;
  EXPECT_EQ(read.estimationMethod, CActionRobotMovement2D::emScan2DMatching);
  EXPECT_EQ(read.timestamp, action->timestamp);
  const auto pdf = std::dynamic_pointer_cast<CPosePDFGaussian>(read.poseChange.get_ptr());
  ASSERT_TRUE(pdf);
  EXPECT_EQ(pdf->mean.x(), 0.12);
  EXPECT_EQ(pdf->cov(1, 0), 1e-6);
  EXPECT_EQ(pdf->cov(2, 2), 1e-6);
}

TEST(ToMrptAction, TheMotionModelSpreadsOneStepAsTheCovarianceDoesAndManyStepsNotMuchMore) {
  const ScanMotion motion = someMotion();
  const auto action = toMrptAction(motion, 1);
  const double std_xy = std::sqrt(9.2e-6);  // larger half axis of the covariance, by hand: 9.19e-6
  for (const int steps : {1, 4, 9, 25}) {
    // What CMetricMapBuilderRBPF does: it adds up the means and spreads the sum by the model.
    CActionRobotMovement2D summed;
    const auto& T = motion.T_previous_current;
    summed.computeFromOdometry(CPose2D(steps * T.x, steps * T.y, steps * T.phi),
                               action->motionModelConfiguration);
    const auto cov = std::get<0>(summed.poseChange->getCovarianceAndMean());
    const double root = std::sqrt(static_cast<double>(steps));
    EXPECT_GT(std::sqrt(cov(2, 2)), 1e-3 * root) << steps;
    EXPECT_LT(std::sqrt(cov(2, 2)), 4e-3 * root) << steps;
    // Heading errors swing the position too, so only a lower bound holds for it.
    EXPECT_GT(std::sqrt(std::max(cov(0, 0), cov(1, 1))), 0.9 * std_xy * root) << steps;
  }
}

TEST(ToMrptAction, RefusesAMotionThatIsNotFinite) {
  ScanMotion motion;
  motion.T_previous_current.x = std::nan("");
  EXPECT_THROW(toMrptAction(motion, 1), core::ContractError);
}

TEST(ToMrptAction, IsPreferredByMrptToWheelOdometryBesideIt) {
  mrpt::obs::CActionCollection actions;
  CActionRobotMovement2D wheels;
  wheels.computeFromOdometry(CPose2D(1, 0, 0), {});
  actions.insert(wheels);
  actions.insert(*toMrptAction(someMotion(), 1));
  EXPECT_EQ(actions.getBestMovementEstimation()->estimationMethod, CActionRobotMovement2D::emScan2DMatching);
}

TEST(ToMrptAction, DrivesMrptsIcpBuilder) {
  mrpt::slam::CMetricMapBuilderICP builder;
  builder.setVerbosityLevel(mrpt::system::LVL_ERROR);
  mrpt::maps::CSimplePointsMap::TMapDefinition points;
  points.insertionOpts.minDistBetweenLaserPoints = 0.05f;
  builder.ICP_options.mapInitializers.push_back(points);
  builder.ICP_params.onlyUniqueRobust = false;
  builder.initialize();

  Lidar lidar;
  lidar.beams = 361;
  const auto odometry = scenes::make("correlation");
  const Pose2 start{0.2, 0.2, 0.3}, step{0.05, 0, 0.03};
  Pose2 truth = start;
  for (int i = 0; i < 15; ++i) {
    if (i > 0) truth = truth * step;
    auto scan = look(oddRoom(), truth, lidar);
    scan.time_s = 1700000000.0 + 0.2 * i;
    mrpt::obs::CActionCollection actions;
    actions.insert(*toMrptAction(odometry->update(scan), scan.time_s));
    mrpt::obs::CSensoryFrame frame;
    frame.insert(lidar::toMrpt(scan));
    builder.processActionObservation(actions, frame);
  }
  const auto pose = builder.getCurrentPoseEstimation()->getMeanVal();
  const Pose2 expected = core::between(start, truth);
  // The builder corrects by ICP every 0.2 m; a few centimetres is what that is worth on a 5 cm point map.
  EXPECT_NEAR(pose.x(), expected.x, 0.05);
  EXPECT_NEAR(pose.y(), expected.y, 0.05);
  EXPECT_NEAR(pose.yaw(), expected.phi, 0.03);
}

TEST(ToMrptActions, AreTwoOfWhichTheFirstBringsItsMotionModelThroughAFile) {
  const auto motion = someMotion();
  mrpt::io::CMemoryStream stream;
  auto archive = mrpt::serialization::archiveFrom(stream);
  archive << *toMrptActions(motion, 1700000000.25);
  stream.Seek(0);
  mrpt::obs::CActionCollection read;
  archive >> read;
  ASSERT_EQ(read.size(), 2U);
  // rbpf-slam takes the first, adds up means and spreads the sum by its model.
  const auto first = read.getActionByClass<CActionRobotMovement2D>();
  EXPECT_EQ(first->estimationMethod, CActionRobotMovement2D::emOdometry);
  EXPECT_NEAR(first->poseChange->getMeanVal().x(), 0.12, 1e-6);  // single precision in the file
  EXPECT_NEAR(first->motionModelConfiguration.gaussianModel.minStdXY, std::sqrt(9.2e-6), 2e-5);
  EXPECT_NEAR(first->motionModelConfiguration.gaussianModel.minStdPHI, 1e-3, 1e-8);
  // icp-slam and graphslam-engine take this one.
  const auto best = read.getBestMovementEstimation();
  EXPECT_EQ(best->estimationMethod, CActionRobotMovement2D::emScan2DMatching);
  EXPECT_NEAR(std::get<0>(best->poseChange->getCovarianceAndMean())(1, 1), 9e-6, 1e-15);
}

TEST(CorrelationOdometry, FollowsTheRealMalagaLogFromScansAlone) {
  const std::string path = "/usr/share/mrpt/datasets/2006-01ENE-21-SENA_Telecom Faculty_one_loop_only.rawlog";
  if (!std::filesystem::exists(path)) GTEST_SKIP() << "needs Debian's mrpt-common: " << path;
  mrpt::io::CFileGZInputStream file(path);
  auto archive = mrpt::serialization::archiveFrom(file);
  const auto odometry = scenes::make("correlation");
  Pose2 pose;
  int scans = 0, unreliable = 0;
  size_t entry = 0;
  mrpt::obs::CActionCollection::Ptr actions;
  mrpt::obs::CSensoryFrame::Ptr frame;
  mrpt::obs::CObservation::Ptr observation;
  while (mrpt::obs::CRawlog::getActionObservationPairOrObservation(archive, actions, frame, observation,
                                                                   entry)) {
    const auto scan = frame ? frame->getObservationByClass<mrpt::obs::CObservation2DRangeScan>() : nullptr;
    if (!scan) continue;
    const ScanMotion motion = odometry->update(lidar::fromMrpt(*scan));
    pose = pose * motion.T_previous_current;
    unreliable += motion.reliable ? 0 : 1;
    ++scans;
  }
  EXPECT_EQ(scans, 224);
  EXPECT_EQ(unreliable, 0);
  // No truth exists. MRPT's icp-slam ends at (4.31, -18.49, -1.530) or (4.23, -18.43, -1.533) by its
  // settings, after 60 m; half a metre and two degrees is what composing 223 increments may drift from that.
  EXPECT_NEAR(pose.x, 4.27, 0.5);
  EXPECT_NEAR(pose.y, -18.46, 0.5);
  EXPECT_NEAR(pose.phi, -1.53, 0.035);
}

}  // namespace
}  // namespace slam::odometry
