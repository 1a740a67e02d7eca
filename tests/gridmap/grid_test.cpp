#include "libslam/gridmap/grid.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <set>
#include <tuple>

#include "libslam/core/error.h"
#include "libslam/core/random.h"
#include "libslam/gridmap/crossed_cells.h"

namespace slam::gridmap {
namespace {

using Spot = std::pair<int, int>;

/// Fan of beams with ranges that jump, some lost, some without return.
lidar::Scan randomScan(core::RandomStream& random, int beams = 90) {
  lidar::Scan scan;
  scan.first_angle_rad = -1.6, scan.step_rad = 3.2 / (beams - 1), scan.max_range_m = 4;
  scan.T_robot_lidar = {0.1, -0.05, 0.2};
  for (int i = 0; i < beams; ++i) {
    const double kind = random.uniform();
    float range_m = static_cast<float>(random.uniform(0.3, 3.5));
    if (kind < 0.1) range_m = lidar::kLostReading;
    if (kind > 0.85) range_m = lidar::kNoReturn;
    scan.ranges_m.push_back(range_m);
  }
  return scan;
}

core::Pose2 randomPose(core::RandomStream& random) {
  return {random.uniform(-1.5, 1.5), random.uniform(-1.5, 1.5), random.uniform(-3.1, 3.1)};
}

/// Whether the segment passes through the inside of the unit cell: Liang and Barsky's clipping.
bool crosses(const core::Point2& a, const core::Point2& b, int x, int y) {
  double from = 0, to = 1;
  const double dx = b.x - a.x, dy = b.y - a.y;
  for (const auto& [direction, low, high] :
       {std::tuple(dx, x - a.x, x + 1 - a.x), std::tuple(dy, y - a.y, y + 1 - a.y)}) {
    if (direction == 0) {
      if (low > 0 || high < 0) return false;
      continue;
    }
    from = std::max(from, std::min(low / direction, high / direction));
    to = std::min(to, std::max(low / direction, high / direction));
  }
  return from < to;
}

/// The grid's definition, cell by cell, without tiles, bits or increments.
struct Twin {
  explicit Twin(const Grid& like) : options(like.options()) {}
  GridOptions options;
  std::map<Spot, int> log_odds;

  void insert(const ScanRays& rays, const core::Pose2& T_map_robot) {
    const auto toCells = [&](const core::Point2& p) {
      const core::Point2 q = T_map_robot * p;
      return core::Point2{q.x / options.cell_m, q.y / options.cell_m};
    };
    const core::Point2 from = toCells(rays.origin);
    std::set<Spot> passed, hit;
    for (const Ray& ray : rays.rays) {
      const core::Point2 to = toCells(ray.end);
      const auto low = [](double v) { return static_cast<int>(std::floor(v)); };
      for (int y = low(std::min(from.y, to.y)); y <= low(std::max(from.y, to.y)); ++y)
        for (int x = low(std::min(from.x, to.x)); x <= low(std::max(from.x, to.x)); ++x)
          if (crosses(from, to, x, y)) passed.insert({x, y});
      if (ray.hit) hit.insert({low(to.x), low(to.y)});
    }
    const auto units = [](double p) { return static_cast<int>(std::lround(20 * std::log(p / (1 - p)))); };
    for (const Spot& spot : passed)
      if (!hit.count(spot))
        log_odds[spot] =
            std::max(units(options.min_probability), log_odds[spot] + units(options.pass_probability));
    for (const Spot& spot : hit)
      log_odds[spot] =
          std::min(units(options.max_probability), log_odds[spot] + units(options.hit_probability));
  }
};

void expectSameOccupancy(const Grid& grid, const Twin& twin) {
  size_t seen = 0;
  for (int y = -130; y <= 130; ++y)
    for (int x = -130; x <= 130; ++x) {
      const auto cell = grid.at(x, y);
      const auto found = twin.log_odds.find({x, y});
      ASSERT_EQ(cell && cell->seen(), found != twin.log_odds.end()) << x << ' ' << y;
      if (found == twin.log_odds.end()) continue;
      ++seen;
      ASSERT_EQ(cell->log_odds, found->second) << x << ' ' << y;
    }
  EXPECT_EQ(seen, twin.log_odds.size());
}

/// Every cell's nearest surface, searched for among all cells around it.
void expectExactField(const Grid& grid, int reach) {
  for (int y = -110; y <= 110; ++y)
    for (int x = -110; x <= 110; ++x) {
      std::tuple<int, int, int> best{reach * reach + 1, -100, -100};
      std::optional<Cell> source;
      for (int dy = -reach; dy <= reach; ++dy)
        for (int dx = -reach; dx <= reach; ++dx) {
          const auto other = grid.at(x + dx, y + dy);
          const std::tuple<int, int, int> here{dx * dx + dy * dy, dy, dx};
          if (other && other->occupied() && here < best) best = here, source = other;
        }
      const auto cell = grid.at(x, y);
      ASSERT_EQ(cell && cell->nearSurface(), source.has_value()) << x << ' ' << y;
      if (!source) continue;
      ASSERT_EQ(cell->toX(), std::get<2>(best)) << x << ' ' << y;
      ASSERT_EQ(cell->toY(), std::get<1>(best)) << x << ' ' << y;
      ASSERT_EQ(cell->shift_x, source->shift_x + cell->toX() * 1024) << x << ' ' << y;
      ASSERT_EQ(cell->shift_y, source->shift_y + cell->toY() * 1024) << x << ' ' << y;
    }
}

Grid randomGrid(int scans, std::uint64_t seed = 5) {
  core::RandomStream random(seed, "grid");
  Grid grid({});
  for (int i = 0; i < scans; ++i) grid.insert(scanRays(randomScan(random), {}), randomPose(random));
  return grid;
}

std::tuple<int, int, bool, int, int, int, int, int> known(const Cell& cell) {
  return {cell.log_odds, cell.returns, cell.nearSurface(), cell.toX(),
          cell.toY(),    cell.side(),  cell.shift_x,       cell.shift_y};
}

bool sameCells(const Grid& a, const Grid& b) {
  for (int y = -130; y <= 130; ++y)
    for (int x = -130; x <= 130; ++x) {
      const auto one = a.at(x, y), two = b.at(x, y);
      if (one.has_value() != two.has_value()) return false;
      if (one && known(*one) != known(*two)) return false;
    }
  return true;
}

TEST(Grid, InsertionEqualsItsDefinitionCellByCell) {
  core::RandomStream random(1, "twin");
  Grid grid({});
  Twin twin(grid);
  for (int i = 0; i < 8; ++i) {
    const auto rays = scanRays(randomScan(random), {});
    const auto pose = randomPose(random);
    grid.insert(rays, pose);
    twin.insert(rays, pose);
    expectSameOccupancy(grid, twin);
  }
}

// Surfaces come and go here: the ranges of one scan contradict the next one's.
TEST(Grid, TheFieldIsExactAfterEveryInsertion) {
  core::RandomStream random(2, "field");
  GridOptions options;
  options.reach_cells = 5;
  Grid grid(options);
  for (int i = 0; i < 12; ++i) {
    grid.insert(scanRays(randomScan(random), {}), randomPose(random));
    expectExactField(grid, 5);
  }
}

TEST(Grid, ACopyNeverSeesWhatTheOtherInserts) {
  Grid original = randomGrid(4);
  const Grid before = randomGrid(4);
  Grid copy = original;
  EXPECT_EQ(copy.ownTiles(), 0U);
  core::RandomStream random(9, "more");
  for (int i = 0; i < 5; ++i) copy.insert(scanRays(randomScan(random), {}), randomPose(random));
  EXPECT_TRUE(sameCells(original, before));
  const Grid kept = copy;
  original.insert(scanRays(randomScan(random), {}), randomPose(random));
  EXPECT_TRUE(sameCells(copy, kept));
  EXPECT_FALSE(sameCells(original, before));
}

TEST(Grid, WhatIsCertainStaysShared) {
  Grid grid({});
  lidar::Scan scan;
  scan.first_angle_rad = -1.5, scan.step_rad = 0.01, scan.max_range_m = 10;
  scan.ranges_m.assign(300, 3.0F);
  for (int i = 0; i < 60; ++i) grid.insert(scanRays(scan, {}), {});
  Grid copy = grid;
  copy.insert(scanRays(scan, {}), {});
  EXPECT_EQ(copy.ownTiles(), 0U);
  EXPECT_GT(copy.tiles(), 5U);
}

TEST(Grid, BeamsThatOnlyPassCopyNoField) {
  lidar::Scan scan;
  scan.first_angle_rad = -1.5, scan.step_rad = 0.01, scan.max_range_m = 10;
  scan.ranges_m.assign(300, 3.0F);
  Grid grid({});
  grid.insert(scanRays(scan, {}), {});
  Grid copy = grid;
  scan.max_range_m = 2.5;
  scan.ranges_m.assign(300, lidar::kNoReturn);
  copy.insert(scanRays(scan, {}), {});
  std::vector<std::pair<const void*, size_t>> before, after;
  grid.appendParts(before), copy.appendParts(after);
  size_t copied = 0;
  for (const auto& part : after)
    if (std::find(before.begin(), before.end(), part) == before.end()) {
      ++copied;
      EXPECT_EQ(part.second, sizeof(SeenCell) * 32 * 32);
    }
  EXPECT_GT(copied, 3U);
}

TEST(Grid, GrowsInAllFourDirections) {
  core::RandomStream random(3, "growth");
  const auto scan = scanRays(randomScan(random), {});
  Grid far({}), near({});
  near.insert(scan, {0.02, 0.03, 0.4});
  far.insert(scan, {0.02, 0.03, 0.4});
  for (const auto& [x, y] : {std::pair(500.0, 0.0), {-700.0, 0.0}, {0.0, 300.0}, {0.0, -900.0}})
    far.insert(scan, {x, y, 0});
  EXPECT_TRUE(sameCells(near, far));
  for (const auto& [x, y] : {std::pair(500.0, 0.0), {-700.0, 0.0}, {0.0, 300.0}, {0.0, -900.0}}) {
    const auto eye = core::Pose2{x, y, 0} * scan.origin;
    const auto cell =
        far.at(static_cast<int>(std::floor(eye.x / 0.05)), static_cast<int>(std::floor(eye.y / 0.05)));
    ASSERT_TRUE(cell);
    EXPECT_TRUE(cell->seen());
  }
  EXPECT_LT(far.tiles(), 5 * near.tiles() + 20);
}

// The story of the stock grid's insertion, which turns every scan by half a beam: here the last beam ends in
// the cell that it measured.
TEST(Grid, EveryBeamEndsWhereItPoints) {
  lidar::Scan scan;
  const int beams = 181;
  scan.first_angle_rad = -core::kPi / 2, scan.step_rad = core::kPi / (beams - 1), scan.max_range_m = 20;
  scan.ranges_m.assign(beams, lidar::kLostReading);
  scan.ranges_m.front() = scan.ranges_m.back() = 10.025F;
  Grid grid({});
  grid.insert(scanRays(scan, {}), {0.025, 0, 0});
  EXPECT_TRUE(grid.at(0, 200)->occupied());
  EXPECT_TRUE(grid.at(0, -201)->occupied());
}

TEST(Grid, ABeamThatMetNothingClearsAndMarksNothing) {
  lidar::Scan scan;
  scan.step_rad = 0.01, scan.max_range_m = 3;
  scan.ranges_m = {lidar::kNoReturn};
  Grid grid({});
  grid.insert(scanRays(scan, {}), {0.01, 0.01, 0});
  EXPECT_LT(grid.probability(59, 0), 0.5);
  EXPECT_EQ(grid.probability(61, 0), 0.5);
  for (int x = -5; x < 80; ++x) EXPECT_LE(grid.probability(x, 0), 0.5);
  Grid silent({});
  silent.insert(scanRays(scan, {20, false}), {});
  EXPECT_EQ(silent.tiles(), 0U);
}

TEST(Grid, ALostReadingChangesNothing) {
  lidar::Scan scan;
  scan.step_rad = 0.01, scan.max_range_m = 3;
  scan.ranges_m = {lidar::kLostReading, 0.0F, -1.0F, -lidar::kNoReturn};
  Grid grid({});
  grid.insert(scanRays(scan, {}), {});
  EXPECT_EQ(grid.tiles(), 0U);
}

TEST(Grid, AReturnBeyondTheRangeClearsUpToIt) {
  lidar::Scan scan;
  scan.step_rad = 0.01, scan.max_range_m = 30;
  scan.ranges_m = {8.0F};
  Grid grid({});
  grid.insert(scanRays(scan, {2, true}), {0.01, 0.01, 0});
  EXPECT_LT(grid.probability(39, 0), 0.5);
  EXPECT_EQ(grid.probability(41, 0), 0.5);
  EXPECT_EQ(grid.probability(160, 0), 0.5);
}

TEST(Grid, TheSameInsertionsGiveTheSameCells) {
  EXPECT_TRUE(sameCells(randomGrid(10, 7), randomGrid(10, 7)));
}

TEST(Grid, ARasterKeepsOccupancyAndTheUnknown) {
  const Grid grid = randomGrid(6);
  const OccupancyRaster raster = grid.toRaster();
  const Grid back = Grid::fromRaster(raster, grid.options());
  size_t unknown = 0, occupied = 0;
  for (int row = 0; row < raster.rows; ++row)
    for (int column = 0; column < raster.columns; ++column) {
      const int x = static_cast<int>(std::lround(raster.x_min_m / 0.05)) + column;
      const int y = static_cast<int>(std::lround(raster.y_min_m / 0.05)) + row;
      EXPECT_NEAR(raster.at(column, row), grid.probability(x, y), 1e-6);
      EXPECT_NEAR(back.probability(x, y), grid.probability(x, y), 1e-6);
      unknown += raster.at(column, row) == 0.5F, occupied += raster.at(column, row) > kOccupiedAbove;
    }
  EXPECT_GT(unknown, 100U);
  EXPECT_GT(occupied, 100U);
  expectExactField(back, grid.options().reach_cells);
  EXPECT_EQ(back.toRaster().occupancy, raster.occupancy);
}

TEST(Grid, AnEmptyGridIsOneUnknownCell) {
  const auto raster = Grid({}).toRaster();
  EXPECT_EQ(raster.columns, 1);
  EXPECT_EQ(raster.occupancy, std::vector<float>{0.5F});
}

TEST(Grid, RefusesWhatItCannotHold) {
  Grid grid({});
  lidar::Scan scan;
  scan.step_rad = 0.01, scan.max_range_m = 3, scan.ranges_m = {1.0F};
  EXPECT_THROW(grid.insert(scanRays(scan, {}), {NAN, 0, 0}), core::ContractError);
  EXPECT_THROW(grid.insert(scanRays(scan, {}), {1e9, 0, 0}), core::ContractError);
  for (const int reach_cells : {0, 17}) {
    GridOptions bad;
    bad.reach_cells = reach_cells;
    EXPECT_THROW(Grid{bad}, core::ContractError);
  }
  OccupancyRaster other;
  other.resolution_m = 0.1, other.columns = other.rows = 1, other.occupancy = {1};
  EXPECT_THROW(Grid::fromRaster(other, {}), core::ContractError);
}

TEST(CrossedCells, ALineIsTheSameBothWays) {
  core::RandomStream random(4, "lines");
  for (int i = 0; i < 300; ++i) {
    const core::Point2 a{random.uniform(-40, 40), random.uniform(-40, 40)};
    const core::Point2 b{random.uniform(-40, 40), random.uniform(-40, 40)};
    CrossedCells one(-40, -40, 40, 40), two(-40, -40, 40, 40);
    one.addLine(a, b), two.addLine(b, a);
    for (int y = -40; y <= 40; ++y)
      for (int column = -2; column <= 1; ++column) ASSERT_EQ(one.word(column, y), two.word(column, y));
  }
}

TEST(CrossedCells, AnEndOnTheLastBorderStaysInside) {
  CrossedCells cells(0, 0, 31, 31);
  const double last = std::nextafter(32.0, 0.0);
  cells.addLine({0, 0}, {last, last});
  cells.addLine({0, last}, {last, last});
  cells.addLine({last, 0}, {last, last});
  EXPECT_EQ(cells.word(0, 31), 0xFFFFFFFFU);
  for (int y = 0; y < 32; ++y) EXPECT_NE(cells.word(0, y) & 0x80000000U, 0U);
}

}  // namespace
}  // namespace slam::gridmap
