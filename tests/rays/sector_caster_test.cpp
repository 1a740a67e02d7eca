#include "libslam/rays/sector_caster.h"
#include "libslam/core/numbers.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <deque>
#include <limits>
#include <optional>
#include <string>

#include "libslam/buildings/building.h"
#include "libslam/buildings/generator.h"
#include "libslam/core/error.h"
#include "libslam/core/random.h"
#include "libslam/rays/ray_caster.h"
#include "libslam/testing/temp_folder.h"
#include "tests/world/drawn_plan.h"

namespace slam::rays {
namespace {

using core::kInfinity;
using core::kNaN;
using core::kPi;

template <class Number>
bool sameBits(Number a, Number b) {
  // NOLINTNEXTLINE(bugprone-suspicious-memory-comparison): bits are what is compared
  return std::memcmp(&a, &b, sizeof a) == 0;
}

/// Counts rays on which the caster and the reference differ, and tells the first of them.
class Comparison {
 public:
  explicit Comparison(const world::Plan& plan) : plan_(plan), caster_(plan) {
    for (const auto instructions : {Instructions::kPortable, Instructions::kAvx2, Instructions::kAvx512})
      if (isSupported(instructions)) casters_.emplace_back(plan, instructions);
  }

  void inCells(const core::Point2& origin, const core::Point2& direction) {
    count(castRayInCells(plan_, origin, direction), caster_.castRayInCells(origin, direction), origin,
          std::atan2(direction.y, direction.x));
  }
  void ray(const core::Point2& origin_world, double angle_rad, double max_range_m) {
    count(castRay(plan_, origin_world, angle_rad, max_range_m),
          caster_.castRay(origin_world, angle_rad, max_range_m), origin_world, angle_rad);
  }
  void scan(const core::Pose2& pose, double first_rad, double step_rad, int beams, double max_range_m) {
    const BeamTable table(first_rad, step_rad, beams);
    castScan(plan_, pose, table, max_range_m, expected_);
    for (const SectorCaster& caster : casters_) {
      caster.castScan(pose, table, max_range_m, found_);
      ASSERT_EQ(found_.size(), expected_.size());
      for (size_t i = 0; i < found_.size(); ++i)
        count(expected_[i], found_[i], core::position(pose), pose.phi + first_rad + double(i) * step_rad);
    }
  }
  /// The eight axis and diagonal directions and their neighbours by one rounding.
  void awkwardDirections(const core::Point2& origin) {
    const double tiny = 6e-17, half = std::sqrt(0.5), above = std::nextafter(half, 1.0);
    for (const double sx : {1.0, -1.0})
      for (const double sy : {1.0, -1.0})
        for (const core::Point2 d : {core::Point2{1, 0.0},
                                     {1, tiny},
                                     {half, half},
                                     {half, above},
                                     {0.8, 0.6},
                                     {2 / std::sqrt(5.0), 1 / std::sqrt(5.0)}}) {
          inCells(origin, {sx * d.x, sy * d.y});
          inCells(origin, {sx * d.y, sy * d.x});
        }
  }

  void expectNoDifference(std::int64_t at_least_rays) const {
    EXPECT_GE(rays_, at_least_rays);
    EXPECT_EQ(differences_, 0) << "of " << rays_ << "; first: " << first_;
  }
  std::int64_t hits() const { return hits_; }

 private:
  template <class Number>
  void count(Number expected, Number found, const core::Point2& origin, double angle_rad) {
    ++rays_;
    hits_ += expected < static_cast<Number>(kInfinity);
    if (sameBits(expected, found)) return;
    if (differences_++ == 0)
      first_ = "from " + std::to_string(origin.x) + " " + std::to_string(origin.y) + " along " +
               std::to_string(angle_rad) + ": " + std::to_string(found) + " instead of " +
               std::to_string(expected);
  }

  const world::Plan& plan_;
  SectorCaster caster_;
  std::deque<SectorCaster> casters_;  ///< one for each instruction set of this processor
  std::int64_t rays_ = 0, hits_ = 0, differences_ = 0;
  std::string first_;
  std::vector<float> expected_, found_;
};

world::Plan placedPlan(int columns, int rows, std::uint64_t seed, int one_in) {
  world::Plan plan = world::scatteredPlan(columns, rows, seed, one_in);
  plan.T_frame_raster = {3, -2, 0.7};
  return plan;
}

/// In a wall, in the open or just outside.
core::Point2 anyPoint(core::RandomStream& random, const world::Plan& plan) {
  return world::cellsToPoint(
      plan, {random.uniform(-0.5, plan.columns + 0.5), random.uniform(-0.5, plan.rows + 0.5)});
}

/// A committed world, a generated building or a real map, by name; nullopt for a real map that is not here.
std::optional<world::Plan> planNamed(const std::string& name) {
  const auto is = [&](const auto& names) {
    return std::find(names.begin(), names.end(), name) != names.end();
  };
  if (is(buildings::buildingNames()))
    return world::loadPlan(std::string(RASTERSLAM_SOURCE_DIR "/datasets/worlds/") + name + ".yaml");
  const std::string kind = name.substr(name.find('_') + 1);
  if (name.rfind("generated_", 0) == 0) {
    buildings::BuildingOptions options;
    options.width_m = 40;
    options.height_m = 30;
    return buildings::generateBuilding(kind, options, 1).plan;
  }
  const std::string file = name == "willow"  ? "willow/willow-full"
                           : name == "depot" ? "nav2/depot"
                                             : "turtlebot3/map";
  const std::string data = slam::testing::realDataFolder(RASTERSLAM_SOURCE_DIR);
  if (data.empty()) return std::nullopt;
  return world::loadPlan(data + "/worlds/" + file + ".yaml");
}

class OfEveryPlan : public ::testing::TestWithParam<const char*> {
 protected:
  void SetUp() override {
    plan_ = planNamed(GetParam());
    if (!plan_)
      GTEST_SKIP() << "the real plan is not here: set RASTERSLAM_REAL_DATA to a folder with worlds/";
  }
  std::optional<world::Plan> plan_;
};

TEST_P(OfEveryPlan, AMillionRaysEqualTheReferenceBitForBit) {
  const world::Plan& plan = *plan_;
  Comparison compare(plan);
  core::RandomStream random(1, "sector caster");
  for (int i = 0; i < 500; ++i) {
    const core::Point2 p = anyPoint(random, plan);
    const core::Pose2 pose{p.x, p.y, random.uniform(-10, 10)};
    compare.scan(pose, -kPi, 2 * kPi / 1080, 1080, 0);
    compare.scan(pose, -kPi, 2 * kPi / 1080, 1080, random.uniform(0.1, 20));
  }
  for (int i = 0; i < 20000; ++i) compare.ray(anyPoint(random, plan), random.uniform(-9, 9), 0);
  for (int i = 0; i < 20000; ++i)
    compare.ray(anyPoint(random, plan), random.uniform(-9, 9), random.uniform(0, 10));
  compare.expectNoDifference(2000000);
  EXPECT_GT(compare.hits(), 300000);
}

TEST_P(OfEveryPlan, RaysOnGridLinesAndThroughCornersEqualTheReference) {
  const world::Plan& plan = *plan_;
  Comparison compare(plan);
  core::RandomStream random(2, "grid lines");
  const auto onLine = [&](int size) { return double(random.below(static_cast<std::uint64_t>(size) + 1)); };
  for (int i = 0; i < 1000; ++i) {
    const core::Point2 corner{onLine(plan.columns), onLine(plan.rows)};
    compare.awkwardDirections(corner);
    compare.awkwardDirections({corner.x + 0.5, corner.y});
    compare.awkwardDirections({corner.x, corner.y + 0.5});
    compare.awkwardDirections({corner.x + 0.25, corner.y + 0.75});
    compare.awkwardDirections({std::nextafter(corner.x, 0.0), std::nextafter(corner.y, 1e9)});
    const double rise = double(random.below(9)) - 4, run = double(random.below(9)) - 4;
    if (rise != 0 || run != 0)
      compare.inCells(corner, {run / std::hypot(run, rise), rise / std::hypot(run, rise)});
  }
  compare.expectNoDifference(200000);
}

INSTANTIATE_TEST_SUITE_P(SectorCaster, OfEveryPlan,
                         ::testing::Values("corridor", "flat", "maze", "office_loop", "pillar_hall",
                                           "generated_flat", "generated_office", "generated_hall",
                                           "generated_hospital", "generated_cave", "willow", "depot",
                                           "turtlebot3"),
                         [](const auto& world) { return std::string(world.param); });

TEST(SectorCaster, EqualsTheReferenceAtEveryDensityOfWallsAndWithOpenRims) {
  for (const int one_in : {1, 2, 8, 60, 1000, 1000000}) {
    const world::Plan plan = placedPlan(150, 110, 7, one_in);
    Comparison compare(plan);
    core::RandomStream random(11, "densities");
    for (int i = 0; i < 40; ++i) {
      const core::Point2 p = anyPoint(random, plan);
      compare.scan({p.x, p.y, random.uniform(-4, 4)}, -kPi, 2 * kPi / 1001, 1001, i % 2 == 0 ? 0 : 2.5);
    }
    for (int column = 0; column <= plan.columns; column += 3)
      for (int row = 0; row <= plan.rows; row += 5) compare.awkwardDirections({double(column), double(row)});
    compare.expectNoDifference(80000);
  }
}

TEST(SectorCaster, SkipsFartherThanOneByteCounts) {
  world::Plan plan = placedPlan(1500, 40, 1, 1000000000);
  for (int row = 0; row < plan.rows; ++row)
    plan.cells[static_cast<size_t>(row) * 1500 + 1400] = world::Cell::kOccupied;
  Comparison compare(plan);
  core::RandomStream random(3, "long skips");
  for (int i = 0; i < 40000; ++i) {
    const double y = random.uniform(-0.03, 0.03), x = random.below(2) == 0 ? -1 : 1;
    compare.inCells({random.uniform(0, 1500), random.uniform(0, 40)}, {x * std::sqrt(1 - y * y), y});
  }
  compare.expectNoDifference(40000);
  EXPECT_GT(compare.hits(), 10000);
}

TEST(SectorCaster, EqualsTheReferenceOnDrawnPlansOfOneCellOneLineAndNothing) {
  for (const world::Plan& plan :
       {world::drawnPlan({"#"}), world::drawnPlan({"."}), world::drawnPlan({"?"}), world::drawnPlan({".?.#"}),
        world::drawnPlan({"#", ".", "."}), world::drawnPlan({"#.", ".#"}), world::Plan{}}) {
    Comparison compare(plan);
    for (double x = -0.5; x <= plan.columns + 0.5; x += 0.25)
      for (double y = -0.5; y <= plan.rows + 0.5; y += 0.25) {
        compare.awkwardDirections({x, y});
        compare.scan({x, y, 0.1}, -kPi, 0.1, 64, 0);
        compare.scan({x, y, 0.1}, -kPi, 0.1, 64, 1.1);
      }
    compare.expectNoDifference(100);
  }
}

TEST(SectorCaster, StopsAtTheMaximumRangeInclusive) {
  const SectorCaster caster(world::drawnPlan({".....#"}));
  EXPECT_EQ(caster.castRay({0.5, 0.5}, 0, 4.5), 4.5);
  EXPECT_EQ(caster.castRay({0.5, 0.5}, 0, std::nextafter(4.5, 0.0)), kInfinity);
  EXPECT_EQ(caster.castRay({0.5, 0.5}, 0, -1), 4.5);
}

TEST(SectorCaster, AnswersInfinityForAPoseThatIsNotFiniteOrOutside) {
  const SectorCaster caster(world::drawnPlan({"########", "#......#", "#......#", "########"}));
  for (const double bad : {kNaN, kInfinity, -kInfinity, 1e300, -0.5, 8.5}) {
    EXPECT_EQ(caster.castRay({bad, 1.5}, 0, 0), kInfinity) << bad;
    EXPECT_EQ(caster.castRay({1.5, bad}, 0, 0), kInfinity) << bad;
  }
  EXPECT_EQ(caster.castRay({1.5, 1.5}, kNaN, 0), kInfinity);
  std::vector<float> ranges(3, -1.0F);
  caster.castScan({1.5, 1.5, kNaN}, {0, 0.1, 5}, 0, ranges);
  EXPECT_EQ(ranges, std::vector<float>(5, std::numeric_limits<float>::infinity()));
  caster.castScan({kNaN, 1.5, 0}, {0, 0.1, 9}, 0, ranges);
  EXPECT_EQ(ranges, std::vector<float>(9, std::numeric_limits<float>::infinity()));
  caster.castScan({1.5, 1.5, 0}, {0, 0.1, 0}, 0, ranges);
  EXPECT_TRUE(ranges.empty());
  caster.castScan({1.5, 1.5, 0}, {0, 0.1, -1}, 0, ranges);
  EXPECT_TRUE(ranges.empty());
}

TEST(SectorCaster, DecidesTiesAtCornersInAScanAsTheReferenceDoes) {
  world::Plan plan = placedPlan(60, 60, 9, 12);
  plan.resolution_m = 1;  // so that quarters of cells stay exact, and with them the ties
  plan.T_frame_raster = {};
  Comparison compare(plan);
  core::RandomStream random(4, "ties");
  constexpr std::uint64_t kQuarters = 240;
  for (int i = 0; i < 4000; ++i) {
    const double x = double(random.below(kQuarters)) / 4, y = double(random.below(kQuarters)) / 4;
    const double run = double(random.below(9)) - 4, rise = double(random.below(9)) - 4;
    compare.scan({x, y, 0}, std::atan2(rise, run), 0, 7, 0);
  }
  compare.expectNoDifference(50000);
}

TEST(SectorCaster, CastsBeamsInAnyOrderAndOfAnyNumber) {
  const world::Plan plan = placedPlan(50, 50, 1, 30);
  Comparison compare(plan);
  const core::Point2 p = world::cellsToPoint(plan, {25.3, 24.6});
  for (const double step : {0.0, 1.0, 2.5, -0.01, 100.7})
    for (const int beams : {1, 2, 7, 700, 2048, 2049, 5000})
      compare.scan({p.x, p.y, 0.3}, 40, step, beams, 0);
  compare.expectNoDifference(40000);
  EXPECT_GT(compare.hits(), 10000);
  EXPECT_THROW(BeamTable(0, kNaN, 2), core::ContractError);
  EXPECT_THROW(BeamTable(kInfinity, 0, 1), core::ContractError);
}

TEST(SectorCaster, CastsAsManyScansAsThereArePosesWithAnyNumberOfThreads) {
  const world::Plan plan = placedPlan(120, 80, 5, 90);
  const SectorCaster caster(plan);
  const BeamTable table(-2, 0.01, 333);
  core::RandomStream random(8, "batch");
  std::vector<core::Pose2> poses;
  std::vector<float> expected, one, found;
  for (int i = 0; i < 41; ++i) {
    const core::Point2 p = anyPoint(random, plan);
    poses.push_back({p.x, p.y, random.uniform(-4, 4)});
    caster.castScan(poses.back(), table, 3, one);
    expected.insert(expected.end(), one.begin(), one.end());
  }
  for (const int threads : {-1, 1, 2, 3, 41, 100}) {
    caster.castScans(poses, table, 3, threads, found);
    ASSERT_EQ(found.size(), expected.size());
    EXPECT_EQ(std::memcmp(found.data(), expected.data(), sizeof(float) * found.size()), 0) << threads;
  }
  caster.castScans({}, table, 3, 2, found);
  EXPECT_TRUE(found.empty());
}

// A column and a row share 32 bits while rays march.
TEST(SectorCaster, EqualsTheReferenceInTheLongestPlans) {
  for (const int length : {32766, 32767, 32768})
    for (const bool lying : {true, false}) {
      world::Plan plan;
      plan.columns = lying ? length : 3;
      plan.rows = lying ? 3 : length;
      plan.resolution_m = 1;
      plan.cells.assign(static_cast<size_t>(length) * 3, world::Cell::kFree);
      plan.cells.front() = plan.cells.back() = world::Cell::kOccupied;
      Comparison compare(plan);
      core::RandomStream random(static_cast<std::uint64_t>(length), "long plans");
      for (int i = 0; i < 60; ++i) {
        const double along = i % 3 == 0 ? 1.5 : i % 3 == 1 ? length - 1.5 : random.uniform(0, length);
        const double across = random.uniform(0, 3), ahead = (lying ? 0 : kPi / 2) + (i % 2 == 0 ? 0 : kPi);
        compare.scan({lying ? along : across, lying ? across : along, ahead}, -2e-5, 4e-7, 101, 0);
        compare.scan({lying ? along : across, lying ? across : along, ahead}, -kPi, 0.4, 16, 0);
      }
      compare.expectNoDifference(10000);
      EXPECT_GT(compare.hits(), 100);
    }
  world::Plan longer;
  longer.columns = 32769;
  longer.rows = 1;
  longer.cells.assign(32769, world::Cell::kFree);
  EXPECT_THROW(SectorCaster{longer}, core::ContractError);
}

TEST(SectorCaster, CastsPartOfATable) {
  const world::Plan plan = placedPlan(120, 80, 5, 90);
  const SectorCaster caster(plan);
  const BeamTable table(-3, 0.01, 600);
  const core::Point2 p = world::cellsToPoint(plan, {60.2, 40.7});
  std::vector<float> all, part(600, -1.0F);
  caster.castScan({p.x, p.y, 1}, table, 0, all);
  caster.castBeams({p.x, p.y, 1}, table, 100, 57, 0, part.data());
  EXPECT_TRUE(std::equal(part.begin(), part.begin() + 57, all.begin() + 100));
  EXPECT_EQ(part[57], -1.0F);
}

TEST(SectorCaster, OutlivesAndIgnoresThePlanItWasMadeFrom) {
  world::Plan plan = world::drawnPlan({".....#"});
  const SectorCaster caster(plan);
  plan = world::drawnPlan({".#"});
  EXPECT_EQ(caster.castRay({0.5, 0.5}, 0, 0), 4.5);
}

}  // namespace
}  // namespace slam::rays
