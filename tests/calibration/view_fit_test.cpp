#include "libslam/calibration/view_fit.h"

#include <gtest/gtest.h>

#include "libslam/core/random.h"
#include "tests/mapping/small_room.h"

namespace slam::calibration {
namespace {

/// A drive through a room with a lidar of 240 degrees, of which the log says `stated` times as many, to and
/// fro and in curves; `moving`: metres of a step.
ViewFit fitOf(double stated, double moving_m = 0.1, int scans = 170) {
  core::RandomStream random(1, "noise");
  ViewPairs pairs(static_cast<std::uint64_t>(scans));
  core::Pose2 T_room_robot{-1, -1, 0};
  for (int k = 0; k < scans; ++k) {
    // 4 m ahead and back, and some turning, back too.
    const double way = k / 40 % 2 == 0 ? 1 : -1, turn = (k / 20 % 2 == 0 ? 1 : -1) * 0.01 * way;
    const core::Pose2 moved{way * moving_m, 0, turn};
    if (k > 0) T_room_robot = T_room_robot * moved;
    auto scan = mapping::test::scanRoom(T_room_robot, 0.1 * k, 241, 240);
    for (auto& range_m : scan.ranges_m) range_m += static_cast<float>(0.005 * random.normal());
    scan.first_angle_rad *= stated, scan.step_rad *= stated;
    ScanStep step;
    step.T_previous_lidar = {moved.x, moved.y, moved.phi * stated};
    step.is_matched = step.is_reliable = true;
    pairs.addScan(scan, k > 0 ? &step : nullptr);
  }
  return pairs.fit();
}

// Within 1 %, as on real logs.
TEST(ViewFit, FindsByWhatTheAngleIsWrong) {
  for (const double stated : {1.0, 0.5, 1.25}) {
    const auto fit = fitOf(stated);
    ASSERT_TRUE(fit.is_observable) << stated << ", " << fit.pairs << " pairs";
    EXPECT_NEAR(fit.factor.value, 1 / stated, 0.01 / stated);
    EXPECT_LE(fit.factor.low, fit.factor.value);
    EXPECT_GE(fit.factor.high, fit.factor.value);
    EXPECT_LT(fit.factor.width(), 0.05 / stated);
    EXPECT_TRUE(std::is_sorted(fit.candidates.begin(), fit.candidates.end(),
                               [](const auto& a, const auto& b) { return a.factor < b.factor; }));
  }
}

TEST(ViewFit, ARobotThatStandsTellsNothing) {
  const auto fit = fitOf(1, 0);
  EXPECT_EQ(fit.pairs, 0U);
  EXPECT_FALSE(fit.is_observable);
  // Six metres, half a metre a pair: 20 of them are the least.
  const auto brief = fitOf(1, 0.1, 60);
  EXPECT_GT(brief.pairs, 5U);
  EXPECT_LE(brief.pairs, 12U);
  EXPECT_FALSE(brief.is_observable);
}

}  // namespace
}  // namespace slam::calibration
