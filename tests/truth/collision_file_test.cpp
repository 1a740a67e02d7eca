#include "libslam/truth/collision_file.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>

#include "libslam/core/error.h"
#include "libslam/testing/temp_folder.h"

namespace slam::truth {
namespace {
using ::testing::HasSubstr;

TEST(CollisionFile, ComesBackAsItWasWritten) {
  const testing::TempFolder folder;
  const std::string path = collisionsPath(folder / "run.rawlog");
  EXPECT_EQ(path, folder / "run.collisions.csv");
  EXPECT_EQ(collisionsPath(folder / "run.gt.tum"), path);
  EXPECT_EQ(collisionsPath(folder / "run.rawlog.GT.txt"), path);
  EXPECT_TRUE(readCollisions(path).empty());
  std::ofstream(path) << collisionsCsv({{1700000000.25, {1.5, -2, 0.5}}});
  const auto collisions = readCollisions(path);
  ASSERT_EQ(collisions.size(), 1U);
  EXPECT_DOUBLE_EQ(collisions[0].time_s, 1700000000.25);
  EXPECT_DOUBLE_EQ(collisions[0].T_world_robot.y, -2);
  std::ofstream(path, std::ios::app) << "1,2\n";
  try {
    readCollisions(path);
    FAIL();
  } catch (const core::InputError& error) {
    EXPECT_THAT(error.what(), HasSubstr("run.collisions.csv:3: found 2 fields, expected 4"));
  }
}

}  // namespace
}  // namespace slam::truth
