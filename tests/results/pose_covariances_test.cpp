#include "libslam/results/pose_covariances.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "libslam/core/error.h"
#include "libslam/core/random.h"
#include "libslam/files/files.h"
#include "libslam/stats/consistency.h"
#include "libslam/testing/error_of.h"
#include "libslam/testing/temp_folder.h"

namespace slam::results {
namespace {
using slam::testing::errorOf;
using ::testing::DoubleNear;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

Eigen::Matrix3d sigmas(double x_m, double y_m, double phi_rad) {
  return Eigen::Vector3d(x_m * x_m, y_m * y_m, phi_rad * phi_rad).asDiagonal();
}

TEST(Covariances, ReadWhatTheyWrite) {
  const testing::TempFolder folder;
  Eigen::Matrix3d full;
  full << 4e-4, 1e-4, -3e-5, 1e-4, 9e-4, 1.0 / 3e5, -3e-5, 1.0 / 3e5, 1e-5;
  writeCovariances({{1.5e9 + 0.25, full}, {1.5e9 + 0.5, Eigen::Matrix3d::Zero()}}, folder / "c.csv");
  EXPECT_THAT(
      files::readTextFile(folder / "c.csv"),
      ::testing::StartsWith("time_s,xx,xy,xphi,yy,yphi,phiphi\n1500000000.250000,0.0004,0.0001,-3e-05,"));
  const auto read = readCovariances(folder / "c.csv");
  ASSERT_EQ(read.size(), 2U);
  EXPECT_EQ(read[0].time_s, 1.5e9 + 0.25);
  EXPECT_LT((read[0].covariance.matrix() - full).cwiseAbs().maxCoeff(), 1e-13);  // 9 digits of 1e-4
  EXPECT_TRUE(read[1].covariance.isZero());
}

TEST(Covariances, SayWhichLineIsWrong) {
  const testing::TempFolder folder;
  const auto errorWith = [&](const std::string& line) {
    files::writeFileAtomically(folder / "c.csv", "time_s,xx,xy,xphi,yy,yphi,phiphi\n" + line + "\n");
    return errorOf([&] { readCovariances(folder / "c.csv"); });
  };
  EXPECT_THAT(errorWith("1,2,3"), HasSubstr("c.csv:2: found 3 numbers, expected 7"));
  EXPECT_THAT(errorWith("1,2,3,4,5,6,7,8"), HasSubstr("found 8 numbers"));
  EXPECT_THAT(errorWith("1,2,x,4,5,6,7"), HasSubstr("c.csv:2: found 'x', expected a finite number"));
  EXPECT_THAT(errorWith("1,2,nan,4,5,6,7"), HasSubstr("found 'nan'"));
}

TEST(PoseNees, IsTheErrorInTheFrameOfTheTrueStart) {
  // The start looks along the world's y: the map's x is the world's y, its y the world's -x.
  const core::Trajectory truth = {{0, {3, 4, core::kPi / 2}}, {1, {3, 6, core::kPi / 2}}};
  const core::Trajectory estimate = {{0, {0, 0, 0}}, {1, {2.2, 0.3, -0.1}}};  // off by 0.2, 0.3, -0.1
  const auto nees = poseNees(truth, estimate, {{0, Eigen::Matrix3d::Zero()}, {1, sigmas(0.1, 0.1, 0.1)}});
  EXPECT_THAT(nees, ElementsAre(DoubleNear(4 + 9 + 1, 1e-9)));  // the start claims no error
}

TEST(PoseNees, AClaimedCertaintyThatIsOffIsInfinite) {
  const core::Trajectory truth = {{0, {}}, {1, {1, 0, 0}}, {2, {2, 0, 0}}};
  const core::Trajectory estimate = {{0, {}}, {1, {1, 1e-6, 0}}, {2, {2, 1e-3, 0}}};
  const Eigen::Matrix3d certain = Eigen::Matrix3d::Zero();
  // The start is given, and a micrometre is what a file rounds by.
  EXPECT_THAT(poseNees(truth, estimate, {{0, certain}, {1, certain}, {2, certain}}),
              ElementsAre(std::numeric_limits<double>::infinity()));
}

TEST(PoseNees, TakesHeadingsTheShorterWayRound) {
  const core::Trajectory truth = {{0, {0, 0, 0}}, {1, {0, 0, 3.1}}};
  const core::Trajectory estimate = {{0, {0, 0, 0}}, {1, {0, 0, -3.1}}};
  const auto nees = poseNees(truth, estimate, {{0, Eigen::Matrix3d::Zero()}, {1, sigmas(1, 1, 1)}});
  EXPECT_THAT(nees, ElementsAre(DoubleNear(std::pow(2 * core::kPi - 6.2, 2), 1e-9)));
}

TEST(PoseNees, LeavesOutWhatHasNoTruth) {
  const core::Trajectory truth = {{0, {}}, {1, {}}};
  const std::vector<StampedCovariance> unit = {{0, sigmas(1, 1, 1)}, {5, sigmas(1, 1, 1)}};
  EXPECT_THAT(poseNees(truth, {{0, {}}, {5, {}}}, unit), ElementsAre(0.0));
  EXPECT_THAT(poseNees(truth, {{5, {}}, {6, {}}}, unit), IsEmpty());
  EXPECT_THAT(poseNees({}, {}, {}), IsEmpty());
  EXPECT_THROW(poseNees(truth, {{0, {}}}, unit), core::ContractError);
}

// A method that says the truth of its own drift passes, one that boasts does not.
TEST(PoseNees, ConvictsAMethodThatIsTooSure) {
  constexpr int kRuns = 60, kSteps = 50;
  constexpr double kSigma_m = 0.01, kSigma_rad = 0.002;
  std::vector<std::vector<double>> honest, boastful;
  core::RandomStream random(1, "drift");
  for (int run = 0; run < kRuns; ++run) {
    core::Trajectory truth, estimate;
    std::vector<StampedCovariance> covariances, smaller;
    Eigen::Vector3d drift = Eigen::Vector3d::Zero();
    for (int i = 0; i <= kSteps; ++i) {
      const double x_m = 0.1 * i;
      truth.push_back({0.1 * i, core::Pose2{5, 1, 2} * core::Pose2{x_m, 0, 0}});
      estimate.push_back({0.1 * i, {x_m + drift.x(), drift.y(), drift.z()}});
      const double grown = std::sqrt(static_cast<double>(i));
      const Eigen::Matrix3d covariance = sigmas(kSigma_m * grown, kSigma_m * grown, kSigma_rad * grown);
      covariances.push_back({0.1 * i, covariance});
      smaller.push_back({0.1 * i, covariance / 4});
      drift += Eigen::Vector3d(random.normal(kSigma_m), random.normal(kSigma_m), random.normal(kSigma_rad));
    }
    honest.push_back(poseNees(truth, estimate, covariances));
    boastful.push_back(poseNees(truth, estimate, smaller));
  }
  const auto passed = stats::consistency(honest, 3), failed = stats::consistency(boastful, 3);
  EXPECT_EQ(passed->samples, static_cast<size_t>(kRuns * kSteps));
  EXPECT_LT(passed->anees.interval->low, 1);
  EXPECT_GT(passed->anees.interval->high, 1);
  EXPECT_NEAR(passed->coverage95.value, 0.95, 0.03);
  EXPECT_NEAR(failed->anees.value, 4 * passed->anees.value, 1e-9);
  EXPECT_GT(failed->anees.interval->low, 2);
}

}  // namespace
}  // namespace slam::results
