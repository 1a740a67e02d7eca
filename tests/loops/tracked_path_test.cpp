#include "libslam/loops/tracked_path.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "libslam/core/error.h"
#include "tests/graph/drawn_drives.h"

namespace slam::loops {
namespace {

using namespace graph::test_drives;

TrackedPath::Placed placedAt(const core::Pose2& T_map_robot, const core::Pose2& T_before_robot) {
  TrackedPath::Placed placed;
  placed.T_map_robot = T_map_robot;
  placed.T_before_robot = T_before_robot;
  placed.odometry_covariance = Eigen::Vector3d(0.02 * 0.02, 0.02 * 0.02, 0.02 * 0.02).asDiagonal();
  placed.is_matched = placed.is_explained = true;
  return placed;
}

/// Every third scan of a drive, where it was in truth.
void follow(TrackedPath& path, const Drive& log, bool is_open = false) {
  for (size_t i = 0; i < log.scans.size(); ++i) {
    path.nextScan(i == 0 ? 0 : core::distance(log.truth[i - 1], log.truth[i]));
    if (i % 3 != 0) continue;
    auto placed =
        placedAt(log.truth[i], i == 0 ? core::Pose2{} : core::between(log.truth[i - 3], log.truth[i]));
    placed.is_matched = i > 0;
    if (is_open) placed.open = core::Point2{1, 0};
    path.addKeyframe({log.scans[i]}, placed);
  }
}

TEST(TrackedPath, GrowsWithTheGroundNotWithTheLaps) {
  keyframes::GraphOptions options;
  options.known_views = 2;
  const auto afterLaps = [&](int laps) {
    TrackedPath path(options);
    follow(path, drive(ring(), lapsAround(laps), {}, 0));
    return path.size();
  };
  const int three = afterLaps(3), six = afterLaps(6);
  EXPECT_LT(three, 2.5 * afterLaps(1));
  EXPECT_LT(six, 1.1 * three);
}

TEST(TrackedPath, HasTheErrorsOfOdometryWhereAMatchLeavesADirectionOpen) {
  std::vector<core::Pose2> way;
  way.reserve(100);
  for (int i = 0; i < 100; ++i) way.push_back({1 + 0.1 * i, 1, 0});
  const Drive log = drive(ring(), way, {}, 0);
  const auto along = [&](bool is_open) {
    TrackedPath path(keyframes::GraphOptions{});
    follow(path, log, is_open);
    return path.covariance(path.size() - 1)(0, 0);
  };
  // 33 steps of 2 cm each, independent, are 11 cm.
  EXPECT_NEAR(std::sqrt(along(true)), 0.02 * std::sqrt(33.0), 0.02);
  EXPECT_LT(std::sqrt(along(false)), 0.03);
}

/// A lap and a bit, with a tracker that turns too far: the end of the lap lies apart from its beginning.
struct Bent {
  Drive log = drive(ring(), lapsAround(2), {}, 0);
  std::vector<core::Pose2> tracked;
  Bent() {
    tracked.push_back({});
    for (size_t i = 1; i < log.truth.size(); ++i) {
      core::Pose2 step = core::between(log.truth[i - 1], log.truth[i]);
      step.phi += 1.5e-4;
      tracked.push_back(tracked.back() * step);
    }
  }
};

double closedBy(const Bent& drive, bool changes_its_mind) {
  TrackedPath path(keyframes::GraphOptions{});
  for (size_t i = 0; i < drive.tracked.size(); ++i) {
    path.nextScan(i == 0 ? 0 : core::distance(drive.tracked[i - 1], drive.tracked[i]));
    if (i % 3 != 0) continue;
    auto placed = placedAt(drive.tracked[i],
                           i == 0 ? core::Pose2{} : core::between(drive.tracked[i - 3], drive.tracked[i]));
    placed.is_matched = i > 0;
    const bool was_off = changes_its_mind && i > 0;
    if (was_off) placed.T_map_robot = placed.T_map_robot * core::Pose2{0, 0.2, 0.05};
    if (path.addKeyframe({drive.log.scans[i]}, placed)) {
      double worst = 0;
      for (int k = 0; k < path.size(); ++k)
        worst =
            std::max(worst, core::distance(path.pose(k), drive.log.truth[static_cast<size_t>(path.scan(k))]));
      return worst;
    }
    if (was_off) path.setPose(path.size() - 1, drive.tracked[i]);
  }
  return -1;
}

TEST(TrackedPath, ClosesALoopAndTellsOf) {
  const Bent bent;
  double before = 0;
  for (size_t i = 0; i < bent.tracked.size(); ++i)
    before = std::max(before, core::distance(bent.tracked[i], bent.log.truth[i]));
  const double after = closedBy(bent, false);
  ASSERT_GE(after, 0) << "no loop";
  RecordProperty("worst", std::to_string(before) + " " + std::to_string(after));
  EXPECT_LT(after, 0.5 * before);
}

// A keyframe that was put elsewhere takes what was measured from there along: nothing pulls it back.
TEST(TrackedPath, AKeyframeThatIsMovedTakesItsMatchesAlong) {
  const Bent bent;
  const double moved = closedBy(bent, true);
  ASSERT_GE(moved, 0) << "no loop";
  RecordProperty("worst", std::to_string(moved));
  // Each was off by 0.2 m and 3 degrees when it was matched, which says a little less; pulled back, they curl
  // up.
  EXPECT_LT(moved, 1);
}

TEST(TrackedPath, HasRules) {
  TrackedPath path(keyframes::GraphOptions{});
  EXPECT_FALSE(path.finish());
  EXPECT_EQ(path.anchor(), -1);
  const Drive log = drive(ring(), {{1, 1, 0}}, {}, 0);
  EXPECT_THROW(path.addKeyframe({log.scans[0]}, placedAt({}, {})), core::ContractError);
  path.nextScan(0);
  EXPECT_THROW(path.addKeyframe({}, placedAt({}, {})), core::ContractError);
}

}  // namespace
}  // namespace slam::loops
