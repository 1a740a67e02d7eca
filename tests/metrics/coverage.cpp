#include "libslam/metrics/coverage.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>

#include "libslam/core/error.h"
#include "libslam/core/random.h"
#include "libslam/rays/ray_caster.h"
#include "tests/world/drawn_plan.h"

namespace slam::metrics {
namespace {

using world::drawnPlan;

/// As drawn, the top row first: '*' explorable, ' ' not.
std::vector<std::string> drawn(const ExplorableArea& area) {
  std::vector<std::string> lines;
  for (int row = area.rows - 1; row >= 0; --row) {
    std::string line;
    for (int column = 0; column < area.columns; ++column)
      line += area.explorable[static_cast<size_t>(row) * area.columns + column] ? '*' : ' ';
    lines.push_back(line);
  }
  return lines;
}

TEST(ExplorableArea, IsWhatTheDiscReachesAndWhatItSeesFromThere) {
  // The disc of radius 0.6 fits into the room on the left, not through the gap one cell wide; it looks
  // through the gap into the right room: into the row of its corners only at slopes from 0.6 to 0.71, which
  // miss its column beside the gap. Nobody sees the cell in the block.
  const auto plan = drawnPlan({"##############",  //
                               "#.....#....###",  //
                               "#.....#....#.#",  //
                               "#..........###",  //
                               "#.....#....###",  //
                               "#.....#....###",  //
                               "##############"});
  const auto area = explorableArea(plan, {3.5, 3.5}, 0.6, 0);
  const std::vector<std::string> expected = {"              ",  //
                                             " *****   **   ",  //
                                             " *****  ***   ",  //
                                             " **********   ",  //
                                             " *****  ***   ",  //
                                             " *****   **   ",  //
                                             "              "};
  EXPECT_EQ(drawn(area), expected);
  EXPECT_EQ(area.cells, 40U);
  EXPECT_DOUBLE_EQ(area.area_m2, 40.0);
  EXPECT_DOUBLE_EQ(area.share_of_free, 40.0 / 47);
}

TEST(ExplorableArea, ASmallerDiscGoesThroughTheGapAndAShortLidarSeesLess) {
  const auto plan = drawnPlan({"#########",  //
                               "#...#...#",  //
                               "#.......#",  //
                               "#...#...#",  //
                               "#########"});
  EXPECT_EQ(explorableArea(plan, {2.5, 2.5}, 0.45, 0).cells, 19U);
  const auto corridor = drawnPlan({"#########",  //
                                   "#.......#",  //
                                   "#########"});
  // Too wide to move at all: it sees from its own cell, which begins 1, 2, ... metres from the others'
  // centres less half a cell.
  EXPECT_EQ(explorableArea(corridor, {1.5, 1.5}, 0.6, 3.4).cells, 4U);
  EXPECT_EQ(explorableArea(corridor, {1.5, 1.5}, 0.6, 3.6).cells, 5U);
}

TEST(ExplorableArea, OfAStartThatCannotBeIsEmpty) {
  const auto plan = drawnPlan({"####", "#..#", "####"});
  for (const core::Point2 start : {core::Point2{0.5, 0.5}, {-3, 1}, {40, 1}, {NAN, 1}}) {
    const auto area = explorableArea(plan, start, 0.2, 0);
    EXPECT_EQ(area.cells, 0U);
    EXPECT_EQ(area.area_m2, 0.0);
    EXPECT_TRUE(std::isnan(Coverage(plan, area).share()));
  }
}

TEST(ExplorableArea, OfAnOpenPlanEndsAtItsEdge) {
  const auto area = explorableArea(drawnPlan({".....", ".....", "..#.."}), {2.5, 1.5}, 0.4, 0);
  EXPECT_EQ(area.cells, 14U);
}

/// Rooms of chance: walls of about a quarter of the cells.
world::Plan randomPlan(std::uint64_t seed) {
  core::RandomStream random(seed, "plan");
  std::vector<std::string> lines(16, std::string(22, '.'));
  for (auto& line : lines)
    for (char& c : line) c = random.chance(0.25) ? '#' : random.chance(0.05) ? '?' : '.';
  lines[8][11] = '.';
  return drawnPlan(lines, 0.5);
}

// The definition once more, by brute force: reachable cells by repetition until nothing changes, sight by
// small steps along each ray of the reference caster.
TEST(ExplorableArea, EqualsItsDefinitionByBruteForce) {
  for (std::uint64_t seed = 1; seed <= 6; ++seed) {
    const auto plan = randomPlan(seed);
    const double radius_m = 0.2, range_m = 3;
    const core::Point2 start{11.5 * 0.5, (15 - 8 + 0.5) * 0.5};
    const auto centre = [](int column, int row) {
      return core::Point2{(column + 0.5) * 0.5, (row + 0.5) * 0.5};
    };
    std::vector<std::vector<bool>> reachable(22, std::vector<bool>(16, false));
    reachable[11][7] = true;
    for (bool changed = true; changed;) {
      changed = false;
      for (int x = 0; x < 22; ++x)
        for (int y = 0; y < 16; ++y) {
          const auto at = [&](int c, int r) { return plan.contains(c, r) && reachable[c][r]; };
          const bool beside = at(x - 1, y) || at(x + 1, y) || at(x, y - 1) || at(x, y + 1) ||
                              (std::abs(x - 11) <= 1 && std::abs(y - 7) <= 1);
          if (reachable[x][y] || !beside || plan.at(x, y) == world::Cell::kOccupied ||
              world::discCollides(plan, centre(x, y), radius_m))
            continue;
          reachable[x][y] = changed = true;
        }
    }
    const auto area = explorableArea(plan, start, radius_m, range_m);
    int differing = 0;
    for (int x = 0; x < 22; ++x)
      for (int y = 0; y < 16; ++y) {
        bool expected = false;
        for (int ray = 0; ray < kSightRays && !expected && plan.at(x, y) == world::Cell::kFree; ++ray) {
          const double angle = 2 * core::kPi * ray / kSightRays;
          const auto c = centre(x, y);
          const double end_m = std::min(range_m, rays::castRay(plan, c, angle, 0));
          for (double r = 0; r < end_m; r += 0.002) {
            const int column = static_cast<int>(std::floor((c.x + r * std::cos(angle)) / 0.5));
            const int row = static_cast<int>(std::floor((c.y + r * std::sin(angle)) / 0.5));
            if (!plan.contains(column, row)) break;
            expected = expected || reachable[column][row];
          }
        }
        differing += expected != (area.explorable[static_cast<size_t>(y) * 22 + x] != 0);
      }
    // A diagonal ray through a corner of cells enters one more of them in the exact walk; small steps jump
    // it.
    EXPECT_LE(differing, 1) << "seed " << seed;
    EXPECT_GT(area.cells, 3U) << "seed " << seed;
  }
}

TEST(Coverage, CountsEachCellOnceAndAgreesWithSeenCells) {
  for (std::uint64_t seed = 1; seed <= 4; ++seed) {
    const auto plan = randomPlan(seed);
    const core::Point2 start{11.5 * 0.5, 7.5 * 0.5};
    Coverage coverage(plan, explorableArea(plan, start, 0.2, 4));
    core::Trajectory path;
    size_t sum = 0;
    for (int i = 0; i < 6; ++i) {
      // Farther apart than seenCells() thins.
      const core::Pose2 pose{start.x + 0.3 * std::cos(i), start.y + 0.3 * std::sin(i), 1.0 * i};
      path.push_back({1.0 * i, pose});
      sum += coverage.look(pose, -1.5, 0.05, 61, 4);
    }
    EXPECT_EQ(coverage.look(path.back().pose, -1.5, 0.05, 61, 4), 0U);
    const auto seen = seenCells(plan, path, {}, -1.5, 0.05, 61, 4);
    EXPECT_EQ(coverage.seen().free, seen.free);
    EXPECT_EQ(coverage.seen().wall, seen.wall);
    size_t expected = 0;
    for (size_t cell = 0; cell < seen.free.size(); ++cell)
      expected += seen.free[cell] && coverage.explorable().explorable[cell];
    EXPECT_EQ(sum, expected);
    EXPECT_DOUBLE_EQ(coverage.area_m2(), static_cast<double>(expected) * 0.25);
    EXPECT_GT(coverage.share(), 0.0);
    EXPECT_LE(coverage.share(), 1.0);
  }
}

TEST(Coverage, SeesNothingFromWhereNoLidarCanBe) {
  const auto plan = drawnPlan({"####", "#..#", "####"});
  Coverage coverage(plan, explorableArea(plan, {1.5, 1.5}, 0.2, 0));
  for (const core::Pose2 pose :
       {core::Pose2{0.5, 0.5, 0}, {-1, 1.5, 0}, {1.5, 99, 0}, {NAN, 1, 0}, {1.5, 1.5, INFINITY}})
    EXPECT_EQ(coverage.look(pose, -3, 0.1, 61, 0), 0U);
  EXPECT_EQ(coverage.share(), 0.0);
  EXPECT_THROW(Coverage(plan, ExplorableArea{}), core::ContractError);
}

TEST(ExplorationFigures, TakeTheFirstTimeThatAShareIsReached) {
  // 10 m2 in all; 3 m there, and the last of them brings nothing.
  const std::vector<CoveragePoint> curve = {
      {0, 0, 1, 4.0}, {2, 1, 2, 9.0}, {4, 1, 3, 9.9}, {6, 2, 4, 9.95}, {8, 3, 5, 9.95}};
  const auto f = explorationFigures(curve, 10);
  EXPECT_DOUBLE_EQ(f.coverage, 0.995);
  EXPECT_EQ(f.t90_s, 2);
  EXPECT_EQ(f.path90_m, 1);
  EXPECT_EQ(f.scans90, 2);
  EXPECT_EQ(f.t99_s, 4);
  EXPECT_EQ(f.path99_m, 1);
  EXPECT_EQ(f.scans99, 3);
  // Pieces: 0 to 1 m adds 5 m2; 1 to 2 m adds 0.95 m2; 2 to 3 m nothing.
  EXPECT_DOUBLE_EQ(f.redundant_share, 1.0 / 3);
  EXPECT_EQ(f.scans, 5U);
}

TEST(ExplorationFigures, WithoutEnoughToSayAreNaN) {
  const auto none = explorationFigures({}, 10);
  EXPECT_TRUE(std::isnan(none.coverage) && std::isnan(none.t90_s) && std::isnan(none.redundant_share));
  const auto one = explorationFigures({{0, 0, 1, 9.5}}, 10);
  EXPECT_DOUBLE_EQ(one.coverage, 0.95);
  EXPECT_EQ(one.t90_s, 0);
  EXPECT_TRUE(std::isnan(one.t99_s) && std::isnan(one.path99_m) && std::isnan(one.scans99));
  EXPECT_TRUE(std::isnan(one.redundant_share));  // it never moved
  EXPECT_TRUE(std::isnan(explorationFigures({{0, 0, 1, 0}}, 0).coverage));
}

TEST(ExplorationFigures, TheLastPieceCountsByItsLength) {
  // 1.5 m: the first metre brings 0.11 m2, the half metre left 0.04 m2, less than 0.05 m2.
  const auto f = explorationFigures({{0, 0, 1, 1}, {1, 1, 2, 1.11}, {2, 1.5, 3, 1.15}}, 2);
  EXPECT_NEAR(f.redundant_share, 0.5 / 1.5, 1e-12);
}

}  // namespace
}  // namespace slam::metrics
