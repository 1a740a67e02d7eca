// Lidars that turn, and several on one robot: from the simulator through the log to the methods.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "libslam/core/error.h"
#include "libslam/files/files.h"
#include "libslam/logs/log_reader.h"
#include "libslam/mapping/map_builder.h"
#include "libslam/record/record.h"
#include "libslam/resources/resources.h"
#include "libslam/run/build_map.h"
#include "libslam/run/log_feed.h"
#include "libslam/score/compare.h"
#include "libslam/score/evaluate.h"
#include "libslam/testing/temp_folder.h"
#include "libslam/truth/truth_files.h"

namespace slam::run {
namespace {
using ::testing::HasSubstr;

files::IniFile configOf(const std::vector<std::string>& settings) {
  files::IniFile ini;
  for (const auto& setting : settings) ini.setFromArgument(setting, "test");
  return ini;
}

void simulate(const std::vector<std::string>& settings, const std::string& log) {
  record::record(world::loadPlan(resources::resolvePlan("flat")),
                 record::readRecordConfig(configOf(settings)), 1, log, {}, core::silentProgress());
}

struct Run {
  MapRun map;
  std::map<std::string, std::string> results;
  double ate_m;
};

Run runOf(const std::string& method, const std::string& log, const std::string& folder,
          const std::vector<std::string>& settings = {}) {
  auto config = mapping::loadMethodConfig(resources::configsFolder() + "/methods", method);
  for (const auto& setting : settings) config.setFromArgument(setting, "test");
  Run run;
  run.map = buildMap(log, config, method, 1, folder, true, {}, core::silentProgress(), {false});
  const auto loaded = results::loadRun(folder);
  run.results = loaded.manifest.results;
  run.ate_m = score::evaluate(loaded, score::loadTruth(truth::findTruth(log), "", loaded))
                  .final_trajectory.position_m.rmse;
  return run;
}

class TurningLidar : public ::testing::Test {
 protected:
  static void SetUpTestSuite() {
    shared_folder = new testing::TempFolder;
    simulate({"simulation.duration_s=40", "lidar.beams=271", "lidar.sweep=0.5", "lidar.sigma_m=0.01"},
             *shared_folder / "turning.rawlog");
  }
  static void TearDownTestSuite() { delete shared_folder; }
  static testing::TempFolder* shared_folder;
};
testing::TempFolder* TurningLidar::shared_folder = nullptr;

TEST_F(TurningLidar, IsDeskewedWithoutBeingAsked) {
  const std::string log = *shared_folder / "turning.rawlog";
  const auto asked = runOf("graph", log, *shared_folder / "asked");
  EXPECT_EQ(asked.results.at("swept_scans"), asked.results.at("deskewed_scans"));
  EXPECT_EQ(asked.map.skew_note, "");
  const auto refused = runOf("graph", log, *shared_folder / "refused", {"method.deskew=false"});
  EXPECT_EQ(refused.results.at("deskewed_scans"), "0");
  EXPECT_THAT(refused.map.skew_note,
              HasSubstr("scans were swept while the robot moved and were not deskewed"));
  // 0.1 s of 0.2: some centimetres at this robot's speeds.
  EXPECT_LT(asked.ate_m, 0.6 * refused.ate_m);
}

TEST_F(TurningLidar, TheLogSaysHowItTurns) {
  logs::LogReader log(*shared_folder / "turning.rawlog");
  const auto entry = log.next();
  ASSERT_TRUE(entry && entry->sweep);
  EXPECT_NEAR(entry->sweep->duration_s, 0.1 * 270 / 271, 1e-9);
}

class TwoLidars : public ::testing::Test {
 protected:
  static void SetUpTestSuite() {
    shared_folder = new testing::TempFolder;
    const std::vector<std::string> one = {"simulation.duration_s=30", "lidar.beams=181", "lidar.fov_deg=180",
                                          "lidar.mount_x_m=0.1"};
    simulate(one, *shared_folder / "one.rawlog");
    auto two = one;
    for (const char* setting : {"lidar rear.beams=91", "lidar rear.fov_deg=180", "lidar rear.mount_x_m=-0.1",
                                "lidar rear.mount_yaw_deg=180"})
      two.emplace_back(setting);
    simulate(two, *shared_folder / "two.rawlog");
  }
  static void TearDownTestSuite() { delete shared_folder; }
  static testing::TempFolder* shared_folder;
};
testing::TempFolder* TwoLidars::shared_folder = nullptr;

TEST_F(TwoLidars, TheSecondChangesNothingOfTheFirst) {
  logs::LogReader one(*shared_folder / "one.rawlog"), two(*shared_folder / "two.rawlog", logs::kAllLidars);
  size_t steps = 0;
  while (const auto entry = one.next()) {
    const auto both = two.next();
    ASSERT_TRUE(both);
    EXPECT_EQ(entry->scan.ranges_m.size(), both->scan.ranges_m.size());
    for (size_t i = 0; i < entry->scan.ranges_m.size(); ++i)
      if (lidar::isReturn(entry->scan.ranges_m[i])) {
        EXPECT_EQ(entry->scan.ranges_m[i], both->scan.ranges_m[i]);
      }
    ASSERT_EQ(both->others.size(), 1U);
    EXPECT_EQ(both->others[0].lidar, "rear");
    EXPECT_EQ(both->others[0].scan.ranges_m.size(), 91U);
    ++steps;
  }
  EXPECT_GT(steps, 100U);
}

TEST_F(TwoLidars, EveryMethodTakesThem) {
  for (const std::string method : {"naive_wheel", "icp", "rbpf", "particles", "graph"}) {
    const auto both = runOf(method, *shared_folder / "two.rawlog", *shared_folder / method);
    EXPECT_EQ(both.results.at("lidars"), "LASER,rear") << method;
    EXPECT_EQ(both.map.steps_without_odometry, 0) << method;
    const auto front = runOf(method, *shared_folder / "two.rawlog", *shared_folder / (method + "_front"),
                             {"method.lidars=LASER"});
    EXPECT_EQ(front.results.at("lidars"), "LASER") << method;
    EXPECT_EQ(both.map.estimate.size(), front.map.estimate.size()) << method;
    // A map of both differs from one of the front; nowhere is it worse by more than 5 mm, which the noise may
    // do.
    EXPECT_NE(files::readTextFile(*shared_folder / (method + "/map.png")),
              files::readTextFile(*shared_folder / (method + "_front/map.png")))
        << method;
    EXPECT_LT(both.ate_m, front.ate_m + 0.005) << method;
  }
}

TEST_F(TwoLidars, BadMountingsAreRefused) {
  const auto refusal = [](const std::vector<std::string>& settings) -> std::string {
    try {
      record::readRecordConfig(configOf(settings));
    } catch (const core::InputError& error) {
      return error.what();
    }
    return "";
  };
  EXPECT_THAT(refusal({"lidar.mount_x_m=3"}), HasSubstr("the lidar is 3 m from the robot's centre"));
  EXPECT_THAT(refusal({"lidar rear.beams=91"}),
              HasSubstr("section [lidar rear]: is mounted where another lidar is"));
  EXPECT_THAT(refusal({"lidar LASER.mount_x_m=0.1"}), HasSubstr("found the name 'LASER'"));
  EXPECT_THAT(refusal({"lidar rear.beans=91"}), HasSubstr("beans"));
}

}  // namespace
}  // namespace slam::run
