#include "libslam/live/robot_drag.h"

#include <gtest/gtest.h>

namespace slam::live {
namespace {

TEST(RobotDrag, MovesTheRobotByAsMuchAsTheMouse) {
  RobotDrag drag;
  EXPECT_FALSE(drag.press({3, 3}, {1, 1, 0.5}, 0.3));
  EXPECT_FALSE(drag.held());
  ASSERT_TRUE(drag.press({1.1, 0.9}, {1, 1, 0.5}, 0.3));
  drag.move({4.1, 2.9}, false);
  EXPECT_NEAR(drag.held()->x, 4, 1e-12);
  const auto pose = drag.release();
  ASSERT_TRUE(pose);
  EXPECT_NEAR(pose->y, 3, 1e-12);
  EXPECT_EQ(pose->phi, 0.5);
  EXPECT_FALSE(drag.held());
}

TEST(RobotDrag, TurnsItTowardsTheMouse) {
  RobotDrag drag;
  drag.press({1, 1}, {1, 1, 0}, 0.3);
  drag.move({1, 5}, true);
  EXPECT_NEAR(drag.held()->phi, core::kPi / 2, 1e-12);
  EXPECT_EQ(drag.held()->x, 1);
  drag.move({2, 5}, false);  // and goes on from there
  EXPECT_NEAR(drag.held()->x, 2, 1e-12);
  EXPECT_NEAR(drag.held()->y, 1, 1e-12);
}

TEST(RobotDrag, AClickCarriesNothing) {
  RobotDrag drag;
  drag.press({1, 1}, {1, 1, 0}, 0.3);
  EXPECT_FALSE(drag.release());
  drag.move({5, 5}, false);
  EXPECT_FALSE(drag.release());
}

}  // namespace
}  // namespace slam::live
