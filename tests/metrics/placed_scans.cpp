#include "libslam/metrics/placed_scans.h"
#include "libslam/core/numbers.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

#include "libslam/core/error.h"
#include "libslam/core/random.h"
#include "libslam/metrics/statistics.h"
#include "tests/metrics/drawn.h"

namespace slam::metrics {
namespace {

using core::kPi;
using core::Point2;
using world::CellMap;

using core::kNaN;
constexpr double kExact = 1e-9;  // a few operations on coordinates of metres
constexpr double kAdded = kSmallestSpread_m * kSmallestSpread_m;

/// Entropy of a spread with these variances along its axes, by the definition.
double entropyOf(double var_x, double var_y) {
  return 0.5 * std::log(std::pow(2 * kPi * std::exp(1.0), 2) * (var_x + kAdded) * (var_y + kAdded));
}

/// Each corner of a rectangle twice: variances a^2 and b^2, and seven others around each point.
std::vector<Point2> rectangle(const Point2& centre, double a, double b) {
  std::vector<Point2> points;
  for (int twice = 0; twice < 2; ++twice)
    for (const double x : {-a, a})
      for (const double y : {-b, b}) points.push_back({centre.x + x, centre.y + y});
  return points;
}

TEST(PointSharpness, OfARectangleIsWhatTheHandComputes) {
  const auto s = pointSharpness(rectangle({1, -2}, 0.1, 0.02));
  EXPECT_NEAR(s.mean_map_entropy, entropyOf(0.01, 0.0004), kExact);
  EXPECT_NEAR(s.mean_map_entropy, -3.3753,
              1e-3);  // 2.8379 + ln(0.1) + ln(0.02), and a little for the millimetre
  EXPECT_NEAR(s.wall_thickness_m, 0.02, kExact);
  EXPECT_EQ(s.points, 8U);
  EXPECT_EQ(s.left_out, 0U);
}

TEST(PointSharpness, IsTheMeanOverThePointsThatHaveNeighbours) {
  auto points = rectangle({0, 0}, 0.1, 0.02);
  const auto other = rectangle({5, 5}, 0.05, 0.05);
  points.insert(points.end(), other.begin(), other.end());
  points.push_back({20, 20});
  const auto s = pointSharpness(points);
  EXPECT_EQ(s.points, 17U);
  EXPECT_EQ(s.left_out, 1U);
  EXPECT_NEAR(s.mean_map_entropy, (entropyOf(0.01, 0.0004) + entropyOf(0.0025, 0.0025)) / 2, kExact);
  EXPECT_NEAR(s.wall_thickness_m, 0.035, kExact);  // median of eight times 0.02 and eight times 0.05
}

TEST(PointSharpness, LeavesAPointOutOneNeighbourBelowTheFewest) {
  const std::vector<Point2> six(6, {1, 1}), five(5, {1, 1});
  EXPECT_EQ(pointSharpness(six).left_out, 0U);
  EXPECT_NEAR(pointSharpness(six).mean_map_entropy, entropyOf(0, 0), kExact);
  EXPECT_EQ(pointSharpness(six).wall_thickness_m, 0);
  EXPECT_EQ(pointSharpness(five).left_out, 5U);
  EXPECT_TRUE(std::isnan(pointSharpness(five).mean_map_entropy));
  EXPECT_TRUE(std::isnan(pointSharpness(five).wall_thickness_m));
  EXPECT_EQ(pointSharpness({}).points, 0U);
  EXPECT_TRUE(std::isnan(pointSharpness({}).mean_map_entropy));
}

TEST(PointSharpness, NeighboursReachTheRadiusAndNoFarther) {
  std::vector<Point2> points(6, {0, 0});
  points.push_back({kNeighbourhood_m, 0});
  EXPECT_EQ(pointSharpness(points).left_out, 0U);
  points.back().x += 1e-6;
  EXPECT_EQ(pointSharpness(points).left_out, 1U);
}

/// Points every centimetre along a straight wall, in two rows `apart_m` from one another.
std::vector<Point2> wall(double apart_m) {
  std::vector<Point2> points;
  for (int i = 0; i < 400; ++i)
    for (const double side : {-0.5, 0.5}) points.push_back({0.01 * i, side * apart_m});
  return points;
}

// A wall seen twice from poses that are 10 cm apart: half the distance is the deviation from the line
// between.
TEST(PointSharpness, AWallThatIsDrawnTwiceIsThickAndLessSharp) {
  EXPECT_NEAR(pointSharpness(wall(0)).wall_thickness_m, 0, kExact);
  // The circle holds a few points less of the other row than of a point's own.
  EXPECT_NEAR(pointSharpness(wall(0.1)).wall_thickness_m, 0.05, 1e-4);
  EXPECT_GT(pointSharpness(wall(0.1)).mean_map_entropy, pointSharpness(wall(0.02)).mean_map_entropy + 1);
  EXPECT_TRUE(std::isfinite(pointSharpness(wall(0)).mean_map_entropy));
}

// What it cannot see, as the header says: the same walls, the second one a metre off and turned.
TEST(PointSharpness, IsBlindToAMapThatIsBentAsAWhole) {
  auto straight = wall(0.04), bent = straight;
  for (const auto& p : wall(0.04)) {
    straight.push_back({p.x, p.y + 10});
    bent.push_back(core::Pose2{1, 10, 0.2} * p);
  }
  EXPECT_NEAR(pointSharpness(straight).mean_map_entropy, pointSharpness(bent).mean_map_entropy, 1e-6);
  EXPECT_NEAR(pointSharpness(straight).wall_thickness_m, pointSharpness(bent).wall_thickness_m, kExact);
}

std::vector<Point2> scattered(size_t count) {
  core::RandomStream random(3, "points");
  std::vector<Point2> points;
  points.reserve(count);
  for (size_t i = 0; i < count; ++i) points.push_back({random.uniform(-2, 2), random.uniform(-1, 1)});
  return points;
}

TEST(PointSharpness, IsTheSameTurnedMirroredAndFarAway) {
  const auto points = scattered(900);
  const auto expected = pointSharpness(points);
  for (const auto& T : {core::Pose2{0, 0, kPi / 2}, {0, 0, 1.1}, {400, -700, 2.2}})
    for (const double mirror : {1.0, -1.0}) {
      std::vector<Point2> moved;
      moved.reserve(points.size());
      for (const auto& p : points) moved.push_back(T * Point2{mirror * p.x, p.y});
      const auto s = pointSharpness(moved);
      // Coordinates of 1000 m are known to 1e-13 m; the variances around are of 1e-2 m2.
      EXPECT_NEAR(s.mean_map_entropy, expected.mean_map_entropy, 1e-8);
      EXPECT_NEAR(s.wall_thickness_m, expected.wall_thickness_m, 1e-9);
      EXPECT_EQ(s.left_out, expected.left_out);
    }
}

TEST(PointSharpness, EqualsTheDefinitionCarriedOutForEveryPair) {
  const auto points = scattered(500);
  double sum = 0;
  std::vector<double> thicknesses;
  for (const auto& p : points) {
    std::vector<Point2> around;
    for (const auto& q : points)
      if (core::distance(p, q) <= kNeighbourhood_m) around.push_back(q);
    if (around.size() < kFewestNeighbours + 1) continue;
    Point2 mean;
    for (const auto& q : around)
      mean.x += q.x / static_cast<double>(around.size()), mean.y += q.y / static_cast<double>(around.size());
    double xx = 0, xy = 0, yy = 0;
    for (const auto& q : around) {
      xx += (q.x - mean.x) * (q.x - mean.x) / static_cast<double>(around.size());
      xy += (q.x - mean.x) * (q.y - mean.y) / static_cast<double>(around.size());
      yy += (q.y - mean.y) * (q.y - mean.y) / static_cast<double>(around.size());
    }
    const double determinant = (xx + kAdded) * (yy + kAdded) - xy * xy;
    sum += 0.5 * std::log(std::pow(2 * kPi * std::exp(1.0), 2) * determinant);
    thicknesses.push_back(std::sqrt((xx + yy - std::sqrt((xx - yy) * (xx - yy) + 4 * xy * xy)) / 2));
  }
  const auto s = pointSharpness(points);
  EXPECT_EQ(s.points - s.left_out, thicknesses.size());
  EXPECT_NEAR(s.mean_map_entropy, sum / static_cast<double>(thicknesses.size()), 1e-9);
  EXPECT_NEAR(s.wall_thickness_m, quantile(thicknesses, 0.5), 1e-9);
}

TEST(PointSharpness, OfASampleLooksAtNoMoreThanAsked) {
  const auto points = scattered(2000);
  const auto sample = pointSharpness(points, 300);
  EXPECT_EQ(sample.points, 286U);  // every seventh
  // Chance in 286 of 2000 nearly equal neighbourhoods.
  EXPECT_NEAR(sample.mean_map_entropy, pointSharpness(points).mean_map_entropy, 0.1);
  EXPECT_THROW(pointSharpness(points, 0), core::ContractError);
}

TEST(PointSharpness, IsTheSameInEveryOrderToTheLastBit) {
  auto points = scattered(2000);
  const auto expected = pointSharpness(points, 300);
  std::reverse(points.begin(), points.end());
  EXPECT_EQ(pointSharpness(points, 300).mean_map_entropy, expected.mean_map_entropy);
  EXPECT_EQ(pointSharpness(points, 300).wall_thickness_m, expected.wall_thickness_m);
}

TEST(PointSharpness, PassesOverPointsThatLieNowhere) {
  auto points = rectangle({0, 0}, 0.1, 0.02);
  const auto expected = pointSharpness(points).mean_map_entropy;
  for (const double bad : {kNaN, std::numeric_limits<double>::infinity(), -1e300}) points.push_back({bad, 0});
  EXPECT_EQ(pointSharpness(points).points, 8U);
  EXPECT_EQ(pointSharpness(points).mean_map_entropy, expected);
}

ScanAgreement agreementOf(const CellMap& map, const core::Pose2& T_map_lidar,
                          const std::vector<Point2>& returns) {
  PlacedScans scans(map);
  scans.add(T_map_lidar, returns);
  return scans.agreement();
}

TEST(PlacedScans, AreOnAWallWithinTheReachOfAnOccupiedCellsCentre) {
  const CellMap map = drawn({"..........#........."});  // the wall's centre is at 1.05 m
  const core::Pose2 lidar{0.05, 0.05, 0};
  for (const auto& [range_m, expected] :
       std::vector<std::pair<double, double>>{{1.0, 1}, {0.9, 1}, {0.899, 0}, {1.1, 1}, {1.101, 0}, {0.5, 0}})
    EXPECT_EQ(agreementOf(map, lidar, {{range_m, 0}}).on_wall_share, expected) << range_m;
  const auto four = agreementOf(map, lidar, {{1.0, 0}, {0.95, 0}, {1.05, 0}, {0.3, 0}});
  EXPECT_EQ(four.returns, 4U);
  EXPECT_EQ(four.on_wall_share, 0.75);
  EXPECT_EQ(four.through_wall_share, 0);
}

TEST(PlacedScans, GoThroughAWallWhenTheyComeOutOfItAgain) {
  const core::Pose2 lidar{0.05, 0.05, 0};
  const CellMap two_walls =
      drawn({".....#...#...."});  // faces at 0.5 and 0.9 m; 0.3 m of free space between them
  EXPECT_EQ(agreementOf(two_walls, lidar, {{0.5, 0}}).through_wall_share, 0);
  EXPECT_EQ(agreementOf(two_walls, lidar, {{0.9, 0}}).through_wall_share, 1);
  // From the wall's far face at 0.6 m on: 0.1 m free are enough, a little less is not.
  EXPECT_EQ(agreementOf(two_walls, lidar, {{0.65, 0}}).through_wall_share, 1);
  EXPECT_EQ(agreementOf(two_walls, lidar, {{0.649, 0}}).through_wall_share, 0);
  // Behind a wall the map knows nothing: no contradiction.
  EXPECT_EQ(agreementOf(drawn({".....#????....."}), lidar, {{0.9, 0}}).through_wall_share, 0);
  // Two free pieces of half a cell's width add up.
  EXPECT_EQ(agreementOf(drawn({".....#.#.#...."}), lidar, {{0.9, 0}}).through_wall_share, 1);
}

TEST(PlacedScans, SkimmingAWallIsNotGoingThroughIt) {
  const CellMap corridor = drawn({"####################",  //
                                  "....................",  //
                                  "....................",  //
                                  "####################"});
  // 0.15 m below the upper wall, along 1.6 m: the beam ends inside the wall's cells, which it enters before
  // its end.
  const core::Pose2 lidar{0.05, 0.15, 0};
  const auto skimming = agreementOf(corridor, lidar, {{1.6, 0.17}});
  EXPECT_EQ(skimming.on_wall_share, 1);
  EXPECT_EQ(skimming.through_wall_share, 0);
}

TEST(PlacedScans, AreTheSameTurnedAndMirrored) {
  const CellMap map = drawn({"....#....#..", "....#....#..", "....#....#.."});
  const core::Pose2 T_turn{3, -2, 2.1};
  CellMap turned = map;
  turned.T_frame_raster = T_turn;
  CellMap upside_down = map;
  std::reverse(upside_down.cells.begin(), upside_down.cells.end());
  const std::vector<Point2> returns = {{0.3, 0.02}, {0.85, 0.05}, {0.6, 0}, {0.88, -0.03}};
  const core::Pose2 lidar{0.1, 0.15, 0};
  const auto expected = agreementOf(map, lidar, returns);
  EXPECT_EQ(expected.on_wall_share, 0.75);
  EXPECT_EQ(expected.through_wall_share, 0.75);
  EXPECT_EQ(agreementOf(turned, T_turn * lidar, returns).on_wall_share, 0.75);
  EXPECT_EQ(agreementOf(turned, T_turn * lidar, returns).through_wall_share, 0.75);
  const core::Pose2 opposite{1.2 - lidar.x, 0.3 - lidar.y, kPi};
  EXPECT_EQ(agreementOf(upside_down, opposite, returns).on_wall_share, 0.75);
  EXPECT_EQ(agreementOf(upside_down, opposite, returns).through_wall_share, 0.75);
}

TEST(PlacedScans, FromOnePlaceCountOnce) {
  const CellMap map = drawn({"..........#"});
  PlacedScans scans(map);
  const std::vector<Point2> returns = {{0.5, 0}};
  scans.add({0.05, 0.05, 0}, returns);
  scans.add({0.15, 0.05, 0}, returns);  // 0.1 m on: still the same place
  EXPECT_EQ(scans.agreement().returns, 1U);
  scans.add({0.16, 0.05, 0}, returns);
  scans.add({0.16, 0.05, core::degToRad(4.9)}, returns);
  EXPECT_EQ(scans.agreement().returns, 2U);
  scans.add({0.16, 0.05, core::degToRad(5.1)}, returns);
  EXPECT_EQ(scans.agreement().returns, 3U);
  EXPECT_EQ(scans.points().size(), 3U);
  EXPECT_NEAR(scans.points()[1].x, 0.66, kExact);
}

TEST(PlacedScans, OutsideTheMapCountForTheSharpnessOnly) {
  const CellMap map = drawn({"...", "..."});
  PlacedScans scans(map);
  EXPECT_TRUE(std::isnan(scans.agreement().on_wall_share));
  EXPECT_TRUE(std::isnan(scans.agreement().through_wall_share));
  scans.add({0.05, 0.05, 0}, {{5, 0}, {-5, 0}, {kNaN, 0}, {0.1, 0}});
  scans.add({kNaN, 0, 0}, {{0.1, 0}});
  EXPECT_EQ(scans.agreement().returns, 1U);
  EXPECT_EQ(scans.points().size(), 3U);
  // A lidar outside of the raster sees through what lies between.
  EXPECT_EQ(agreementOf(drawn({".#."}), {-1, 0.05, 0}, {{1.25, 0}}).through_wall_share, 0);
}

TEST(PlacedScans, HaveNothingToSayOfAnEmptyMap) {
  const CellMap nothing;
  PlacedScans scans(nothing);
  scans.add({0, 0, 0}, {{1, 0}});
  EXPECT_EQ(scans.agreement().returns, 0U);
}

/// Two lidars, one before a wall and one in the open, every 0.2 m along a corridor; 2 returns each.
PlacedScans placedAlong(const CellMap& corridor, int steps, std::size_t most_points) {
  PlacedScans scans(corridor, most_points);
  for (int i = 0; i < steps; ++i) {
    const double x = 0.05 + 0.2 * i;
    scans.add({x, 0.15, kPi / 2}, {{0.1, 0}, {0.1, 0.01}});
    scans.add({x, 0.15, -kPi / 2}, {{0.05, 0}, {0.05, 0.01}});
  }
  return scans;
}

TEST(PlacedScans, OfALongDriveAreHalvedEvenlyOverTheDriveAndTheLidars) {
  const CellMap corridor = drawn({std::string(2100, '.'), std::string(2100, '.'), std::string(2100, '#')});
  const auto all = placedAlong(corridor, 1000, 4000);
  EXPECT_EQ(all.points().size(), 4000U);
  EXPECT_EQ(all.halvings(), 0);
  for (const std::size_t most : {3999, 1000, 250}) {
    const auto some = placedAlong(corridor, 1000, most);
    EXPECT_LE(some.points().size(), most);
    EXPECT_GT(some.points().size(), most / 3);
    EXPECT_EQ(some.agreement().returns, some.points().size());
    EXPECT_NEAR(some.agreement().on_wall_share, all.agreement().on_wall_share, 0.05) << most;
    std::vector<double> x;
    for (const Point2& p : some.points()) x.push_back(p.x);
    EXPECT_TRUE(std::is_sorted(x.begin(), x.end(), [](double a, double b) { return a < b - 0.05; }));
    const double widest = 200.0 / (static_cast<double>(most) / 3 / 2);  // were they as even as can be
    for (std::size_t i = 1; i < x.size(); ++i) EXPECT_LT(x[i] - x[i - 1], 3 * widest) << most;
  }
}

TEST(PlacedScans, KeepOneScanHoweverManyReturnsItHas) {
  const CellMap corridor = drawn({"..........", "..........", "##########"});
  const auto one = placedAlong(corridor, 4, 1);
  EXPECT_EQ(one.points().size(), 2U);
  EXPECT_EQ(one.points().front().x, placedAlong(corridor, 1, 100).points().front().x);
}

}  // namespace
}  // namespace slam::metrics
