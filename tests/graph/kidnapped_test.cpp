#include <gtest/gtest.h>

#include <algorithm>
#include <array>

#include "libslam/graph/graph_slam.h"
#include "tests/graph/drawn_drives.h"

namespace slam::graph {
namespace {

using namespace test_drives;

/// A hall of 12 x 9 m in which everything stands askew.
std::vector<Wall> furnishedHall() {
  auto walls = rectangle(0, 0, 12, 9);
  const double boxes[][4] = {{1, 1, 2.2, 1.6},   {4, 0, 4.5, 1.1},   {9, 0.8, 10.1, 2.1}, {11.2, 4, 12, 5.6},
                             {8, 7.7, 9.3, 8.4}, {5.4, 8.5, 6, 9},   {2.1, 7, 2.6, 8.2},  {0, 4.4, 0.7, 5.1},
                             {5, 4, 6.2, 5},     {7.3, 3, 7.6, 3.4}, {3, 4.1, 3.3, 4.7}};
  for (const auto& b : boxes) {
    const auto box = rectangle(b[0], b[1], b[2], b[3]);
    walls.insert(walls.end(), box.begin(), box.end());
  }
  return walls;
}

std::vector<core::Pose2> round(const core::Point2& centre, double radius_x_m, double radius_y_m, int steps,
                               int from = 0) {
  std::vector<core::Pose2> path;
  for (int i = from; i < from + steps; ++i) {
    const double a = 0.05 * i;
    path.push_back({centre.x + radius_x_m * std::cos(a), centre.y + radius_y_m * std::sin(a),
                    std::atan2(radius_y_m * std::cos(a), -radius_x_m * std::sin(a))});
  }
  return path;
}

constexpr int kCarried = 150;

/// One round through a hall, and then, carried there, for half a minute on a circle through another.
Drive carriedFrom(const std::vector<Wall>& hall, const std::vector<Wall>& other, double radius_m = 1.25) {
  auto path = round({6, 4.5}, 4.5, 2.6, kCarried);
  const auto after = round({8.6, 5.9}, radius_m, radius_m, 150, 40);
  path.insert(path.end(), after.begin(), after.end());
  Lidar lidar;
  lidar.beams = 360, lidar.fov_rad = 2 * core::kPi * 359 / 360;
  Drive log = drive(hall, path, lidar, 0);
  const Drive elsewhere = drive(other, path, lidar, 0);
  for (size_t i = kCarried; i < path.size(); ++i) log.scans[i] = elsewhere.scans[i];
  log.increments[kCarried] = {0.05, 0, 0.05};
  return log;
}

int joinedAt(const GraphSlam& graph) {
  for (const auto& entry : graph.journal())
    if (entry.event == core::JournalEvent::kRecovered) return entry.scan;
  return -1;
}

std::vector<Wall> hallWith(const std::vector<std::array<double, 4>>& boxes) {
  auto walls = rectangle(0, 0, 12, 9);
  for (const auto& b : boxes) add(walls, rectangle(b[0], b[1], b[2], b[3]));
  return walls;
}

GraphSlam mappedToTheEnd(const Drive& log) {
  GraphSlam graph{keyframes::GraphOptions()};
  for (size_t i = 0; i < log.scans.size(); ++i) graph.process(log.scans[i], log.increments[i], true);
  graph.finish();
  return graph;
}

void expectToBeJoined(const Drive& log) {
  const GraphSlam graph = mappedToTheEnd(log);
  EXPECT_GT(joinedAt(graph), kCarried);
  EXPECT_LT(worstError(graph.poses(), log.truth), 0.1);
}

int lostAt(const GraphSlam& graph) {
  for (const auto& entry : graph.journal())
    if (entry.event == core::JournalEvent::kLost) return entry.scan;
  return -1;
}

// Where no place beside it is like its own, a kidnapped robot need not leave the room to be joined.
TEST(Kidnapped, IsJoinedInAFurnishedHallAfterAShortWay) {
  expectToBeJoined(carriedFrom(furnishedHall(), furnishedHall(), 0.8));
}

// Most of a hall looks the same when it is turned round. What stands in it contradicts that, and the robot is
// joined all the same.
TEST(Kidnapped, IsJoinedInAHallThatLooksAlikeTurnedRound) {
  const auto hall = hallWith({{1, 1, 1.6, 1.4}, {9.5, 6.9, 10.1, 7.5}, {3.2, 7.6, 3.6, 8}});
  expectToBeJoined(carriedFrom(hall, hall));
}

// A hall of the same walls is another one where something stands elsewhere, however much of it fits.
TEST(Kidnapped, IsNotJoinedToAHallInWhichSomethingStandsElsewhere) {
  std::vector<std::array<double, 4>> boxes = {{1, 1, 2.2, 1.6},   {4, 0, 4.5, 1.1},   {11.2, 4, 12, 5.6},
                                              {8, 7.7, 9.3, 8.4}, {2.1, 7, 2.6, 8.2}, {5, 4, 6.2, 5}};
  const auto hall = hallWith(boxes);
  boxes[1] = {3.2, 0, 3.7, 1.1};
  const GraphSlam graph = mappedToTheEnd(carriedFrom(hall, hallWith(boxes)));
  EXPECT_GT(lostAt(graph), kCarried);
  EXPECT_EQ(joinedAt(graph), -1);
}

/// From one end of a yard to the other.
std::vector<core::Pose2> yardPath() {
  return along({{2.5, 5.5}, {8.5, 5.5}}, 0.2);
}

/// Carried from one end of a yard into a corridor that no map holds, it drives there for so many scans: by
/// the wheels, out of the yard after a few.
Drive carriedFromTheYard(size_t scans) {
  auto walls = yard();
  add(walls, rectangle(100, 0, 160, 2));
  for (const double x : {104.0, 109.0, 117.0, 123.0, 131.0, 142.0}) add(walls, rectangle(x, 0, x + 0.5, 0.3));
  auto path = yardPath();
  auto after = along({{102, 1}, {150, 1}}, 1);
  after.resize(scans);
  path.insert(path.end(), after.begin(), after.end());
  auto log = drive(walls, path, Lidar(), 0);
  log.increments[yardPath().size()] = {1, 0, 0};
  return log;
}

// The few scans before it leaves the yard are all that speak of it.
TEST(Kidnapped, IsNoticedByTheFewScansBeforeItLeavesWhatIsKnown) {
  const GraphSlam graph = mappedToTheEnd(carriedFromTheYard(49));
  EXPECT_GE(lostAt(graph), static_cast<int>(yardPath().size()));
}

// What no scan decided is decided by all of them when no more come, if they told enough.
TEST(Kidnapped, IsNoticedInTheEndWhereTheLogEndsInDoubt) {
  for (const size_t scans : {2, 6}) {
    const auto log = carriedFromTheYard(scans);
    GraphSlam graph{keyframes::GraphOptions()};
    for (size_t i = 0; i < log.scans.size(); ++i) graph.process(log.scans[i], log.increments[i], true);
    EXPECT_EQ(lostAt(graph), -1) << scans;
    graph.finish();
    EXPECT_EQ(lostAt(graph), scans == 6 ? static_cast<int>(log.scans.size()) : -1) << scans;
    bool is_apart = false;
    for (const auto& entry : graph.journal())
      is_apart = is_apart || entry.event == core::JournalEvent::kApart;
    EXPECT_EQ(is_apart, scans == 6) << scans;
  }
}

Drive roundOfTheHall() {
  Lidar lidar;
  lidar.beams = 360, lidar.fov_rad = 2 * core::kPi * 359 / 360;
  return drive(furnishedHall(), round({6, 4.5}, 4.5, 2.6, 150), lidar, 0);
}

GraphSlam mappedWithoutLoss(const Drive& log) {
  GraphSlam graph{keyframes::GraphOptions()};
  for (size_t i = 0; i < log.scans.size(); ++i) graph.process(log.scans[i], log.increments[i], true);
  for (const auto& entry : graph.journal()) EXPECT_NE(entry.event, core::JournalEvent::kLost) << entry.scan;
  return graph;
}

// From a map that holds less than one scan tells nothing can be lost: it began where the lidar reached next
// to nothing, and what little it saw fits nothing since.
TEST(Kidnapped, IsNobodyWhoBeganWhereNextToNothingWasSeen) {
  auto log = roundOfTheHall();
  auto& first = log.scans.front().ranges_m;
  for (size_t i = 0; i < first.size(); ++i) first[i] = i < 12 ? 0.5F * first[i] : lidar::kNoReturn;
  const GraphSlam graph = mappedWithoutLoss(log);
  EXPECT_LT(worstError(graph.poses(), log.truth), 0.1);
}

// What a first scan saw is no map when none after it fits: as where the clocks of lidar and wheels differ and
// the robot begins with a fast turn.
TEST(Kidnapped, IsNobodyWhoseFirstScanFitsNone) {
  auto log = roundOfTheHall();
  auto& first = log.scans.front().ranges_m;
  std::rotate(first.begin(), first.begin() + 45, first.end());
  for (size_t i = 1; i < log.scans.size(); ++i)
    for (size_t k = i % 6; k < first.size(); k += 6) log.scans[i].ranges_m[k] = lidar::kNoReturn;
  mappedWithoutLoss(log);
}

}  // namespace
}  // namespace slam::graph
