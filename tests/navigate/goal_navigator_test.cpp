#include "libslam/goals/goal_navigator.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>

#include "libslam/buildings/building.h"
#include "libslam/core/error.h"
#include "tests/navigate/goal_scenes.h"
#include "tests/navigate/scenes.h"

namespace slam::navigate {
namespace {

using ::testing::HasSubstr;
using namespace scenes;

/// The guard's distance and the clearance: how far from walls the boundary of the grown obstacles runs.
double followRadius(const robot::LidarOptions& lidar) {
  const goals::NavigateOptions options;
  return robot::circumscribedRadius(robot::RobotOptions()) + 0.02 + lidar.sigma_m + options.clearance_m;
}

// ---- the contract, for every method

class EveryNavigator : public ::testing::TestWithParam<std::string> {};
INSTANTIATE_TEST_SUITE_P(Methods, EveryNavigator, ::testing::ValuesIn(goals::goalNavigatorNames()),
                         [](const auto& method) { return method.param; });

robot::Scan emptyScan(float range_m) {
  robot::Scan scan;
  scan.first_angle_rad = -core::kPi;
  scan.step_rad = core::kPi / 180;
  scan.max_range_m = 6;
  scan.ranges_m.assign(360, range_m);
  return scan;
}

std::unique_ptr<goals::GoalNavigator> navigatorTo(const std::string& method, const core::Point2& goal,
                                                  double limit_s = 100) {
  goals::NavigateOptions options;
  options.time_limit_s = limit_s;
  return goals::makeGoalNavigator(method, options, {goal, robot::RobotOptions(), 0.2});
}

TEST_P(EveryNavigator, CrossesAnOpenRoom) {
  const auto drive = driveTo(openRoom(), GetParam(), exactLidar(), exactOdometry());
  EXPECT_EQ(drive.status, goals::GoalStatus::kReached) << drive.reason;
  EXPECT_LE(drive.goal_distance_m, 0.1 + 1e-9);
  EXPECT_LE(drive.path_m, 4.1);  // 4.01 m as the crow flies, 0.1 m for the turn on the way
  EXPECT_EQ(drive.collisions, 0U);
}

TEST_P(EveryNavigator, IsThereAtOnceWhenTheGoalIsTheStart) {
  const auto step = navigatorTo(GetParam(), {0, 0})->next(emptyScan(3), {}, false);
  EXPECT_EQ(step.status, goals::GoalStatus::kReached);
  EXPECT_EQ(step.command.speed_mps, 0);
  EXPECT_EQ(step.command.turn_rate_radps, 0);
}

TEST_P(EveryNavigator, DrivesWhereNothingReturns) {
  const auto navigator = navigatorTo(GetParam(), {3, -2});
  core::Pose2 T_odom_robot;
  goals::GoalStep step;
  for (int i = 0; i < 200 && step.status == goals::GoalStatus::kMoving; ++i) {
    step = navigator->next(emptyScan(robot::kNoReturn), T_odom_robot, false);
    T_odom_robot = T_odom_robot * robot::driveMotion(step.command);
  }
  EXPECT_EQ(step.status, goals::GoalStatus::kReached);
}

TEST_P(EveryNavigator, GivesUpWithoutAnyValidReading) {
  const auto navigator = navigatorTo(GetParam(), {3, 0});
  goals::GoalStep step;
  for (int i = 0; i < 30; ++i) {
    step = navigator->next(emptyScan(robot::kLostReading), {}, false);
    EXPECT_EQ(step.command.speed_mps, 0);
  }
  EXPECT_EQ(step.status, goals::GoalStatus::kGaveUp);
  EXPECT_EQ(step.reason, "no valid reading for 5 s");
}

TEST_P(EveryNavigator, GivesUpAtTheTimeLimitAndWhenThePoseIsLost) {
  const auto navigator = navigatorTo(GetParam(), {100, 0}, 2);
  goals::GoalStep step;
  for (int i = 0; i < 12; ++i) step = navigator->next(emptyScan(robot::kNoReturn), {0.5 * i, 0, 0}, false);
  EXPECT_EQ(step.status, goals::GoalStatus::kGaveUp);
  EXPECT_EQ(step.reason, "time limit of 2 s of the robot's time");
  const core::Pose2 lost{std::nan(""), 0, 0};
  EXPECT_EQ(navigatorTo(GetParam(), {1, 0})->next(emptyScan(3), lost, false).status,
            goals::GoalStatus::kGaveUp);
}

TEST_P(EveryNavigator, EndsWhenItIsBoxedIn) {
  // Something all round nearer than the guard lets it move.
  const auto navigator = navigatorTo(GetParam(), {3, 0});
  goals::GoalStep step;
  core::Pose2 T_odom_robot;
  for (int i = 0; i < 400 && step.status == goals::GoalStatus::kMoving; ++i) {
    step = navigator->next(emptyScan(0.3F), T_odom_robot, false);
    T_odom_robot = T_odom_robot * robot::driveMotion(step.command);
  }
  EXPECT_NE(step.status, goals::GoalStatus::kMoving);
  EXPECT_NE(step.status, goals::GoalStatus::kReached);
  EXPECT_LT(std::hypot(T_odom_robot.x, T_odom_robot.y), 0.03);
}

TEST_P(EveryNavigator, RepeatsItself) {
  const auto first = driveTo(doors(), GetParam(), circleLidar(), {}, {}, 5);
  const auto second = driveTo(doors(), GetParam(), circleLidar(), {}, {}, 5);
  ASSERT_EQ(first.truth.size(), second.truth.size());
  EXPECT_EQ(first.end.x, second.end.x);
  EXPECT_EQ(first.end.y, second.end.y);
}

// The lidar of 270 degrees with its noise, wheels with theirs, every committed world.
TEST_P(EveryNavigator, NeverCollidesInACommittedWorldWithNoise) {
  for (const auto& name : buildings::buildingNames()) {
    GoalScene scene;
    scene.plan = buildings::makeBuilding(name, 1);
    const auto start = world::findStartPose(scene.plan, robot::circumscribedRadius(robot::RobotOptions()));
    ASSERT_TRUE(start.has_value());
    scene.start = *start;
    robot::LidarOptions lidar;
    lidar.beams = 181;
    goals::NavigateOptions options;
    options.time_limit_s = 80;
    for (const double side : {-1.0, 1.0}) {
      scene.goal = {start->x + side * 6, start->y + side * 2.5};
      const auto drive = driveTo(scene, GetParam(), lidar, robot::OdometryOptions(), options, 3);
      EXPECT_EQ(drive.collisions, 0U) << name;
      EXPECT_NE(drive.status, goals::GoalStatus::kMoving);
    }
  }
}

TEST_P(EveryNavigator, FeelsItsWayWhereTheLidarSeesNothing) {
  // The plan's edge stops the robot and returns no ray: only the bumper knows of it.
  GoalScene scene{room(4, 3), {1, 1.5, 0}, {8, 1.5}};
  for (auto& cell : scene.plan.cells) cell = world::Cell::kFree;
  fill(scene.plan, 0, 0, 0.1, 0.1);  // a plan needs a wall somewhere
  goals::NavigateOptions options;
  options.time_limit_s = 300;
  const auto drive = driveTo(scene, GetParam(), exactLidar(), exactOdometry(), options);
  EXPECT_NE(drive.status, goals::GoalStatus::kReached);
  EXPECT_GT(drive.collisions, 0U);
}

// ---- the guarantees of the textbook methods

class TextbookBug : public ::testing::TestWithParam<std::string> {};
INSTANTIATE_TEST_SUITE_P(Methods, TextbookBug, ::testing::Values("bug1", "bug2", "tangent"),
                         [](const auto& method) { return method.param; });

TEST_P(TextbookBug, ReachesEveryGoalThatCanBeReached) {
  for (const auto& [name, scene] : reachableScenes())
    for (const bool noisy : {false, true}) {
      // With noise: the lidar with a blind sector behind.
      robot::LidarOptions lidar = exactLidar();
      if (noisy) lidar = robot::LidarOptions(), lidar.beams = 271;
      const auto drive = driveTo(scene, GetParam(), lidar, exactOdometry());
      EXPECT_EQ(drive.status, goals::GoalStatus::kReached) << name << ": " << drive.reason;
      EXPECT_LE(drive.goal_distance_m, 0.1 + 1e-9) << name;
      EXPECT_EQ(drive.collisions, 0U) << name;
    }
}

TEST_P(TextbookBug, SaysOfEveryOtherGoalThatItCannotBeReached) {
  for (const auto& [name, scene] : unreachableScenes())
    for (const bool noisy : {false, true}) {
      robot::LidarOptions lidar = exactLidar();
      if (noisy) lidar = robot::LidarOptions(), lidar.beams = 271;
      const auto drive = driveTo(scene, GetParam(), lidar, exactOdometry());
      EXPECT_EQ(drive.status, goals::GoalStatus::kUnreachable) << name << ": " << drive.reason;
      EXPECT_EQ(drive.collisions, 0U) << name;
    }
}

TEST_P(TextbookBug, TurnsTheOtherWayWhenAsked) {
  goals::NavigateOptions options;
  options.turn = "right";
  for (const auto& scene : {pillar(), trap()}) {
    const auto drive = driveTo(scene, GetParam(), exactLidar(), exactOdometry(), options);
    EXPECT_EQ(drive.status, goals::GoalStatus::kReached) << drive.reason;
  }
}

GoalScene mazeScene(std::uint64_t seed) {
  GoalScene scene;
  scene.plan = buildings::makeBuilding("maze", seed);
  int low = scene.plan.columns, high = 0;
  for (int row = 0; row < scene.plan.rows; ++row)
    for (int column = 0; column < scene.plan.columns; ++column)
      if (scene.plan.at(column, row) == world::Cell::kFree)
        low = std::min(low, column), high = std::max(high, column);
  // The middles of the first and of the last cell of the maze: passages are 26 cells wide.
  const auto start = world::cellsToWorld(scene.plan, {low + 13.0, low + 13.0});
  scene.start = {start.x, start.y, 0};
  scene.goal = world::cellsToWorld(scene.plan, {high - 12.0, high - 12.0});
  return scene;
}

TEST_P(TextbookBug, FindsThroughGeneratedMazes) {
  for (const std::uint64_t seed : {1, 3}) {
    robot::LidarOptions lidar = exactLidar(4);
    lidar.beams = 240;
    const auto drive = driveTo(mazeScene(seed), GetParam(), lidar, exactOdometry());
    EXPECT_EQ(drive.status, goals::GoalStatus::kReached) << seed << ": " << drive.reason;
    EXPECT_EQ(drive.collisions, 0U) << seed;
  }
}

TEST_P(TextbookBug, KnowsThatAWalledInGoalOfAMazeCannotBeReached) {
  GoalScene scene = mazeScene(1);
  const auto wall = [&](double x0, double y0, double x1, double y1) {
    fill(scene.plan, scene.goal.x + x0, scene.goal.y + y0, scene.goal.x + x1, scene.goal.y + y1);
  };
  wall(-0.7, -0.7, -0.6, 0.7), wall(-0.7, -0.7, 0.7, -0.6);
  wall(0.6, -0.7, 0.7, 0.7), wall(-0.7, 0.6, 0.7, 0.7);
  robot::LidarOptions lidar = exactLidar(4);
  lidar.beams = 240;
  const auto drive = driveTo(scene, GetParam(), lidar, exactOdometry());
  EXPECT_EQ(drive.status, goals::GoalStatus::kUnreachable) << drive.reason;
}

// ---- the published bounds

/// The boundaries of the obstacles grown by a disc: the level lines of the distance to the nearest wall.
class GrownObstacles {
 public:
  struct Boundary {
    double perimeter_m = 0, nearest_goal_m = std::numeric_limits<double>::infinity();
    int crossings = 0;  ///< with the line from start to goal
  };

  /// Distances by brute force at the corners of a grid, crossings along its edges by linear interpolation.
  GrownObstacles(const GoalScene& scene, double radius_m) : scene_(scene), radius_m_(radius_m) {
    const auto& plan = scene.plan;
    const int columns = plan.columns + 1, rows = plan.rows + 1;
    margin_m_.resize(static_cast<size_t>(columns) * rows);
    for (int row = 0; row < rows; ++row)
      for (int column = 0; column < columns; ++column)
        margin_m_[static_cast<size_t>(row) * columns + column] = distanceToWall(column, row) - radius_m;
    for (int row = 0; row + 1 < rows; ++row)
      for (int column = 0; column + 1 < columns; ++column) addSquare(column, row, columns);
  }

  std::vector<Boundary> boundaries() {
    std::map<size_t, Boundary> found;
    for (const auto& s : segments_) {
      Boundary& b = found[rootOf(s.edge_a)];
      b.perimeter_m += core::distance(s.a, s.b);
      b.nearest_goal_m = std::min(b.nearest_goal_m, core::distance(s.a, scene_.goal));
      b.crossings += crossesLine(s.a, s.b);
    }
    std::vector<Boundary> list;
    for (const auto& [root, boundary] : found) list.push_back(boundary);
    return list;
  }

 private:
  struct Segment {
    core::Point2 a, b;
    size_t edge_a;
  };

  double distanceToWall(int column, int row) const {
    const auto& plan = scene_.plan;
    const int reach = static_cast<int>(std::ceil(radius_m_ / plan.resolution_m)) + 2;
    double nearest = std::pow(reach, 2);
    for (int r = std::max(0, row - reach); r < std::min(plan.rows, row + reach); ++r)
      for (int c = std::max(0, column - reach); c < std::min(plan.columns, column + reach); ++c) {
        if (plan.at(c, r) != world::Cell::kOccupied) continue;
        const double dx = std::max({0, c - column, column - c - 1}), dy = std::max({0, r - row, row - r - 1});
        nearest = std::min(nearest, dx * dx + dy * dy);
      }
    return std::sqrt(nearest) * plan.resolution_m;
  }

  /// Marching squares without the ambiguous case: its two segments join what they join.
  void addSquare(int column, int row, int columns) {
    const auto corner = [&](int dc, int dr) { return static_cast<size_t>(row + dr) * columns + column + dc; };
    std::vector<std::pair<core::Point2, size_t>> cuts;
    const auto cut = [&](int c0, int r0, int c1, int r1) {
      const double a = margin_m_[corner(c0, r0)], b = margin_m_[corner(c1, r1)];
      if ((a > 0) == (b > 0)) return;
      const double s = a / (a - b);
      cuts.push_back(
          {world::cellsToWorld(scene_.plan, {column + c0 + s * (c1 - c0), row + r0 + s * (r1 - r0)}),
           2 * corner(c0, r0) + (r0 != r1)});
    };
    cut(0, 0, 1, 0), cut(1, 0, 1, 1), cut(0, 0, 0, 1), cut(0, 1, 1, 1);
    for (size_t i = 0; i + 1 < cuts.size(); i += 2) {
      segments_.push_back({cuts[i].first, cuts[i + 1].first, cuts[i].second});
      const size_t a = rootOf(cuts[i].second), b = rootOf(cuts[i + 1].second);
      root_[a] = b;
    }
  }

  size_t rootOf(size_t edge) {
    auto it = root_.find(edge);
    if (it == root_.end()) it = root_.emplace(edge, edge).first;
    while (it->second != edge) edge = it->second, it = root_.find(edge);
    return edge;
  }

  bool crossesLine(const core::Point2& a, const core::Point2& b) const {
    const core::Point2 s = core::position(scene_.start), g = scene_.goal;
    const auto side = [](const core::Point2& p, const core::Point2& q, const core::Point2& r) {
      return (q.x - p.x) * (r.y - p.y) - (q.y - p.y) * (r.x - p.x) > 0;
    };
    return side(s, g, a) != side(s, g, b) && side(a, b, s) != side(a, b, g);
  }

  const GoalScene& scene_;
  double radius_m_;
  std::vector<double> margin_m_;
  std::vector<Segment> segments_;
  std::map<size_t, size_t> root_;
};

// A path is at most this much longer than the boundary that it follows: 3 % for steps of 0.1 m on arcs and
// the grid's error in the perimeter, 0.5 m for every boundary for meeting it, and for the tolerance within
// which a round is closed.
double tolerated(double bound_m, size_t boundaries) {
  return 1.03 * bound_m + 0.5 * static_cast<double>(boundaries);
}

TEST(GrownObstacles, AreMeasuredRight) {
  const GoalScene scene = pillar();
  auto boundaries = GrownObstacles(scene, 0.35).boundaries();
  ASSERT_EQ(boundaries.size(), 2U);  // the walls of the room, the block
  std::sort(boundaries.begin(), boundaries.end(),
            [](const auto& a, const auto& b) { return a.perimeter_m < b.perimeter_m; });
  // Linear interpolation of a distance that curves within a cell of 5 cm: 1 %.
  EXPECT_NEAR(boundaries[0].perimeter_m, 2 * (0.8 + 1.2) + 2 * core::kPi * 0.35, 0.06);
  EXPECT_NEAR(boundaries[1].perimeter_m, 2 * (7 + 5 - 4 * 0.35), 0.2);
  EXPECT_EQ(boundaries[0].crossings, 2);
  EXPECT_EQ(boundaries[1].crossings, 0);
}

// Lumelsky and Stepanov, Algorithmica 2 (1987): P <= D + 1.5 * sum of p_i over the obstacles that meet the
// disc of radius D around the goal.
TEST(Bug1Bound, HoldsInEveryDrawnScene) {
  for (const auto& [name, scene] : reachableScenes()) {
    const auto drive = driveTo(scene, "bug1", exactLidar(), exactOdometry());
    const double direct_m = core::distance(core::position(scene.start), scene.goal);
    double bound_m = direct_m;
    const auto boundaries = GrownObstacles(scene, followRadius(exactLidar())).boundaries();
    for (const auto& b : boundaries)
      if (b.nearest_goal_m <= direct_m) bound_m += 1.5 * b.perimeter_m;
    EXPECT_LE(drive.path_m, tolerated(bound_m, boundaries.size())) << name;
    EXPECT_GE(drive.path_m, direct_m - 0.2) << name;
  }
}

// The same: P <= D + sum of n_i * p_i / 2, n_i the crossings of the line with obstacle i.
TEST(Bug2Bound, HoldsInEveryDrawnScene) {
  for (const auto& [name, scene] : reachableScenes()) {
    const auto drive = driveTo(scene, "bug2", exactLidar(), exactOdometry());
    const double direct_m = core::distance(core::position(scene.start), scene.goal);
    double bound_m = direct_m;
    const auto boundaries = GrownObstacles(scene, followRadius(exactLidar())).boundaries();
    for (const auto& b : boundaries) bound_m += 0.5 * b.crossings * b.perimeter_m;
    EXPECT_LE(drive.path_m, tolerated(bound_m, boundaries.size())) << name;
  }
}

TEST(goals::TangentBug, SeesItsWayRoundAPillarWithoutTouchingIt) {
  const auto drive = driveTo(pillar(), "tangent", exactLidar(), exactOdometry());
  // Over the nearer corner the disc's way is 5.22 m.
  EXPECT_LE(drive.path_m, 5.5);
  EXPECT_THAT(drive.states, ::testing::ElementsAre("to goal", "reached"));
}

TEST(goals::TangentBug, SavesWayWithALongerRange) {
  goals::NavigateOptions near;
  near.sensor_range_m = 1.0;
  const auto blind = driveTo(pillar(), "tangent", exactLidar(8), exactOdometry(), near);
  const auto far = driveTo(pillar(), "tangent", exactLidar(8), exactOdometry());
  EXPECT_EQ(blind.status, goals::GoalStatus::kReached) << blind.reason;
  EXPECT_LT(far.path_m, blind.path_m - 0.1);
}

TEST(GoalNavigators, AreMadeByName) {
  try {
    goals::makeGoalNavigator("bug3", {}, {});
    FAIL() << "no error";
  } catch (const core::InputError& error) {
    EXPECT_STREQ(
        error.what(),
        "method of navigation: found 'bug3', expected one of bug1, bug2, tangent, lidar_bug; did you "
        "mean 'bug1'?");
  }
  EXPECT_THROW(goals::makeGoalNavigator("bug1", {}, {{std::nan(""), 0}, {}, 0.2}), core::ContractError);
  EXPECT_THROW(goals::makeGoalNavigator("bug1", {}, {{1, 0}, {}, 0.0}), core::ContractError);
  for (const auto& name : goals::goalNavigatorNames()) EXPECT_NE(goals::goalNavigatorMeaning(name), "");
  EXPECT_THROW(goals::goalNavigatorMeaning("bug3"), core::ContractError);
}

}  // namespace
}  // namespace slam::navigate
