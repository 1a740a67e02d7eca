#include "libslam/choices/certainty.h"

#include <gtest/gtest.h>

#include "tests/paths/drawn_map.h"

namespace slam::choices {
namespace {

// Characters are 0.5 m: a corridor round a block, nearly all known; its lower left corner is the origin.
const std::vector<std::string> kRing = {"################################################",  //
                                        "#..............................................#",  //
                                        "#..............................................#",  //
                                        "#..............................................#",  //
                                        "#...########################################...#",  //
                                        "#...########################################...#",  //
                                        "#...########################################...#",  //
                                        "#..............................................#",  //
                                        "#..............................................#",  //
                                        "#..............................................#",  //
                                        "################################################"};

struct Ring {
  paths::FreeSpace space = paths::readFreeSpace(paths::enlarged(kRing, 5, 0.1));
  paths::PlannerOptions planning;
  paths::PathPlanner plannerAt(const core::Point2& p) const { return paths::PathPlanner(space, planning, p); }
  paths::PathPlanner::Node nodeAt(const paths::PathPlanner& planner, const core::Point2& p) const {
    return planner.nodeOf(space.index(space.columnOf(p.x), space.rowOf(p.y)));
  }
};

/// From a to b in steps of half a metre, with the spread growing by metre.
void drive(Certainty& certainty, const core::Point2& a, const core::Point2& b, double& spread_m,
           double per_metre) {
  const int steps = static_cast<int>(2 * core::distance(a, b));
  for (int i = 0; i <= steps; ++i) {
    const double s = static_cast<double>(i) / steps;
    if (i > 0) spread_m += per_metre / 2;
    certainty.tell(spread_m);
    certainty.see({a.x + s * (b.x - a.x), a.y + s * (b.y - a.y), 0});
  }
}

constexpr core::Point2 kStart{1, 1}, kRight{23, 1}, kUpRight{23, 4.5}, kUpMiddle{12, 4.5},
    kNearStart{2.5, 4.5};

/// Nearly round the ring: the start is near again by the left corridor, far along what was driven.
double roundTheRing(Certainty& certainty, double per_metre) {
  double spread_m = 0;
  drive(certainty, kStart, kRight, spread_m, per_metre);
  drive(certainty, kRight, kUpRight, spread_m, per_metre);
  drive(certainty, kUpRight, kNearStart, spread_m, per_metre);
  return spread_m;
}

TEST(Certainty, GoesBackWhereTheWayHasComeRoundToAPlaceOfLongAgo) {
  const Ring ring;
  Certainty certainty(100);
  const double spread_m = roundTheRing(certainty, 0.005);
  const auto planner = ring.plannerAt(kNearStart);
  const auto back = certainty.best(ring.space, planner, ring.nodeAt(planner, kUpMiddle));
  ASSERT_TRUE(back);
  EXPECT_LT(back->p_map.x, 5);  // at the start's end of the lower corridor
  EXPECT_LT(back->p_map.y, 2);
  EXPECT_NEAR(back->gain_m, spread_m - back->spread_m, 1e-12);
  EXPECT_GT(back->gain_m, 0.15);
  EXPECT_LT(back->detour_m, 16);
}

TEST(Certainty, DoesNotGoBackAlongTheWayThatItCame) {
  const Ring ring;
  Certainty certainty(100);
  double spread_m = 0;
  drive(certainty, kStart, kRight, spread_m, 0.005);
  const auto planner = ring.plannerAt(kRight);
  // 100 m a metre at 5 mm a metre: half a metre of detour for each metre of way, which costs two.
  EXPECT_FALSE(certainty.best(ring.space, planner, ring.nodeAt(planner, kUpRight)));
}

TEST(Certainty, StaysWhereThePriceIsLowOrTheGainSmall) {
  const Ring ring;
  const auto planner = ring.plannerAt(kNearStart);
  const auto next = ring.nodeAt(planner, kUpMiddle);
  Certainty free_of_charge(0), cheap(10), sure(1000), silent(100);
  roundTheRing(free_of_charge, 0.005);
  roundTheRing(cheap, 0.005);
  roundTheRing(sure, 0.0002);
  EXPECT_FALSE(free_of_charge.best(ring.space, planner, next));
  EXPECT_FALSE(cheap.best(ring.space, planner, next));
  EXPECT_FALSE(sure.best(ring.space, planner, next));
  // A method that reports no covariance.
  silent.see({1, 1, 0});
  silent.see({4, 4.5, 0});
  EXPECT_FALSE(silent.spread_m());
  EXPECT_FALSE(silent.best(ring.space, planner, next));
}

TEST(Certainty, CountsWhatTheWayOnCostsFromThere) {
  const Ring ring;
  Certainty certainty(100);
  roundTheRing(certainty, 0.005);
  const auto planner = ring.plannerAt(kNearStart);
  const auto last = certainty.best(ring.space, planner, std::nullopt);
  const auto on_the_way = certainty.best(ring.space, planner, ring.nodeAt(planner, {6, 1}));
  const auto behind = certainty.best(ring.space, planner, ring.nodeAt(planner, kUpMiddle));
  ASSERT_TRUE(last && behind);
  EXPECT_FALSE(on_the_way);
  EXPECT_GT(last->detour_m, 3);                 // one way
  EXPECT_GT(behind->detour_m, last->detour_m);  // there and back
}

TEST(Certainty, APlaceThatClosedNoLoopDrawsNobodyAgain) {
  const Ring ring;
  Certainty certainty(100);
  double spread_m = roundTheRing(certainty, 0.005);
  const auto planner = ring.plannerAt(kNearStart);
  const auto back = certainty.best(ring.space, planner, std::nullopt);
  ASSERT_TRUE(back);
  EXPECT_FALSE(certainty.isDone(*back));
  // It drives there, and the method closes nothing.
  drive(certainty, {1, 4.5}, back->p_map, spread_m, 0.005);
  EXPECT_FALSE(certainty.isDone(*back));
  certainty.end(back->p_map);
  const auto again = certainty.best(ring.space, ring.plannerAt(back->p_map), std::nullopt);
  EXPECT_TRUE(!again || core::distance(again->p_map, back->p_map) > 4);
}

TEST(Certainty, AWayBackIsDoneOnceItsLoopIsClosed) {
  const Ring ring;
  Certainty certainty(100);
  roundTheRing(certainty, 0.005);
  const auto planner = ring.plannerAt(kNearStart);
  const auto back = certainty.best(ring.space, planner, std::nullopt);
  ASSERT_TRUE(back);
  certainty.tell(back->spread_m + 0.01);
  EXPECT_TRUE(certainty.isDone(*back));
  EXPECT_FALSE(certainty.best(ring.space, planner, std::nullopt));
}

TEST(Certainty, AllDetoursTogetherStayAShareOfTheWay) {
  const Ring ring;
  Certainty certainty(1000);
  roundTheRing(certainty, 0.005);
  const auto planner = ring.plannerAt(kNearStart);
  double detours_m = 0;
  int detours = 0;
  while (const auto back = certainty.best(ring.space, planner, ring.nodeAt(planner, kUpMiddle))) {
    ASSERT_GT(back->detour_m, 0);
    certainty.begin(*back);
    detours_m += back->detour_m;
    ASSERT_LT(++detours, 100);
  }
  EXPECT_GE(detours, 1);
  EXPECT_LE(detours_m, Certainty::kMostShare * 46.1);  // of the 46 m that were driven
}

}  // namespace
}  // namespace slam::choices
