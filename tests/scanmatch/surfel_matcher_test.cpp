#include "libslam/scanmatch/surfel_matcher.h"

#include <gtest/gtest.h>

#include <cmath>
#include <utility>
#include <vector>

#include "libslam/scanmatch/scan_points.h"
#include "tests/scanmatch/drawn_rooms.h"
#include "tests/scanmatch/drawn_surfels.h"

namespace slam::scanmatch {
namespace {

using scanmatch_test::aFewPosesAround;
using scanmatch_test::Lidar;
using scanmatch_test::look;
using scanmatch_test::mapOf;
using scanmatch_test::rectangle;
using scanmatch_test::Wall;

TEST(SurfelMatcher, TheEvidenceIsTheInformationByTheViewsThatSawFirst) {
  core::RandomStream chance(2, "lidar");
  const auto room = rectangle(-4, -3, 5, 3);
  SurfelMap map(0.1, 0.03, true);
  map.clear({}, 30);
  const core::Pose2 back{0, 0, core::kPi};
  for (int i = 0; i < 4; ++i) map.add(patchPoints(look(room, back, {}, chance), {}), back, 1);
  for (int i = 0; i < 4; ++i) map.add(patchPoints(look(room, {}, {}, chance), {}), {}, 2);
  const auto points = patchPoints(look(room, {}, {}, chance), {});
  const auto evidence = evidenceOf(points, map, {}, 3);
  PosePrior flat;
  flat.information.setIdentity();
  MatchOptions once;
  once.max_iterations = 1;
  const auto matched = alignToSurfels(points, map, {}, flat, once);
  const Eigen::Matrix3d sum = evidence.information();
  EXPECT_TRUE(sum.isApprox(matched.information, 0.03)) << sum << "\n\n" << matched.information;
  // What lies behind was seen first by the view that looked back, what lies ahead by the other alone.
  ASSERT_EQ(evidence.by_view.size(), 2U);
  EXPECT_EQ(evidence.by_view[0].view, 1);
  EXPECT_EQ(evidence.by_view[1].view, 2);
  EXPECT_GT(evidence.by_view[1].information.trace(), 5 * evidence.by_view[0].information.trace());
}

// A stiff prior gives way by the pull over its stiffness.
TEST(SurfelMatcher, TheEvidencesSlopeIsThatOfThePull) {
  core::RandomStream chance(5, "lidar");
  const auto room = rectangle(-4, -3, 5, 3);
  Lidar lidar;
  lidar.noise_m = 0.03;
  SurfelMap map(0.1, 0.01, true);
  map.clear({}, 30);
  for (int i = 0; i < 30; ++i) map.add(patchPoints(look(room, {}, lidar, chance), {}), {}, i);
  MatchOptions once;
  once.max_iterations = 1;
  constexpr double kStiff = 1e12, kBeside_m = 1e-3;
  const auto pullAt = [&](const std::vector<PatchPoint>& points, const core::Pose2& T) {
    PosePrior stiff;
    stiff.mean = T;
    stiff.information = kStiff * Eigen::Matrix3d::Identity();
    const auto moved = alignToSurfels(points, map, T, stiff, once).T_map_robot;
    return Eigen::Vector2d(kStiff * (moved.x - T.x), kStiff * (moved.y - T.y));
  };
  Eigen::Vector2d slope(0, 0), by_slope(0, 0), by_weights(0, 0);
  for (int i = 0; i < 50; ++i) {
    const auto points = patchPoints(look(room, {}, lidar, chance), {});
    slope.x() +=
        (pullAt(points, {-kBeside_m, 0, 0}) - pullAt(points, {kBeside_m, 0, 0})).x() / (2 * kBeside_m);
    slope.y() +=
        (pullAt(points, {0, -kBeside_m, 0}) - pullAt(points, {0, kBeside_m, 0})).y() / (2 * kBeside_m);
    const auto evidence = evidenceOf(points, map, {}, 3);
    by_slope += evidence.slope().diagonal().head<2>();
    by_weights += evidence.information().diagonal().head<2>();
  }
  for (int axis = 0; axis < 2; ++axis) {
    EXPECT_GT(by_weights(axis), 1.3 * slope(axis));
    // What is left: points that fall into the next cell are pulled by that one's surfel.
    EXPECT_LT(by_slope(axis), 1.35 * slope(axis));
    EXPECT_GT(by_slope(axis), 1.05 * slope(axis));
    EXPECT_LT(by_slope(axis), 0.9 * by_weights(axis));
  }
}

/// Walls next to parallel to an axis: along them a surfel, rounded, may tell less than nothing.
TEST(SurfelMatcher, TheEvidenceOfFlatWallsIsFinite) {
  for (int tilt = 1; tilt <= 40; ++tilt) {
    const double slope = 1e-6 * tilt;
    const auto wall = [&](double from_m) {
      std::vector<PatchPoint> points;
      for (int i = 0; i < 100; ++i) {
        const double x = from_m + 0.02 * i, y = 0.02 + slope * x;
        points.push_back(
            {static_cast<float>(x), static_cast<float>(y), 0.006F, static_cast<float>(0.006 * slope)});
      }
      return points;
    };
    SurfelMap map(0.1, 0.02, true);
    map.clear({}, 3);
    map.add(wall(-1), {}, 1);
    for (int step = 0; step < 40; ++step) {
      const auto evidence = evidenceOf(wall(-1 + 0.0007 * step), map, {}, 3);
      EXPECT_GE(evidence.squared, 0);
      for (const double lagged : evidence.lagged) ASSERT_TRUE(std::isfinite(lagged)) << tilt << " " << step;
    }
  }
}

TEST(SurfelMatcher, TheEvidenceTellsNoiseFromWhatNeighbouringPointsHaveInCommon) {
  const auto room = rectangle(-4, -3, 5, 3);
  const auto map = mapOf(room, aFewPosesAround(0));
  core::RandomStream chance(3, "lidar");
  const auto look_at = [&](double noise_m) {
    Lidar lidar;
    lidar.noise_m = noise_m;
    return patchPoints(look(room, {}, lidar, chance), {});
  };
  const auto fine = evidenceOf(look_at(0.01), map, {}, 3), rough = evidenceOf(look_at(0.02), map, {}, 3);
  EXPECT_NEAR(rough.squared / rough.dimensions / (fine.squared / fine.dimensions), 4, 1.2);
  EXPECT_LT(std::abs(rough.lagged[0]), 0.3 * rough.squared);
  // A pose that is off by 5 cm: neighbours agree.
  const auto off = evidenceOf(look_at(0.01), map, {0.05, 0, 0}, 3);
  for (const double lagged : off.lagged) EXPECT_GT(lagged, 0.5 * off.squared);
}

// From which side a point is seen is asked in the map's axes: otherwise its wall would be seen from behind.
TEST(SurfelMatcher, AWallIsTheSameWhicheverWayTheRobotLooks) {
  std::vector<PatchPoint> wall;
  for (int i = -20; i <= 20; ++i) wall.push_back({0.1F * static_cast<float>(i) + 0.05F, 2.05F, -0.03F, 0});
  SurfelMap map(0.1, 0.02, true);
  map.clear({}, 5);
  map.add(wall, {});
  PosePrior none;
  MatchOptions once;
  once.max_iterations = 1;
  const double told = alignToSurfels(wall, map, {}, none, once).information(1, 1);
  ASSERT_GT(told, 0);
  for (const double phi : {0.7, 1.5, 2.5, -1.2}) {
    const core::Pose2 T{0, 0, phi};
    std::vector<PatchPoint> seen;
    for (const auto& point : wall) seen.push_back(core::inverse(T) * point);
    EXPECT_NEAR(alignToSurfels(seen, map, T, none, once).information(1, 1), told, 1e-3 * told) << phi;
  }
}

TEST(SurfelMap, IsNotHeldAlongAWallByWhereAFewBeamsStruckIt) {
  // One scan: at x = 6 its beams strike the wall 30 cm apart, each in a cell of its own.
  const auto map = mapOf(rectangle(-100, -1, 100, 1), {core::Pose2{}, {0.01, 0, 0}});
  int struck = 0;
  for (double x = 5; x < 7; x += 0.05) {
    const Surfel* surfel = map.at(x - map.origin().x, 1 - map.origin().y);
    if (surfel == nullptr) continue;
    ++struck;
    EXPECT_LT(surfel->xx, 0.1 * surfel->yy) << x;
  }
  EXPECT_GT(struck, 2);
}

TEST(SurfelMatcher, FindsADisplacedRoomToMillimetres) {
  const auto walls = rectangle(-4, -3, 5, 3);
  const auto map = mapOf(walls, aFewPosesAround(0));
  core::RandomStream chance(7, "scan");
  for (int i = 0; i < 20; ++i) {
    const core::Pose2 truth{0.03 * i, -0.2 + 0.02 * i, 0.3 * i};
    const auto points = patchPoints(look(walls, truth, {}, chance), {});
    const core::Pose2 start{truth.x + 0.06, truth.y - 0.05, truth.phi + 0.02};
    PosePrior flat;
    flat.mean = start;
    flat.information.setIdentity();
    const auto result = alignToSurfels(points, map, start, flat, {});
    // 1 cm of noise over some hundred points, and surfels of a dozen scans.
    EXPECT_LT(core::distance(result.T_map_robot, truth), 0.006) << i;
    EXPECT_LT(std::abs(core::angleDifference(result.T_map_robot.phi, truth.phi)), 0.003) << i;
    EXPECT_GT(result.score, 0.8) << i;
  }
}

TEST(SurfelMatcher, StaysWithOdometryAlongACorridorAndSaysThatItKnowsNothingThere) {
  const auto walls = rectangle(-200, -1, 200, 1);
  const auto map = mapOf(walls, aFewPosesAround(0));
  core::RandomStream chance(7, "scan");
  const auto points = patchPoints(look(walls, {0.5, 0.1, 0}, {}, chance), {});
  PosePrior odometry;
  odometry.mean = {0.42, 0.05, 0.01};
  odometry.information.diagonal() << 2500, 2500, 1e4;
  const auto result = alignToSurfels(points, map, odometry.mean, odometry, {});
  EXPECT_NEAR(result.T_map_robot.x, 0.42, 0.01);
  EXPECT_NEAR(result.T_map_robot.y, 0.1, 0.01);
  EXPECT_NEAR(result.T_map_robot.phi, 0, 0.003);
  EXPECT_LT(result.information(0, 0), 0.05 * result.information(1, 1));
}

// The directions of a wall's surfels err, and each seems to hold the scan a little.
TEST(SurfelMatcher, TheEvidenceOfABareCorridorIsNothingAlongIt) {
  const auto walls = rectangle(-200, -1, 200, 1);
  double feigned = 0, told = 0, across = 0;
  for (std::uint64_t seed = 1; seed <= 8; ++seed) {
    core::RandomStream chance(seed, "scans");
    SurfelMap map(0.1, 0.02, true);
    map.clear({}, 30);
    for (int i = -4; i <= 4; ++i) {
      const core::Pose2 T{0.3 * i, 0.01 * i, 0};
      map.add(patchPoints(look(walls, T, {}, chance), {}), T);
    }
    const auto points = patchPoints(look(walls, {0.1, 0, 0}, {}, chance), {});
    PosePrior flat;
    flat.mean = {0.1, 0, 0};
    flat.information = 1e6 * Eigen::Matrix3d::Identity();
    feigned += alignToSurfels(points, map, flat.mean, flat, {}).information(0, 0);
    const auto information = evidenceOf(points, map, flat.mean, 3).information();
    told += information(0, 0), across += information(1, 1);
  }
  EXPECT_GT(feigned, 1e-4 * across);
  EXPECT_LT(told, 0.1 * feigned);
  EXPECT_GT(told, -3e-4 * across);
}

TEST(SurfelMatcher, LetsGoOfOdometryThatContradictsTheScanOnlyWithAKernel) {
  const auto walls = rectangle(-4, -3, 5, 3);
  const auto map = mapOf(walls, aFewPosesAround(0));
  core::RandomStream chance(7, "scan");
  const auto points = patchPoints(look(walls, {}, {}, chance), {});
  PosePrior odometry;
  odometry.mean = {0, 0, 0.1};
  odometry.information.diagonal() << 2500, 2500, 1e6;
  MatchOptions options;
  options.information_scale = 0.2;
  const auto held = alignToSurfels(points, map, {}, odometry, options);
  options.prior_kernel = 2;
  const auto free = alignToSurfels(points, map, {}, odometry, options);
  EXPECT_GT(held.T_map_robot.phi, 0.03);
  // What has let go must not make the answer look surer.
  EXPECT_GT(held.posterior_information(2, 2) - held.information(2, 2), 0.99e6);
  EXPECT_LT(free.posterior_information(2, 2) - free.information(2, 2), 0.01e6);
  EXPECT_NEAR(free.T_map_robot.phi, 0, 0.004);
}

TEST(SurfelMatcher, GivesUpOnlyScoresThatAreNotWanted) {
  const auto walls = rectangle(-4, -3, 5, 3);
  const auto map = mapOf(walls, aFewPosesAround(0));
  core::RandomStream chance(5, "scores");
  const auto points = patchPoints(look(walls, {}, {}, chance), {});
  int given_up = 0;
  for (int i = 0; i < 300; ++i) {
    // Some poses lie so far off that much falls outside of the map.
    const core::Pose2 T{chance.uniform(-1, 1) + (i % 10 == 0 ? 28 : 0), chance.uniform(-1, 1),
                        chance.uniform(-1, 1)};
    const double score = surfelScore(points, map, T, 3, 2), least = chance.uniform(0, 1);
    const double other = surfelScore(points, map, T, 3, 2, least);
    if (score > least) {
      EXPECT_EQ(other, score);
    } else {
      EXPECT_LE(other, least);
      given_up += other != score;
    }
  }
  EXPECT_GT(given_up, 50);
}

TEST(SurfelMatcher, ScoresNothingWhereThereIsNoMap) {
  SurfelMap map(0.1, 0.03);
  map.clear({}, 10);
  const std::vector<PatchPoint> points = {{1, 0}, {0, 1}};
  PosePrior prior;
  prior.mean = {0.1, 0.2, 0.3};
  prior.information.setIdentity();
  const auto result = alignToSurfels(points, map, prior.mean, prior, {});
  EXPECT_EQ(result.score, 0);
  EXPECT_NEAR(result.T_map_robot.x, 0.1, 1e-9);
  EXPECT_EQ(alignToSurfels({}, map, prior.mean, prior, {}).score, 0);
}

}  // namespace
}  // namespace slam::scanmatch
