#include "libslam/core/pose2.h"

#include <gtest/gtest.h>

#include "libslam/core/random.h"
#include "libslam/core/rigid_motion2.h"

namespace slam::core {
namespace {

TEST(WrapToPi, KeepsPlusPiAndTurnsMinusPiIntoIt) {
  EXPECT_EQ(wrapToPi(kPi), kPi);
  EXPECT_EQ(wrapToPi(-kPi), kPi);
  EXPECT_NEAR(wrapToPi(3 * kPi / 2), -kPi / 2, 1e-15);
  EXPECT_NEAR(wrapToPi(-7 * kPi / 2), kPi / 2, 1e-14);
  EXPECT_TRUE(std::isnan(wrapToPi(NAN)));
}

TEST(Pose2, TurnsThenShifts) {
  const Point2 p = Pose2{1, 2, kPi / 2} * Point2{3, 0};
  EXPECT_NEAR(p.x, 1, 1e-15);
  EXPECT_NEAR(p.y, 5, 1e-15);
}

TEST(RigidMotion2, MovesPointsToTheSameBitsAsItsPose) {
  RandomStream random(3, "poses");
  for (int i = 0; i < 1000; ++i) {
    const Pose2 T{random.uniform(-50, 50), random.uniform(-50, 50), random.uniform(-10, 10)};
    const Point2 p{random.uniform(-50, 50), random.uniform(-50, 50)}, by_pose = T * p,
                                                                      by_motion = RigidMotion2(T) * p;
    EXPECT_EQ(by_motion.x, by_pose.x);
    EXPECT_EQ(by_motion.y, by_pose.y);
  }
}

TEST(Pose2, AProductsHeadingStaysWithinHalfATurn) {
  const Pose2 T{0, 0, 3};
  EXPECT_NEAR((T * T).phi, 6 - 2 * kPi, 1e-15);
  EXPECT_NEAR((inverse(T) * inverse(T)).phi, 2 * kPi - 6, 1e-15);
  EXPECT_NEAR(between(inverse(T), T).phi, 6 - 2 * kPi, 1e-15);
}

TEST(Pose2, GroupLawsHoldForRandomPoses) {
  RandomStream random(1, "poses");
  const auto draw = [&] {
    return Pose2{random.uniform(-50, 50), random.uniform(-50, 50), random.uniform(-kPi, kPi)};
  };
  for (int i = 0; i < 1000; ++i) {
    const Pose2 a = draw(), b = draw(), c = draw();
    const Pose2 left = (a * b) * c, right = a * (b * c);
    // A few roundings of numbers up to 150.
    EXPECT_NEAR(left.x, right.x, 1e-12);
    EXPECT_NEAR(left.y, right.y, 1e-12);
    EXPECT_NEAR(angleDifference(left.phi, right.phi), 0, 1e-14);
    const Pose2 back = between(a, a * b), identity = a * inverse(a);
    EXPECT_NEAR(back.x, b.x, 1e-12);
    EXPECT_NEAR(back.y, b.y, 1e-12);
    EXPECT_NEAR(angleDifference(back.phi, b.phi), 0, 1e-14);
    EXPECT_NEAR(std::hypot(identity.x, identity.y), 0, 1e-12);
  }
}

TEST(Interpolate, TakesTheShorterWayRound) {
  const Pose2 middle = interpolate({0, 0, degToRad(170)}, {2, 0, degToRad(-170)}, 0.5);
  EXPECT_NEAR(middle.x, 1, 1e-15);
  EXPECT_NEAR(std::abs(middle.phi), kPi, 1e-12);
}

TEST(PathLength, IsZeroForNoneAndOne) {
  EXPECT_EQ(pathLength({}), 0);
  EXPECT_EQ(pathLength({{0, {1, 1, 0}}}), 0);
  EXPECT_EQ(pathLength({{0, {0, 0, 0}}, {1, {3, 4, 0}}, {2, {3, 5, 1}}}), 6);
}

}  // namespace
}  // namespace slam::core
