#include "libslam/wheels/steady_motion.h"

#include <gtest/gtest.h>

#include <cmath>

#include "libslam/core/random.h"

namespace slam::wheels {
namespace {

void expectStep(const core::Pose2& T, const core::Pose2& expected) {
  EXPECT_NEAR(T.x, expected.x, 1e-9);
  EXPECT_NEAR(T.y, expected.y, 1e-9);
  EXPECT_NEAR(T.phi, expected.phi, 1e-9);
}

TEST(SteadyMotion, StandsUntilSomethingIsKnown) {
  SteadyMotion steady;
  expectStep(steady.next(0.2), {});
  steady.note({0.1, 0, 0});
  expectStep(steady.next(0.2), {0.1, 0, 0});
}

TEST(SteadyMotion, GoesOnByTheMiddleMoveAndTheLastTurn) {
  SteadyMotion steady;
  for (const core::Pose2& T : {core::Pose2{0.1, 0, 0}, {0.1, 0, 0}, {-0.8, 0, 0}, {0.1, 0, 0}, {1.2, 0, 0.3}})
    steady.next(0.2), steady.note(T);
  expectStep(steady.next(0.2), {0.1, 0, 0.3});
}

TEST(SteadyMotion, ForgetsWhatLiesSixStepsBack) {
  SteadyMotion steady;
  for (int i = 0; i < 20; ++i) steady.next(0.2), steady.note({0.5, 0, 0});
  for (int i = 0; i < 3; ++i) steady.next(0.2), steady.note({0.1, 0, 0});
  expectStep(steady.next(0.2), {0.1, 0, 0});
}

// A scan was dropped: along an arc of twice the length.
TEST(SteadyMotion, GoesTwiceAsFarInTwiceTheTime) {
  SteadyMotion steady;
  const core::Pose2 step{0.2 * std::sin(0.25) / 0.25 * std::cos(0.25),
                         0.2 * std::sin(0.25) / 0.25 * std::sin(0.25), 0.5};
  for (int i = 0; i < 5; ++i) steady.next(0.2), steady.note(step);
  expectStep(steady.next(0.4), step * step);
  EXPECT_TRUE(steady.goesByTime());
}

TEST(SteadyMotion, LearnsThatStampsLeap) {
  SteadyMotion steady;
  core::RandomStream chance(1, "stamps");
  for (int i = 0; i < 30; ++i)
    steady.next(i % 3 == 2 ? 0.7 : 0.02), steady.note({0.1 + 0.001 * chance.normal(), 0, 0.05});
  EXPECT_FALSE(steady.goesByTime());
  EXPECT_NEAR(steady.next(0.7).x, 0.1, 0.005);
  EXPECT_NEAR(steady.next(0.02).phi, 0.05, 1e-9);
}

TEST(SteadyMotion, TrustsStampsWhereStepsGoByThem) {
  SteadyMotion steady;
  for (int i = 0; i < 30; ++i) {
    const double since_s = i % 4 == 3 ? 0.6 : 0.2;
    steady.next(since_s), steady.note({0.5 * since_s, 0, 0});
  }
  EXPECT_TRUE(steady.goesByTime());
  EXPECT_NEAR(steady.next(0.6).x, 0.3, 1e-9);
}

TEST(SteadyMotion, LearnsNothingOfWhatIsNotFinite) {
  SteadyMotion steady;
  steady.next(0.2), steady.note({0.1, 0, 0.1});
  steady.next(0.2), steady.note({std::nan(""), 0, 0});
  steady.next(0.2), steady.note({0, 0, INFINITY});
  expectStep(steady.next(0.2), {0.1, 0, 0.1});
}

}  // namespace
}  // namespace slam::wheels
