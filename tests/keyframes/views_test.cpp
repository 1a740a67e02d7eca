// What keyframes' beams say of other scans.
#include <gtest/gtest.h>

#include "tests/keyframes/drawn_map.h"

namespace slam::keyframes {
namespace {

using core::kPi;
using core::Pose2;
using test_maps::addKeyframe;
using test_maps::pointAt;
using test_maps::roundRoom;

/// Beams of one length over an angle around straight ahead, one per degree.
lidar::Scan fan(double degrees, double range_m, const Pose2& T_robot_lidar = {}) {
  lidar::Scan scan;
  scan.step_rad = core::degToRad(1);
  scan.first_angle_rad = -core::degToRad(degrees / 2);
  scan.max_range_m = 20;
  scan.T_robot_lidar = T_robot_lidar;
  scan.ranges_m.assign(static_cast<size_t>(degrees) + 1, static_cast<float>(range_m));
  return scan;
}

Sight at(const lidar::Scan& scan, double distance_m, double degrees) {
  return Beams(scan, {}).say(core::polar(distance_m, core::degToRad(degrees)));
}

TEST(Views, ABeamAgreesPassesOrSaysNothing) {
  const lidar::Scan scan = fan(180, 4);
  EXPECT_EQ(at(scan, 4.2, 0), Sight::kAgreed);
  EXPECT_EQ(at(scan, 3.8, 0), Sight::kAgreed);
  EXPECT_EQ(at(scan, 3.6, 0), Sight::kPassed);
  EXPECT_EQ(at(scan, 0.1, 40), Sight::kPassed);
  EXPECT_EQ(at(scan, 4.4, 0), Sight::kUnseen) << "hidden behind what was met";
  EXPECT_EQ(at(scan, 2, 100), Sight::kUnseen) << "no beam goes there";
  EXPECT_EQ(at(scan, 2, -100), Sight::kUnseen);
  EXPECT_EQ(at(scan, 2, 180), Sight::kUnseen);
  EXPECT_EQ(at(scan, 2, -89), Sight::kPassed);
  EXPECT_EQ(at(scan, 2, -90), Sight::kUnseen) << "the outermost beams have one neighbour only";
}

TEST(Views, BeamsAreCountedFromTheFirstOneCounterClockwise) {
  lidar::Scan scan = fan(180, 4);
  for (size_t i = 0; i < 91; ++i) scan.ranges_m[i] = 2;  // on the right
  EXPECT_EQ(at(scan, 2, -45), Sight::kAgreed);
  EXPECT_EQ(at(scan, 2, 45), Sight::kPassed);
  EXPECT_EQ(at(scan, 4, 45), Sight::kAgreed);
  EXPECT_EQ(at(scan, 4, -45), Sight::kUnseen);
  // Beams from 90 to 270 degrees: half of them have angles that atan2 gives as negative ones.
  scan.first_angle_rad = core::degToRad(90);
  EXPECT_EQ(at(scan, 2, 135), Sight::kAgreed);
  EXPECT_EQ(at(scan, 4, -135), Sight::kAgreed);
  EXPECT_EQ(at(scan, 2, -135), Sight::kPassed);
  EXPECT_EQ(at(scan, 2, 0), Sight::kUnseen);
}

TEST(Views, NeighboursOfABeamAreHeard) {
  lidar::Scan scan = fan(180, 3);
  scan.ranges_m[90] = 8;  // through a slit
  EXPECT_EQ(at(scan, 5, 0), Sight::kUnseen) << "what is beside the slit may hide it";
  EXPECT_EQ(at(scan, 8, 0), Sight::kAgreed);
  EXPECT_EQ(at(scan, 3, 0), Sight::kAgreed);
  scan.ranges_m.assign(scan.ranges_m.size(), lidar::kNoReturn);
  EXPECT_EQ(at(scan, 5, 0), Sight::kUnseen) << "glass and black things give no return, either";
  scan.ranges_m[91] = 8;
  EXPECT_EQ(at(scan, 5, 0), Sight::kPassed);
  EXPECT_EQ(at(scan, 5, -2), Sight::kUnseen);
  scan.ranges_m[91] = lidar::kLostReading;
  EXPECT_EQ(at(scan, 5, 0), Sight::kUnseen);
}

// A hundred-thousandth of a degree to either side of the middle between two beams, all the way round: of a
// beam alone its neighbours hear, and no others.
TEST(Views, BeamsEndInTheMiddleBetweenThem) {
  constexpr double kAside_rad = 1.7e-7;
  for (const double first_deg : {-179.9, -90.0, 0.0, 77.7})
    for (int alone = 3; alone < 998; ++alone) {
      lidar::Scan scan;
      scan.step_rad = 2 * kPi / 1001;
      scan.first_angle_rad = core::degToRad(first_deg);
      scan.max_range_m = 20;
      scan.ranges_m.assign(1001, lidar::kNoReturn);
      scan.ranges_m[static_cast<size_t>(alone)] = 5;
      const Beams beams(scan, {});
      for (const double way : {-1.0, 1.0}) {
        const double end_rad = scan.angle(static_cast<size_t>(alone)) + way * 1.5 * scan.step_rad;
        ASSERT_EQ(beams.say(core::polar(5, end_rad - way * kAside_rad)), Sight::kAgreed) << alone << way;
        ASSERT_EQ(beams.say(core::polar(5, end_rad + way * kAside_rad)), Sight::kUnseen) << alone << way;
      }
    }
}

// A lidar that sits ahead and looks to the left, at a wall 3 m from it: 3 m to the left of the robot, too.
TEST(Views, GoThroughTheLidarsMounting) {
  const lidar::Scan scan = fan(40, 3, {0.5, 0, kPi / 2});
  const std::vector<scanmatch::PatchPoint> points = {pointAt(0.5, 3), pointAt(0.5, 1), pointAt(0.5, 5),
                                                     pointAt(3.5, 0), pointAt(0.5, -3)};
  const View seen = view(scan, {}, points);
  EXPECT_EQ(seen.agreed, 1);
  EXPECT_EQ(seen.passed, 1);
  EXPECT_DOUBLE_EQ(seen.conflict(), 0.5);
  // Points of a robot that stands 2 m ahead and has turned left by a quarter: its x is the viewer's y.
  const std::vector<scanmatch::PatchPoint> its = {pointAt(3, 1.5), pointAt(1, 1.5), pointAt(2, 1.5)};
  const View turned = view(scan, {2, 0, kPi / 2}, its);
  EXPECT_EQ(turned.agreed, 1);
  EXPECT_EQ(turned.passed, 2);
  // Every second point: the two outer ones.
  EXPECT_EQ(view(scan, {2, 0, kPi / 2}, its, 2).passed, 1);
  EXPECT_DOUBLE_EQ(View{}.conflict(), 0);
}

TEST(Views, OfAMapGoThroughPosesAndMountings) {
  KeyframeMap map{GraphOptions{}};
  addKeyframe(map, {}, roundRoom(3), 0, -1);
  addKeyframe(map, {10, 4, kPi / 2}, fan(40, 3, {0.5, 0, kPi / 2}), 1, 0);
  // The second keyframe's lidar is at (10, 4.5) in the map and looks along -x.
  const auto beams = map.beamsOf({1});
  ASSERT_EQ(beams.size(), 1U);
  EXPECT_EQ(beams[0].say({7, 4.5}), Sight::kAgreed);
  EXPECT_EQ(beams[0].say({9, 4.5}), Sight::kPassed);
  EXPECT_EQ(beams[0].say({6, 4.5}), Sight::kUnseen);
  EXPECT_EQ(beams[0].say({10, 3.5}), Sight::kUnseen);
  // Points in the map itself, and a viewer that sees none of them.
  const std::vector<scanmatch::PatchPoint> points = {pointAt(7, 4.5), pointAt(8, 4.5), pointAt(9, 4.5),
                                                     pointAt(9.5, 4.5)};
  EXPECT_DOUBLE_EQ(map.meanConflict({1}, {}, points), 0.75);
  EXPECT_DOUBLE_EQ(map.meanConflict({1, 0}, {}, points), 0.375);
  EXPECT_DOUBLE_EQ(map.meanConflict({}, {}, points), 0);
}

/// A keyframe at the origin that sees a round wall 2 m off, and what a map of it says.
struct Telling {
  KeyframeMap map{GraphOptions{}};
  Telling() { addKeyframe(map, {}, roundRoom(2), 0, -1); }
};

// Every third point is asked.
TEST(Views, ToldByKeyframesIsTheShareOfPointsOfWhichTheySaySomething) {
  const Telling one;
  const auto there = pointAt(2, 0), before = pointAt(0, 1), behind = pointAt(0, 4);
  const auto toldOf = [&](const std::vector<scanmatch::PatchPoint>& asked) {
    std::vector<scanmatch::PatchPoint> points;
    for (const auto& p : asked) points.insert(points.end(), {p, behind, behind});
    return one.map.toldBy({0}, points, {});
  };
  Told told = toldOf({there, before});
  EXPECT_DOUBLE_EQ(told.telling, 1);
  EXPECT_DOUBLE_EQ(told.contradicted, 0.5);
  told = toldOf({there, before, behind, behind});
  EXPECT_DOUBLE_EQ(told.telling, 0.5);
  EXPECT_DOUBLE_EQ(told.contradicted, 0.5) << "of what is told";
  told = toldOf({behind});
  EXPECT_DOUBLE_EQ(told.telling, 0);
  EXPECT_DOUBLE_EQ(told.contradicted, 0);
  EXPECT_DOUBLE_EQ(one.map.toldBy({}, {there}, {}).telling, 0);
  EXPECT_DOUBLE_EQ(one.map.toldBy({0}, {}, {}).telling, 0);
  // One point, asked as one of one; a scan that stands 1 m ahead sees it 1 m off.
  EXPECT_DOUBLE_EQ(one.map.toldBy({0}, {pointAt(1, 0)}, {1, 0, 0}).telling, 1);
  EXPECT_DOUBLE_EQ(one.map.toldBy({0}, {pointAt(1, 0)}, {1, 0, 0}).contradicted, 0);
}

// The scan's own beams speak of what the keyframe saw: they go on behind all of it.
TEST(Views, ToldByAScanItselfCountsAsMuch) {
  const Telling one;
  const std::vector<scanmatch::PatchPoint> points = {pointAt(2, 0)};
  const lidar::Scan far = roundRoom(6), same = roundRoom(2);
  const Told agreed = one.map.toldBy({0}, points, {}, &same), against = one.map.toldBy({0}, points, {}, &far);
  EXPECT_NEAR(agreed.contradicted, 0, 1e-12);
  EXPECT_NEAR(agreed.telling, 1, 1e-12);
  // All that is told by one side is for it, all by the other against; beams at the seam of the circle say
  // nothing, one or two points of forty.
  EXPECT_NEAR(against.contradicted, 0.5, 0.03);
  EXPECT_NEAR(against.telling, 1, 1e-12);
  // From 5 m below a narrow lidar looks up at all that the keyframe saw, and through it.
  const lidar::Scan narrow = fan(60, 10);
  const Told aside = one.map.toldBy({0}, {pointAt(0, 9)}, {0, -5, kPi / 2}, &narrow);
  EXPECT_NEAR(aside.contradicted, 1, 1e-12) << "only the scan's beams tell";
  EXPECT_NEAR(aside.telling, 1, 1e-12);
  EXPECT_EQ(one.map.toldBy({0}, {pointAt(0, 9)}, {0, -5, -kPi / 2}, &narrow).telling, 0) << "it looks away";
}

TEST(Views, WhatSpeaksAgainstIsAShareOfAllThatSpeaks) {
  EXPECT_DOUBLE_EQ((Told{0.5, 0.8}.against(0.6)), 0.4);
  EXPECT_DOUBLE_EQ((Told{0, 0.8}.against(0.6)), 0);
  EXPECT_DOUBLE_EQ((Told{1, 1}.against(0)), 1);
  EXPECT_DOUBLE_EQ((Told{0, 0}.against(0)), 0);
}

TEST(Views, AreSharedByTheDirectionsThatBothLookIn) {
  const auto shared = [](const lidar::Scan& a, double a_rad, const lidar::Scan& b, double b_rad) {
    return sharedView(a, {0, 0, a_rad}, b, {1, 2, b_rad});
  };
  const lidar::Scan half = fan(179, 3), quarter = fan(89, 3);  // n beams count as n steps wide
  EXPECT_NEAR(shared(half, 1, half, 1), 1, 1e-9);
  EXPECT_NEAR(shared(half, 1, half, 1 + kPi / 2), 0.5, 1e-9);
  EXPECT_NEAR(shared(half, 1, half, 1 - kPi / 4), 0.75, 1e-9);
  EXPECT_NEAR(shared(half, 3, half, 3 - 2 * kPi + kPi / 2), 0.5, 1e-9) << "across the turn";
  EXPECT_NEAR(shared(half, 0, half, kPi), 0, 1e-9);
  // Of the first one's directions.
  EXPECT_NEAR(shared(quarter, 0, half, 0), 1, 1e-9);
  EXPECT_NEAR(shared(half, 0, quarter, 0), 0.5, 1e-9);
  EXPECT_NEAR(shared(half, 0, quarter, kPi / 2), 0.25, 1e-9);
  // Three quarters of a circle each, back to back: both ends meet, 180 of 270 degrees.
  const lidar::Scan wide = fan(269, 3);
  EXPECT_NEAR(shared(wide, 0, wide, kPi), 2.0 / 3, 1e-9);
  EXPECT_NEAR(shared(roundRoom(3), 0, wide, kPi), 0.75, 1e-9);
  EXPECT_NEAR(shared(wide, 0, roundRoom(3), kPi), 1, 1e-9);
  // One that is mounted backwards on a robot that has turned round looks the same way.
  EXPECT_NEAR(shared(half, 0, fan(179, 3, {0.2, 0, kPi}), kPi), 1, 1e-9);
  EXPECT_NEAR(shared(fan(179, 3, {0, 0, kPi / 2}), 0, half, 0), 0.5, 1e-9);
}

TEST(Views, AreCountedOfKeyframesWithinTwoOfTheirDistances) {
  GraphOptions options;
  options.keyframe_distance_m = 0.5;
  KeyframeMap map(options);
  const lidar::Scan half = fan(179, 3);
  for (const double x : {0.0, 0.99, 1.01, 5.0}) addKeyframe(map, {x, 0, 0}, half, x, map.lastKeyframe());
  EXPECT_NEAR(map.viewsOf(half, {}, {0, 1, 2, 3}), 2, 1e-9);
  EXPECT_NEAR(map.viewsOf(half, {0, 0, kPi / 2}, {0, 1, 2, 3}), 1, 1e-9);
  EXPECT_NEAR(map.viewsOf(half, {}, {1, 3}), 1, 1e-9) << "among those that are asked";
}

TEST(Views, ViewersLookAtHalfOfWhatAScanLooksAt) {
  // A lidar that looks half round, in a corridor that was driven both ways.
  KeyframeMap map{GraphOptions()};
  const lidar::Scan half = fan(179, 3);
  for (int k = 0; k < 12; ++k)
    addKeyframe(map, {0.5 * k, 0, k % 2 == 0 ? 0 : kPi}, half, k, map.lastKeyframe());
  EXPECT_EQ(map.viewersOf(half, {0, 0, 0.1}, {5, 4, 3, 2, 1, 0}, 4), (std::vector<int>{4, 2, 0}));
  EXPECT_EQ(map.viewersOf(half, {0, 0, kPi}, {0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11}, 4),
            (std::vector<int>{1, 3, 5, 7}));
  EXPECT_TRUE(map.viewersOf(half, {}, {1, 3}, 4).empty());
}

/// Keyframes at one place, ten of them, each reached from the one before; the last one's partners.
std::vector<int> partnersOfTheLast(KeyframeMap& map, const std::vector<int>& near) {
  return map.partnersOf(map.lastKeyframe(), near, map.pose(map.lastKeyframe()));
}

TEST(Views, PartnersAreApartInTimeAndNoMoreThanAskedFor) {
  GraphOptions options;
  options.edges_per_keyframe = 3;
  KeyframeMap map(options);
  for (int k = 0; k < 12; ++k) addKeyframe(map, {}, roundRoom(3), 0.1 * k, k - 1);
  EXPECT_EQ(partnersOfTheLast(map, {11, 10, 9, 8, 7, 6, 5, 4, 3, 2, 1, 0}), (std::vector<int>{10, 7, 4}));
  EXPECT_EQ(partnersOfTheLast(map, {2, 4, 5, 0}), (std::vector<int>{2, 5})) << "in the order they are given";
  EXPECT_TRUE(partnersOfTheLast(map, {11}).empty()) << "not with itself";
}

TEST(Views, PartnersAgreeWithWhatIsSeen) {
  KeyframeMap map{GraphOptions{}};
  const lidar::Scan same = roundRoom(3);
  lidar::Scan through = same, narrow = same, most = same;
  // A third of the beams go on behind; a quarter see the same, and the others nothing; a tenth go on.
  for (size_t i = 0; i < 360; ++i) {
    if (i < 120) through.ranges_m[i] = 8;
    if (i >= 90) narrow.ranges_m[i] = lidar::kNoReturn;
    if (i < 36) most.ranges_m[i] = 8;
  }
  int before = -1;
  for (const auto& seen : {through, same, same, narrow, same, same, most, same, same, through, same})
    before = addKeyframe(map, {}, seen, map.size(), before);
  EXPECT_EQ(partnersOfTheLast(map, {0, 3, 6}), (std::vector<int>{6}));
  EXPECT_EQ(partnersOfTheLast(map, {9, 0, 6}), (std::vector<int>{9, 6}))
      << "the one before holds it in any case";
  // The same keyframe where its scan would lie 2 m off: its beams go through what is seen, or end before it.
  EXPECT_TRUE(map.partnersOf(10, {1}, {2, 0, 0}).empty());
}

}  // namespace
}  // namespace slam::keyframes
