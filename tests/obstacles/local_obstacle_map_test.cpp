#include "libslam/obstacles/local_obstacle_map.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "libslam/core/error.h"
#include "libslam/core/random.h"
#include "libslam/obstacles/camera_view.h"

namespace slam::obstacles {
namespace {

constexpr double kRounding = 1e-12;  // a few operations on numbers of a few metres
constexpr double kQuarter = core::kPi / 2;

/// A sensor that sees a rectangle of floor.
class Rectangle : public VisibleArea {
 public:
  Rectangle(double x0, double x1, double y0, double y1) : x0_(x0), x1_(x1), y0_(y0), y1_(y1) {}
  bool contains(const core::Point2& p) const override {
    return p.x > x0_ && p.x < x1_ && p.y > y0_ && p.y < y1_;
  }
  std::vector<core::Point2> outline(double) const override { return {}; }

 private:
  double x0_, x1_, y0_, y1_;
};
const Rectangle kBlind(0, 0, 0, 0);

LocalObstacleOptions zone(double width_m, double front_m, double rear_m) {
  LocalObstacleOptions options;
  options.width_m = width_m, options.front_m = front_m, options.rear_m = rear_m;
  return options;
}

void expectPoints(const LocalObstacleMap& map, const std::vector<core::Point2>& expected) {
  ASSERT_EQ(map.points().size(), expected.size());
  for (size_t i = 0; i < expected.size(); ++i) {
    EXPECT_NEAR(map.points()[i].x, expected[i].x, kRounding) << i;
    EXPECT_NEAR(map.points()[i].y, expected[i].y, kRounding) << i;
  }
}

TEST(LocalObstacleMap, IsEmptyAtFirstAndForgetsNothingThatItNeverSaw) {
  LocalObstacleMap map;
  map.update(1, 1, kBlind, {});
  EXPECT_TRUE(map.points().empty());
  EXPECT_EQ(map.rememberedCount(), 0U);
}

TEST(LocalObstacleMap, TurnsPointsAgainstTheRobotAndThenShiftsThemBack) {
  LocalObstacleMap map;
  map.update(0, 0, kBlind, {{2, 0}});
  map.update(kQuarter, 0, kBlind, {});  // a left turn: what was ahead is now at the right
  expectPoints(map, {{0, -2}});
  map.update(0, 0.5, kBlind, {});  // what the robot drives past falls behind
  expectPoints(map, {{-0.5, -2}});
  map.update(-kQuarter, 0.25, kBlind, {});  // turned back first, then along the old heading
  expectPoints(map, {{2 - 0.25, -0.5}});
}

TEST(LocalObstacleMap, TurnsTheSameWayInTheOriginalFrame) {
  // The document's own steps on (x to the right, y ahead), with its turn counter-clockwise positive.
  const double turn = 0.3, travel = 0.2;
  const core::Point2 p{0.7, 1.9};  // x to the right, y ahead
  const core::Point2 turned{std::cos(turn) * p.x + std::sin(turn) * p.y,
                            -std::sin(turn) * p.x + std::cos(turn) * p.y};
  const core::Point2 shifted{turned.x, turned.y - travel};
  EXPECT_GT(turned.x, p.x);  // the robot turned left, so the point went to the right
  LocalObstacleMap map;
  map.update(0, 0, kBlind, {fromOriginalFrame(p)});
  map.update(turn, travel, kBlind, {});
  expectPoints(map, {fromOriginalFrame(shifted)});
}

TEST(LocalObstacleMap, FollowsAnyPlanarMotion) {
  const core::Point2 p{1.5, 0.4};
  for (const core::Pose2& T_previous_robot :
       {core::Pose2{0.2, 0.1, 0.4}, {-0.3, 0.05, -2}, {0, 0, 1}, {0.3, 0, 0}}) {
    LocalObstacleMap map(zone(100, 100, 100));
    map.update(0, 0, kBlind, {p});
    map.update(T_previous_robot, kBlind, {});
    expectPoints(map, {core::inverse(T_previous_robot) * p});
    // A turn and then a travel along the new heading is the original tick.
    LocalObstacleMap by_pose(zone(100, 100, 100)), by_tick(zone(100, 100, 100));
    by_pose.update(core::Pose2{}, kBlind, {p});
    by_tick.update(0, 0, kBlind, {p});
    by_pose.update(core::Pose2{0, 0, 0.7} * core::Pose2{0.3, 0, 0}, kBlind, {});
    by_tick.update(0.7, 0.3, kBlind, {});
    expectPoints(by_pose, by_tick.points());
  }
}

TEST(LocalObstacleMap, DropsWhatLeavesTheZoneWhoseBorderBelongsToIt) {
  LocalObstacleMap map(zone(2, 3, 1));
  const std::vector<core::Point2> on_border = {{3, 0}, {-1, 0}, {0, 1}, {0, -1}, {3, 1}, {-1, -1}};
  auto seen = on_border;
  for (const core::Point2& outside : {core::Point2{3.001, 0}, {-1.001, 0}, {0, 1.001}, {0, -1.001}, {9, 9}})
    seen.push_back(outside);
  map.update(0, 0, kBlind, seen);
  EXPECT_EQ(map.points().size(), seen.size()) << "what is seen now is laid over wherever it is";
  map.update(0, 0, kBlind, {});
  expectPoints(map, on_border);
  map.update(0, 0.5, kBlind, {});  // behind the rear end, two are forgotten
  expectPoints(map, {{2.5, 0}, {-0.5, 1}, {-0.5, -1}, {2.5, 1}});
}

TEST(LocalObstacleMap, TrustsTheSensorWhereItLooksAndItsMemoryElsewhere) {
  LocalObstacleMap map;
  const Rectangle ahead(0.5, 2.5, -1, 1);
  map.update(0, 0, ahead, {{1, 0}, {2, 0.5}, {3, 0}});
  map.update(0, 0, ahead, {{1, 0}});  // (2, 0.5) has gone; (3, 0) lies outside of what is visible
  expectPoints(map, {{3, 0}, {1, 0}});
  EXPECT_EQ(map.rememberedCount(), 1U);
}

TEST(LocalObstacleMap, KeepsTheEarlierOfTwoPointsCloserThanTheMergeDistance) {
  auto options = zone(10, 10, 10);
  options.merge_distance_m = 0.1;
  LocalObstacleMap map(options);
  map.update(0, 0, kBlind, {{1, 0}, {2, 0}, {2.0625, 0}});
  map.update(0, 0, kBlind, {{1.05, 0}, {3, 0}, {3.1, 0}});
  expectPoints(map, {{1, 0}, {2, 0}, {1.05, 0}, {3, 0}, {3.1, 0}});  // step 4 comes before the overlay
  map.update(0, 0, kBlind, {});
  // At exactly the distance both stay; 3.1 - 3 is a rounding step more than 0.1.
  expectPoints(map, {{1, 0}, {2, 0}, {3, 0}, {3.1, 0}});
}

TEST(LocalObstacleMap, IsNotEatenAwayByWhatIsSeenOfAThingTickByTick) {
  auto options = zone(10, 10, 10);
  options.merge_distance_m = 0.1;
  LocalObstacleMap map(options);
  // A face of half a metre of which every look shows a little less at one end.
  for (int tick = 0; tick < 8; ++tick) map.update(0, 0, kBlind, {{1, 0.5 - 0.06 * tick}});
  map.update(0, 0, kBlind, {});
  EXPECT_EQ(map.points().front().y, 0.5);
}

TEST(LocalObstacleMap, LeavesNoTwinsAndDropsNoPointWithoutATwin) {
  core::RandomStream random(8, "twins");
  auto options = zone(10, 10, 10);
  options.merge_distance_m = 0.3;
  LocalObstacleMap map(options);
  std::vector<core::Point2> all;
  all.reserve(300);
  for (int i = 0; i < 300; ++i) all.push_back({random.uniform(-3, 3), random.uniform(-3, 3)});
  map.update(0, 0, kBlind, all);
  map.update(0, 0, kBlind, {});
  const auto kept = map.points();
  EXPECT_LT(kept.size(), all.size());
  for (size_t i = 0; i < kept.size(); ++i)
    for (size_t k = 0; k < i; ++k) EXPECT_GE(core::distance(kept[i], kept[k]), 0.3);
  for (const auto& p : all)
    EXPECT_TRUE(
        std::any_of(kept.begin(), kept.end(), [&](const auto& q) { return core::distance(p, q) < 0.3; }));
  map.update(0, 0, kBlind, {});
  EXPECT_EQ(map.points().size(), kept.size()) << "merging again changes nothing";
}

TEST(LocalObstacleMap, HoldsAtMostMaxPointsAndForgetsTheOldestFirst) {
  auto options = zone(10, 10, 10);
  options.max_points = 3;
  LocalObstacleMap map(options);
  map.update(0, 0, kBlind, {{1, 0}, {2, 0}});
  map.update(0, 0, kBlind, {{3, 0}});
  EXPECT_EQ(map.rememberedCount(), 2U);
  map.update(0, 0, kBlind, {{4, 0}});
  expectPoints(map, {{2, 0}, {3, 0}, {4, 0}});
  EXPECT_EQ(map.rememberedCount(), 2U);
  map.update(0, 0, kBlind, {{5, 0}, {6, 0}, {7, 0}, {8, 0}});
  expectPoints(map, {{6, 0}, {7, 0}, {8, 0}});
  EXPECT_EQ(map.rememberedCount(), 0U);
  map.clear();
  EXPECT_TRUE(map.points().empty());
}

TEST(LocalObstacleMap, PassesOverPointsThatAreNotFiniteAndRefusesSuchMotions) {
  LocalObstacleMap map;
  map.update(0, 0, kBlind, {{std::nan(""), 0}, {1, INFINITY}, {1, 0}});
  expectPoints(map, {{1, 0}});
  EXPECT_THROW(map.update(std::nan(""), 0, kBlind, {}), core::ContractError);
  EXPECT_THROW(map.update(0, INFINITY, kBlind, {}), core::ContractError);
  EXPECT_THROW(map.update(core::Pose2{0, std::nan(""), 0}, kBlind, {}), core::ContractError);
  expectPoints(map, {{1, 0}});
}

/// The original experiment: obstacles in front, the robot turns away and sees them leave its view; it drives
/// on, and turns back. After every tick the map is compared with what is known of the scene: an obstacle that
/// was ever seen and has since stayed in the zone stands exactly where it is, whether seen or remembered.
TEST(LocalObstacleMap, RemembersAtTheRightPlacesWhatTheRobotTurnsAwayFrom) {
  const auto options = zone(6, 4, 2);
  const CameraView camera{CameraOptions()};
  const std::vector<core::Point2> scene = {{1.2, 0.2}, {1.5, -0.4}, {2, 0.7}, {2.5, 0}, {0.3, 0.5}, {-1, 0}};
  LocalObstacleMap map(options);
  std::vector<char> known(scene.size(), 0);
  core::Pose2 T_scene_robot;
  struct Tick {
    double turn_rad, travel_m;
  };
  std::vector<Tick> ticks = {{0, 0}};
  for (int i = 0; i < 12; ++i) ticks.push_back({core::degToRad(10), 0});   // away to the left
  for (int i = 0; i < 5; ++i) ticks.push_back({core::degToRad(-3), 0.2});  // on, in a curve
  for (int i = 0; i < 15; ++i) ticks.push_back({core::degToRad(-9), 0});   // and back
  size_t most_remembered = 0, moved_to_memory = 0;
  for (const auto& tick : ticks) {
    T_scene_robot = T_scene_robot * core::Pose2{0, 0, tick.turn_rad} * core::Pose2{tick.travel_m, 0, 0};
    std::vector<core::Point2> p_robot;
    p_robot.reserve(scene.size());
    for (const auto& p : scene) p_robot.push_back(core::inverse(T_scene_robot) * p);
    const size_t remembered_before = map.rememberedCount();
    map.update(tick.turn_rad, tick.travel_m, camera, pointsWithin(camera, p_robot));

    std::vector<core::Point2> white, grey;
    for (size_t i = 0; i < scene.size(); ++i) {
      const auto& p = p_robot[i];
      const bool in_zone = std::abs(p.y) <= 3 && p.x <= 4 && p.x >= -2;
      known[i] = camera.contains(p) || (known[i] && in_zone);
      if (known[i]) (camera.contains(p) ? white : grey).push_back(p);
    }
    ASSERT_EQ(map.points().size(), white.size() + grey.size());
    ASSERT_EQ(map.rememberedCount(), grey.size());
    for (size_t k = 0; k < map.points().size(); ++k) {
      const auto& candidates = k < grey.size() ? grey : white;
      EXPECT_TRUE(std::any_of(candidates.begin(), candidates.end(), [&](const auto& p) {
        return core::distance(p, map.points()[k]) < 1e-12 * static_cast<double>(ticks.size());  // per tick
      })) << (k < grey.size() ? "remembered" : "seen");
    }
    most_remembered = std::max(most_remembered, map.rememberedCount());
    moved_to_memory += map.rememberedCount() > remembered_before;
  }
  EXPECT_EQ(most_remembered, 5U) << "all that ever came into view";
  EXPECT_GT(moved_to_memory, 2U) << "one after the other";
}

TEST(LocalObstacleOptions, RefuseAMisspeltKeyAndAZoneWithoutWidth) {
  LocalObstacleOptions options;
  const auto message = [&](const std::string& line) {
    try {
      files::readParameters(files::IniFile::parse("[obstacles]\n" + line + "\n", "robot.ini"),
                            LocalObstacleOptions::table(), options);
    } catch (const core::InputError& error) {
      return std::string(error.what());
    }
    return std::string("no error");
  };
  EXPECT_EQ(message("witdh_m = 3"),
            "robot.ini:2: section [obstacles], unknown key 'witdh_m'; did you mean 'width_m'?");
  EXPECT_EQ(
      message("width_m = 0"),
      "robot.ini:2: section [obstacles], key 'width_m': found '0', expected a number from 0.01 to 1000");
  EXPECT_EQ(message("max_points = 12"), "no error");
  EXPECT_EQ(options.max_points, 12);
}

}  // namespace
}  // namespace slam::obstacles
