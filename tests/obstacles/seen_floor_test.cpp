#include "libslam/obstacles/seen_floor.h"

#include <gtest/gtest.h>

#include <limits>

#include "libslam/core/error.h"

namespace slam::obstacles {
namespace {

/// What a sensor sees that looks from x = 0 to `reach_m` ahead, half a metre to either side.
class Strip : public VisibleArea {
 public:
  explicit Strip(double reach_m) : reach_m_(reach_m) {}
  bool contains(const core::Point2& p_robot) const override {
    return p_robot.x >= 0 && p_robot.x <= reach_m_ && std::abs(p_robot.y) <= 0.5;
  }
  std::vector<core::Point2> outline(double /*reach_m*/) const override { return {}; }

 private:
  double reach_m_;
};

LocalObstacleOptions zone(double width_m, double front_m, double rear_m) {
  LocalObstacleOptions options;
  options.width_m = width_m, options.front_m = front_m, options.rear_m = rear_m;
  return options;
}

TEST(SeenFloor, IsWhatTheSensorShowsAndWhereTheRobotStands) {
  SeenFloor floor(zone(4, 4, 4));
  EXPECT_FALSE(floor.isSeen({0, 0}));
  floor.update({10, 20, core::kPi / 2}, Strip(1.5), 0.3);
  EXPECT_TRUE(floor.isSeen({10, 21.4}));
  EXPECT_TRUE(floor.isSeen({9.6, 21}));
  EXPECT_FALSE(floor.isSeen({9.4, 21}));
  EXPECT_FALSE(floor.isSeen({10, 21.6}));
  EXPECT_TRUE(floor.isSeen({10, 19.8})) << "under the robot";
  EXPECT_FALSE(floor.isSeen({10, 19.6}));
}

TEST(SeenFloor, IsRememberedUntilItLeavesTheZone) {
  SeenFloor floor(zone(4, 4, 1));
  floor.update({0, 0, 0}, Strip(2), 0);
  floor.update({0, 0, core::kPi}, Strip(0), 0);  // turned round: still in the zone, up to 1 m behind
  EXPECT_TRUE(floor.isSeen({0.9, 0}));
  EXPECT_FALSE(floor.isSeen({1.2, 0}));
  floor.update({0, 0, 0}, Strip(0), 0);
  EXPECT_FALSE(floor.isSeen({1.2, 0})) << "forgotten for good";
  floor.update({100, 0, 0}, Strip(0), 0);
  floor.update({0, 0, 0}, Strip(0), 0);
  EXPECT_FALSE(floor.isSeen({0.9, 0}));
}

TEST(SeenFloor, NamesTheNearestPlaceThatWasNotSeen) {
  SeenFloor floor(zone(6, 6, 6));
  floor.update({0, 0, 0}, Strip(1.5), 0.3);
  EXPECT_FALSE(floor.unseenWithin({1, 0}, 0.4, {0, 0}));
  const auto beyond = floor.unseenWithin({1.3, 0}, 0.4, {0, 0});
  ASSERT_TRUE(beyond);
  EXPECT_NEAR(beyond->x, 1.525, 1e-9);  // the centre of the first cell beyond
  EXPECT_NEAR(std::abs(beyond->y), 0.025, 1e-9);
  const auto beside = floor.unseenWithin({1, 0.2}, 0.4, {1, 0});
  ASSERT_TRUE(beside);
  EXPECT_NEAR(beside->y, 0.525, 1e-9);
  SeenFloor wide(zone(20, 20, 20));
  wide.update({0, 0, 0}, Strip(20), 0.3);
  EXPECT_TRUE(wide.isSeen({1.9, 0}));
  EXPECT_FALSE(wide.isSeen({2.1, 0})) << "farther than its reach";
}

TEST(SeenFloor, RefusesAPoseThatIsNotFinite) {
  SeenFloor floor;
  EXPECT_THROW(floor.update({std::numeric_limits<double>::quiet_NaN(), 0, 0}, Strip(1), 0),
               core::ContractError);
  floor.update({1e300, 0, 0}, Strip(1), 0.3);  // so far out there are no cells, and nothing else happens
  EXPECT_FALSE(floor.isSeen({0, 0}));
}

}  // namespace
}  // namespace slam::obstacles
