#include "libslam/builders/naive_map_builder.h"

#include <gtest/gtest.h>
#include <mrpt/obs/CActionCollection.h>
#include <mrpt/obs/CActionRobotMovement2D.h>
#include <mrpt/obs/CObservation2DRangeScan.h>
#include <mrpt/obs/CSensoryFrame.h>
#include <mrpt/poses/CPosePDFGaussian.h>

#include "libslam/builders/exact_grid.h"
#include "libslam/lidar/mrpt_types.h"

namespace slam::builders {
namespace {

using mrpt::obs::CActionRobotMovement2D;

/// Three beams to the right, ahead and to the left; only the middle one returns, at 2 m, and the left one
/// at 1.
lidar::Scan threeBeams() {
  lidar::Scan scan;
  scan.first_angle_rad = -core::kPi / 2;
  scan.step_rad = core::kPi / 2;
  scan.max_range_m = 10;
  scan.ranges_m = {lidar::kNoReturn, 2, 1};
  return scan;
}

void process(NaiveMapBuilder& builder, const mrpt::obs::CActionCollection& actions) {
  mrpt::obs::CActionCollection copy = actions;
  mrpt::obs::CSensoryFrame frame;
  frame.insert(lidar::toMrpt(threeBeams()));
  builder.processActionObservation(copy, frame);
}

CActionRobotMovement2D wheelAction(const mrpt::poses::CPose2D& increment) {
  CActionRobotMovement2D action;
  action.computeFromOdometry(increment, {});
  return action;
}

std::vector<std::pair<int, int>> dotsInTenths(const NaiveMapBuilder& builder) {
  const auto grid =
      compat::asReference(builder.getCurrentlyBuiltMetricMap()).mapByClass<mrpt::maps::COccupancyGridMap2D>();
  std::vector<std::pair<int, int>> dots;
  for (unsigned y = 0; y < grid->getSizeY(); ++y)
    for (unsigned x = 0; x < grid->getSizeX(); ++x)
      if (grid->getCell(static_cast<int>(x), static_cast<int>(y)) != 0.5F)
        dots.emplace_back(static_cast<int>(std::floor(grid->idx2x(x) * 10)),
                          static_cast<int>(std::floor(grid->idx2y(y) * 10)));
  return dots;
}

MappingOptions tenthOfAMetre() {
  MappingOptions options;
  options.resolution_m = 0.1;
  return options;
}

TEST(NaiveMapBuilder, PutsADotForEveryReturnAndNothingElse) {
  NaiveMapBuilder builder(tenthOfAMetre());
  mrpt::obs::CActionCollection actions;
  // Off the lines between cells: returns at (2.04, 0.03) and (0.04, 1.03).
  actions.insert(wheelAction({0.04, 0.03, 0}));
  process(builder, actions);
  EXPECT_EQ(dotsInTenths(builder), (std::vector<std::pair<int, int>>{{20, 0}, {0, 10}}));
}

TEST(NaiveMapBuilder, AddsUpTheMotionsAndNeverCorrectsThem) {
  NaiveMapBuilder builder(tenthOfAMetre());
  mrpt::obs::CActionCollection quarter_turn;
  quarter_turn.insert(wheelAction({1, 0, core::kPi / 2}));
  process(builder, quarter_turn);
  process(builder, quarter_turn);
  const auto pose = builder.getCurrentPoseEstimation()->getMeanVal();
  EXPECT_NEAR(pose.x(), 1, 1e-12);
  EXPECT_NEAR(pose.y(), 1, 1e-12);
  EXPECT_NEAR(std::abs(pose.yaw()), core::kPi, 1e-12);
}

TEST(NaiveMapBuilder, BelievesScanMatchingBeforeTheWheels) {
  NaiveMapBuilder builder(tenthOfAMetre());
  mrpt::obs::CActionCollection both;
  both.insert(wheelAction({5, 0, 0}));
  CActionRobotMovement2D matched;
  matched.estimationMethod = CActionRobotMovement2D::emScan2DMatching;
  mrpt::math::CMatrixDouble33 covariance;
  covariance.setDiagonal(1e-4);
  matched.poseChange = mrpt::poses::CPosePDFGaussian::Create(mrpt::poses::CPose2D(1, 0, 0), covariance);
  both.insert(matched);
  process(builder, both);
  EXPECT_NEAR(builder.getCurrentPoseEstimation()->getMeanVal().x(), 1, 1e-12);
}

TEST(NaiveMapBuilder, WithRaysFreesWhatTheRaysCross) {
  auto options = tenthOfAMetre();
  options.draw = "rays";
  options.grid = "exact";
  NaiveMapBuilder builder(options);
  process(builder, {});
  const auto grid = compat::asReference(builder.getCurrentlyBuiltMetricMap()).mapByClass<ExactGrid>();
  ASSERT_TRUE(grid);
  EXPECT_GT(grid->getPos(1.0F, 0.0F), 0.5F);
  EXPECT_LT(grid->getPos(2.0F, 0.0F), 0.5F);
  EXPECT_EQ(grid->getPos(3.0F, 0.0F), 0.5F);
}

TEST(NaiveMapBuilder, DrawsAfterMovesOnlyWhereAskedTo) {
  auto options = tenthOfAMetre();
  options.draw_after = "moves";
  NaiveMapBuilder builder(options);
  process(builder, {});
  EXPECT_TRUE(dotsInTenths(builder).empty()) << "the first look comes before any command";
  EXPECT_EQ(builder.getCurrentlyBuiltMapSize(), 1U);
  mrpt::obs::CActionCollection turn, move;
  turn.insert(wheelAction({0.001, 0, 0.4}));
  move.insert(wheelAction({0.31, 0.03, 0}));
  process(builder, turn);
  EXPECT_TRUE(dotsInTenths(builder).empty());
  process(builder, move);
  EXPECT_EQ(dotsInTenths(builder).size(), 2U);
}

TEST(NaiveMapBuilder, KeepsKeyFramesOnlyAfterTheInsertDistance) {
  auto options = tenthOfAMetre();
  options.insert_distance_m = 0.5;
  NaiveMapBuilder builder(options);
  mrpt::obs::CActionCollection step;
  step.insert(wheelAction({0.26, 0, 0}));
  for (int i = 0; i < 5; ++i) process(builder, step);
  // The first scan, and those after 0.52 and 1.04 m more.
  EXPECT_EQ(builder.getCurrentlyBuiltMapSize(), 3U);
  mrpt::maps::CSimpleMap key_frames;
  builder.getCurrentlyBuiltMap(key_frames);
  EXPECT_EQ(key_frames.size(), 3U);
  builder.initialize();
  EXPECT_EQ(builder.getCurrentlyBuiltMapSize(), 0U);
  EXPECT_EQ(builder.getCurrentPoseEstimation()->getMeanVal().x(), 0);
}

}  // namespace
}  // namespace slam::builders
