#include "libslam/calibration/sweep_fit.h"

#include <gtest/gtest.h>

#include "libslam/core/random.h"
#include "tests/mapping/small_room.h"

namespace slam::calibration {
namespace {

constexpr double kPeriod_s = 0.1;

/// The drive of a robot that turns left, not at all, and right in turn, with a lidar whose sweep takes so
/// long (negative: clockwise).
SweepFit fitOf(double duration_s, double turn_rad, int scans = 90) {
  const auto walls = mapping::test::smallRoom();
  core::RandomStream random(1, "noise");
  SweepPairs pairs(static_cast<std::uint64_t>(scans));
  core::Pose2 T_room_robot{1, 0, 0};
  for (int k = 0; k < scans; ++k) {
    const int phase = k / 2 % 4;
    const double turn = phase == 0 ? turn_rad : phase == 2 ? -turn_rad : 0;
    const core::Pose2 motion{phase % 2 == 1 ? (k / 8 % 2 == 0 ? 0.04 : -0.04) : 0.0, 0, turn};
    T_room_robot = T_room_robot * motion;
    auto scan = mapping::test::scanRoom(T_room_robot, k * kPeriod_s, 271, 270);
    const size_t last = scan.ranges_m.size() - 1;
    for (size_t i = 0; i <= last; ++i) {
      const double ago_s = std::abs(duration_s) * static_cast<double>(duration_s < 0 ? i : last - i) /
                           static_cast<double>(last);
      const core::Pose2 T_room_then =
          T_room_robot * core::interpolate({}, core::inverse(motion), ago_s / kPeriod_s);
      scan.ranges_m[i] = static_cast<float>(mapping::test::castRay(walls, T_room_then, scan.angle(i)) +
                                            0.01 * random.normal());
    }
    pairs.addScan(scan, k > 0 ? std::optional<core::Pose2>(motion) : std::nullopt);
  }
  return pairs.fit();
}

TEST(SweepFit, FindsHowLongASweepTakesAndWhichWayItGoes) {
  for (const double duration_s : {0.05, -0.08, 0.0}) {
    const auto fit = fitOf(duration_s, 0.1);
    ASSERT_TRUE(fit.is_observable) << duration_s << ", " << fit.pairs << " pairs";
    // A tenth of the period; 1 cm of noise is seen at 0.1 rad over half a turn as some milliseconds.
    EXPECT_NEAR(fit.duration_s.value, duration_s, 0.01);
    EXPECT_LT(fit.duration_s.width(), 0.03);
  }
}

TEST(SweepFit, ARobotThatTurnsSteadilyTellsNothing) {
  EXPECT_FALSE(fitOf(0.05, 0.01).is_observable);
  EXPECT_EQ(fitOf(0.05, 0.01).pairs, 0U);
  EXPECT_FALSE(fitOf(0.05, 0.1, 4).is_observable);
}

}  // namespace
}  // namespace slam::calibration
