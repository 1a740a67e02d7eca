// Errors that are drawn from how they hang together, at once and keyframe by keyframe.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>

#include "tests/uncertainty/pile.h"

namespace slam::uncertainty {
namespace {

using Eigen::Matrix3d;
using keyframes::Inheritance;
using test_maps::diagonal;
using test_maps::kHundred;
using test_maps::kOwn;
using test_maps::matchedTo;
using test_maps::Pile;

/// A way with views before, odometry alone, and a loop.
Pile windingWay() {
  Pile pile;
  pile.add({});
  for (int k = 1; k < 12; ++k) {
    Inheritance inherited =
        matchedTo({{k - 1, diagonal(60, 90, 200)}, {std::max(k - 4, 0), kHundred}}, kOwn, 0.8);
    if (k == 5) inherited = {};
    inherited.points_err = k % 3 == 0 ? 2 : 1;
    pile.add(inherited, {0.7 * k, 0.1 * k * k, 0.2 * k});
  }
  posegraph::Edge loop;
  loop.from = 1, loop.to = 11, loop.T_from_to = core::between(pile.map.pose(1), pile.map.pose(11));
  loop.information = diagonal(400, 300, 900), loop.kind = posegraph::EdgeKind::kLoop;
  pile.map.addLoop({loop});
  return pile;
}

// Who alone is matched to a view has its noise to itself anyhow.
TEST(DrawnErrors, NoiseApartIsAddedToEachMatch) {
  Pile chain, star;
  chain.add({}), star.add({});
  for (int k = 1; k <= 4; ++k)
    chain.add(matchedTo({{k - 1, kHundred}}, kOwn)), star.add(matchedTo({{0, kHundred}}, kOwn));
  const auto apart = [](const Pile& pile) {
    return ErrorFlow(ErrorSources(pile.map), pile.map.graph().poses(), Poses::kTracked, ViewNoise::kApart);
  };
  EXPECT_NEAR(apart(chain).covariances()[4](0, 0), chain.x(4), 1e-9);
  EXPECT_NEAR(apart(star).covariances()[4](0, 0), star.x(4), 1e-9);
  EXPECT_NEAR(apart(star).relative(2, 3)(0, 0), 2 * (0.01 + 0.002), 1e-9)
      << "and not what they have in common";
}

TEST(DrawnErrors, DrawsHaveItsCovariances) {
  const Pile pile = windingWay();
  const ErrorFlow flow(ErrorSources(pile.map), pile.map.graph().poses(), Poses::kTracked, ViewNoise::kApart);
  constexpr int kTimes = 100;
  Matrix3d of_pose = Matrix3d::Zero(), of_way = Matrix3d::Zero();
  for (int time = 0; time < kTimes; ++time) {
    std::vector<keyframes::ErrorSamples> errors(static_cast<size_t>(pile.map.size()));
    for (size_t k = 1; k < errors.size(); ++k)
      errors[k].addNew(Matrix3d::Identity(), 1000 * static_cast<std::uint64_t>(time) + k);
    for (int piece = 0; piece < ErrorFlow::kPieces; ++piece) flow.draw(errors, piece);
    EXPECT_EQ(errors[0].covariance(), Matrix3d::Zero());
    of_pose += errors[7].covariance() / kTimes;
    of_way += wayCovariance(errors[4], pile.map.pose(4), errors[9], pile.map.pose(9)) / kTimes;
  }
  const double larger = keyframes::ErrorSamples::kCount / (keyframes::ErrorSamples::kCount - 4.0);
  const Matrix3d pose = larger * flow.covariances()[7], way = larger * flow.relative(4, 9);
  EXPECT_LT((of_pose - pose).norm(), 0.05 * pose.norm());
  EXPECT_LT((of_way - way).norm(), 0.05 * way.norm());
}

// Drawn keyframe by keyframe they are the same, where points have no noise.
TEST(DrawnErrors, WhatIsInheritedOneByOneHasItsCovariances) {
  Pile pile;
  pile.add({});
  for (int k = 1; k < 9; ++k) {
    Inheritance inherited =
        matchedTo({{k - 1, 1e6 * diagonal(60, 90, 200)}, {std::max(k - 4, 0), 1e6 * kHundred}}, kOwn, 0.8);
    if (k == 5) inherited = {};
    if (k == 7) inherited.before = 3;
    pile.add(inherited, {0.7 * k, 0.1 * k * k, 0.2 * k});
  }
  constexpr int kTimes = 100;
  Matrix3d of_pose = Matrix3d::Zero(), of_way = Matrix3d::Zero();
  for (int time = 0; time < kTimes; ++time) {
    for (int k = 1; k < 9; ++k)
      pile.map.setErrors(
          k, inheritedErrors(pile.map, k,
                             1000 * static_cast<std::uint64_t>(time + 1) + static_cast<std::uint64_t>(k)));
    of_pose += pile.map.errorsOf(8).covariance() / kTimes;
    of_way += wayCovariance(pile.map.errorsOf(4), pile.map.pose(4), pile.map.errorsOf(8), pile.map.pose(8)) /
              kTimes;
  }
  const double larger = keyframes::ErrorSamples::kCount / (keyframes::ErrorSamples::kCount - 4.0);
  const ErrorFlow flow(pile.map, Poses::kTracked);
  const Matrix3d pose = larger * flow.covariances()[8], way = larger * flow.relative(4, 8);
  EXPECT_LT((of_pose - pose).norm(), 0.05 * pose.norm());
  EXPECT_LT((of_way - way).norm(), 0.05 * way.norm());
}

// Of a map that grew and moved since nothing comes in.
TEST(DrawnErrors, SourcesAreACopy) {
  Pile pile = windingWay();
  const ErrorSources sources(pile.map);
  const auto poses = pile.map.graph().poses();
  const auto before = ErrorFlow(pile.map, Poses::kTracked).relative(3, 10);
  pile.add(matchedTo({{2, kHundred}}, kOwn));
  pile.map.keyframes()[6].inherited = {};
  pile.map.graph().setPose(4, {9, 9, 1});
  EXPECT_EQ(ErrorFlow(sources, poses, Poses::kTracked, ViewNoise::kShared).relative(3, 10), before);
}

}  // namespace
}  // namespace slam::uncertainty
