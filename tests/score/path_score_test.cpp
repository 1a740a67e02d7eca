#include "libslam/score/path_score.h"

#include <gmock/gmock.h>

#include <cmath>

#include "libslam/testing/error_of.h"

namespace slam::score {
namespace {
using ::testing::HasSubstr;

/// Drives and stands by turns of `period_s`, 0.5 m/s ahead, 120 s at 5 Hz; the way is scaled.
core::Trajectory stopAndGo(double period_s, double scale = 1) {
  core::Trajectory path;
  double x = 0;
  for (int i = 0; i < 600; ++i) {
    const double time_s = 0.2 * i;
    path.push_back({time_s, {scale * x, 0, 0}});
    if (static_cast<int>(time_s / period_s) % 2 == 0) x += 0.1;
  }
  return path;
}

TEST(RpeSteps, AreMetresAndSeconds) {
  const auto steps = parseRpeSteps("1m, 10m,0.5s", "--rpe");
  ASSERT_EQ(steps.size(), 3U);
  EXPECT_EQ(steps[1].length, 10);
  EXPECT_FALSE(steps[1].is_time);
  EXPECT_EQ(steps[2].length, 0.5);
  EXPECT_TRUE(steps[2].is_time);
  for (const char* bad : {"", "1", "m", "1km", "0m", "-1s", "1m,,2m", "xm"})
    EXPECT_THAT(testing::errorOf([&] { parseRpeSteps(bad, "--rpe"); }), HasSubstr("--rpe: found ")) << bad;
}

TEST(RpeTable, HasARowForEachStep) {
  const auto table = rpeTable(stopAndGo(4), stopAndGo(4, 1.1), parseRpeSteps("1m,10m", "--rpe"));
  ASSERT_EQ(table.rows.size(), 2U);
  EXPECT_EQ(std::get<std::string>(table.rows[0][0]), "1 m");
  EXPECT_NEAR(std::get<double>(table.rows[0][2]), 0.1, 0.011);  // a tenth; pairs are up to a step longer
  EXPECT_NEAR(std::get<double>(table.rows[1][2]), 1.0, 0.011);
}

TEST(PathTable, NeedsACommonStamp) {
  auto later = stopAndGo(4);
  for (auto& pose : later) pose.time_s += 1e6;
  EXPECT_THAT(testing::errorOf([&] { pathTable("p.tum", stopAndGo(4), later, {}); }),
              HasSubstr("no stamp in common"));
  const auto table = pathTable("p.tum", stopAndGo(4), stopAndGo(4), {});
  EXPECT_NEAR(std::get<double>(table.rows[0][2]), 0, 1e-9);
}

TEST(MotionAgreement, TellsABadEstimateFromThatOfAnotherDrive) {
  EXPECT_GT(motionAgreement(stopAndGo(4), stopAndGo(4)), 0.99);
  EXPECT_GT(motionAgreement(stopAndGo(4), stopAndGo(4, 3)), 0.9) << "far off, and of the same drive";
  EXPECT_LT(motionAgreement(stopAndGo(4), stopAndGo(7)), kLeastMotionAgreement);
  EXPECT_TRUE(std::isnan(motionAgreement(stopAndGo(1000), stopAndGo(4)))) << "the truth keeps its pace";
  EXPECT_TRUE(std::isnan(motionAgreement({}, stopAndGo(4))));
}

}  // namespace
}  // namespace slam::score
