#include "libslam/buildings/generator.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <string>

#include "libslam/core/error.h"
#include "libslam/core/random.h"
#include "libslam/resources/file_hash.h"
#include "libslam/testing/error_of.h"
#include "libslam/world/clearance.h"
#include "libslam/world/region.h"

namespace slam::buildings {
namespace {

constexpr double kRobotRadius_m = 0.25;
constexpr std::uint64_t kSeeds = 12;  // six hundred of each kind were tried when the generator was written

std::string hashOf(const world::Plan& plan) {
  std::string bytes = std::to_string(plan.columns) + " ";
  for (const world::Cell cell : plan.cells) bytes += static_cast<char>('0' + static_cast<int>(cell));
  for (const world::Material material : plan.materials)
    bytes += static_cast<char>('a' + static_cast<int>(material));
  for (const world::Door& door : plan.doors)
    for (const int end : {door.x0, door.y0, door.x1, door.y1}) bytes += " " + std::to_string(end);
  return resources::sha256(bytes).substr(0, 16);
}

size_t regionsOf(const world::Plan& plan, const std::vector<char>& marked) {
  const std::vector<world::RegionRun> runs = world::regionRuns(plan.columns, marked);
  size_t regions = 0;
  for (size_t i = 0; i < runs.size(); ++i) regions += runs[i].region == i;
  return regions;
}

/// Everything that generator.h promises of a plan; "" when it holds.
std::string brokenPromiseOf(const world::Plan& plan, const BuildingOptions& options) {
  const auto sized = [&](double side_m, int cells) {
    return std::abs(side_m / options.resolution_m - cells) <= 1;
  };
  if (!sized(options.width_m, plan.columns) || !sized(options.height_m, plan.rows)) return "another size";
  const auto at = [&](int column, int row) {
    return plan.contains(column, row) ? plan.at(column, row) : world::Cell::kUnknown;
  };
  std::vector<char> is_free(plan.cells.size());
  for (int row = 0; row < plan.rows; ++row)
    for (int column = 0; column < plan.columns; ++column) {
      if (at(column, row) != world::Cell::kFree) continue;
      is_free[static_cast<size_t>(row) * plan.columns + column] = 1;
      for (int dy = -1; dy <= 1; ++dy)
        for (int dx = -1; dx <= 1; ++dx)
          if (at(column + dx, row + dy) == world::Cell::kUnknown)
            return "not enclosed at " + std::to_string(column) + " " + std::to_string(row);
    }
  if (regionsOf(plan, is_free) != 1)
    return "free cells in " + std::to_string(regionsOf(plan, is_free)) + " regions";
  const std::vector<char> admissible = world::admissibleCells(plan, kRobotRadius_m / options.resolution_m);
  if (regionsOf(plan, admissible) != 1)
    return "a robot is at home in " + std::to_string(regionsOf(plan, admissible)) + " regions";
  for (const world::Door& door : plan.doors) {
    const std::string where = "door at " + std::to_string(door.x0) + " " + std::to_string(door.y0);
    if (std::max(door.x1 - door.x0, door.y1 - door.y0) * options.resolution_m < 0.8 - 1e-9)
      return where + " narrow";
    for (int row = door.y0; row < door.y1; ++row)
      for (int column = door.x0; column < door.x1; ++column)
        if (at(column, row) != world::Cell::kFree) return where + " shut";
    const auto isReached = [&](int x0, int y0, int x1, int y1) {
      for (int row = y0; row < y1; ++row)
        for (int column = x0; column < x1; ++column)
          if (admissible[static_cast<size_t>(row) * plan.columns + column]) return true;
      return false;
    };
    const int step = static_cast<int>(std::lround(0.6 / options.resolution_m));
    const bool runs_in_x = door.x1 - door.x0 > door.y1 - door.y0;
    const bool is_passed = isReached(door.x0, door.y0, door.x1, door.y1) &&
                           (runs_in_x ? isReached(door.x0, door.y0 - step, door.x1, door.y0) &&
                                            isReached(door.x0, door.y1, door.x1, door.y1 + step)
                                      : isReached(door.x0 - step, door.y0, door.x0, door.y1) &&
                                            isReached(door.x1, door.y0, door.x1 + step, door.y1));
    if (!is_passed) return where + " not passable";
  }
  if (!world::findStartPose(plan, 0.35)) return "no start";
  for (size_t i = 0; i < plan.materials.size(); ++i)
    if (plan.materials[i] != world::Material::kPlain && plan.cells[i] != world::Cell::kOccupied)
      return "air of glass";
  return "";
}

BuildingOptions sized(double width_m, double height_m, double resolution_m = 0.05) {
  BuildingOptions options;
  options.width_m = width_m, options.height_m = height_m, options.resolution_m = resolution_m;
  return options;
}

class Generator : public ::testing::TestWithParam<std::string> {};
std::vector<std::string> kindNames() {
  std::vector<std::string> names;
  for (const BuildingKind& kind : buildingKinds()) names.push_back(kind.name);
  return names;
}
INSTANTIATE_TEST_SUITE_P(All, Generator, ::testing::ValuesIn(kindNames()),
                         [](const auto& kind) { return kind.param; });

TEST_P(Generator, KeepsItsPromisesForManySeedsAndSizes) {
  core::RandomStream random(1, "sizes " + GetParam());
  int drawn = 0;
  for (std::uint64_t seed = 1; seed <= kSeeds; ++seed) {
    BuildingOptions options =
        sized(std::round(random.uniform(50, 450)) / 10, std::round(random.uniform(50, 350)) / 10,
              0.02 * static_cast<double>(2 + random.below(4)));
    options.clutter = random.uniform(), options.glass = random.chance(0.5) ? random.uniform() : 0;
    options.door_m = random.uniform(0.8, 2.0), options.wall_m = random.uniform(0.1, 0.5);
    options.outer_wall_m = random.uniform(0.1, 1.0);
    if (random.chance(0.5)) options.corridor_m = random.uniform(1, 8);
    if (random.chance(0.5)) options.room_m = std::exp(random.uniform(std::log(2.5), std::log(80)));
    try {
      const GeneratedBuilding building = generateBuilding(GetParam(), options, seed);
      ASSERT_EQ(brokenPromiseOf(building.plan, options), "")
          << "seed " << seed << ", " << options.width_m << " x " << options.height_m << " m at "
          << options.resolution_m << " m, glass " << options.glass << ", clutter " << options.clutter
          << ", door " << options.door_m << ", walls " << options.wall_m << " and " << options.outer_wall_m;
      ++drawn;
    } catch (const core::InputError& e) {
      ASSERT_NE(std::string(e.what()).find("expected at least"), std::string::npos) << e.what();
    }
  }
  EXPECT_GT(drawn, static_cast<int>(kSeeds) / 4);
}

TEST_P(Generator, DrawsTheSameCellsOnAnyMachine) {
  const std::map<std::string, std::string> golden = {
      {"flat", "e9a0c85b60dd1e15"},     {"office", "fdbfa51327d96150"}, {"hall", "86ee538e1e5e1344"},
      {"hospital", "d4536b8af39faf6f"}, {"cave", "3d18b5de91a132cf"},   {"campus", "a261cda34ce65947"}};
  BuildingOptions options = sized(34, 26);
  options.glass = 0.3;
  const world::Plan plan = generateBuilding(GetParam(), options, 1).plan;
  EXPECT_EQ(hashOf(plan), golden.at(GetParam()));
  EXPECT_EQ(hashOf(plan), hashOf(generateBuilding(GetParam(), options, 1).plan));
  EXPECT_NE(hashOf(plan), hashOf(generateBuilding(GetParam(), options, 2).plan));
}

TEST_P(Generator, LeavesTheWallsAsTheyAreForOtherFurnitureOrGlass) {
  BuildingOptions bare = sized(34, 26);
  bare.clutter = 0;
  BuildingOptions full = bare, glazed = bare;
  full.clutter = 1, glazed.glass = 1;
  const world::Plan walls = generateBuilding(GetParam(), bare, 5).plan;
  const world::Plan furnished = generateBuilding(GetParam(), full, 5).plan;
  const world::Plan with_glass = generateBuilding(GetParam(), glazed, 5).plan;
  EXPECT_TRUE(walls.cells == with_glass.cells);
  ASSERT_EQ(walls.cells.size(), furnished.cells.size());
  size_t added = 0;
  for (size_t i = 0; i < walls.cells.size(); ++i) {
    // Windows keep their wall where furniture stands before them.
    added += walls.cells[i] == world::Cell::kFree && furnished.cells[i] == world::Cell::kOccupied;
    ASSERT_FALSE(walls.cells[i] == world::Cell::kOccupied && furnished.cells[i] == world::Cell::kFree)
        << "cell " << i;
  }
  EXPECT_GT(added, 0U);
  EXPECT_EQ(walls.doors.size(), furnished.doors.size());
}

TEST_P(Generator, StandsWhereItIsHigherThanWide) {
  const world::Plan lying = generateBuilding(GetParam(), sized(30, 22), 3).plan;
  const world::Plan standing = generateBuilding(GetParam(), sized(22, 30), 3).plan;
  ASSERT_EQ(standing.columns, lying.rows);
  ASSERT_EQ(standing.rows, lying.columns);
  for (int row = 0; row < lying.rows; ++row)
    for (int column = 0; column < lying.columns; ++column)
      ASSERT_EQ(lying.at(column, row), standing.at(row, column));
  EXPECT_EQ(brokenPromiseOf(standing, sized(22, 30)), "");
}

TEST_P(Generator, HasMoreRoomsWhenItIsLarger) {
  const GeneratedBuilding small = generateBuilding(GetParam(), sized(40, 25, 0.1), 1);
  const GeneratedBuilding large = generateBuilding(GetParam(), sized(160, 100, 0.1), 1);
  EXPECT_GE(large.rooms, small.rooms + 5);  // sixteen times the area; a hall has sections of some 60 x 60 m
}

TEST_P(Generator, DrawsTheLargestSize) {
  const BuildingOptions options = sized(200, 200, 0.1);
  EXPECT_EQ(brokenPromiseOf(generateBuilding(GetParam(), options, 1).plan, options), "");
}

TEST_P(Generator, SaysTheLeastSizeAndDrawsIt) {
  const auto draw = [&](const BuildingOptions& options) { return generateBuilding(GetParam(), options, 1); };
  const std::string error = testing::errorOf([&] { draw(sized(5, 5)); });
  double width = 5, height = 5;
  if (error != "no error") {
    ASSERT_EQ(error.rfind("[building] width_m, height_m: found 5 x 5, expected at least ", 0), 0U) << error;
    ASSERT_EQ(
        std::sscanf(error.c_str(), "%*[^:]: found %*s x %*s expected at least %lf x %lf", &width, &height),
        2);
  }
  for (const double wide : {width, width + 6.7})
    for (const double high : {height, height + 0.1, height + 0.9})
      for (std::uint64_t seed = 1; seed <= 3; ++seed) {
        const BuildingOptions options = sized(wide, std::min(wide, high));
        EXPECT_EQ(brokenPromiseOf(generateBuilding(GetParam(), options, seed).plan, options), "")
            << wide << " x " << high << ", seed " << seed;
      }
}

TEST(GeneratorErrors, NameTheKeyOrTheKind) {
  const auto error = [](const std::string& kind, const BuildingOptions& options) {
    return testing::errorOf([&] { generateBuilding(kind, options, 1); });
  };
  EXPECT_EQ(
      error("ofice", {}),
      "unknown kind of building 'ofice', expected flat, office, hall, hospital, cave or campus; did you mean "
      "'office'?");
  EXPECT_EQ(error("office", sized(4, 20)),
            "[building] width_m: found 4, expected 5 to 500, or 0 for the kind's own");
  EXPECT_EQ(error("office", sized(20, 501)),
            "[building] height_m: found 501, expected 5 to 500, or 0 for the kind's own");
  EXPECT_EQ(error("office", sized(500, 400, 0.04)),
            "[building] resolution_m: found 0.04 for 500 x 400 m, expected at least 0.045: at most 100 "
            "million cells");
  BuildingOptions options;
  options.corridor_m = 0.4;
  EXPECT_EQ(error("office", options),
            "[building] corridor_m: found 0.4, expected 1 to 8, or 0 for the kind's own");
  options.corridor_m = 0, options.room_m = 2;
  EXPECT_EQ(error("office", options),
            "[building] room_m: found 2, expected 2.5 to 200, or 0 for the kind's own");
  options.room_m = 0, options.pillars_m = 2;
  EXPECT_EQ(error("hall", options),
            "[building] pillars_m: found 2, expected 3 to 80, or 0 for a furnished hall");
}

TEST(GeneratedCampus, HasOneYardOf200MetresWhereAsked) {
  BuildingOptions options = sized(200, 200, 0.1);
  options.room_m = 200;
  const GeneratedBuilding building = generateBuilding("campus", options, 1);
  EXPECT_EQ(building.rooms, 1);
  EXPECT_EQ(brokenPromiseOf(building.plan, options), "");
  options.room_m = 50;
  EXPECT_EQ(generateBuilding("campus", options, 1).rooms, 16);
}

/// Occupied cells with nothing of the outer walls: farther than 5 m from the plan's rim.
size_t innerWallCells(const world::Plan& plan) {
  const int rim = static_cast<int>(5 / plan.resolution_m);
  size_t cells = 0;
  for (int row = rim; row < plan.rows - rim; ++row)
    for (int column = rim; column < plan.columns - rim; ++column)
      cells += plan.at(column, row) == world::Cell::kOccupied;
  return cells;
}

TEST(GeneratedHall, IsOneOpenRoomWithPillarsSoFarApartWhereAsked) {
  BuildingOptions options = sized(200, 120, 0.1);
  options.clutter = 0, options.pillars_m = 20;
  const world::Plan plan = generateBuilding("hall", options, 1).plan;
  EXPECT_EQ(brokenPromiseOf(plan, options), "");
  // 9 x 5 pillars of 0.45 m, which are 5 x 5 cells at most; without racks, and the office in the corner
  // apart.
  EXPECT_LE(innerWallCells(plan), 45U * 25 + 200);
  EXPECT_GE(innerWallCells(plan), 45U * 16);
  options.pillars_m = 0;
  EXPECT_GT(innerWallCells(generateBuilding("hall", options, 1).plan), 5000U);
}

TEST(GeneratedHospital, IsAliasedWithoutFurniture) {
  BuildingOptions options = sized(60, 44);
  options.clutter = 0;
  const world::Plan plan = generateBuilding("hospital", options, 4).plan;
  for (int row = 0; row < plan.rows; ++row)
    for (int column = 0; column < plan.columns; ++column)
      ASSERT_EQ(plan.at(column, row), plan.at(plan.columns - 1 - column, row)) << column << " " << row;
}

/// Independent loops of the free space: holes of the plan seen by the robot, by Euler's formula.
int loopsOf(const world::Plan& plan, double resolution_m) {
  const std::vector<char> admissible = world::admissibleCells(plan, kRobotRadius_m / resolution_m);
  std::vector<char> rest(admissible.size());
  for (size_t i = 0; i < rest.size(); ++i) rest[i] = !admissible[i];
  // 8-connected complement would be exact; 4-connected counts a little more at corners that touch.
  return static_cast<int>(regionsOf(plan, rest)) - 1;
}

TEST_P(Generator, HasLoopsWhenItIsLarge) {
  BuildingOptions options = sized(80, 60, 0.1);
  options.clutter = 0;
  EXPECT_GE(loopsOf(generateBuilding(GetParam(), options, 2).plan, 0.1), 3);
}

}  // namespace
}  // namespace slam::buildings
