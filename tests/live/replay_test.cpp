#include "libslam/live/replay.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>

#include "libslam/core/error.h"
#include "libslam/files/files.h"
#include "libslam/record/record.h"
#include "libslam/resources/resources.h"
#include "libslam/run/build_map.h"
#include "libslam/testing/error_of.h"
#include "libslam/testing/temp_folder.h"

namespace slam::live {
namespace {
using testing::errorOf;
using ::testing::HasSubstr;

class ReplayTest : public ::testing::Test {
 protected:
  ReplayTest() {
    files::IniFile ini;
    ini.set("simulation", "duration_s", "8", "test");
    ini.set("lidar", "beams", "181", "test");
    record::record(world::loadPlan(resources::resolvePlan("flat")), record::readRecordConfig(ini), 2, log_,
                   {}, core::silentProgress());
    run_ = run::buildMap(log_, mapping::loadMethodConfig(resources::configsFolder() + "/methods", "icp"),
                         "icp", 1, out_, false, {}, core::silentProgress());
  }
  const testing::TempFolder folder_{};
  const std::string log_ = folder_ / "run.rawlog", out_ = folder_ / "out";
  run::MapRun run_;
};

struct Poses : record::StepObserver {
  void onStep(const record::Step& step) override {
    poses.push_back({step.scan.time_s, step.T_map_robot});
    const auto map = mapping::currentMap(*step.method);
    map_width_m = map.columns * map.resolution_m;
  }
  core::Trajectory poses;
  double map_width_m = 0;
};

TEST_F(ReplayTest, ShowsEveryScanAtItsPose) {
  const auto replay = loadReplay(out_, "");
  EXPECT_EQ(replay.log_path, log_);
  EXPECT_EQ(replay.method, "icp");
  Poses seen;
  play(replay, seen);
  ASSERT_EQ(seen.poses.size(), run_.estimate.size());
  for (size_t i = 0; i < seen.poses.size(); ++i)
    EXPECT_LT(core::distance(seen.poses[i].pose, run_.estimate[i].pose), 1e-6) << i;
  // The map is drawn where the path says, not where the wheels went.
  auto displaced = replay;
  for (size_t i = displaced.path.size() / 2; i < displaced.path.size(); ++i) displaced.path[i].pose.x += 30;
  Poses far;
  play(displaced, far);
  EXPECT_NEAR(far.map_width_m, seen.map_width_m + 30, 15);
}

TEST_F(ReplayTest, RefusesInOneLine) {
  EXPECT_THAT(errorOf([&] { loadReplay(folder_ / "nowhere", ""); }), HasSubstr("manifest.json"));
  EXPECT_THAT(errorOf([&] { loadReplay(out_, folder_ / "no.rawlog"); }), HasSubstr("no.rawlog: the log of"));
  EXPECT_THAT(errorOf([&] { loadReplay(out_, out_ + "/map.png"); }), HasSubstr("is not the log that"));
  std::filesystem::rename(log_, folder_ / "moved.rawlog");
  EXPECT_THAT(errorOf([&] { loadReplay(out_, ""); }), HasSubstr("give --log"));
  EXPECT_EQ(errorOf([&] { loadReplay(out_, folder_ / "moved.rawlog"); }), "no error");
}

TEST_F(ReplayTest, APathOfAnotherLogIsAnError) {
  auto replay = loadReplay(out_, "");
  replay.path.erase(replay.path.begin() + 5);
  Poses seen;
  EXPECT_THAT(errorOf([&] { play(replay, seen); }), HasSubstr("has no pose in the run's path"));
  EXPECT_EQ(seen.poses.size(), 5U);
}

}  // namespace
}  // namespace slam::live
