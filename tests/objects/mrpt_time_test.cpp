#include "libslam/objects/mrpt_time.h"

#include <gtest/gtest.h>
#include <mrpt/core/Clock.h>

#include <cmath>
#include <limits>

#include "libslam/core/error.h"
#include "libslam/core/random.h"

namespace slam::objects {
namespace {

TEST(MrptTime, CountsFromTheYear1601AsMrptDoes) {
  EXPECT_EQ(mrptTicks(0), 116'444'736'000'000'000);
  EXPECT_EQ(mrptTicks(1.5), 116'444'736'015'000'000);
  EXPECT_EQ(mrptTicks(-0.25), 116'444'735'997'500'000);
  const auto ticks = mrpt::Clock::time_point(mrpt::Clock::duration(mrptTicks(1137834225.97376)));
  EXPECT_DOUBLE_EQ(mrpt::Clock::toDouble(ticks), 1137834225.97376);
}

TEST(MrptTime, GivesBackTheVerySecondsOfTodaysStamps) {
  core::RandomStream random(1, "stamps");
  for (int i = 0; i < 10000; ++i) {
    const double time_s = random.uniform(6e8, 4e9);
    ASSERT_EQ(secondsFromMrptTicks(mrptTicks(time_s)), time_s);
  }
}

TEST(MrptTime, RoundsEarlyStampsToTheNearestTick) {
  core::RandomStream random(2, "stamps");
  // Half a tick, and the rounding of the double itself (1e-7 of a millionth part of the stamp).
  for (int i = 0; i < 10000; ++i) {
    const double time_s = random.uniform(-1e6, 1e6);
    ASSERT_NEAR(secondsFromMrptTicks(mrptTicks(time_s)), time_s, 0.5e-7 + 2e-10);
  }
  EXPECT_EQ(mrptTicks(0.7e-7), mrptTicks(0) + 1) << "cut off instead of rounded";
}

TEST(MrptTime, LeavesAtMostOneTickOfDoubtInAStampOfALog) {
  for (std::int64_t ticks = 133'444'736'000'000'000; ticks < 133'444'736'000'000'100; ++ticks)
    ASSERT_LE(std::abs(mrptTicks(secondsFromMrptTicks(ticks)) - ticks), 1);
}

TEST(MrptTime, RefusesTimesThatMrptCannotHold) {
  EXPECT_THROW(mrptTicks(std::numeric_limits<double>::quiet_NaN()), core::ContractError);
  EXPECT_THROW(mrptTicks(std::numeric_limits<double>::infinity()), core::ContractError);
  EXPECT_THROW(mrptTicks(-11'644'473'600.0), core::ContractError) << "that is MRPT's 'no stamp'";
  EXPECT_THROW(mrptTicks(1e12), core::ContractError);
}

}  // namespace
}  // namespace slam::objects
