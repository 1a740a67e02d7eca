#include "libslam/metrics/trajectory_error.h"
#include "libslam/core/numbers.h"

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <sstream>

#include "libslam/core/error.h"
#include "libslam/core/random.h"
#include "libslam/files/files.h"
#include "libslam/testing/temp_folder.h"

namespace slam::metrics {
namespace {

using core::kPi;
using core::Pose2;
using core::Trajectory;

using core::kNaN;
// Coordinates of tens of metres in doubles, a few operations each: far above rounding, far below any error
// that matters.
constexpr double kExact = 1e-9;

/// A winding drive of 61 poses at 10 Hz from an epoch-sized stamp.
Trajectory windingTruth() {
  Trajectory truth;
  Pose2 pose{3, -2, 0.4};
  for (int i = 0; i <= 60; ++i) {
    truth.push_back({1.7e9 + 0.1 * i, pose});
    pose = pose * Pose2{0.2, 0, 0.3 * std::sin(0.2 * i)};
  }
  return truth;
}

Trajectory movedBy(const Pose2& T, Trajectory trajectory) {
  for (auto& stamped : trajectory) stamped.pose = T * stamped.pose;
  return trajectory;
}

Trajectory straightLine(int poses, double step_m, double phi = 0) {
  Trajectory line;
  for (int i = 0; i < poses; ++i) line.push_back({double(i), {i * step_m, 0, phi}});
  return line;
}

void expectAllNaN(const ErrorStatistics& s) {
  for (const double value : {s.mean, s.rmse, s.median, s.p95, s.max}) EXPECT_TRUE(std::isnan(value));
}

TEST(TrajectoryError, IsZeroForTheTruthItself) {
  const auto e = trajectoryError(windingTruth(), windingTruth());
  EXPECT_EQ(e.position_m.count, 61U);
  EXPECT_EQ(e.unmatched, 0U);
  EXPECT_NEAR(e.position_m.max, 0, kExact);
  EXPECT_NEAR(e.heading_rad.max, 0, kExact);
}

TEST(TrajectoryError, WithoutAlignmentCountsWhereTheMapsFrameLies) {
  const Pose2 T_truth_map{5, 1, 0.5};
  const auto in_map = movedBy(core::inverse(T_truth_map), windingTruth());
  EXPECT_GT(trajectoryError(windingTruth(), in_map, Align::kNone).position_m.max, 1);
  const auto placed = trajectoryError(windingTruth(), in_map, Align::kNone, T_truth_map);
  EXPECT_NEAR(placed.position_m.max, 0, kExact);
  EXPECT_NEAR(placed.heading_rad.max, 0, kExact);
  EXPECT_EQ(placed.T_truth_estimate.x, 5);
}

TEST(TrajectoryError, AlignedAtTheFirstPoseGrowsFromThere) {
  Trajectory truth = straightLine(11, 1), estimate = truth;
  for (auto& stamped : estimate) stamped.pose = Pose2{7, 3, 1} * Pose2{1.1 * stamped.pose.x, 0, 0};
  const auto e = trajectoryError(truth, estimate, Align::kFirst);
  EXPECT_NEAR(e.position_m.max, 1, kExact);  // a tenth of 10 m
  EXPECT_NEAR(e.position_m.mean, 0.5, kExact);
  EXPECT_NEAR(e.heading_rad.max, 0, kExact);
  EXPECT_LT(trajectoryError(truth, estimate).position_m.max, 0.51);
}

TEST(TrajectoryError, IgnoresWhereTheEstimatesFrameLies) {
  const Pose2 T_map_world{-40, 17, 2.9};
  const auto e = trajectoryError(windingTruth(), movedBy(T_map_world, windingTruth()));
  EXPECT_NEAR(e.position_m.max, 0, kExact);
  EXPECT_NEAR(e.heading_rad.max, 0, kExact);
  const auto back = e.T_truth_estimate * T_map_world;
  EXPECT_NEAR(back.x, 0, kExact);
  EXPECT_NEAR(back.y, 0, kExact);
  EXPECT_NEAR(back.phi, 0, kExact);
}

TEST(TrajectoryError, OfALineStretchedByAFactorIsItsSpread) {
  // Positions 0..4 m estimated as 0..4.4 m: aligned at the centre, errors 0.1 * |i - 2|.
  const auto e = trajectoryError(straightLine(5, 1), straightLine(5, 1.1));
  EXPECT_NEAR(e.position_m.rmse, 0.1 * std::sqrt(2.0), kExact);
  EXPECT_NEAR(e.position_m.mean, 0.1 * 6 / 5, kExact);
  EXPECT_NEAR(e.position_m.median, 0.1, kExact);
  EXPECT_NEAR(e.position_m.max, 0.2, kExact);
}

TEST(TrajectoryError, OfOneWrongPoseOutOfFourIsWhatTheHandSays) {
  // Corners of a square, one estimated 0.4 m too far out along the diagonal (from the centre).
  const Trajectory truth = {{0, {1, 1, 0}}, {1, {-1, 1, 0}}, {2, {-1, -1, 0}}, {3, {1, -1, 0}}};
  auto estimate = truth;
  estimate[0].pose.x += 0.4, estimate[0].pose.y += 0.4;
  // The diagonal is an axis of symmetry: no rotation; the centroid shifts by 0.1 on each axis.
  const auto e = trajectoryError(truth, estimate);
  EXPECT_NEAR(e.T_truth_estimate.x, -0.1, kExact);
  EXPECT_NEAR(e.T_truth_estimate.phi, 0, kExact);
  EXPECT_NEAR(e.position_m.max, 0.3 * std::sqrt(2.0), kExact);
  EXPECT_NEAR(e.position_m.median, 0.1 * std::sqrt(2.0), kExact);
}

TEST(TrajectoryError, MeasuresHeadingsTheShortWayRound) {
  const auto e = trajectoryError(straightLine(4, 1, kPi - 0.01), straightLine(4, 1, -kPi + 0.02));
  EXPECT_NEAR(e.position_m.max, 0, kExact);
  EXPECT_NEAR(e.heading_rad.mean, 0.03, kExact);
}

TEST(TrajectoryError, OfARobotThatOnlyTurnsIsAlignedByItsFirstPose) {
  Trajectory truth, estimate;
  for (int i = 0; i < 4; ++i) {
    // Rounding errors of a nanometre, across each other: they must not give the rotation.
    truth.push_back({double(i), {5 + 1e-9 * (i % 2), 6, 0.5 + i}});
    estimate.push_back({double(i), {-1, 1e-9 * (i % 2), 0.1 * i + 1.0 * i}});
  }
  const auto e = trajectoryError(truth, estimate);
  EXPECT_NEAR(e.T_truth_estimate.phi, 0.5, kExact);
  EXPECT_NEAR(e.position_m.max, 0, 2 * kExact);
  EXPECT_NEAR(e.heading_rad.max, 0.3, kExact);
}

TEST(TrajectoryError, OfASingleMatchedPoseIsZero) {
  const auto e = trajectoryError(straightLine(3, 1), {{1, {70, 80, 1}}, {99, {0, 0, 0}}});
  EXPECT_EQ(e.position_m.count, 1U);
  EXPECT_EQ(e.unmatched, 1U);
  EXPECT_NEAR(e.position_m.max, 0, kExact);
  EXPECT_NEAR(e.heading_rad.max, 0, kExact);
  EXPECT_NEAR((e.T_truth_estimate * Pose2{70, 80, 1}).x, 1, kExact);
}

TEST(TrajectoryError, OfAStuckEstimateIsTheSpreadOfTheTruth) {
  const auto e = trajectoryError(straightLine(3, 1), straightLine(3, 0));
  EXPECT_NEAR(e.position_m.rmse, std::sqrt(2.0 / 3), kExact);
}

TEST(TrajectoryError, InterpolatesTheTruthAndCountsWhatLiesOutside) {
  const Trajectory truth = {{10, {0, 0, kPi - 0.1}}, {12, {2, 0, -kPi + 0.1}}};
  const Trajectory estimate = {
      {9.9985, {9, 9, 9}},           {9.9995, {0, 0, kPi - 0.1}},   {11, {1, 0, kPi}},
      {11.5, {1.5, 0, -kPi + 0.05}}, {12.0005, {2, 0, -kPi + 0.1}}, {12.5, {9, 9, 9}}};
  const auto e = trajectoryError(truth, estimate);
  EXPECT_EQ(e.position_m.count, 4U);
  EXPECT_EQ(e.unmatched, 2U);
  EXPECT_NEAR(e.position_m.max, 0, kExact);
  EXPECT_NEAR(e.heading_rad.max, 0, kExact);
}

TEST(TrajectoryError, IsNaNWithoutACommonStamp) {
  for (const auto& [truth, estimate] : {std::pair{straightLine(3, 1), Trajectory{}},
                                        {Trajectory{}, straightLine(3, 1)},
                                        {straightLine(3, 1), {{100, {0, 0, 0}}}}}) {
    const auto e = trajectoryError(truth, estimate);
    EXPECT_EQ(e.position_m.count, 0U);
    EXPECT_EQ(e.unmatched, estimate.size());
    expectAllNaN(e.position_m);
    expectAllNaN(e.heading_rad);
    EXPECT_FALSE(core::isFinite(e.T_truth_estimate));
  }
}

TEST(TrajectoryError, NeverLetsAPoseThatIsNotFinitePass) {
  auto estimate = windingTruth();
  estimate[30].pose.y = kNaN;
  const auto bad_position = trajectoryError(windingTruth(), estimate);
  expectAllNaN(bad_position.position_m);
  expectAllNaN(bad_position.heading_rad);
  EXPECT_EQ(bad_position.position_m.count, 61U);

  estimate = windingTruth();
  estimate[30].pose.phi = INFINITY;
  const auto bad_heading = trajectoryError(windingTruth(), estimate);
  EXPECT_NEAR(bad_heading.position_m.max, 0, kExact);
  expectAllNaN(bad_heading.heading_rad);

  auto truth = windingTruth();
  truth[30].pose.x = kNaN;
  expectAllNaN(trajectoryError(truth, windingTruth()).position_m);
  truth = windingTruth();
  truth.push_back({1.8e9, {kNaN, 0, 0}});  // long after the estimate
  expectAllNaN(trajectoryError(truth, windingTruth()).position_m);

  estimate = windingTruth();
  estimate[60].time_s = kNaN;
  expectAllNaN(trajectoryError(windingTruth(), estimate).position_m);
  expectAllNaN(relativeErrorOverTime(windingTruth(), estimate, 1).translation_m);
}

TEST(TrajectoryError, RefusesStampsThatRunBack) {
  auto shuffled = straightLine(3, 1);
  std::swap(shuffled[0], shuffled[1]);
  EXPECT_THROW(trajectoryError(straightLine(3, 1), shuffled), core::ContractError);
  EXPECT_THROW(trajectoryError(shuffled, straightLine(3, 1)), core::ContractError);
}

double sumOfSquares(const std::vector<Pose2>& truth, const std::vector<Pose2>& estimate, const Pose2& T) {
  double sum = 0;
  for (size_t i = 0; i < truth.size(); ++i) sum += std::pow(core::distance(truth[i], T * estimate[i]), 2);
  return sum;
}

/// The motion with this heading that takes the mean of `from` to the mean of `to`.
Pose2 throughCentroids(const std::vector<Pose2>& to, const std::vector<Pose2>& from, double phi) {
  Pose2 T{0, 0, phi};
  const auto n = static_cast<double>(from.size());
  double x = 0, y = 0;
  for (size_t i = 0; i < from.size(); ++i) {
    const auto turned = T * from[i];
    x += (to[i].x - turned.x) / n, y += (to[i].y - turned.y) / n;
  }
  return {x, y, phi};
}

TEST(AlignPositions, CannotBeBeatenByAGridOfOtherMotions) {
  core::RandomStream random(7, "alignment");
  for (int round = 0; round < 20; ++round) {
    std::vector<Pose2> truth, estimate;  // unrelated, so that no rotation is good
    for (int i = 0; i < 2 + round; ++i) {
      truth.push_back({random.uniform(-5, 5), random.uniform(-5, 5), 0});
      estimate.push_back({random.uniform(-5, 5), random.uniform(-5, 5), 0});
    }
    const auto best = alignPositions(truth, estimate);
    const double least = sumOfSquares(truth, estimate, best);
    std::vector<double> turns_rad = {-1e-3, -1e-4, 1e-4, 1e-3};
    for (int degrees = 0; degrees < 360; ++degrees) turns_rad.push_back(core::degToRad(degrees));
    for (const double turn_rad : turns_rad)
      for (const double dx : {-0.3, -0.001, 0.0, 0.001, 0.3})
        for (const double dy : {-0.3, -0.001, 0.0, 0.001, 0.3}) {
          Pose2 other = throughCentroids(truth, estimate, best.phi + turn_rad);
          other.x += dx, other.y += dy;
          ASSERT_GE(sumOfSquares(truth, estimate, other), least - kExact);
        }
  }
}

TEST(AlignPositions, SwappingTruthAndEstimateInvertsIt) {
  std::vector<Pose2> a = {{0, 0, 0}, {1, 0, 0}, {1, 2, 0}, {4, 1, 0}},
                     b = {{3, 1, 0}, {4, 1, 0}, {3, 3, 0}, {6, 4, 0}};
  const auto there_and_back = alignPositions(a, b) * alignPositions(b, a);
  EXPECT_NEAR(there_and_back.x, 0, kExact);
  EXPECT_NEAR(there_and_back.y, 0, kExact);
  EXPECT_NEAR(there_and_back.phi, 0, kExact);
}

TEST(AlignPositions, FallsBackToTheFirstHeadingsWhereEveryRotationIsAsGood) {
  // A square driven the other way round: dot and cross products cancel exactly.
  const std::vector<Pose2> truth = {{1, 0, 0.3}, {0, 1, 0}, {-1, 0, 0}, {0, -1, 0}};
  const std::vector<Pose2> mirrored = {{1, 0, 0.1}, {0, -1, 0}, {-1, 0, 0}, {0, 1, 0}};
  EXPECT_NEAR(alignPositions(truth, mirrored).phi, 0.2, kExact);
  EXPECT_THROW(alignPositions({}, {}), core::ContractError);
  EXPECT_THROW(alignPositions(truth, {{0, 0, 0}}), core::ContractError);
}

TEST(RelativeError, IsZeroForAnEstimateInAnotherFrame) {
  const auto moved = movedBy({9, 9, -2}, windingTruth());
  const auto by_distance = relativeErrorOverDistance(windingTruth(), moved, 1);
  EXPECT_EQ(by_distance.translation_m.count, 56U);  // 0.2 m steps: the last 5 of 61 run out
  EXPECT_NEAR(by_distance.translation_m.max, 0, kExact);
  EXPECT_NEAR(by_distance.rotation_rad.max, 0, kExact);
  const auto by_time = relativeErrorOverTime(windingTruth(), moved, 1);
  EXPECT_EQ(by_time.translation_m.count, 51U);  // 0.1 s steps
  EXPECT_NEAR(by_time.translation_m.max, 0, kExact);
}

TEST(RelativeError, OfAConstantDriftPerMetreIsThatDrift) {
  // 2 % too long, 0.01 rad per metre: over 1 m every pair says the same.
  Trajectory truth, estimate;
  Pose2 estimated;
  for (int i = 0; i <= 10; ++i) {
    truth.push_back({double(i), {double(i), 0, 0}});
    estimate.push_back({double(i), estimated});
    estimated = estimated * Pose2{1.02, 0, 0.01};
  }
  const auto e = relativeErrorOverDistance(truth, estimate, 1);
  EXPECT_EQ(e.translation_m.count, 10U);
  EXPECT_NEAR(e.translation_m.mean, 0.02, kExact);
  EXPECT_NEAR(e.translation_m.max, 0.02, kExact);
  EXPECT_NEAR(e.rotation_rad.mean, 0.01, kExact);
  EXPECT_NEAR(relativeErrorOverTime(truth, estimate, 3).rotation_rad.mean, 0.03, kExact);
  EXPECT_NEAR(relativeErrorOverDistance(truth, estimate, 2.5).rotation_rad.max, 0.03, kExact);
}

TEST(RelativeError, MeasuresDistanceAlongTheWholeTruthNotAlongTheSparseEstimate) {
  // The truth goes 1 m out and back between two estimated stamps that lie at the same place.
  const Trajectory truth = {{0, {0, 0, 0}}, {1, {1, 0, 0}}, {2, {0, 0, 0}}};
  const Trajectory estimate = {{0, {0, 0, 0}}, {2, {0.5, 0, 0}}};
  const auto e = relativeErrorOverDistance(truth, estimate, 2);
  EXPECT_EQ(e.translation_m.count, 1U);
  EXPECT_NEAR(e.translation_m.mean, 0.5, kExact);
}

TEST(RelativeError, MeasuresDistanceToBetweenTheTruthsStamps) {
  const Trajectory truth = straightLine(5, 1);
  const Trajectory estimate = {{0, {0, 0, 0}}, {0.9, {1, 0, 0}}, {4, {4.3, 0, 0}}};
  const auto e = relativeErrorOverDistance(truth, estimate, 0.9);
  EXPECT_EQ(e.translation_m.count, 2U);
  EXPECT_NEAR(e.translation_m.mean, (0.1 + 0.2) / 2, kExact);
}

TEST(RelativeError, WithoutAPairIsNaNWithCountZero) {
  for (const auto& e : {relativeErrorOverDistance(straightLine(5, 1), straightLine(5, 1), 4.1),
                        relativeErrorOverTime(straightLine(5, 1), straightLine(5, 1), 4.1),
                        relativeErrorOverTime(straightLine(5, 1), {}, 1)}) {
    EXPECT_EQ(e.translation_m.count, 0U);
    expectAllNaN(e.translation_m);
    expectAllNaN(e.rotation_rad);
  }
}

TEST(RelativeError, NeverLetsAPoseThatIsNotFinitePass) {
  auto estimate = straightLine(5, 1);
  estimate[4].pose.x = kNaN;
  expectAllNaN(relativeErrorOverDistance(straightLine(5, 1), estimate, 1).translation_m);
  auto truth = straightLine(5, 1);
  truth[4].pose.phi = kNaN;
  expectAllNaN(relativeErrorOverDistance(truth, straightLine(5, 1), 1).translation_m);
}

TEST(RelativeError, RefusesAStepThatIsNotAboveZero) {
  for (const double bad : {0.0, -1.0, kNaN, double(INFINITY)}) {
    EXPECT_THROW(relativeErrorOverDistance(straightLine(2, 1), straightLine(2, 1), bad), core::ContractError);
    EXPECT_THROW(relativeErrorOverTime(straightLine(2, 1), straightLine(2, 1), bad), core::ContractError);
  }
}

TEST(PoseAt, TakesStampsWithinAMillisecondAsTheSame) {
  const Trajectory trajectory = {{1.7e9, {0, 0, 0}}, {1.7e9 + 1, {1, 0, 0}}};
  Pose2 pose;
  ASSERT_TRUE(poseAt(trajectory, 1.7e9 + 0.001, pose));
  EXPECT_EQ(pose.x, 0);  // exactly: not interpolated
  ASSERT_TRUE(poseAt(trajectory, 1.7e9 + 0.999, pose));
  EXPECT_EQ(pose.x, 1);
  ASSERT_TRUE(poseAt(trajectory, 1.7e9 + 0.25, pose));
  EXPECT_NEAR(pose.x, 0.25, 1e-6);  // an epoch time is stored to 0.24 us
  EXPECT_FALSE(poseAt(trajectory, 1.7e9 - 0.002, pose));
  EXPECT_FALSE(poseAt(trajectory, 1.7e9 + 1.002, pose));
  EXPECT_FALSE(poseAt(trajectory, kNaN, pose));
  EXPECT_FALSE(poseAt({}, 0, pose));
}

/// Stamp, x, y and the angle, however the file states it.
Trajectory readPoses(const std::string& text, bool angle_is_quaternion) {
  Trajectory poses;
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);) {
    std::istringstream fields(line);
    double t = 0, x = 0, y = 0, z = 0, qx = 0, qy = 0, a = 0, b = 0;
    fields >> t >> x >> y;
    if (angle_is_quaternion)
      fields >> z >> qx >> qy >> a >> b;
    else
      fields >> a;
    if (fields) poses.push_back({t, {x, y, angle_is_quaternion ? 2 * std::atan2(a, b) : a}});
  }
  return poses;
}

TEST(TrajectoryError, OfTheRingOfficesOdometryIsWhatItsMakerPublished) {
  const auto data = testing::realDataFolder(RASTERSLAM_SOURCE_DIR);
  if (data.empty() || !testing::programExists("xz")) GTEST_SKIP() << "needs the folder of real data and xz";
  for (const auto& [name, ate_rmse_m] : {std::pair{"ring_A", 1.98}, {"ring_B", 3.25}}) {
    const std::string base = data + "/sim/" + name;
    if (!std::filesystem::exists(base + ".clf.xz")) GTEST_SKIP() << base << ".clf.xz is not there";
    // The line's fields: 9 of the head (the last one counts the ranges), ranges, count of remissions,
    // remissions, then the laser's pose; the stamp is the last but two.
    const auto odometry =
        testing::runCommand("xz -dc '" + base +
                            ".clf.xz' | awk '$1 == \"ROBOTLASER1\" { i = 10 + $9; j = i + $i + 1; "
                            "print $(NF - 2), $j, $(j + 1), $(j + 2) }'");
    const auto truth = readPoses(files::readTextFile(base + ".truth.tum"), true);
    const auto e = trajectoryError(truth, readPoses(odometry.out, false));
    EXPECT_EQ(e.position_m.count, 2082U);
    EXPECT_EQ(e.unmatched, 0U);
    EXPECT_NEAR(e.position_m.rmse, ate_rmse_m, 0.005);  // published with two decimals
  }
}

}  // namespace
}  // namespace slam::metrics
