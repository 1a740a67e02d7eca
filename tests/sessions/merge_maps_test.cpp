// Two drives in one building, and what becomes of their maps.
#include "libslam/sessions/merge_maps.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "libslam/core/error.h"
#include "libslam/files/files.h"
#include "libslam/logs/trajectory_io.h"
#include "libslam/mapping/key_frames.h"
#include "libslam/record/record.h"
#include "libslam/resources/file_hash.h"
#include "libslam/resources/resources.h"
#include "libslam/run/build_map.h"
#include "libslam/sessions/diff_maps.h"
#include "libslam/testing/error_of.h"
#include "libslam/testing/temp_folder.h"

namespace slam::sessions {
namespace {

namespace fs = std::filesystem;
using slam::testing::errorOf;
using ::testing::HasSubstr;

files::IniFile config() {
  return mapping::loadMethodConfig(resources::configsFolder() + "/methods", "graph");
}

class TwoVisits : public ::testing::Test {
 protected:
  static void SetUpTestSuite() {
    shared_folder = new testing::TempFolder;
    visit("monday", "flat", 2, "auto", "150");
    // From the other end of the flat, with other furniture.
    visit("tuesday", "flat", 7, "9.5,8,180", "150", "2");
    visit("elsewhere", "pillar_hall", 3, "auto", "30");
  }
  static void TearDownTestSuite() {
    delete shared_folder;
    shared_folder = nullptr;
  }
  static void visit(const std::string& name, const std::string& plan, std::uint64_t seed,
                    const std::string& start, const std::string& duration_s,
                    const std::string& number = "1") {
    files::IniFile ini;
    ini.set("simulation", "duration_s", duration_s, "test");
    ini.set("simulation", "start", start, "test");
    ini.set("strategy", "name", "wall_follow", "test");
    ini.set("living", "visit", number, "test");
    const std::string log = *shared_folder / (name + ".rawlog");
    record::record(world::loadPlan(resources::resolvePlan(plan)), record::readRecordConfig(ini), seed, log,
                   {}, core::silentProgress());
    run::buildMap(log, config(), "graph", 1, *shared_folder / name, true, {}, core::silentProgress(),
                  {false});
  }
  static std::string at(const std::string& name) { return *shared_folder / name; }
  static MergedMap merge(const std::vector<std::string>& maps, const std::string& output) {
    return mergeMaps(maps, config(), at(output), true, {}, core::silentProgress());
  }
  static testing::TempFolder* shared_folder;
};
testing::TempFolder* TwoVisits::shared_folder = nullptr;

/// Where each path has the world's frame in the merged map.
core::Pose2 worldIn(const std::string& path, const std::string& truth) {
  const auto estimate = logs::readTum(path);
  const auto true_path = logs::readTum(truth);
  const size_t i = estimate.size() / 2;
  const auto same = std::find_if(true_path.begin(), true_path.end(), [&](const core::StampedPose& pose) {
    return std::abs(pose.time_s - estimate[i].time_s) < 1e-4;
  });
  return estimate[i].pose * core::inverse(same->pose);
}

TEST_F(TwoVisits, BecomeOneMap) {
  const auto merged = merge({at("monday"), at("tuesday") + "/"}, "both");
  ASSERT_EQ(merged.sessions.size(), 2U);
  EXPECT_EQ(merged.sessions[1].session.name, "tuesday");
  EXPECT_LT(merged.sessions[1].place.contradicted, kMostContradicted);
  const auto one = worldIn(at("both/monday.tum"), at("monday.gt.tum")),
             other = worldIn(at("both/tuesday.tum"), at("tuesday.gt.tum"));
  EXPECT_LT(core::distance(one, other), 0.05);
  EXPECT_LT(std::abs(core::angleDifference(one.phi, other.phi)), 0.01);
  for (const std::string name : {"monday", "tuesday"})
    EXPECT_EQ(logs::readTum(at("both/" + name + ".tum")).size(),
              logs::readTum(at(name + "/trajectory.tum")).size());
  const auto json = nlohmann::json::parse(files::readTextFile(at("both/merge.json")));
  EXPECT_EQ(json.at("sessions").size(), 2U);
  EXPECT_NEAR(json.at("sessions")[1].at("pose").at("x_m").get<double>(),
              merged.sessions[1].place.T_map_part.x, 1e-9);
  // All that either has seen.
  const auto frames = mapping::readKeyFrames(at("both/map.simplemap"));
  EXPECT_EQ(static_cast<int>(frames.size()), merged.sessions[0].key_frames + merged.sessions[1].key_frames);
}

TEST_F(TwoVisits, AMergedMapIsLocalisedInLikeARunsMap) {
  merge({at("monday"), at("tuesday")}, "both");
  run::Continuation in;
  in.folder = at("both");
  in.localise_only = true;
  const auto result = run::buildMap(at("tuesday.rawlog"), config(), "graph", 1, at("localised"), true, {},
                                    core::silentProgress(), {false, in});
  const auto path = logs::readTum(at("both/tuesday.tum"));
  EXPECT_LT(core::distance(result.estimate.back().pose, path.back().pose), 0.1);
}

TEST_F(TwoVisits, SameMapsSameBytes) {
  merge({at("monday"), at("tuesday")}, "once");
  merge({at("monday"), at("tuesday")}, "again");
  for (const std::string file : {"map.png", "map.simplemap", "graph.g2o", "merge.json", "tuesday.tum"})
    EXPECT_EQ(resources::fileSha256(at("once/" + file)), resources::fileSha256(at("again/" + file))) << file;
}

TEST_F(TwoVisits, WhatDoesNotBelongIsRefusedAndNothingIsWritten) {
  EXPECT_THAT(errorOf([] { merge({at("monday"), at("elsewhere")}, "wrong"); }), HasSubstr("elsewhere"));
  EXPECT_FALSE(fs::exists(at("wrong")));
}

TEST_F(TwoVisits, AMirrorImageIsCalledOne) {
  auto frames = mapping::readKeyFrames(at("tuesday/map.simplemap"));
  for (auto& frame : frames) {
    std::reverse(frame.scan.ranges_m.begin(), frame.scan.ranges_m.end());
    frame.T_map_robot.y *= -1, frame.T_map_robot.phi *= -1;
  }
  mapping::writeKeyFrames(frames, at("mirror.simplemap"));
  EXPECT_THAT(errorOf([] {
                merge({at("monday"), at("mirror.simplemap")}, "wrong");
              }),
              HasSubstr("is a mirror image of the first map"));
}

TEST_F(TwoVisits, AMapOfAnotherScaleIsRefused) {
  auto frames = mapping::readKeyFrames(at("tuesday/map.simplemap"));
  for (auto& frame : frames) {
    for (auto& range_m : frame.scan.ranges_m) range_m *= 1.1F;
    frame.T_map_robot.x *= 1.1, frame.T_map_robot.y *= 1.1;
  }
  mapping::writeKeyFrames(frames, at("scaled.simplemap"));
  EXPECT_THAT(errorOf([] {
                merge({at("monday"), at("scaled.simplemap")}, "wrong");
              }),
              HasSubstr("scaled.simplemap: "));
}

// Most of it fits where it belongs; where the path ends it lies aside by more than a room's furniture.
TEST_F(TwoVisits, AMapThatContradictsTheOtherIsRefused) {
  auto frames = mapping::readKeyFrames(at("tuesday/map.simplemap"));
  for (size_t i = frames.size() * 2 / 3; i < frames.size(); ++i) frames[i].T_map_robot.y += 2;
  mapping::writeKeyFrames(frames, at("broken.simplemap"));
  EXPECT_THAT(errorOf([] {
                merge({at("monday"), at("broken.simplemap")}, "wrong");
              }),
              HasSubstr("% of what it shares with the other maps to contradict them, expected at most 15 %"));
  EXPECT_FALSE(fs::exists(at("wrong")));
}

TEST_F(TwoVisits, AMapIsNotMergedWithItself) {
  EXPECT_THAT(errorOf([] {
                merge({at("monday"), at("monday/map.simplemap")}, "wrong");
              }),
              HasSubstr("map.simplemap: holds the same scans as " + at("monday")));
  EXPECT_THAT(errorOf([] { merge({at("monday")}, "wrong"); }), HasSubstr("found 1 map"));
  EXPECT_THAT(errorOf([] {
                merge({at("monday"), at("nowhere")}, "wrong");
              }),
              HasSubstr("nowhere: holds no map.simplemap"));
}

TEST_F(TwoVisits, FurnitureThatWasMovedIsFound) {
  const auto changes =
      diffMaps(at("monday"), at("tuesday"), config(), at("changes"), true, {}, core::silentProgress());
  const auto before = world::loadPlan(resources::resolvePlan("flat")),
             after = world::loadPlan(at("tuesday.plan.yaml"));
  // Where the true plans differ, in the frame of the first map.
  const auto T_map_world = core::inverse(logs::readTum(at("monday.gt.tum")).front().pose);
  const auto differs = [&](const core::Point2& p_world) {
    constexpr double kNear_m = 0.4;
    for (double dy = -kNear_m; dy <= kNear_m; dy += 0.05)
      for (double dx = -kNear_m; dx <= kNear_m; dx += 0.05) {
        const auto cell = world::pointToCells(before, {p_world.x + dx, p_world.y + dy});
        const int column = static_cast<int>(cell.x), row = static_cast<int>(cell.y);
        if (before.contains(column, row) && before.at(column, row) != after.at(column, row)) return true;
      }
    return false;
  };
  ASSERT_GE(changes.changes.size(), 2U);
  double right_m2 = 0, all_m2 = 0;
  for (const auto& change : changes.changes) {
    all_m2 += change.area_m2;
    if (differs(core::inverse(T_map_world) * change.centre())) right_m2 += change.area_m2;
  }
  EXPECT_GE(right_m2, 0.9 * all_m2);
  for (const char* file : {"changes.png", "changes.html", "changes.csv", "changes.json", "changes.txt"})
    EXPECT_TRUE(fs::exists(at(std::string("changes/") + file))) << file;
  EXPECT_THAT(files::readTextFile(at("changes/changes.html")),
              HasSubstr("What has changed from monday to tuesday"));
}

TEST_F(TwoVisits, AGridIsNotComparedWithARun) {
  EXPECT_THAT(errorOf([] {
                diffMaps(at("monday"), at("tuesday/map.yaml"), config(), at("x"), true, {},
                         core::silentProgress());
              }),
              HasSubstr("map.yaml: is a grid, expected two grids of one frame"));
  const auto none = diffMaps(at("monday/map.yaml"), at("monday/map.gridmap.gz"), config(), at("grids"), true,
                             {}, core::silentProgress());
  EXPECT_TRUE(none.changes.empty());
}

}  // namespace
}  // namespace slam::sessions
