// Where the robots of a team stand at the beginning.
#include <gtest/gtest.h>

#include "libslam/core/error.h"
#include "libslam/robot/drive.h"
#include "libslam/teams/team.h"
#include "tests/explore/two_rooms.h"

namespace slam::teams {
namespace {

/// A team in a plan of 20 x 14 m; the first one starts at `start`, "x,y,degrees".
TeamRequest requestOf(int robots, const std::string& start) {
  TeamRequest request;
  request.config = explore::quickConfig("nearest_frontier", 5, {"simulation.start=" + start});
  request.robots = robots;
  return request;
}

double spacingOf(const TeamRequest& request) {
  return 2 * robot::circumscribedRadius(request.config.record.robot) + kBeside_m;
}

void expectAt(const core::Pose2& actual, double x, double y, double degrees) {
  EXPECT_NEAR(actual.x, x, 1e-9);
  EXPECT_NEAR(actual.y, y, 1e-9);
  EXPECT_NEAR(core::angleDifference(actual.phi, core::degToRad(degrees)), 0, 1e-9);
}

TEST(TeamStarts, BesideTheFirstToItsLeftAndRightThenBehind) {
  const auto hall = explore::drawnPlan("hall", 400, 280, {});
  const auto request = requestOf(4, "10,7,90");
  const auto starts = teamStarts(hall, request);
  const double aside_m = spacingOf(request);
  ASSERT_EQ(starts.size(), 4U);
  expectAt(starts[0], 10, 7, 90);
  // It looks along y: its left is at smaller x, and behind it is below.
  expectAt(starts[1], 10 - aside_m, 7, 90);
  expectAt(starts[2], 10 + aside_m, 7, 90);
  expectAt(starts[3], 10, 7 - aside_m, 90);
}

TEST(TeamStarts, NotInAWallAndNotBehindOne) {
  auto request = requestOf(2, "10,7,0");
  const double aside_m = spacingOf(request), radius_m = (aside_m - kBeside_m) / 2;
  // A thin wall to the left, between both discs; cells of 5 cm.
  const auto cells = [](double metres) { return static_cast<int>(std::lround(metres / 0.05)); };
  const int wall = cells(7 + radius_m + kBeside_m / 2);
  const auto beside = explore::drawnPlan("beside", 400, 280, {{150, wall, 250, wall + 1}});
  const auto starts = teamStarts(beside, request);
  ASSERT_EQ(starts.size(), 2U);
  expectAt(starts[1], 10, 7 - aside_m, 0);
}

TEST(TeamStarts, AreTakenAsTheyAreGivenIfNoDiscsTouch) {
  const auto hall = explore::drawnPlan("hall", 400, 280, {});
  auto request = requestOf(2, "10,7,90");
  const double radius_m = (spacingOf(request) - kBeside_m) / 2;
  request.T_world_starts = {{3, 3, 1}, {3 + 2 * radius_m + 0.001, 3, 2}};
  const auto starts = teamStarts(hall, request);
  ASSERT_EQ(starts.size(), 2U);
  EXPECT_EQ(starts[0].phi, 1);
  EXPECT_EQ(starts[1].phi, 2);
  request.T_world_starts[1].x -= 0.002;
  EXPECT_THROW(teamStarts(hall, request), core::InputError);
  request.T_world_starts[1].x = 40;
  EXPECT_THROW(teamStarts(hall, request), core::InputError) << "outside of the plan";
  request.T_world_starts.pop_back();
  EXPECT_THROW(teamStarts(hall, request), core::InputError);
}

}  // namespace
}  // namespace slam::teams
