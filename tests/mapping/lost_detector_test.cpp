#include "libslam/mapping/lost_detector.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "libslam/core/random.h"

namespace slam::mapping {
namespace {

/// Contradicted shares of a robot that is well, in a place as busy as `mean` says.
double wellShare(core::RandomStream& random, double mean) {
  return std::max(0.0, mean + 0.5 * mean * random.normal());
}

/// Seconds until it is lost when from now on every scan contradicts by `share`; endless after a minute.
double secondsToNotice(LostDetector& detector, double from_s, double period_s, double speed_mps,
                       double share) {
  for (double t = period_s; t < 60; t += period_s) {
    detector.look(from_s + t, speed_mps * period_s, share, 1);
    if (detector.isLost()) return t;
  }
  return std::numeric_limits<double>::infinity();
}

TEST(LostDetector, NoticesACarriedRobotWithinFiveSecondsAtAnyRate) {
  for (const double rate_hz : {1.4, 2.0, 5.0, 10.0, 40.0})
    for (const double speed_mps : {0.0, 0.5, 2.0}) {
      LostDetector detector;
      core::RandomStream random(1, "well");
      for (int i = 0; i < 500; ++i)
        detector.look(i / rate_hz, speed_mps / rate_hz, wellShare(random, 0.03), 1);
      EXPECT_EQ(detector.isInDoubt(), false);
      EXPECT_LE(secondsToNotice(detector, 500 / rate_hz, 1 / rate_hz, speed_mps, 0.4), 5.0)
          << rate_hz << " Hz, " << speed_mps << " m/s";
    }
}

TEST(LostDetector, TakesHoursOfABusyPlaceForNoLoss) {
  for (const double mean : {0.01, 0.05, 0.12}) {
    LostDetector detector;
    core::RandomStream random(2, "busy");
    for (int i = 0; i < 100000; ++i) {
      detector.look(0.2 * i, 0.1, wellShare(random, mean), 1);
      ASSERT_FALSE(detector.isLost()) << mean << ", scan " << i;
    }
  }
}

TEST(LostDetector, TakesASecondOfNonsenseForNoLoss) {
  for (const double rate_hz : {2.0, 10.0, 40.0}) {
    LostDetector detector;
    for (int i = 0; i < 100; ++i) detector.look(i / rate_hz, 0.05, 0.02, 1);
    for (int i = 0; i < rate_hz; ++i) detector.look((100 + i) / rate_hz, 0, 1, 1);
    EXPECT_FALSE(detector.isLost()) << rate_hz;
    EXPECT_GT(detector.evidence(), 0) << rate_hz;
  }
}

TEST(LostDetector, SaysNothingWhereWrongPlacesAreNoWorse) {
  LostDetector detector;
  for (int i = 0; i < 200; ++i) detector.learnWrong(0.04);
  for (int i = 0; i < 200; ++i) detector.look(0.2 * i, 0.1, 0.03, 1);
  EXPECT_TRUE(std::isinf(secondsToNotice(detector, 40, 0.2, 0.5, 0.5)));
}

TEST(LostDetector, TheUnknownAndTheExplainedSayNothing) {
  LostDetector detector;
  for (int i = 0; i < 1000; ++i) detector.look(0.2 * i, 0.1, 0.9, 0);
  EXPECT_EQ(detector.evidence(), 0);
  for (int i = 0; i < 1000; ++i) detector.look(200 + 0.2 * i, 0.1, 0.9, 1, false);
  EXPECT_EQ(detector.evidence(), 0);
  detector.look(std::numeric_limits<double>::quiet_NaN(), 0, std::numeric_limits<double>::quiet_NaN(), 1);
  EXPECT_EQ(detector.evidence(), 0);
}

}  // namespace
}  // namespace slam::mapping
