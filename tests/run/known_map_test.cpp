// A robot localised in a grid map: a ROS yaml or MRPT's grid.
#include "libslam/run/known_map.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "libslam/core/error.h"
#include "libslam/files/files.h"
#include "libslam/logs/trajectory_io.h"
#include "libslam/mapping/map_builder.h"
#include "libslam/rays/ray_caster.h"
#include "libslam/record/record.h"
#include "libslam/resources/file_hash.h"
#include "libslam/resources/resources.h"
#include "libslam/results/journal_file.h"
#include "libslam/run/build_map.h"
#include "libslam/score/evaluate.h"
#include "libslam/testing/error_of.h"
#include "libslam/testing/temp_folder.h"
#include "tests/world/drawn_plan.h"

namespace slam::run {
namespace {
using slam::testing::errorOf;
using ::testing::HasSubstr;

/// Two rooms of 6 x 5 m at 0.1 m with a door, unknown outside; placed and turned.
world::Plan twoRooms() {
  world::Plan plan;
  plan.columns = 140, plan.rows = 60;
  plan.resolution_m = 0.1;
  plan.T_frame_raster = {3, -2, 0.7};
  plan.cells.assign(size_t{140} * 60, world::Cell::kUnknown);
  const auto fill = [&](int x0, int y0, int x1, int y1, world::Cell cell) {
    for (int y = y0; y < y1; ++y)
      for (int x = x0; x < x1; ++x) plan.cells[static_cast<size_t>(y) * 140 + x] = cell;
  };
  fill(4, 4, 136, 56, world::Cell::kOccupied);
  fill(5, 5, 68, 55, world::Cell::kFree);
  fill(69, 5, 135, 55, world::Cell::kFree);
  fill(68, 25, 69, 34, world::Cell::kFree);
  return plan;
}

TEST(ViewsOf, SeeWhatTheMapHoldsFromItsFreePlaces) {
  const world::Plan map = twoRooms();
  const auto views = viewsOf(map, 20, "map");
  EXPECT_GT(views.size(), 12U);  // 65 m2 at 1.5 m
  EXPECT_LT(views.size(), 60U);
  for (const auto& view : views) {
    EXPECT_FALSE(world::discCollides(map, core::position(view.T_map_robot), 0.3));
    ASSERT_EQ(view.scan.ranges_m.size(), 360U);
    for (size_t i = 0; i < 360; i += 7)
      EXPECT_EQ(view.scan.ranges_m[i], static_cast<float>(rays::castRay(map, core::position(view.T_map_robot),
                                                                        view.scan.angle(i), 20)));
  }
  for (const double side : {-1.0, 1.0})  // both rooms
    EXPECT_TRUE(std::any_of(views.begin(), views.end(), [&](const auto& view) {
      return side * (world::pointToCells(map, core::position(view.T_map_robot)).x - 68) > 10;
    }));
}

TEST(ViewsOf, SeeNothingThroughUnknownCells) {
  world::Plan map = twoRooms();
  for (int y = 5; y < 55; ++y) map.cells[static_cast<size_t>(y) * 140 + 40] = world::Cell::kUnknown;
  int lost = 0;
  for (const auto& view : viewsOf(map, 20, "map")) {
    const double side = world::pointToCells(map, core::position(view.T_map_robot)).x - 40.5;
    for (size_t i = 0; i < view.scan.ranges_m.size(); ++i) {
      if (std::isnan(view.scan.ranges_m[i])) ++lost;
      const core::Point2 end =
          view.T_map_robot * core::Point2{view.scan.ranges_m[i] * std::cos(view.scan.angle(i)),
                                          view.scan.ranges_m[i] * std::sin(view.scan.angle(i))};
      if (lidar::isReturn(view.scan.ranges_m[i])) {
        EXPECT_GT(side * (world::pointToCells(map, end).x - 40.5), 0);
      }
    }
  }
  EXPECT_GT(lost, 300);
}

TEST(ViewsOf, AMapWithoutAFreePlaceIsRefused) {
  world::Plan map = twoRooms();
  std::replace(map.cells.begin(), map.cells.end(), world::Cell::kFree, world::Cell::kUnknown);
  EXPECT_EQ(errorOf([&] { viewsOf(map, 20, "map.yaml"); }),
            "map.yaml: found no free place from which walls are seen within 20 m, expected at least 1");
}

TEST(GridMaps, AreKnownByTheirNames) {
  for (const char* name : {"map.yaml", "a/b.yml", "map.gridmap.gz", "x.gridmap"})
    EXPECT_TRUE(isGridMap(name));
  for (const char* name : {"folder", "map.simplemap", "folder.yaml/run"}) EXPECT_FALSE(isGridMap(name));
}

TEST(GridMaps, WhatIsNoneIsRefused) {
  const testing::TempFolder folder;
  files::writeFileAtomically(folder / "bad.gridmap.gz", "no grid");
  EXPECT_EQ(errorOf([&] { loadGridMap(folder / "bad.gridmap.gz"); }),
            folder / "bad.gridmap.gz" + ": is no MRPT occupancy grid");
  EXPECT_THAT(errorOf([&] { loadGridMap(folder / "none.yaml"); }), HasSubstr("no such file"));
}

/// A drive in the flat, in whose plan, or in a map that was made of another drive there, the robot is found.
class InAGrid : public ::testing::Test {
 protected:
  static void SetUpTestSuite() {
    shared_folder = new testing::TempFolder;
    world::Plan plan = world::loadPlan(resources::resolvePlan("flat"));
    const auto cell = world::pointToCells(plan, core::position(*world::findStartPose(plan, 0.3)));
    const int column = static_cast<int>(cell.x), row = static_cast<int>(cell.y);
    plan.doors = {{column, row, column + 1, row + 1}};  // a kept map keeps it
    world::savePlan(plan, *shared_folder / "flat.yaml");
    files::IniFile ini;
    ini.set("simulation", "duration_s", "30", "test");
    ini.set("lidar", "beams", "181", "test");
    for (const int seed : {1, 2})
      record::record(plan, record::readRecordConfig(ini), static_cast<std::uint64_t>(seed),
                     *shared_folder / ("drive" + std::to_string(seed) + ".rawlog"), {},
                     core::silentProgress());
    build("drive1", {}, "map");
  }
  static void TearDownTestSuite() {
    delete shared_folder;
    shared_folder = nullptr;
  }
  static MapRun build(const std::string& log, const Continuation& continuation, const std::string& output) {
    return buildMap(*shared_folder / (log + ".rawlog"),
                    mapping::loadMethodConfig(resources::configsFolder() + "/methods", "graph"), "graph", 1,
                    *shared_folder / output, true, {}, core::silentProgress(), {false, continuation});
  }
  static core::Trajectory truthOf(const std::string& log) {
    return logs::readTum(*shared_folder / (log + ".gt.tum"));
  }
  static testing::TempFolder* shared_folder;
};
testing::TempFolder* InAGrid::shared_folder = nullptr;

TEST_F(InAGrid, ThePosesAreThoseOfTheRosMapsFrame) {
  const auto truth = truthOf("drive2");
  const auto run = build("drive2", {*shared_folder / "flat.yaml", true, truth.front().pose}, "in_plan");
  ASSERT_TRUE(run.lost_share);
  EXPECT_EQ(*run.lost_share, 0);
  const auto evaluation =
      score::evaluate(results::loadRun(*shared_folder / "in_plan"), score::Truth{truth, {}, {}, {}});
  EXPECT_EQ(evaluation.align, metrics::Align::kNone);
  EXPECT_LT(evaluation.trajectory.position_m.max, 0.05);  // a cell of the plan
  EXPECT_EQ(evaluation.lost_share, 0);
  const auto map = world::loadPlan(*shared_folder / "in_plan/map.yaml");
  const auto plan = world::loadPlan(*shared_folder / "flat.yaml");
  EXPECT_EQ(map.cells, plan.cells);
  EXPECT_EQ(map.doors.size(), 1U);
}

TEST_F(InAGrid, SoInMrptsGrid) {
  const auto truth = truthOf("drive2");
  const core::Pose2 T_world_map = truthOf("drive1").front().pose;
  const std::string map = *shared_folder / "map/map.gridmap.gz";
  build("drive2", {map, true, core::between(T_world_map, truth.front().pose)}, "in_grid");
  EXPECT_EQ(resources::fileSha256(*shared_folder / "in_grid/map.gridmap.gz"), resources::fileSha256(map));
  const auto run = results::loadRun(*shared_folder / "in_grid");
  const score::Alignment alignment{metrics::Align::kNone,
                                   score::mapFrame(run.manifest, *shared_folder / "drive1.gt.tum")};
  EXPECT_LT(core::distance(alignment.T_truth_map, T_world_map), 1e-9);
  EXPECT_LT(score::evaluate(run, score::Truth{truth, {}, {}, {}}, alignment).trajectory.position_m.rmse,
            0.05);
}

std::vector<core::JournalLine> journalOf(const std::vector<std::pair<double, std::string>>& events) {
  std::vector<core::JournalLine> journal;
  for (const auto& [time_s, event] : events) {
    journal.emplace_back();
    journal.back().time_s = time_s, journal.back().event = core::journalEventOf(event).value();
  }
  return journal;
}

TEST(LostTime, RunsFromLostToRecoveredOrToTheEnd) {
  EXPECT_EQ(results::lostShare({}, 10), 0);
  EXPECT_EQ(results::lostShare(journalOf({{1, "poor"}, {2, "lost"}, {2.5, "lost"}, {4, "recovered"}}), 10),
            0.2);
  EXPECT_EQ(results::lostShare(journalOf({{2, "lost"}, {3, "recovered"}, {8, "lost"}}), 10), 0.3);
  EXPECT_EQ(results::lostShare(journalOf({{0, "lost"}}), 0), 0);
}

TEST(LostTime, APathWithoutItLacksThosePoses) {
  core::Trajectory path;
  for (int i = 0; i <= 10; ++i) path.push_back({100.0 + i, {static_cast<double>(i), 0, 0}});
  EXPECT_EQ(results::whileNotLost(path, {}).size(), 11U);
  const auto found = results::whileNotLost(path, {{2, 4}, {9, 10}});
  ASSERT_EQ(found.size(), 7U);  // 0, 1, 4 .. 8: recovered at 4, and lost from 9 to the end
  EXPECT_EQ(found[2].pose.x, 4);
  EXPECT_EQ(found.back().pose.x, 8);
}

}  // namespace
}  // namespace slam::run
