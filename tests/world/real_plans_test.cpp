#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <string>

#include "libslam/testing/temp_folder.h"
#include "libslam/world/plan.h"

namespace slam::world {
namespace {

class RealPlans : public ::testing::Test {
 protected:
  void SetUp() override {
    folder_ = testing::realDataFolder(RASTERSLAM_SOURCE_DIR);
    if (folder_.empty())
      GTEST_SKIP() << "no real plans here: set RASTERSLAM_REAL_DATA to a folder with worlds/";
  }
  std::string folder_;
};

TEST_F(RealPlans, LoadWithPlausibleSizes) {
  struct Expected {
    const char* file;
    int columns, rows;
    double resolution_m;
    int least_occupied, most_occupied;  // of the cells, in 1/1000
    int least_free, most_free;
  };
  // willow: 54.0 x 58.7 m; its rooms cover nearly all of the picture. turtlebot3: a small room in a large
  // unknown picture. depot: free all over.
  for (const Expected& expected : {Expected{"willow/willow-full.yaml", 540, 587, 0.1, 20, 40, 900, 980},
                                   Expected{"turtlebot3/map.yaml", 384, 384, 0.05, 3, 10, 40, 70},
                                   Expected{"nav2/depot.yaml", 604, 307, 0.05, 20, 50, 950, 980}}) {
    const Plan plan = loadPlan(folder_ + "/worlds/" + expected.file);
    EXPECT_EQ(plan.columns, expected.columns) << expected.file;
    EXPECT_EQ(plan.rows, expected.rows);
    EXPECT_EQ(plan.resolution_m, expected.resolution_m);
    const auto perMille = [&](Cell cell) {
      return 1000 * std::count(plan.cells.begin(), plan.cells.end(), cell) /
             static_cast<std::ptrdiff_t>(plan.cells.size());
    };
    EXPECT_GE(perMille(Cell::kOccupied), expected.least_occupied) << expected.file;
    EXPECT_LE(perMille(Cell::kOccupied), expected.most_occupied) << expected.file;
    EXPECT_GE(perMille(Cell::kFree), expected.least_free) << expected.file;
    EXPECT_LE(perMille(Cell::kFree), expected.most_free) << expected.file;
    const auto pose = findStartPose(plan, 0.3);
    ASSERT_TRUE(pose) << expected.file;
    EXPECT_FALSE(discCollides(plan, core::position(*pose), 0.3));
  }
}

TEST_F(RealPlans, PlaceTheTurtlebotWorldAtItsOrigin) {
  // The picture's origin is (-10, -10) so that the little world lies around the world's origin.
  const Plan plan = loadPlan(folder_ + "/worlds/turtlebot3/map.yaml");
  const core::Point2 corner = cellsToPoint(plan, {0, 0});
  EXPECT_EQ(corner.x, -10);
  EXPECT_EQ(corner.y, -10);
  const auto pose = findStartPose(plan, 0.2);
  ASSERT_TRUE(pose);
  EXPECT_LT(std::hypot(pose->x, pose->y), 1);
}

}  // namespace
}  // namespace slam::world
