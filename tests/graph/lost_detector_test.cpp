#include "libslam/graph/lost_detector.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "libslam/core/random.h"

namespace slam::graph {
namespace {

/// Contradicted shares of a robot that is well, in a place as busy as `mean` says.
double wellShare(core::RandomStream& random, double mean) {
  return std::max(0.0, mean + 0.5 * mean * random.normal());
}

LostDetector::Look seen(double time_s, double moved_m, double contradicted, double broken) {
  LostDetector::Look look{};
  look.time_s = time_s;
  look.moved_m = moved_m;
  look.contradicted = contradicted;
  look.telling = 1;
  look.broken = broken;
  return look;
}

/// One that has driven well for 500 scans.
LostDetector settled(double rate_hz, double speed_mps, double mean = 0.03) {
  LostDetector detector;
  core::RandomStream random(1, "well");
  for (int i = 0; i < 500; ++i)
    detector.look(seen(i / rate_hz, speed_mps / rate_hz, wellShare(random, mean), wellShare(random, 0.02)));
  return detector;
}

/// Seconds until it is lost when from now on every scan contradicts by `share`, after a break; endless after
/// a minute.
double secondsToNotice(LostDetector& detector, double from_s, double period_s, double speed_mps, double share,
                       double first_break) {
  for (double t = period_s; t < 60; t += period_s) {
    detector.look(seen(from_s + t, speed_mps * period_s, share, t == period_s ? first_break : 0.02));
    if (detector.isLost()) return t;
  }
  return std::numeric_limits<double>::infinity();
}

TEST(LostDetector, NoticesAKidnappedRobotWithinFiveSecondsAtAnyRate) {
  for (const double rate_hz : {1.4, 2.0, 5.0, 10.0, 40.0})
    for (const double speed_mps : {0.0, 0.5, 2.0}) {
      auto detector = settled(rate_hz, speed_mps);
      EXPECT_FALSE(detector.isInDoubt());
      EXPECT_LE(secondsToNotice(detector, 500 / rate_hz, 1 / rate_hz, speed_mps, 0.7, 0.6), 5.0)
          << rate_hz << " Hz, " << speed_mps << " m/s";
    }
}

TEST(LostDetector, BelievesInDriftRatherThanKidnappingWhereNothingBreaks) {
  auto broken = settled(5, 0.5), drifted = settled(5, 0.5);
  const double with_break_s = secondsToNotice(broken, 100, 0.2, 0.5, 0.7, 0.6),
               without_s = secondsToNotice(drifted, 100, 0.2, 0.5, 0.7, 0.02);
  EXPECT_GT(without_s, 2 * with_break_s);
  EXPECT_LT(without_s, 30);
}

// Where nothing will tell any more, a thousand to one is enough.
TEST(LostDetector, DecidesByLessWhenNothingWillTellAnyMore) {
  auto detector = settled(2, 0.5);
  for (double t = 0.5; detector.evidence() < LostDetector::kToldEnough; t += 0.5) {
    ASSERT_LT(t, 60);
    detector.decide();
    ASSERT_FALSE(detector.isLost()) << t;
    detector.look(seen(250 + t, 0.25, 0.7, t == 0.5 ? 0.6 : 0.02));
  }
  EXPECT_FALSE(detector.isLost());
  detector.decide();
  EXPECT_TRUE(detector.isLost());
}

TEST(LostDetector, TakesHoursOfABusyPlaceForNoLoss) {
  for (const double mean : {0.01, 0.05, 0.12}) {
    LostDetector detector;
    core::RandomStream random(2, "busy");
    for (int i = 0; i < 100000; ++i) {
      detector.look(seen(0.2 * i, 0.1, wellShare(random, mean), wellShare(random, mean)));
      ASSERT_FALSE(detector.isLost()) << mean << ", scan " << i;
    }
  }
}

TEST(LostDetector, NoticesAPlaceThatContradictsLittleAfterABreak) {
  // Far more than is seen where all is well, a third to two of what wrong places contradict as a rule.
  for (const double share : {0.25, 0.3, 0.4}) {
    auto detector = settled(5, 0.5);
    for (int i = 0; i < 50; ++i) detector.learnWrong(0.65 + (i % 2 == 0 ? 0.17 : -0.17));
    EXPECT_LE(secondsToNotice(detector, 100, 0.2, 0.5, share, 0.9), 5.0) << share;
  }
}

TEST(LostDetector, ListensLessToLittleContradictionWhereThatWasWell) {
  // A sparse log: one look in ten contradicts by a third where the robot is.
  auto odd = settled(5, 0.5), clean = settled(5, 0.5);
  for (auto* detector : {&odd, &clean})
    for (int i = 0; i < 50; ++i) detector->learnWrong(0.65 + (i % 2 == 0 ? 0.17 : -0.17));
  for (int i = 0; i < 300; ++i) {
    odd.look(seen(100 + 0.4 * i, 0.2, i % 10 == 0 ? 0.35 : 0.03, 0.02));
    clean.look(seen(100 + 0.4 * i, 0.2, 0.03, 0.02));
  }
  const double odd_s = secondsToNotice(odd, 220, 0.2, 0.5, 0.3, 0.9),
               clean_s = secondsToNotice(clean, 220, 0.2, 0.5, 0.3, 0.9);
  EXPECT_LE(clean_s, 5);
  EXPECT_GT(odd_s, 2 * clean_s);
}

TEST(LostDetector, TakesAMapThatIsOutOfDateForNoLoss) {
  // Furniture was moved: the map contradicts as much, but nothing broke on the way there.
  auto detector = settled(5, 0.5);
  for (int i = 0; i < 50; ++i) detector.learnWrong(0.65 + (i % 2 == 0 ? 0.17 : -0.17));
  EXPECT_TRUE(std::isinf(secondsToNotice(detector, 100, 0.2, 0.5, 0.3, 0.02)));
}

TEST(LostDetector, TakesPeopleWhoWalkAboutForNoLoss) {
  // Half of every scan is people: the map contradicts it more than keyframes of late do, and so does the scan
  // before it.
  auto detector = settled(5, 0.5);
  for (int i = 0; i < 100; ++i) {
    detector.look(seen(100 + 0.2 * i, 0.1, 0.4, 0.5));
    ASSERT_FALSE(detector.isLost()) << i;
  }
}

TEST(LostDetector, TakesASecondOfNonsenseForNoLoss) {
  for (const double rate_hz : {2.0, 10.0, 40.0}) {
    LostDetector detector;
    for (int i = 0; i < 100; ++i) detector.look(seen(i / rate_hz, 0.05, 0.02, 0.02));
    for (int i = 0; i < rate_hz; ++i) detector.look(seen((100 + i) / rate_hz, 0, 1, i == 0 ? 1 : 0));
    EXPECT_FALSE(detector.isLost()) << rate_hz;
    EXPECT_TRUE(detector.isInDoubt()) << rate_hz;
  }
}

TEST(LostDetector, ABreakBackEndsADoubt) {
  // Some scans of nothing that is there. Afterwards the robot is on new ground, of which the map says little.
  for (const bool fits : {true, false}) {
    auto detector = settled(5, 0.5);
    for (int i = 0; i < 3; ++i) detector.look(seen(101 + 0.4 * i, 0.2, 0.9, i == 0 ? 0.8 : 0.02));
    ASSERT_TRUE(detector.isInDoubt());
    auto after = seen(102.2, 0.2, fits ? 0.05 : 0.9, 0.8);
    after.telling = 0.1;
    detector.look(after);
    EXPECT_EQ(detector.isInDoubt(), !fits);
  }
}

TEST(LostDetector, ListensLessToBreaksWhereDoubtsHavePassed) {
  auto fresh = settled(5, 0.5), wary = settled(5, 0.5);
  for (int i = 0; i < 8; ++i) wary.dismiss();
  EXPECT_GT(secondsToNotice(wary, 100, 0.2, 0.5, 0.7, 0.6),
            1.5 * secondsToNotice(fresh, 100, 0.2, 0.5, 0.7, 0.6));
}

/// Time goes on by a look of 0.4 s each: one break, looks that contradict the map, and some that do not,
/// until the doubt has passed.
void passStreak(LostDetector& detector, double& time_s, int looks) {
  for (int i = 0; i < looks; ++i) detector.look(seen(time_s += 0.4, 0.2, 0.7, i == 0 ? 0.6 : 0.02));
  while (detector.isInDoubt()) detector.look(seen(time_s += 0.4, 0.2, 0.03, 0.02));
  detector.dismiss();
}

TEST(LostDetector, ListensLessToStreaksWhereStreaksHavePassed) {
  // Slopes: the lidar sees the ground for some metres. Later, on flat ground, breaks are forgotten.
  auto hilly = settled(5, 0.5), flat = settled(5, 0.5);
  double time_s = 100;
  for (int i = 0; i < 10; ++i) passStreak(hilly, time_s, 5);
  for (int i = 0; i < 600; ++i) hilly.look(seen(time_s += 0.4, 0.2, 0.03, 0.02));
  const double there_s = secondsToNotice(hilly, time_s, 0.4, 0.5, 0.7, 0.6),
               here_s = secondsToNotice(flat, 100, 0.4, 0.5, 0.7, 0.6);
  EXPECT_GT(there_s, 1.5 * here_s);
  EXPECT_LT(there_s, 20);
}

TEST(LostDetector, StreaksOfARobotThatWasKidnappedTeachNothing) {
  auto detector = settled(5, 0.5), fresh = settled(5, 0.5);
  double time_s = 100;
  for (int i = 0; i < 10; ++i) {
    secondsToNotice(detector, time_s, 0.4, 0.5, 0.7, 0.6);
    ASSERT_TRUE(detector.isLost());
    detector.restart();
    time_s += 60;
    for (int k = 0; k < 5; ++k) detector.look(seen(time_s += 0.4, 0.2, 0.03, 0.02));
  }
  EXPECT_NEAR(secondsToNotice(detector, time_s, 0.4, 0.5, 0.7, 0.6),
              secondsToNotice(fresh, 100, 0.4, 0.5, 0.7, 0.6), 0.5);
}

TEST(LostDetector, SaysNothingWhereWrongPlacesAreNoWorse) {
  auto detector = settled(5, 0.5);
  for (int i = 0; i < 300; ++i) detector.learnWrong(0.04);
  EXPECT_TRUE(std::isinf(secondsToNotice(detector, 100, 0.2, 0.5, 0.5, 0.5)));
}

TEST(LostDetector, TheUnknownAndTheExplainedSayNothing) {
  LostDetector detector;
  auto unknown = seen(0, 0.1, 0.9, 0.9), explained = seen(0, 0.1, 0.9, 0.9);
  unknown.telling = 0;
  explained.may_be_lost = false;
  for (int i = 0; i < 1000; ++i) {
    unknown.time_s = 0.2 * i;
    detector.look(unknown);
    ASSERT_FALSE(detector.isLost()) << i;
  }
  for (int i = 0; i < 1000; ++i) {
    explained.time_s = 200 + 0.2 * i;
    detector.look(explained);
  }
  EXPECT_FALSE(detector.isInDoubt());
  const double nan = std::numeric_limits<double>::quiet_NaN();
  auto none = seen(nan, nan, nan, nan);
  none.telling = nan;
  detector.look(none);
  EXPECT_TRUE(std::isfinite(detector.evidence()));
}

}  // namespace
}  // namespace slam::graph
