#include <gtest/gtest.h>

#include <string>

#include "libslam/core/error.h"
#include "tests/odometry/scene.h"

// What every method keeps, whatever it is.
namespace slam::odometry {
namespace {

using scenes::isPositiveDefinite;
using scenes::Lidar;
using scenes::look;
using scenes::make;
using scenes::oddRoom;

class ScanOdometryContract : public ::testing::TestWithParam<std::string> {
 protected:
  std::unique_ptr<ScanOdometry> odometry_ = make(GetParam().c_str());
};

void expectIdentity(const ScanMotion& motion) {
  EXPECT_EQ(motion.T_previous_current.x, 0);
  EXPECT_EQ(motion.T_previous_current.y, 0);
  EXPECT_EQ(motion.T_previous_current.phi, 0);
}

TEST_P(ScanOdometryContract, TheFirstScanIsTheIdentityWithTinyCovariance) {
  const ScanMotion motion = odometry_->update(look(oddRoom(), {}, {}));
  expectIdentity(motion);
  EXPECT_TRUE(motion.reliable);
  EXPECT_TRUE(isPositiveDefinite(motion.covariance));
  EXPECT_LT(motion.covariance[0], 1e-9);
  EXPECT_LT(motion.covariance[8], 1e-9);
}

TEST_P(ScanOdometryContract, ARobotAtRestStaysAtRest) {
  const auto scan = look(oddRoom(), {}, {});
  odometry_->update(scan);
  const ScanMotion motion = odometry_->update(scan);
  // Equal scans have residuals of exactly zero, but sums of zeros with rounding in the solver may not.
  EXPECT_NEAR(motion.T_previous_current.x, 0, 1e-9);
  EXPECT_NEAR(motion.T_previous_current.y, 0, 1e-9);
  EXPECT_NEAR(motion.T_previous_current.phi, 0, 1e-9);
  EXPECT_TRUE(motion.reliable);
  EXPECT_TRUE(isPositiveDefinite(motion.covariance));
}

TEST_P(ScanOdometryContract, ResetForgetsTheScanBefore) {
  odometry_->update(look(oddRoom(), {}, {}));
  odometry_->reset();
  expectIdentity(odometry_->update(look(oddRoom(), {0.2, 0, 0.1}, {})));
}

TEST_P(ScanOdometryContract, TheSameScansGiveTheSameBits) {
  const auto before = look(oddRoom(), {}, {}), after = look(oddRoom(), {0.1, 0.02, 0.05}, {});
  const ScanMotion first = scenes::between(GetParam().c_str(), before, after);
  const ScanMotion second = scenes::between(GetParam().c_str(), before, after);
  EXPECT_EQ(first.T_previous_current.x, second.T_previous_current.x);
  EXPECT_EQ(first.T_previous_current.y, second.T_previous_current.y);
  EXPECT_EQ(first.T_previous_current.phi, second.T_previous_current.phi);
  EXPECT_EQ(first.covariance, second.covariance);
}

TEST_P(ScanOdometryContract, BlindScansGiveAnUnreliableIdentityWithALargeCovariance) {
  for (const float nothing : {lidar::kNoReturn, lidar::kLostReading}) {
    auto scan = look(oddRoom(), {}, {});
    scan.ranges_m.assign(scan.ranges_m.size(), nothing);
    odometry_->reset();
    odometry_->update(scan);
    const ScanMotion motion = odometry_->update(scan);
    expectIdentity(motion);
    EXPECT_FALSE(motion.reliable);
    EXPECT_TRUE(isPositiveDefinite(motion.covariance));
    EXPECT_GT(motion.covariance[0], 0.5);
  }
}

TEST_P(ScanOdometryContract, OneReturnIsNotEnough) {
  auto scan = look(oddRoom(), {}, {});
  scan.ranges_m.assign(scan.ranges_m.size(), lidar::kLostReading);
  scan.ranges_m[10] = 2;
  odometry_->update(scan);
  const ScanMotion motion = odometry_->update(scan);
  expectIdentity(motion);
  EXPECT_FALSE(motion.reliable);
}

TEST_P(ScanOdometryContract, SurvivesAChangeOfLidar) {
  Lidar other;
  other.beams = 181, other.fov_rad = core::kPi;
  odometry_->update(look(oddRoom(), {}, {}));
  const ScanMotion motion = odometry_->update(look(oddRoom(), {0.1, 0, 0}, other));
  EXPECT_TRUE(isPositiveDefinite(motion.covariance));
  if (motion.reliable) {
    EXPECT_NEAR(motion.T_previous_current.x, 0.1, 0.005);
  }
}

TEST_P(ScanOdometryContract, SurvivesReadingsThatNoLidarGives) {
  for (const float odd : {1e-38f, 1e-6f, 1e9f, 3e38f}) {
    auto scan = look(oddRoom(), {}, {});
    for (size_t i = 0; i < scan.ranges_m.size(); i += 3) scan.ranges_m[i] = odd;
    odometry_->reset();
    odometry_->update(scan);
    for (const auto& next : {scan, look(oddRoom(), {0.1, 0, 0}, {})}) {
      const ScanMotion motion = odometry_->update(next);
      EXPECT_TRUE(core::isFinite(motion.T_previous_current)) << odd;
      EXPECT_TRUE(isPositiveDefinite(motion.covariance)) << odd;
    }
  }
}

TEST_P(ScanOdometryContract, TwoBeamsAreTakenFewerAreTheCallersBug) {
  auto scan = look(oddRoom(), {}, {});
  scan.ranges_m.resize(2);
  EXPECT_NO_THROW(odometry_->update(scan));
  EXPECT_TRUE(isPositiveDefinite(odometry_->update(scan).covariance));
  scan.ranges_m.resize(1);
  EXPECT_THROW(odometry_->update(scan), core::ContractError);
  scan.ranges_m.resize(4);
  scan.step_rad = 0;
  EXPECT_THROW(odometry_->update(scan), core::ContractError);
}

INSTANTIATE_TEST_SUITE_P(Every, ScanOdometryContract, ::testing::ValuesIn(scanOdometryNames()),
                         [](const auto& method) { return method.param; });

TEST(MakeScanOdometry, NamesTheNearestMethodForAMisspeltOne) {
  ScanOdometryOptions options;
  options.method = "corelation";
  try {
    makeScanOdometry(options);
    FAIL() << "no error";
  } catch (const core::InputError& error) {
    EXPECT_STREQ(error.what(),
                 "[scan_odometry] method: found 'corelation', expected argmax, argmax_blind, correlation, "
                 "range_flow or "
                 "plicp; did you mean 'correlation'?");
  }
}

TEST(MakeScanOdometry, ReadsDegreesFromTheIni) {
  ScanOdometryOptions options;
  EXPECT_EQ(options.method, "correlation");
  EXPECT_DOUBLE_EQ(options.max_turn_rad, core::degToRad(60));
}

}  // namespace
}  // namespace slam::odometry
