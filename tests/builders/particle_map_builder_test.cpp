#include "libslam/builders/particle_map_builder.h"

#include <gtest/gtest.h>
#include <mrpt/math/TPose2D.h>
#include <mrpt/obs/CActionCollection.h>
#include <mrpt/obs/CActionRobotMovement2D.h>
#include <mrpt/obs/CObservation2DRangeScan.h>
#include <mrpt/poses/CPosePDFGaussian.h>

#include "libslam/lidar/mrpt_types.h"
#include "libslam/mapping/map_builder.h"
#include "tests/mapping/small_room.h"

namespace slam::builders {
namespace {

mapping::MapBuilder makeMethod() {
  const std::string path = std::string(RASTERSLAM_SOURCE_DIR) + "/configs/methods";
  return mapping::makeMapBuilder(mapping::loadMethodConfig(path, "particles"), "particles", 1);
}

core::Trajectory run(mapping::MapBuilder& method, const mapping::test::Drive& drive) {
  core::Trajectory online;
  for (const auto& entry : drive.entries)
    online.push_back(
        {entry.scan.time_s, mapping::processScan(method, entry.scan, entry.T_previous_robot, true)});
  return online;
}

TEST(ParticleMapBuilder, GivesTheCorrectedPathWithAPoseForEveryScan) {
  auto method = makeMethod();
  const auto drive = mapping::test::driveThroughRoom();
  const auto online = run(method, drive);
  const auto path = finalPath(method, online).value();
  ASSERT_EQ(path.size(), drive.entries.size());
  for (size_t i = 0; i < path.size(); ++i) EXPECT_LT(core::distance(path[i].pose, drive.truth[i]), 0.06);
}

TEST(ParticleMapBuilder, EveryPoseComesWithItsCovariance) {
  auto method = makeMethod();
  const auto online = run(method, mapping::test::driveThroughRoom(20));
  const auto [covariance, mean] = mrptBuilder(method).getCurrentPoseEstimation()->getCovarianceAndMean();
  for (const int i : {0, 1, 3}) {
    EXPECT_GT(covariance(i, i), 1e-8);
    EXPECT_LT(covariance(i, i), 1e-2);
  }
  EXPECT_EQ(covariance(2, 2), 0);
  EXPECT_EQ(finalPath(method, online)->back().pose.x, mean.x());
}

// The map as MRPT has it is the map as our own grid has it: same walls, free where the robot drove, unknown
// outside.
TEST(ParticleMapBuilder, PublishesWhatTheKeyFramesSaw) {
  auto method = makeMethod();
  const auto drive = mapping::test::driveThroughRoom();
  run(method, drive);
  const auto map = currentMap(method);
  EXPECT_EQ(map.resolution_m, 0.05);
  for (const auto& pose : drive.truth) EXPECT_LT(map.at(map.columnOf(pose.x), map.rowOf(pose.y)), 0.4F);
  EXPECT_EQ(map.at(0, 0), 0.5F);
  mrpt::maps::CSimpleMap frames;
  mrptBuilder(method).getCurrentlyBuiltMap(frames);
  EXPECT_GE(frames.size(), 5U);
  EXPECT_EQ(frames.size(), mrptBuilder(method).getCurrentlyBuiltMapSize());
  // Asked again, and in between: the same.
  auto watched = makeMethod();
  for (const auto& entry : drive.entries) {
    mapping::processScan(watched, entry.scan, entry.T_previous_robot, true);
    currentMap(watched);
  }
  EXPECT_EQ(currentMap(watched).occupancy, map.occupancy);
}

TEST(ParticleMapBuilder, ContinuesFromASavedMapAndLocalisesInIt) {
  auto first = makeMethod();
  const auto drive = mapping::test::driveThroughRoom();
  run(first, drive);
  mrpt::maps::CSimpleMap saved;
  mrptBuilder(first).getCurrentlyBuiltMap(saved);

  auto second = makeMethod();
  const auto& truth = drive.truth[30];
  const mrpt::poses::CPosePDFGaussian start(
      mrpt::poses::CPose2D(lidar::toMrpt(core::Pose2{truth.x + 0.1, truth.y - 0.05, truth.phi + 0.05})));
  mrptBuilder(second).initialize(saved, &start);
  mrptBuilder(second).options.enableMapUpdating = false;
  for (size_t i = 30; i < 50; ++i) {
    const auto pose =
        mapping::processScan(second, drive.entries[i].scan, drive.entries[i].T_previous_robot, true);
    EXPECT_LT(core::distance(pose, drive.truth[i]), 0.06) << i;
  }
  EXPECT_EQ(mrptBuilder(second).getCurrentlyBuiltMapSize(), saved.size());
}

TEST(ParticleMapBuilder, ItsJournalIsTheFilters) {
  auto method = makeMethod();
  const auto drive = mapping::test::driveThroughRoom();
  run(method, drive);
  auto blind = drive.entries.back().scan;
  for (auto& range_m : blind.ranges_m) range_m = lidar::kNoReturn;
  mapping::processScan(method, blind, {}, true);
  const auto journal = journalOf(method);
  ASSERT_FALSE(journal.empty());
  EXPECT_EQ(journal.back().event, core::JournalEvent::kLost);
  EXPECT_EQ(journal.back().scan, static_cast<int>(drive.entries.size()));
  EXPECT_EQ(journal.back().value, 0);
  EXPECT_EQ(journal.back().other_scan, -1);
}

TEST(ParticleMapBuilder, KeepsTheMotionOfFramesWithoutAScan) {
  const auto drive = mapping::test::driveThroughRoom(3);
  auto whole = makeMethod(), split = makeMethod();
  run(whole, drive);
  mapping::processScan(split, drive.entries[0].scan, {}, true);
  const auto feed = [&](const core::Pose2& motion, const lidar::Scan* scan) {
    mrpt::obs::CActionRobotMovement2D action;
    mrpt::obs::CActionRobotMovement2D::TMotionModelOptions model;
    model.modelSelection = mrpt::obs::CActionRobotMovement2D::mmGaussian;
    action.computeFromOdometry(mrpt::poses::CPose2D(lidar::toMrpt(motion)), model);
    mrpt::obs::CActionCollection actions;
    actions.insert(action);
    mrpt::obs::CSensoryFrame frame;
    if (scan) frame.insert(lidar::toMrpt(*scan));
    mrptBuilder(split).processActionObservation(actions, frame);
  };
  feed(drive.entries[1].T_previous_robot, nullptr);
  feed(drive.entries[2].T_previous_robot, &drive.entries[2].scan);
  const auto pose = mrptBuilder(split).getCurrentPoseEstimation()->getMeanVal();
  EXPECT_LT(core::distance({pose.x(), pose.y(), 0}, drive.truth[2]), 0.03);
}

}  // namespace
}  // namespace slam::builders
