#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <set>
#include <string>

#include "libslam/doctor/log_check.h"
#include "tests/doctor/drive.h"

namespace slam::doctor {
namespace {

using ::testing::HasSubstr;

class RealLog : public ::testing::Test {
 protected:
  void SetUp() override {
    folder_ = testing::realDataFolder(RASTERSLAM_SOURCE_DIR);
    if (folder_.empty()) GTEST_SKIP() << "real logs are not there";
  }
  LogCheck look(const std::string& name) const {
    return checkLog(folder_ + "/logs/" + name, "", core::silentProgress());
  }
  std::string folder_;
};

std::set<std::string> complaintKeys(const LogCheck& check) {
  std::set<std::string> keys;
  for (const auto& finding : check.findings)
    if (finding.severity != Severity::kNote) keys.insert(finding.key);
  return keys;
}

// What each of the three gets, and why it is no false alarm, stands beside the expectation.
TEST_F(RealLog, MitKillianHasOdometryThatLeadsBySixTenths) {
  const auto result = look("mit-killian/mit-killian.reconstructed.clf.xz");
  const auto& f = result.figures;
  ASSERT_EQ(f.ranges.scans, 17480U);
  ASSERT_TRUE(f.odometry[0].clock.is_observable);
  EXPECT_NEAR(f.odometry[0].clock.offset_s.value, 0.6, 0.05);
  EXPECT_LT(f.odometry[0].clock.offset_s.width(), 0.05);
  EXPECT_EQ(complaintKeys(result), std::set<std::string>({"clock"}));
  ASSERT_TRUE(f.ranges.spike);
  EXPECT_NEAR(f.ranges.spike->low_m, 51.05, 0.011);
  EXPECT_NEAR(f.ranges.spike->high_m, 51.22, 0.011);
  EXPECT_NEAR(f.view.factor.value, 1, 0.02);
}

TEST_F(RealLog, IntelHasStampsThatRunBackPausesAndAnOdometerThatDrifts) {
  const auto result = look("intel/intel.clf.bz2");
  const auto& f = result.figures;
  ASSERT_EQ(f.ranges.scans, 13631U);
  EXPECT_FALSE(f.is_view_given);
  EXPECT_THAT(said(result.findings, "backward"), HasSubstr("'FLASER': 631 of 13631 stamps"));
  ASSERT_EQ(f.odometry.size(), 2U);
  for (const auto& odometry : f.odometry) {
    ASSERT_TRUE(odometry.clock.is_observable);
    EXPECT_NEAR(odometry.clock.offset_s.value, 0, 0.02);
  }
  // Recording paused for up to 3.5 s; its odometry is the worst of the benchmark's (drift of 3 deg per
  // metre).
  EXPECT_EQ(complaintKeys(result), std::set<std::string>({"gaps", "heading"}));
  ASSERT_TRUE(f.ranges.spike);
  EXPECT_NEAR(f.ranges.spike->peak_m, 81.83, 0.006);
  EXPECT_EQ(f.ranges.spike->readings, 68313U);
  EXPECT_NEAR(f.view.factor.value, 1, 0.02);
}

TEST_F(RealLog, FreiburgStatesItsLidarBehindTheCentre) {
  const auto result = look("fr079/fr079.clf.bz2");
  const auto& f = result.figures;
  ASSERT_EQ(f.ranges.scans, 4934U);
  EXPECT_TRUE(f.is_view_given);
  EXPECT_DOUBLE_EQ(f.ranges.T_robot_lidar.x, -0.04);
  EXPECT_THAT(said(result.findings, "mounting"), HasSubstr("note: x -0.040 m"));
  // 0.12 s: a sweep of 360 readings takes 0.19 s over this lidar's line of 38400 baud, and is stamped after
  // it.
  for (const auto& odometry : f.odometry) {
    ASSERT_TRUE(odometry.clock.is_observable);
    EXPECT_NEAR(odometry.clock.offset_s.value, 0.12, 0.03);
  }
  EXPECT_EQ(complaintKeys(result), std::set<std::string>());
  ASSERT_TRUE(f.ranges.spike);
  EXPECT_NEAR(f.ranges.spike->peak_m, 81.91, 0.006);
  EXPECT_EQ(f.ranges.spike->readings, 36881U);
  EXPECT_NEAR(f.view.factor.value, 1, 0.02);
}

}  // namespace
}  // namespace slam::doctor
