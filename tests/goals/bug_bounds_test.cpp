// The published bounds of the lengths of paths, in every drawn scene.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>

#include "libslam/goals/goal_navigator.h"
#include "tests/navigate/goal_scenes.h"
#include "tests/navigate/scenes.h"

namespace slam::navigate {
namespace {

using namespace scenes;

/// The guard's distance and the clearance: how far from walls the boundary of the grown obstacles runs.
double followRadius(const lidar::LidarOptions& lidar) {
  const goals::NavigateOptions options;
  return robot::circumscribedRadius(robot::RobotOptions()) + 0.02 + lidar.sigma_m + options.clearance_m;
}

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
    list.reserve(found.size());
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
          {world::cellsToPoint(scene_.plan, {column + c0 + s * (c1 - c0), row + r0 + s * (r1 - r0)}),
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

}  // namespace
}  // namespace slam::navigate
