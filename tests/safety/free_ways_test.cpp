#include <gmock/gmock.h>

#include "libslam/safety/free_ways.h"
#include "libslam/safety/view.h"
#include "libslam/strategies/strategy.h"
#include "tests/navigate/scenes.h"

namespace slam::safety {
namespace {

using core::degToRad;
using lidar::kLostReading;
using lidar::kNoReturn;

/// Beams at -180, -135, -90, -45, 0, 45, 90 and 135 degrees.
lidar::Scan star(std::vector<float> ranges_m) {
  lidar::Scan scan;
  scan.first_angle_rad = -core::kPi;
  scan.step_rad = core::kPi / 4;
  scan.max_range_m = 10;
  scan.ranges_m = std::move(ranges_m);
  return scan;
}

TEST(CanMove, TellsTheFourCasesApart) {
  EXPECT_EQ(safety::canMove(star({5, 5, 5, 5, 5, 5, 5, 5}), 1), safety::FreeWays::kBoth);
  EXPECT_EQ(safety::canMove(star({0.9F, 5, 5, 5, 5, 5, 5, 5}), 1), safety::FreeWays::kFrontOnly);
  EXPECT_EQ(safety::canMove(star({5, 5, 5, 5, 0.9F, 5, 5, 5}), 1), safety::FreeWays::kRearOnly);
  EXPECT_EQ(safety::canMove(star({0.9F, 5, 5, 5, 0.9F, 5, 5, 5}), 1), safety::FreeWays::kNone);
  EXPECT_EQ(static_cast<int>(safety::FreeWays::kNone), 3);  // the original document's numbers
}

TEST(CanMove, CountsTheEdgesOfTheSectorsAndNotTheSides) {
  for (const size_t front : {3, 5}) {
    std::vector<float> ranges(8, 5);
    ranges[front] = 0.9F;
    EXPECT_EQ(safety::canMove(star(ranges), 1), safety::FreeWays::kRearOnly) << front;
  }
  for (const size_t rear : {1, 7}) {
    std::vector<float> ranges(8, 5);
    ranges[rear] = 0.9F;
    EXPECT_EQ(safety::canMove(star(ranges), 1), safety::FreeWays::kFrontOnly) << rear;
  }
  EXPECT_EQ(safety::canMove(star({5, 5, 0.1F, 5, 5, 5, 0.1F, 5}), 1), safety::FreeWays::kBoth);
}

TEST(CanMove, IsFreeAtExactlyTheClearanceAndWhereNothingReturns) {
  EXPECT_EQ(safety::canMove(star({1, 1, 1, 1, 1, 1, 1, 1}), 1), safety::FreeWays::kBoth);
  EXPECT_EQ(safety::canMove(star(std::vector<float>(8, kNoReturn)), 1), safety::FreeWays::kBoth);
}

TEST(CanMove, IsBlockedWhereItSeesNothing) {
  EXPECT_EQ(safety::canMove(star({}), 1), safety::FreeWays::kNone);
  EXPECT_EQ(safety::canMove(star(std::vector<float>(8, kLostReading)), 1), safety::FreeWays::kNone);
  auto half_circle = star({5, 5, 5, 5, 5});
  half_circle.first_angle_rad = -core::kPi / 2;
  EXPECT_EQ(safety::canMove(half_circle, 1), safety::FreeWays::kFrontOnly);
  half_circle.T_robot_lidar.phi = core::kPi;  // mounted backwards
  EXPECT_EQ(safety::canMove(half_circle, 1), safety::FreeWays::kRearOnly);
}

TEST(CanMove, MeasuresFromTheRobotsCentreForALidarMountedAhead) {
  auto scan = star(std::vector<float>(8, 0.8F));
  scan.T_robot_lidar.x = 0.3;
  EXPECT_EQ(safety::canMove(scan, 1), safety::FreeWays::kFrontOnly);  // 1.1 m ahead, 0.5 m behind
}

/// The original document's own indices: 0 straight ahead, growing to the left; first and last eighth, 3/8 to
/// 5/8.
safety::FreeWays canMoveByIndices(const std::vector<float>& ranges, double w) {
  const size_t n = ranges.size();
  bool front = true, rear = true;
  for (size_t i = 0; i < n; ++i) {
    if (ranges[i] >= w) continue;
    if (i < n / 8 || i >= n - n / 8) front = false;
    if (i >= 3 * n / 8 && i < 5 * n / 8) rear = false;
  }
  return front ? (rear ? safety::FreeWays::kBoth : safety::FreeWays::kFrontOnly)
               : (rear ? safety::FreeWays::kRearOnly : safety::FreeWays::kNone);
}

TEST(CanMove, AgreesWithTheOriginalIndicesOnRandomScans) {
  core::RandomStream random(3, "test scans");
  std::vector<int> seen(4, 0);
  for (int trial = 0; trial < 500; ++trial) {
    // Beams between the degrees, so that none lies on the edge of a sector, which ours includes on both
    // sides.
    std::vector<float> original(360, 5);
    for (int k = 0; k < 2; ++k) original[random.below(360)] = 0.5F;
    lidar::Scan scan;
    scan.first_angle_rad = degToRad(-179.5);
    scan.step_rad = degToRad(1);
    scan.max_range_m = 10;
    for (size_t i = 0; i < 360; ++i) scan.ranges_m.push_back(original[(i + 180) % 360]);
    const safety::FreeWays ways = safety::canMove(scan, 1);
    ++seen[static_cast<size_t>(ways)];
    ASSERT_EQ(ways, canMoveByIndices(original, 1));
  }
  for (const int count : seen) EXPECT_GT(count, 10);
}

TEST(SeenBeams, StartStraightAheadAndGoRoundToTheLeft) {
  const auto beams = safety::seenBeams(star({1, 2, kLostReading, 4, 5, 6, kNoReturn, 8}));
  ASSERT_EQ(beams.size(), 7u);
  const std::vector<double> degrees = {0, 45, 90, 135, 180, 225, 315}, ranges = {5, 6, 10, 8, 1, 2, 4};
  for (size_t i = 0; i < beams.size(); ++i) {
    EXPECT_NEAR(core::radToDeg(beams[i].angle_rad), degrees[i], 1e-9);  // sums of a few products
    EXPECT_EQ(beams[i].range_m, ranges[i]);
  }
}

TEST(SeenBeams, PutABeamThatIsAFewUlpsRightOfAheadFirst) {
  auto scan = star({5, 5, 5, 5, 5, 5, 5, 5});
  scan.first_angle_rad -= 1e-15;
  EXPECT_EQ(safety::seenBeams(scan).front().angle_rad, 0);
  EXPECT_EQ(safety::quadrantOf(core::kPi / 2 - 1e-15), 1);
  EXPECT_EQ(safety::quadrantOf(2 * core::kPi), 3);
}

TEST(FreeTravel, IsTheDistanceToTheFirstContactOfTheDisc) {
  EXPECT_DOUBLE_EQ(safety::freeTravel({{3, 0}}, 0, 0.5), 2.5);
  EXPECT_DOUBLE_EQ(safety::freeTravel({{3, 0.3}, {5, 0}}, 0, 0.5), 2.6);  // 3-4-5 triangle
  EXPECT_EQ(safety::freeTravel({{3, 0.5}, {-1, 0}}, 0, 0.5), INFINITY);   // passes, and what is behind
  EXPECT_EQ(safety::freeTravel({}, 0, 0.5), INFINITY);
  EXPECT_EQ(safety::freeTravel({{0.3, 0}}, 0, 0.5), 0);                 // already too near: not further in,
  EXPECT_EQ(safety::freeTravel({{0.3, 0}}, core::kPi, 0.5), INFINITY);  // but out again
  EXPECT_NEAR(safety::freeTravel({{0, 2}}, core::kPi / 2, 0.5), 1.5, 1e-15);
}

}  // namespace
}  // namespace slam::safety
