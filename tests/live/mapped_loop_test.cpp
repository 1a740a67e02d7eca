#include "libslam/live/mapped_loop.h"

#include <gtest/gtest.h>

#include <limits>

#include "libslam/resources/resources.h"

namespace slam::live {
namespace {

lidar::Scan scanAt(double time_s) {
  lidar::Scan scan;
  scan.time_s = time_s;
  scan.first_angle_rad = -1, scan.step_rad = 0.1, scan.max_range_m = 10;
  scan.ranges_m.assign(21, 2);
  return scan;
}

class Watcher : public record::StepObserver {
 public:
  void onStep(const record::Step& step) override {
    pose = step.T_map_robot, note = step.note;
    occupied = 0;
    if (!step.method) return void(has_method = false);
    for (const float cell : mapping::currentMap(*step.method).occupancy) occupied += cell > 0.5F;
    has_method = true;
  }
  core::Pose2 pose;
  std::string note;
  bool has_method = false;
  int occupied = 0;
};

mapping::MapBuilder naiveByWheels() {
  return mapping::makeMapBuilder(
      mapping::loadMethodConfig(resources::configsFolder() + "/methods", "naive_wheel"), "naive_wheel", 1);
}

TEST(MappedLoop, AMapGrowsWhereNoneWasBuilt) {
  Watcher watcher;
  MappedLoop loop(naiveByWheels(), watcher);
  const auto first = scanAt(100), second = scanAt(101);
  loop.onStep({0, first, {}, {}});
  EXPECT_TRUE(watcher.has_method);
  const int before = watcher.occupied;
  EXPECT_GT(before, 0);
  loop.onStep({1, second, {1, 0, 0}, {1, 0, 0}});
  EXPECT_GT(watcher.occupied, before);
  EXPECT_NEAR(watcher.pose.x, 1, 1e-6);
}

TEST(MappedLoop, AMethodThatFailsDoesNotEndTheDrive) {
  Watcher watcher;
  MappedLoop loop(naiveByWheels(), watcher);
  const auto first = scanAt(100), second = scanAt(101), third = scanAt(102);
  loop.onStep({0, first, {}, {}});
  loop.onStep({1, second, {std::numeric_limits<double>::infinity(), 0, 0}, {}});
  EXPECT_FALSE(watcher.has_method);
  EXPECT_NE(watcher.note.find("naive_wheel failed"), std::string::npos) << watcher.note;
  loop.onStep({2, third, {1, 0, 0}, {}});
  EXPECT_FALSE(watcher.has_method);
}

}  // namespace
}  // namespace slam::live
