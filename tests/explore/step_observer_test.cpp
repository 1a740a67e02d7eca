#include "libslam/record/step_observer.h"
#include "libslam/navigate/driver.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>

#include "libslam/core/error.h"
#include "libslam/explore/explore.h"
#include "libslam/graph/graph_slam.h"
#include "libslam/record/record.h"
#include "libslam/resources/file_hash.h"
#include "libslam/resources/resources.h"
#include "libslam/run/build_map.h"
#include "libslam/testing/temp_folder.h"

namespace slam::explore {
namespace {
namespace fs = std::filesystem;

/// Looks at everything that can be looked at, at every step.
class Curious : public record::StepObserver {
 public:
  void onStep(const record::Step& step) override {
    times_s.push_back(step.time_s);
    if (step.simulator) truth = step.simulator->truth();
    decisions += step.decision != nullptr;
    if (!step.method) return;
    map_cells += mapping::currentMap(*step.method).occupancy.size();
    online.push_back({step.scan.time_s, step.T_map_robot});
    mapping::finalPath(*step.method, online);
    particles = mapping::particlePoses(*step.method).size();
    if (const auto* graph = mapping::graphSlamOf(*step.method)) nodes = graph->keyframeCount();
  }
  void onFinished(const mapping::MapBuilder& method) override {
    ++finished;
    mapping::currentMap(method);
  }

  std::vector<double> times_s;
  core::Trajectory online;
  core::Pose2 truth;
  size_t map_cells = 0, particles = 0;
  int decisions = 0, finished = 0, nodes = 0;
};

files::IniFile shortIni(double duration_s) {
  files::IniFile ini;
  ini.set("simulation", "duration_s", files::formatNumber(duration_s), "test");
  ini.set("lidar", "beams", "181", "test");
  return ini;
}

world::Plan flat() {
  return world::loadPlan(resources::resolvePlan("flat"));
}

/// All files of a folder but those that hold times.
std::map<std::string, std::string> bytesOf(const std::string& folder) {
  std::map<std::string, std::string> bytes;
  for (const auto& entry : fs::recursive_directory_iterator(folder)) {
    const std::string name = entry.path().filename().string();
    const bool has_times =
        name == "timing.csv" || name.find("manifest.json") != std::string::npos || name.find("cost.") == 0;
    if (entry.is_regular_file() && !has_times)
      bytes[fs::relative(entry.path(), folder).string()] = resources::fileSha256(entry.path().string());
  }
  return bytes;
}

TEST(StepObserver, SeesEveryScanOfARecordingAndChangesNothing) {
  const testing::TempFolder folder;
  const auto config = record::readRecordConfig(shortIni(10));
  fs::create_directories(folder / "with");
  fs::create_directories(folder / "without");
  Curious curious;
  record::record(flat(), config, 5, folder / "without/run.rawlog", {}, core::silentProgress());
  const auto recording =
      record::record(flat(), config, 5, folder / "with/run.rawlog", {}, core::silentProgress(), &curious);
  EXPECT_EQ(bytesOf(folder / "with"), bytesOf(folder / "without"));
  EXPECT_EQ(curious.times_s.size(), recording.scans);
  EXPECT_EQ(curious.times_s.front(), 0);
  EXPECT_NEAR(curious.times_s.back(), 10, 1e-6);
  EXPECT_EQ(curious.decisions, static_cast<int>(recording.scans));
}

class StepObserverOfMethods : public ::testing::TestWithParam<const char*> {};

TEST_P(StepObserverOfMethods, SeesEveryScanAndChangesNothing) {
  const testing::TempFolder folder;
  const std::string log = folder / "run.rawlog", name = GetParam();
  record::record(flat(), record::readRecordConfig(shortIni(20)), 5, log, {}, core::silentProgress());
  const auto config = mapping::loadMethodConfig(resources::configsFolder() + "/methods", name);
  Curious curious;
  run::buildMap(log, config, name, 3, folder / "without", false, {}, core::silentProgress());
  const auto run = run::buildMap(log, config, name, 3, folder / "with", false, {}, core::silentProgress(),
                                 {true, {}, &curious});
  EXPECT_EQ(bytesOf(folder / "with"), bytesOf(folder / "without"));
  EXPECT_EQ(curious.times_s.size(), run.estimate.size());
  EXPECT_EQ(curious.finished, 1);
  EXPECT_GT(curious.map_cells, 0U);
  EXPECT_EQ(curious.particles > 0, name == "particles" || name == "rbpf_exact");
  EXPECT_EQ(curious.nodes > 0, name == "graph");
}

INSTANTIATE_TEST_SUITE_P(Methods, StepObserverOfMethods,
                         ::testing::Values("graph", "particles", "rbpf_exact", "icp", "naive_wheel"));

TEST(StepObserver, SeesAnExplorationAndChangesNothing) {
  const testing::TempFolder folder;
  ExploreRequest request;
  auto ini = shortIni(15);
  ini.set("strategy", "name", "nearest_frontier", "test");
  request.strategies = {readExploreConfig(ini)};
  request.plan_path = resources::resolvePlan("flat");
  request.slam = "graph";
  request.methods_folder = resources::configsFolder() + "/methods";
  request.output = folder / "without";
  explore(request, {}, core::silentProgress());
  Curious curious;
  request.output = folder / "with";
  request.observer = &curious;
  explore(request, {}, core::silentProgress());
  EXPECT_EQ(bytesOf(folder / "with"), bytesOf(folder / "without"));
  EXPECT_GT(curious.times_s.size(), 50U);
  EXPECT_EQ(curious.decisions, static_cast<int>(curious.times_s.size()));
  request.seeds = 2;
  EXPECT_THROW(explore(request, {}, core::silentProgress()), core::ContractError);
}

/// What a strategy commands, written down and given again by hand, makes the same log.
TEST(RecordCommands, WritesWhatAStrategysSameCommandsWrite) {
  const testing::TempFolder folder;
  fs::create_directories(folder / "strategy");
  fs::create_directories(folder / "hand");
  const auto plan = flat();
  const auto config = record::readRecordConfig(shortIni(10));
  record::record(plan, config, 5, folder / "strategy/run.rawlog", {}, core::silentProgress());
  navigate::Driver driver(strategies::makeStrategy(config.strategy, core::RandomStream(5, "strategy")),
                          config.strategy, config.robot, 1 / config.lidar.rate_hz,
                          core::RandomStream(5, "driver"));
  const auto hand = [&](const sim::Sensed& sensed) -> std::optional<robot::Command> {
    return driver.next(sensed.scan, sensed.T_odom_robot, sensed.collided);
  };
  record::recordCommands(plan, config, 5, folder / "hand/run.rawlog", {}, core::silentProgress(), hand);
  EXPECT_EQ(bytesOf(folder / "hand"), bytesOf(folder / "strategy"));
  EXPECT_GE(bytesOf(folder / "hand").size(), 4U);
}

TEST(RecordCommands, EndsWhereTheCommandsEndAndStopsAtWalls) {
  const testing::TempFolder folder;
  const auto config = record::readRecordConfig(shortIni(60));
  int commands = 0;
  const auto ahead = [&](const sim::Sensed&) -> std::optional<robot::Command> {
    if (++commands > 100) return std::nullopt;
    return robot::Command{config.robot.max_speed_mps, 0, 0.2};
  };
  const auto recording =
      record::recordCommands(flat(), config, 1, folder / "run.rawlog", {}, core::silentProgress(), ahead);
  EXPECT_EQ(recording.scans, 101U);
  EXPECT_GT(recording.collisions.size(), 10U);  // 20 s at 0.5 m/s is more than any room of the flat is long
  EXPECT_LT(recording.path_length_m, 9);
  EXPECT_TRUE(fs::exists(folder / "run.collisions.csv"));
}

}  // namespace
}  // namespace slam::explore
