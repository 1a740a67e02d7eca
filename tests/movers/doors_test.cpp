#include "libslam/movers/doors.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <map>

#include "libslam/movers/crowd.h"

namespace slam::movers {
namespace {

constexpr double kTick_s = 1e-9 * static_cast<double>(kTick_ns);

/// 0.1 m cells, with so many doors of 10 x 2 cells above one another; the first one from (2, 1) to (3, 1.2)
/// m.
world::Plan planWith(int doors) {
  world::Plan plan;
  plan.columns = 60, plan.rows = 400;
  plan.resolution_m = 0.1;
  plan.cells.assign(size_t{60} * 400, world::Cell::kFree);
  for (int i = 0; i < doors; ++i) plan.doors.push_back({20, 10 + 10 * i, 30, 12 + 10 * i});
  return plan;
}

LivingOptions moving(double share, double open_s, double closed_s) {
  LivingOptions options;
  options.doors_share = share, options.door_open_s = open_s, options.door_closed_s = closed_s;
  return options;
}

Disc bodyAt(double x, double y, double radius_m = 0.2) {
  Disc disc{};
  disc.p = {x, y}, disc.radius_m = radius_m;
  return disc;
}

TEST(Doors, EachStaysOpenAndClosedForItsTimeAndAHalfAtMost) {
  Doors doors(planWith(30), moving(1, 4, 2), 5);
  ASSERT_EQ(doors.all().size(), 30U);
  std::map<size_t, double> since_s;
  double open_s = 0, closed_s = 0;
  int opens = 0, closes = 0;
  for (double now_s = 0; now_s < 60; now_s += kTick_s)
    for (const size_t i : doors.tick({}, 0.1)) {
      const bool is_open = doors.all()[i].state == DoorState::kOpen;
      const auto before = since_s.find(i);
      if (before != since_s.end()) {
        const double lasted_s = now_s - before->second, mean_s = is_open ? 2 : 4;
        EXPECT_GE(lasted_s, 0.5 * mean_s - kTick_s);
        EXPECT_LE(lasted_s, 1.5 * mean_s + kTick_s);
        (is_open ? closed_s : open_s) += lasted_s, ++(is_open ? closes : opens);
      } else {
        EXPECT_FALSE(is_open) << "it begins open";
        EXPECT_LE(now_s, 6) << "and within its time";
      }
      since_s[i] = now_s;
    }
  // Uniform from half to one and a half: the mean of 280 of them to a twentieth is three standard errors.
  ASSERT_GT(opens, 200);
  EXPECT_NEAR(open_s / opens, 4, 0.2);
  EXPECT_NEAR(closed_s / closes, 2, 0.1);
}

TEST(Doors, TheShareThatMovesIsDrawnForEach) {
  const auto idsOf = [](std::uint64_t seed, int doors) {
    std::vector<size_t> ids;
    const Doors drawn(planWith(doors), moving(0.5, 4, 2), seed);
    for (const auto& door : drawn.all()) ids.push_back(door.id);
    return ids;
  };
  const auto ids = idsOf(1, 38);
  EXPECT_GT(ids.size(), 9U);  // by the binomial distribution in 999 of 1000 seeds
  EXPECT_LT(ids.size(), 29U);
  EXPECT_EQ(idsOf(1, 38), ids);
  EXPECT_NE(idsOf(2, 38), ids);
  // More doors change nothing for those before them.
  auto first = idsOf(1, 20);
  EXPECT_TRUE(std::equal(first.begin(), first.end(), ids.begin()));
  EXPECT_TRUE(Doors(planWith(38), moving(0, 4, 2), 1).all().empty());
}

/// What the only door does in ten seconds, with this body at its place.
DoorState afterWaiting(Doors& doors, const std::vector<Disc>& bodies) {
  for (int tick = 0; tick < static_cast<int>(10 / kTick_s); ++tick) doors.tick(bodies, 0.1);
  return doors.all()[0].state;
}

TEST(Doors, DoNotCloseOnAnybodyAndCloseOnceHeHasGone) {
  Doors doors(planWith(1), moving(1, 4, 1000), 3);
  EXPECT_EQ(afterWaiting(doors, {bodyAt(2.5, 1.1)}), DoorState::kHeld);
  EXPECT_EQ(afterWaiting(doors, {bodyAt(2.5, 1.1)}), DoorState::kHeld) << "however long he stands there";
  const auto changed = doors.tick({bodyAt(4, 1.1)}, 0.1);
  EXPECT_EQ(changed, std::vector<size_t>{0});
  EXPECT_EQ(doors.all()[0].state, DoorState::kClosed);
}

TEST(Doors, KeepTheirDistanceFromTheRimOfABody) {
  // A disc of 0.2 m and 0.1 m to keep: beside the door, above it, and at its corner.
  const auto stateWith = [](double x, double y) {
    Doors doors(planWith(1), moving(1, 4, 1000), 3);
    return afterWaiting(doors, {bodyAt(9, 9), bodyAt(x, y)});
  };
  EXPECT_EQ(stateWith(3.29, 1.1), DoorState::kHeld);
  EXPECT_EQ(stateWith(3.31, 1.1), DoorState::kClosed);
  EXPECT_EQ(stateWith(1.71, 1.1), DoorState::kHeld);
  EXPECT_EQ(stateWith(1.69, 1.1), DoorState::kClosed);
  EXPECT_EQ(stateWith(2.5, 1.49), DoorState::kHeld);
  EXPECT_EQ(stateWith(2.5, 1.51), DoorState::kClosed);
  EXPECT_EQ(stateWith(3.2, 1.4), DoorState::kHeld) << "0.28 m from the corner";
  EXPECT_EQ(stateWith(3.22, 1.42), DoorState::kClosed) << "0.31 m";
}

TEST(Doors, OneThatIsClosedOpensWhoeverStandsThere) {
  Doors doors(planWith(1), moving(1, 4, 2), 3);
  while (doors.all()[0].state != DoorState::kClosed) doors.tick({}, 0.1);
  std::vector<size_t> changed;
  for (int tick = 0; changed.empty() && tick < static_cast<int>(3.1 / kTick_s); ++tick)
    changed = doors.tick({bodyAt(2.5, 1)}, 0.1);
  EXPECT_EQ(changed, std::vector<size_t>{0});
  EXPECT_EQ(doors.all()[0].state, DoorState::kOpen);
}

}  // namespace
}  // namespace slam::movers
