#include <gmock/gmock.h>

#include <algorithm>

#include "libslam/navigate/driver.h"
#include "libslam/strategies/map_strategy.h"
#include "tests/navigate/scenes.h"

/// What strategies on the map, and the driver, do about people.
namespace slam::strategies {
namespace {

/// Two rooms and a passage between them: 0.8 m wide, from x = 3 to 5 along y = 2.
world::Plan twoRooms() {
  auto plan = navigate::scenes::room(8, 4);
  navigate::scenes::fill(plan, 3, 0, 5, 1.6);
  navigate::scenes::fill(plan, 3, 2.4, 5, 4);
  return plan;
}

world::Plan withLegAt(world::Plan plan, const core::Point2& p) {
  navigate::scenes::fill(plan, p.x - 0.05, p.y - 0.05, p.x + 0.05, p.y + 0.05);
  return plan;
}

const core::Pose2 kRobot{1, 2, 0};
const core::Point2 kInTheWay{3.4, 2};

/// A robot that stands in the left room and has a map of what is seen from there, with somebody in the
/// passage.
struct Standing {
  std::unique_ptr<Strategy> strategy;
  world::Plan without = twoRooms(), with = withLegAt(twoRooms(), kInTheWay);
  navigate::scenes::PerfectMap map{with};
  double time_s = 0;

  explicit Standing(const std::string& name) {
    StrategyOptions options;
    options.name = name;
    strategy = makeStrategy(options, {1, "strategy"});
    for (const core::Pose2& T : {kRobot, core::Pose2{0.5, 1, 0}, {0.5, 3, 0}, {2.9, 1.7, 0}, {2.9, 2.3, 0}})
      map.insert(T, navigate::scenes::scanIn(with, T, 0));
    strategy->seeMap(map.raster());
  }
  void see(const world::Plan& plan) {
    strategy->seeCommand({});
    strategy->seeScan(navigate::scenes::scanIn(plan, kRobot, time_s += 0.2), kRobot);
  }
  void letSomebodyCome() {
    for (int i = 0; i < 5; ++i) see(without);
    for (int i = 0; i < 5; ++i) see(with);
  }
  choices::Decision decide(const world::Plan& plan) {
    strategy->seeMap(map.raster());
    return strategy->decide(navigate::scenes::scanIn(plan, kRobot, time_s), kRobot);
  }
};

std::vector<std::string> strategies() {
  return {"nearest_frontier", "next_best_view", "tour"};
}

TEST(People, InTheWayAreAWallWhileNobodyWasSeenToCome) {
  for (const auto& name : strategies()) {
    Standing robot(name);
    for (int i = 0; i < 5; ++i) robot.see(robot.with);
    const auto decision = robot.decide(robot.with);
    EXPECT_TRUE(decision.finished) << name;
    EXPECT_THAT(decision.reason, testing::HasSubstr("out of reach")) << name;
  }
}

TEST(People, WhoHaveLeftAreDrivenThroughAndWhoHoldTheRobotUpAreWaitedFor) {
  for (const auto& name : strategies()) {
    Standing robot(name);
    robot.letSomebodyCome();
    robot.see(robot.without);
    const auto decision = robot.decide(robot.without);
    ASSERT_FALSE(decision.path.empty()) << name << ": " << decision.reason;
    EXPECT_GT(decision.goal.x, 3) << name;
    robot.strategy->tellOutcome(decision, false);
    EXPECT_GT(robot.decide(robot.without).wait_s, 0) << name;
    EXPECT_FALSE(robot.decide(robot.without).path.empty()) << name;
  }
}

TEST(People, WhoStandInTheWayAreWaitedForAMinuteAndNotForEver) {
  for (const auto& name : strategies()) {
    Standing robot(name);
    robot.letSomebodyCome();
    double waited_s = 0;
    int asides = 0;
    auto decision = robot.decide(robot.with);
    for (int i = 0; i < 100 && !decision.finished; ++i) {
      if (!decision.path.empty()) {
        // They may wait for the robot.
        EXPECT_THAT(decision.reason, testing::HasSubstr("makes way"));
        EXPECT_GT(core::distance(decision.goal, core::position(kRobot)), 0.9);
        EXPECT_LT(decision.goal.x, 3);
        EXPECT_TRUE(robot.strategy->isStillGood(decision, kRobot, 0));
        robot.strategy->tellOutcome(decision, true);
        ++asides;
      } else {
        ASSERT_GT(decision.wait_s, 0) << name << ": " << decision.reason;
        EXPECT_THAT(decision.reason, testing::HasSubstr("somebody may stand in the way"));
      }
      waited_s += decision.wait_s;
      robot.time_s += decision.wait_s;
      robot.see(robot.with);
      decision = robot.decide(robot.with);
    }
    EXPECT_TRUE(decision.finished) << name;
    EXPECT_GE(waited_s, 30) << name;
    EXPECT_LE(waited_s, 90) << name;
    EXPECT_GE(asides, 2) << name;
  }
}

/// Along a straight path past somebody of whom the lidar sees nothing.
class PathPastSomebody : public Strategy {
 public:
  explicit PathPastSomebody(std::vector<core::Point2> people) : people_(std::move(people)) {}
  choices::Decision decide(const lidar::Scan&, const core::Pose2&) override {
    choices::Decision decision;
    decision.finished = has_ended_;
    decision.path = {{5, 2}};
    decision.goal = {5, 2};
    return decision;
  }
  bool needsMap() const override { return true; }
  bool drivesByDisc() const override { return true; }
  bool isStillGood(const choices::Decision&, const core::Pose2&, size_t) override { return true; }
  void tellOutcome(const choices::Decision&, bool reached) override { has_ended_ = reached; }
  const std::vector<core::Point2>& people() const override { return people_; }

 private:
  std::vector<core::Point2> people_;
  bool has_ended_ = false;
};

/// How often a robot that goes on hits somebody in a passage of whom its lidar sees nothing.
int hitsIn(double limit_s, const core::Point2& hidden) {
  const auto plan = twoRooms();
  const double contact_m = robot::circumscribedRadius({}) + 0.1;
  navigate::Driver driver(std::make_unique<PathPastSomebody>(std::vector<core::Point2>{}), {}, {}, 0.2,
                          {1, "driver"});
  core::Pose2 T = kRobot;
  int hits = 0;
  bool collided = false;
  for (double time_s = 0; time_s < limit_s && !driver.finished(); time_s += 0.2) {
    const auto next =
        T * robot::driveMotion(driver.next(navigate::scenes::scanIn(plan, T, time_s), T, collided));
    collided = core::distance(core::position(next), hidden) < contact_m;
    hits += collided;
    if (!collided) T = next;
  }
  return hits;
}

/// The least distance from p on the way.
double closestTo(const core::Point2& p, std::vector<core::Point2> people) {
  const auto plan = navigate::scenes::room(6, 4);
  navigate::Driver driver(std::make_unique<PathPastSomebody>(std::move(people)), {}, {}, 0.2, {1, "driver"});
  core::Pose2 T = kRobot;
  double closest_m = core::distance(core::position(T), p);
  for (int i = 0; i < 300 && !driver.finished(); ++i) {
    T = T * robot::driveMotion(driver.next(navigate::scenes::scanIn(plan, T, 0.2 * i), T, false));
    closest_m = std::min(closest_m, core::distance(core::position(T), p));
  }
  EXPECT_TRUE(driver.finished());
  EXPECT_NEAR(T.x, 5, 0.3);
  return closest_m;
}

TEST(People, WhoWereHitAreRememberedForAWhile) {
  EXPECT_GE(hitsIn(60, {3.6, 2}), 1);
  EXPECT_LE(hitsIn(60, {3.6, 2}), 3);
}

TEST(People, AreGivenAWideBerthByTheDriver) {
  const core::Point2 p{3, 2.2};
  const double radius_m = robot::circumscribedRadius({});
  EXPECT_LT(closestTo(p, {}), radius_m);
  EXPECT_GT(closestTo(p, {p}), radius_m);
}

}  // namespace
}  // namespace slam::strategies
