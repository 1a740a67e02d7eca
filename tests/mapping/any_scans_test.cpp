// Whatever scans and odometry come: nothing throws, and nothing that is given back is not finite.
// RASTERSLAM_DRIVES says how many drives each test tries (5000 are some 10^5 scans); by default few enough
// for every run of the tests.
#include <gtest/gtest.h>

#include <cstdlib>
#include <limits>

#include "libslam/core/error.h"
#include "libslam/graph/graph_slam.h"
#include "libslam/mapping/map_builder.h"
#include "libslam/odometry/scan_odometry.h"
#include "libslam/particles/particle_filter.h"
#include "libslam/scanmatch/correlative_search.h"
#include "libslam/scanmatch/field_matcher.h"
#include "libslam/scanmatch/information.h"
#include "libslam/scanmatch/surfel_matcher.h"
#include "tests/mapping/is_covariance.h"
#include "tests/mapping/random_scans.h"

namespace slam::mapping {
namespace {

using test::isCovariance;
using test::RandomStep;
using test::RandomSteps;

constexpr int kStepsPerDrive = 20;

int drives(int by_default) {
  const char* wanted = std::getenv("RASTERSLAM_DRIVES");
  return wanted != nullptr ? std::atoi(wanted) : by_default;
}

TEST(AnyScans, LeaveTheGraphFinite) {
  for (int drive = 0; drive < drives(60); ++drive) {
    SCOPED_TRACE(drive);
    // A leap of kilometres as well as one of metres: loops are searched for where the robot comes back.
    RandomSteps steps(static_cast<std::uint64_t>(drive), 400, drive % 2 == 0 ? 1e6 : 3);
    keyframes::GraphOptions options;
    options.refine_rounds = drive % 4;
    graph::GraphSlam graph(options);
    for (int i = 0; i < kStepsPerDrive; ++i) {
      RandomStep given = steps.next();
      // Or as if deskewed, of a lidar that takes the whole period, or says so.
      if (drive % 3 == 1)
        given.scan.deskewing = {{i % 5 == 0 ? 1e3 : 0.2, i % 2 == 0, i % 7 == 0 ? 0.0 : 1.0},
                                given.T_previous_robot,
                                0.2,
                                i % 3 == 0};
      const auto step = graph.process(given.scan, given.T_previous_robot, given.has_odometry);
      ASSERT_TRUE(core::isFinite(step.T_map_robot)) << i;
      ASSERT_TRUE(isCovariance(step.drift_covariance)) << i << "\n" << step.drift_covariance;
      ASSERT_TRUE(isCovariance(step.pose_covariance)) << i << "\n" << step.pose_covariance;
      ASSERT_TRUE(step.score >= 0 && step.score <= 1) << i << " " << step.score;
    }
    graph.finish();
    for (const auto& pose : graph.poses()) ASSERT_TRUE(core::isFinite(pose));
    for (const auto& covariance : graph.covariances()) ASSERT_TRUE(isCovariance(covariance)) << covariance;
    for (const auto& entry : graph.journal())
      ASSERT_TRUE(std::isfinite(entry.value)) << core::wordOf(entry.event);
  }
}

TEST(AnyScans, LeaveTheParticlesFinite) {
  for (int drive = 0; drive < drives(60); ++drive) {
    SCOPED_TRACE(drive);
    RandomSteps steps(static_cast<std::uint64_t>(drive), 400, 3);
    particles::ParticleFilterOptions options;
    options.count = 3, options.lost_scans = 5;
    particles::ParticleFilter filter(options, 1);
    for (int i = 0; i < kStepsPerDrive; ++i) {
      const RandomStep given = steps.next();
      const core::Pose2& move = given.T_previous_robot;
      const double xy = 0.02 + 0.1 * std::hypot(move.x, move.y), turn = 0.01 + 0.2 * std::abs(move.phi);
      std::optional<particles::Motion> motion;
      if (given.has_odometry)
        motion = particles::Motion{move, Eigen::Vector3d(xy * xy, xy * xy, turn * turn).asDiagonal()};
      const auto& step = filter.update(given.scan, motion);
      ASSERT_TRUE(core::isFinite(step.T_map_robot)) << i;
      ASSERT_TRUE(isCovariance(step.covariance)) << i << "\n" << step.covariance;
      ASSERT_TRUE(step.score >= 0 && step.score <= 1) << i << " " << step.score;
      ASSERT_TRUE(step.effective_share > 0 && step.effective_share <= 1 + 1e-9) << i;
    }
    for (const auto& entry : filter.journal())
      ASSERT_TRUE(std::isfinite(entry.value)) << core::wordOf(entry.event);
  }
}

TEST(AnyScans, LeaveEveryScanOdometryFinite) {
  for (const auto& name : odometry::scanOdometryNames())
    for (int drive = 0; drive < drives(60); ++drive) {
      SCOPED_TRACE(name + " " + std::to_string(drive));
      RandomSteps steps(static_cast<std::uint64_t>(drive), 400, 3);
      odometry::ScanOdometryOptions options;
      options.method = name;
      const auto scan_odometry = makeScanOdometry(options);
      for (int i = 0; i < kStepsPerDrive; ++i) {
        const auto motion = scan_odometry->update(steps.next().scan);
        ASSERT_TRUE(core::isFinite(motion.T_previous_current)) << i;
        const Eigen::Map<const Eigen::Matrix3d> covariance(motion.covariance.data());
        ASSERT_TRUE(isCovariance(covariance)) << i << "\n" << covariance;
      }
    }
}

TEST(AnyScans, LeaveTheMatchersFinite) {
  const scanmatch::ScanPointOptions spacing;
  scanmatch::SurfelMap surfels(0.1, 0.02);
  for (int drive = 0; drive < drives(300); ++drive) {
    SCOPED_TRACE(drive);
    RandomSteps steps(static_cast<std::uint64_t>(drive), 400, 3);
    const RandomStep first = steps.next(), second = steps.next();
    const double far_m = drive % 3 == 0 ? 1e6 : 1;
    const core::Pose2 T_start{far_m, -far_m, 0.3};
    scanmatch::PosePrior prior;
    prior.mean = T_start * second.T_previous_robot;
    if (drive % 2 == 0) prior.information.diagonal() << 1e-10, 1e4, 1;
    surfels.clear(core::position(T_start), 30);
    surfels.add(patchPoints(first.scan, spacing), T_start);
    const auto points = patchPoints(second.scan, spacing);
    const auto matched = alignToSurfels(points, surfels, prior.mean, prior, {});
    ASSERT_TRUE(core::isFinite(matched.T_map_robot));
    ASSERT_TRUE(isCovariance(matched.information)) << matched.information;

    if (far_m < 10) {
      gridmap::Grid grid{gridmap::GridOptions()};
      grid.insert(gridmap::scanRays(first.scan, {20, true}), T_start);
      const auto in_field = alignToField(surfacePoints(second.scan, spacing), grid, prior.mean, prior, {});
      ASSERT_TRUE(core::isFinite(in_field.T_map_robot));
      ASSERT_TRUE(isCovariance(in_field.information)) << in_field.information;
      ASSERT_TRUE(std::isfinite(in_field.cost) && std::isfinite(in_field.free_sigma_m));
    }

    std::vector<core::Point2> place, query;
    for (const auto& point : patchPoints(first.scan, spacing)) place.push_back(T_start * position(point));
    for (const auto& point : points) query.push_back(position(point));
    if (place.size() < 60 && query.size() < 60) {
      const scanmatch::LikelihoodPyramid pyramid(place, 0.2, 0.2, 4);
      const auto found = searchBest(pyramid, query, T_start, {1, 0.1}, 0.3);
      ASSERT_TRUE(!found || (core::isFinite(found->T_map_robot) && found->score <= 1));
    }
  }
}

TEST(AnyScans, GiveInformationWithoutNegativeEigenvaluesWhereverSurfelsAreSeen) {
  // Far along one wall without noise, as seen in every direction: rank is lost, and rounding has the last
  // word.
  scanmatch::SurfelMap map(0.1, 0.001);
  for (int turn = 0; turn < 100; ++turn) {
    const double phi = 0.063 * turn;
    std::vector<scanmatch::PatchPoint> wall;
    for (int i = -500; i <= 500; ++i) wall.push_back({static_cast<float>(0.05 * i), 15, 0.01F, 0});
    const core::Pose2 T{3, 4, phi};
    map.clear(core::position(T), 40);
    map.add(wall, T);
    const auto matched = alignToSurfels(wall, map, T, {}, {});
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> parts(matched.information, Eigen::EigenvaluesOnly);
    ASSERT_GT(parts.eigenvalues()[2], 1e6);
    ASSERT_GE(parts.eigenvalues()[0], -1e-14 * parts.eigenvalues()[2]) << turn;
    const auto edge = scanmatch::edgeInformation(matched.information, phi);
    ASSERT_STREQ(posegraph::informationProblem(edge), "") << turn;
  }
}

TEST(AnyScans, InformationOfAnyRankGivesACovariance) {
  for (const Eigen::Vector3d& diagonal :
       {Eigen::Vector3d(0, 0, 0), Eigen::Vector3d(1e9, 0, 0), Eigen::Vector3d(1e9, -1, 1),
        Eigen::Vector3d(-1, -2, -3), Eigen::Vector3d(1e-10, 1e9, 1e-10)}) {
    EXPECT_TRUE(isCovariance(scanmatch::covarianceOf(diagonal.asDiagonal()))) << diagonal.transpose();
    EXPECT_STREQ(posegraph::informationProblem(scanmatch::edgeInformation(diagonal.asDiagonal(), 0.7)), "")
        << diagonal.transpose();
  }
  const Eigen::Matrix3d sure = Eigen::Vector3d(4, 25, 100).asDiagonal();
  EXPECT_TRUE(scanmatch::covarianceOf(sure).isApprox(sure.inverse(), 1e-12));
}

}  // namespace
}  // namespace slam::mapping
