#include "libslam/metrics/map_score.h"
#include "libslam/core/numbers.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "libslam/core/error.h"
#include "libslam/core/random.h"
#include "libslam/rays/ray_caster.h"
#include "tests/metrics/drawn.h"

namespace slam::metrics {
namespace {

using core::kPi;
using world::Cell;
using world::CellMap;
using world::Plan;

using core::kNaN;
constexpr double kExact = 1e-9;  // a few operations on coordinates of metres
constexpr double kNoLimit = 0;

/// The same alphabet, for what a mask saw: '#' wall, '.' free, ' ' neither.
std::vector<std::string> picture(const SeenMask& seen) {
  std::vector<std::string> lines;
  for (int row = seen.rows - 1; row >= 0; --row) {
    lines.emplace_back();
    for (int column = 0; column < seen.columns; ++column) {
      const auto cell = static_cast<size_t>(row) * seen.columns + column;
      lines.back() += seen.wall[cell] ? '#' : seen.free[cell] ? '.' : ' ';
    }
  }
  return lines;
}

/// A map that knows exactly what was seen.
CellMap perfectMap(const Plan& plan, const SeenMask& seen) {
  CellMap map = plan;
  for (size_t cell = 0; cell < map.cells.size(); ++cell)
    map.cells[cell] = seen.wall[cell] ? Cell::kOccupied : seen.free[cell] ? Cell::kFree : Cell::kUnknown;
  return map;
}

const Plan kRoom = drawn({"##########",  //
                          "##########",  //
                          "##......##",  //
                          "##......##",  //
                          "##..##..##",  //
                          "##......##",  //
                          "##......##",  //
                          "##########",  //
                          "##########"});

SeenMask allRound(const Plan& plan, const core::Trajectory& truth) {
  return seenCells(plan, truth, {}, -kPi, kPi / 1000, 2000, kNoLimit);
}

SeenMask kRoomSeen() {
  return allRound(kRoom,
                  {{0, {0.25, 0.25, 0}}, {1, {0.75, 0.65, 0}}, {2, {0.25, 0.65, 0}}, {3, {0.75, 0.25, 0}}});
}

TEST(SeenCells, AreTheFacesOfWallsAndTheFreeSpaceBeforeThem) {
  EXPECT_EQ(picture(kRoomSeen()), (std::vector<std::string>{"          ",  //
                                                            "  ######  ",  //
                                                            " #......# ",  //
                                                            " #......# ",  //
                                                            " #..##..# ",  //
                                                            " #......# ",  //
                                                            " #......# ",  //
                                                            "  ######  ",  //
                                                            "          "}));
}

TEST(SeenCells, EndAtWallsAndAtTheMaximumRange) {
  const Plan corridor = drawn({"..........#.."});
  const core::Trajectory at_left = {{0, {0.05, 0.05, 0}}};
  EXPECT_EQ(picture(seenCells(corridor, at_left, {}, 0, 0.1, 1, kNoLimit)).front(), "..........#  ");
  // 0.45 m reach the face of the cell that begins at 0.5 m; 0.449 m do not.
  EXPECT_EQ(picture(seenCells(corridor, at_left, {}, 0, 0.1, 1, 0.449)).front(), ".....        ");
  EXPECT_EQ(picture(seenCells(corridor, at_left, {}, 0, 0.1, 1, 0.451)).front(), "......       ");
  // Seen backwards, from a lidar turned round.
  EXPECT_EQ(picture(seenCells(corridor, {{0, {0.75, 0.05, 0}}}, {-0.1, 0, kPi}, 0, 0.1, 1, kNoLimit)).front(),
            ".......      ");
}

TEST(SeenCells, SeeThroughUnknownCellsWithoutCountingThem) {
  EXPECT_EQ(picture(seenCells(drawn({"..??..#"}), {{0, {0.05, 0.05, 0}}}, {}, 0, 0.1, 1, kNoLimit)).front(),
            "..  ..#");
}

TEST(SeenCells, ArePlacedByThePlansPose) {
  Plan turned = kRoom;
  turned.T_frame_raster = {10, -4, 2.2};
  core::Trajectory truth;
  for (const auto& p : {core::Pose2{0.25, 0.25, 0}, {0.75, 0.65, 0}, {0.25, 0.65, 0}, {0.75, 0.25, 0}})
    truth.push_back({double(truth.size()), turned.T_frame_raster * p});
  EXPECT_EQ(picture(allRound(turned, truth)), picture(kRoomSeen()));
}

TEST(SeenCells, FromNowhereAreNone) {
  const auto none = std::vector<std::string>(9, std::string(10, ' '));
  for (const auto& pose : {core::Pose2{-1, 0.5, 0}, {0.55, 1e300, 0}, {0.05, 0.05, 0}, {kNaN, 0.3, 0}})
    EXPECT_EQ(picture(allRound(kRoom, {{0, pose}})), none);
  EXPECT_EQ(picture(allRound(kRoom, {})), none);
  // And such a pose does not keep the next one from seeing.
  const core::Trajectory lost_at_first = {{0, {kNaN, 0, 0}}, {1, {0.75, 0.65, 0}}, {2, {0.25, 0.25, 0}}};
  EXPECT_EQ(picture(allRound(kRoom, lost_at_first)),
            picture(allRound(kRoom, {lost_at_first.begin() + 1, lost_at_first.end()})));
}

TEST(SeenCells, LeaveOutPosesTooCloseToTheLastOneUsed) {
  // One beam; each pose adds the column in front of it, unless it is left out.
  const Plan open = drawn(std::vector<std::string>(3, std::string(12, '.')));
  core::Trajectory truth;
  for (const double x : {0.05, 0.14, 0.26, 0.34}) truth.push_back({10 * x, {x, 0.05, kPi / 2}});
  // 0.14 is within 0.1 m of 0.05; so is 0.34 of 0.26, but the last one always counts.
  EXPECT_EQ(picture(seenCells(open, truth, {}, 0, 0.1, 1, kNoLimit)).front(), ". ..        ");
  for (const double turn_rad : {0.085, 0.09}) {  // 5 degrees are 0.0873 rad
    const core::Trajectory turning = {
        {0, {0.05, 0.05, 0}}, {1, {0.05, 0.05, turn_rad}}, {2, {0.05, 0.05, 0}}};
    EXPECT_EQ(picture(seenCells(open, turning, {}, 0, 0.1, 1, kNoLimit))[1],
              turn_rad < 0.0873 ? "            " : "      ......");
  }
}

TEST(SeenCells, EndWhereTheReferenceRayEnds) {
  core::RandomStream random(11, "seen");
  Plan plan = drawn(std::vector<std::string>(37, std::string(53, '.')), 0.05);
  plan.T_frame_raster = {1, 2, 0.7};
  for (auto& cell : plan.cells)
    if (random.chance(0.03)) cell = Cell::kOccupied;
  int hits = 0;
  for (int i = 0; i < 3000; ++i) {
    const core::Point2 p =
        plan.T_frame_raster * core::Point2{random.uniform(0, 2.65), random.uniform(0, 1.85)};
    const double angle = random.uniform(-4, 4);
    const double range_m = rays::castRay(plan, p, angle, 1.5);
    const auto seen = seenCells(plan, {{0, {p.x, p.y, angle}}}, {}, 0, 0.1, 1, 1.5);
    if (range_m == 0) continue;  // in a wall
    const auto wall = std::find(seen.wall.begin(), seen.wall.end(), true);
    ASSERT_EQ(wall != seen.wall.end(), std::isfinite(range_m));
    if (wall == seen.wall.end()) continue;
    ++hits;
    const auto cell = wall - seen.wall.begin(), column = cell % 53, row = cell / 53;
    const auto hit =
        world::pointToCells(plan, {p.x + range_m * std::cos(angle), p.y + range_m * std::sin(angle)});
    // The hit lies on the face of the marked cell: within it but for rounding.
    EXPECT_NEAR(hit.x, double(column) + 0.5, 0.5 + kExact);
    EXPECT_NEAR(hit.y, double(row) + 0.5, 0.5 + kExact);
  }
  EXPECT_GT(hits, 1000);
}

TEST(MapScore, OfThePerfectMapIsPerfect) {
  const auto seen = kRoomSeen();
  const auto s = scoreMap(kRoom, seen, perfectMap(kRoom, seen), {}, 0);
  for (const double share :
       {s.occupied_precision, s.occupied_recall, s.occupied_f1, s.free_iou, s.known_share})
    EXPECT_EQ(share, 1);
  for (const double distance_m :
       {s.wall_to_truth_p50_m, s.wall_to_truth_p95_m, s.truth_to_wall_p50_m, s.truth_to_wall_p95_m})
    EXPECT_NEAR(distance_m, 0, kExact);
}

TEST(MapScore, KnowsAPerfectMapInAnotherFrameAndRaster) {
  // The map's raster is cut out of the plan's, drawn at half the cell size, and its frame is turned by 90
  // degrees and shifted; the plan itself is turned too.
  Plan plan = kRoom;
  plan.T_frame_raster = {3, 1, -0.8};
  core::Trajectory truth;
  for (const auto& p : {core::Pose2{0.25, 0.25, 0}, {0.75, 0.65, 0}, {0.25, 0.65, 0}, {0.75, 0.25, 0}})
    truth.push_back({double(truth.size()), plan.T_frame_raster * p});
  const auto seen = allRound(plan, truth);
  const CellMap perfect = perfectMap(plan, seen);
  CellMap map;
  map.resolution_m = 0.05;
  map.columns = 16, map.rows = 14;  // columns 1 to 8 and rows 1 to 7 of the plan
  for (int row = 0; row < map.rows; ++row)
    for (int column = 0; column < map.columns; ++column)
      map.cells.push_back(perfect.at(1 + column / 2, 1 + row / 2));
  map.T_frame_raster = {-2, 5, 0.3};
  const core::Pose2 T_world_raster = plan.T_frame_raster * core::Pose2{0.1, 0.1, 0};
  const core::Pose2 T_world_map = T_world_raster * core::inverse(map.T_frame_raster);
  const auto s = scoreMap(plan, seen, map, T_world_map, 0.04);
  EXPECT_EQ(s.occupied_precision, 1);  // a quarter cell's centre is 0.025 * sqrt(2) m from the whole one's
  EXPECT_EQ(s.occupied_recall, 1);
  EXPECT_EQ(s.free_iou, 1);
  EXPECT_EQ(s.known_share, 1);
  EXPECT_NEAR(s.wall_to_truth_p95_m, 0.025 * std::sqrt(2.0), kExact);
  EXPECT_EQ(scoreMap(plan, seen, map, T_world_map, 0.03).occupied_precision, 0);
}

TEST(MapScore, OfAMapShiftedByCellsMeasuresTheShift) {
  // A wall one cell high: shifted k cells along its normal, every distance is k cells.
  const Plan wall =
      drawn({"##########", "..........", "..........", "..........", "..........", ".........."});
  const auto seen = allRound(wall, {{0, {0.05, 0.05, 0}}, {1, {0.55, 0.15, 0}}, {2, {0.95, 0.05, 0}}});
  for (const int k : {1, 3}) {
    const auto s = scoreMap(wall, seen, perfectMap(wall, seen), {0, -0.1 * k, 0}, 0.2);
    EXPECT_EQ(s.occupied_precision, k <= 2);
    EXPECT_EQ(s.occupied_recall, k <= 2);
    EXPECT_NEAR(s.wall_to_truth_p50_m, 0.1 * k, kExact);
    EXPECT_NEAR(s.truth_to_wall_p95_m, 0.1 * k, kExact);
    // 5 rows each, 5 - k shared, and k rows of the map lie below the plan: 10 * (5 - k) of 10 * (5 + k).
    EXPECT_NEAR(s.free_iou, (5.0 - k) / (5.0 + k), kExact);
    // The mask's top rows have no map over them.
    EXPECT_NEAR(s.known_share, (6.0 - k) / 6, kExact);
  }
}

TEST(MapScore, CountsHalfOfItsWallsWrong) {
  const Plan plan = drawn({"####", "....", "...."});
  const auto seen = allRound(plan, {{0, {0.25, 0.05, 0}}});
  const auto s = scoreMap(plan, seen, drawn({"##??", "....", "##.."}), {}, 0.05);
  EXPECT_EQ(s.occupied_precision, 0.5);
  EXPECT_EQ(s.occupied_recall, 0.5);
  EXPECT_EQ(s.occupied_f1, 0.5);
  EXPECT_EQ(s.free_iou, 6.0 / 8);
  EXPECT_EQ(s.known_share, 10.0 / 12);
  EXPECT_NEAR(s.truth_to_wall_p50_m, 0.05, kExact);  // 0, 0, 0.1, 0.2
}

TEST(MapScore, PunishesFreeSpaceClaimedBehindAWall) {
  const Plan two_rooms = drawn({"...#...", "...#...", "...#..."});
  const auto seen = allRound(two_rooms, {{0, {0.15, 0.15, 0}}});
  const auto honest = scoreMap(two_rooms, seen, perfectMap(two_rooms, seen), {}, 0.1);
  EXPECT_EQ(honest.free_iou, 1);
  // Free in truth, but nobody could know.
  EXPECT_EQ(scoreMap(two_rooms, seen, two_rooms, {}, 0.1).free_iou, 0.5);
}

TEST(MapScore, CountsFreeSpaceBeyondThePlanOnEverySide) {
  const Plan open = drawn({"...", "...", "..."});
  const auto seen = allRound(open, {{0, {0.15, 0.15, 0}}});
  for (const auto& T_world_map : {core::Pose2{0.1, 0, 0}, {-0.1, 0, 0}, {0, 0.1, 0}, {0, -0.1, 0}})
    EXPECT_EQ(scoreMap(open, seen, open, T_world_map, 0.1).free_iou, 6.0 / 12);
}

TEST(MapScore, OfWallsThatAreAllWrongIsZeroNotNaN) {
  const Plan plan = drawn({"####", "....", "...."});
  const auto s =
      scoreMap(plan, allRound(plan, {{0, {0.25, 0.05, 0}}}), drawn({"....", "....", "####"}), {}, 0.1);
  EXPECT_EQ(s.occupied_precision, 0);
  EXPECT_EQ(s.occupied_recall, 0);
  EXPECT_EQ(s.occupied_f1, 0);
}

TEST(MapScore, PunishesWallsInsideABlockAndOnItsFarSide) {
  const Plan block = drawn({".....######."});
  const auto seen = seenCells(block, {{0, {0.05, 0.05, 0}}}, {}, 0, 0.1, 1, kNoLimit);
  const auto s = scoreMap(block, seen, drawn({".....#???.#?"}), {}, 0.1);
  EXPECT_EQ(s.occupied_precision, 0.5);
  EXPECT_EQ(s.occupied_recall, 1);
}

TEST(MapScore, OfAMapWithoutWallsHasNoPrecision) {
  const auto seen = kRoomSeen();
  CellMap map = kRoom;
  map.cells.assign(map.cells.size(), Cell::kUnknown);
  const auto unknown = scoreMap(kRoom, seen, map, {}, 0.1);
  EXPECT_TRUE(std::isnan(unknown.occupied_precision));
  EXPECT_EQ(unknown.occupied_recall, 0);
  EXPECT_TRUE(std::isnan(unknown.occupied_f1));
  EXPECT_EQ(unknown.free_iou, 0);
  EXPECT_EQ(unknown.known_share, 0);
  EXPECT_TRUE(std::isnan(unknown.wall_to_truth_p50_m));
  EXPECT_TRUE(std::isnan(unknown.truth_to_wall_p95_m));

  map.cells.assign(map.cells.size(), Cell::kFree);
  const auto free = scoreMap(kRoom, seen, map, {}, 0.1);
  EXPECT_EQ(free.occupied_recall, 0);
  EXPECT_EQ(free.free_iou, 28.0 / 90);
  EXPECT_EQ(free.known_share, 1);
}

TEST(MapScore, IsNaNWhereNothingWasSeenOrTheMapHasNoPlace) {
  const auto nothing = allRound(kRoom, {});
  const auto blind = scoreMap(kRoom, nothing, kRoom, {}, 0.1);
  EXPECT_EQ(blind.occupied_precision, 0);
  for (const double value : {blind.occupied_recall, blind.known_share, blind.wall_to_truth_p50_m})
    EXPECT_TRUE(std::isnan(value));
  const auto lost = scoreMap(kRoom, kRoomSeen(), kRoom, {kNaN, 0, 0}, 0.1);
  for (const double value : {lost.occupied_precision, lost.occupied_recall, lost.occupied_f1, lost.free_iou,
                             lost.wall_to_truth_p50_m, lost.wall_to_truth_p95_m, lost.truth_to_wall_p50_m,
                             lost.truth_to_wall_p95_m, lost.known_share})
    EXPECT_TRUE(std::isnan(value));
}

TEST(MapScore, RefusesAMaskOfAnotherPlanAndANegativeTolerance) {
  EXPECT_THROW(scoreMap(kRoom, {}, kRoom, {}, 0.1), core::ContractError);
  EXPECT_THROW(scoreMap(kRoom, kRoomSeen(), kRoom, {}, -1), core::ContractError);
  EXPECT_THROW(scoreMap(kRoom, kRoomSeen(), kRoom, {}, kNaN), core::ContractError);
}

TEST(MapEntropy, IsTheMeanOverTheKnownCells) {
  const double quarter = 0.25 * 2 + 0.75 * std::log2(4.0 / 3);  // entropy of 1/4, bits
  EXPECT_NEAR(mapEntropy({0.0F, 1.0F, 0.5F, 0.25F, 0.75F}), 2 * quarter / 4, kExact);
  EXPECT_EQ(mapEntropy({0.1F, -0.0F}, 0.1F), 0);
}

TEST(MapEntropy, IsNaNWithoutKnownCellsOrWithAValueThatIsNoProbability) {
  for (const auto& cells : {std::vector<float>{}, {0.5F, 0.5F}, {0.1F, std::nanf("")}, {0.1F, 1.5F}})
    EXPECT_TRUE(std::isnan(mapEntropy(cells)));
}

}  // namespace
}  // namespace slam::metrics
