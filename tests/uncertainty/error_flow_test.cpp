// How sure keyframes' poses are in the end: by hand in one dimension after the other, and by drawing errors.
#include "libslam/uncertainty/error_flow.h"

#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <cmath>

#include "libslam/core/random.h"
#include "libslam/keyframes/matching.h"
#include "libslam/keyframes/search.h"
#include "libslam/scanmatch/information.h"
#include "tests/uncertainty/pile.h"

namespace slam::uncertainty {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;
using keyframes::Inheritance;
using keyframes::KeyframeMap;
using keyframes::moved;
using scanmatch::kInformationScale;
using test_maps::diagonal;
using test_maps::kHundred;
using test_maps::kOwn;
using test_maps::matchedTo;
using test_maps::Pile;

// What the first saw errs by its points' noise, 1 / 100; that is the same for all that are matched to it.
TEST(ErrorFlow, WhatOneKeyframeSawFirstErrsForAllAlike) {
  Pile star;
  star.add({});
  for (int i = 0; i < 20; ++i) star.add(matchedTo({{0, kHundred}}, kOwn));
  for (const int k : {1, 7, 20}) EXPECT_NEAR(star.x(k), 0.01 + 0.002, 1e-9) << k;
  EXPECT_NEAR(star.between(3, 18), 2 * 0.002, 1e-9) << "their own noise alone";
  EXPECT_NEAR(star.x(0), 0, 1e-12) << "where it lies is given";
}

TEST(ErrorFlow, ErrorsGrowFromViewToView) {
  Pile chain;
  chain.add({});
  for (int k = 1; k <= 6; ++k) chain.add(matchedTo({{k - 1, kHundred}}, kOwn));
  for (const int k : {1, 2, 6}) EXPECT_NEAR(chain.x(k), k * (0.01 + 0.002), 1e-9) << k;
  EXPECT_NEAR(chain.between(2, 6), 4 * (0.01 + 0.002), 1e-9);
}

TEST(ErrorFlow, WhatAMatchLeavesIsOfThePoseBefore) {
  Pile pile;
  pile.add({});
  pile.add(matchedTo({{0, kHundred}}, kOwn));
  pile.add(matchedTo({{0, kHundred}}, kOwn, 0.75));
  // Of 1: its own noise; of what 0 saw: all, three quarters at once and a quarter by 1.
  EXPECT_NEAR(pile.x(2), 0.01 + 0.25 * 0.25 * 0.002 + 0.002, 1e-9);
}

// Along a bare corridor: of a robot that was hung on another keyframe meanwhile, it is that at which all that
// it errs by began.
TEST(ErrorFlow, WhatAMatchLeavesIsOfTheKeyframeThatItWasGatheredFrom) {
  Pile hung;
  hung.add({});
  Inheritance along;
  along.own = kOwn;
  for (int k = 1; k <= 3; ++k) hung.add(along);
  along.before = 1;
  hung.add(along);
  EXPECT_NEAR(hung.between(1, 4), 0.002, 1e-9);
  EXPECT_NEAR(hung.between(3, 4), 3 * 0.002, 1e-9) << "from which odometry's edge is";
  EXPECT_NEAR(hung.x(4), 2 * 0.002, 1e-9);
}

// A mean of two views: were it a measurement of the way between them, that way would be known the better the
// more keyframes are matched to both.
TEST(ErrorFlow, WhoIsMatchedToTwoViewsMakesThemNoSurer) {
  Pile pile;
  pile.add({});
  pile.add(matchedTo({{0, kHundred}}, kOwn));
  const double before = pile.between(0, 1);
  const Matrix3d half = 0.5 * kHundred;
  for (int i = 0; i < 10; ++i) pile.add(matchedTo({{0, half}, {1, half}}, kOwn));
  EXPECT_NEAR(pile.between(0, 1), before, 1e-9);
  // Half of each: of what 0 saw (noise 1 / 50, twice: by itself, and by way of 1), and of 1 and what it saw.
  const double of_0 = 0.25 * 0.02, of_1 = 0.25 * (0.01 + 0.002) + 0.25 * 0.02;
  const double both = 2 * 0.25 * std::sqrt(0.02 * 0.01);
  EXPECT_NEAR(pile.x(5), of_0 + of_1 + both + 0.002, 1e-9);
}

TEST(ErrorFlow, AlongAnOpenDirectionTheStepsErrorsAddUp) {
  Pile corridor;
  corridor.add({});
  for (int k = 1; k <= 4; ++k) {
    Inheritance inherited = matchedTo({{0, kHundred}}, diagonal(0.04, 0.002, 0.002));
    inherited.views[0].information = diagonal(0, 100, 100);
    inherited.gain = diagonal(0, 0.01, 0.01);
    corridor.add(inherited);
  }
  const auto covariance = ErrorFlow(corridor.map, Poses::kTracked).covariances()[4];
  EXPECT_NEAR(covariance(0, 0), 4 * 0.04, 1e-9);
  EXPECT_NEAR(covariance(1, 1), 0.01 + 0.002, 1e-9);
}

TEST(ErrorFlow, OfAKeyframeThatNothingIsKnownOfOdometryTells) {
  Pile pile;
  pile.add({});
  pile.add({});
  EXPECT_NEAR(pile.x(1), 0.01, 1e-9);
}

// What the points' residuals say of their noise is what the views err by.
TEST(ErrorFlow, ViewsErrByTheNoiseThatResidualsTell) {
  Pile pile;
  pile.add({});
  pile.add(matchedTo({{0, kHundred}}, kOwn));
  scanmatch::MatchEvidence scan;
  scan.squared = scan.pulled = 400, scan.dimensions = 100;
  pile.map.pointNoise().add(scan);
  EXPECT_NEAR(pile.x(1), 4 * 0.01 + 0.002, 1e-9);
  EXPECT_NEAR(pile.x(1, Poses::kFitted), 1 / (1 / 0.08 + 100), 1e-9) << "of both views, and odometry";
}

TEST(ErrorFlow, WhatASpinningLidarSawErrsByMore) {
  Pile pile;
  pile.add({});
  pile.add(matchedTo({{0, kHundred}}, kOwn));
  pile.map.keyframes()[0].inherited.points_err = 3;
  EXPECT_NEAR(pile.x(1), 9 * 0.01 + 0.002, 1e-9);
}

TEST(ErrorFlow, LoopsMeasureTheWayBetweenTheirEnds) {
  Pile pile;
  pile.add({});
  for (int k = 1; k <= 3; ++k) pile.add(matchedTo({{k - 1, kHundred}}, kOwn));
  posegraph::Edge loop;
  loop.from = 0, loop.to = 3, loop.kind = posegraph::EdgeKind::kLoop;
  loop.information = kInformationScale * kHundred;
  pile.map.addLoop({loop});
  // As one match of two views tells it: a variance of 2 / 100.
  EXPECT_NEAR(pile.x(3), 1 / (1 / 0.036 + 1 / 0.02), 1e-9);
  pile.map.graph().setOn(static_cast<int>(pile.map.graph().edges().size()) - 1, false);
  EXPECT_NEAR(pile.x(3), 0.036, 1e-9);
}

/// Poses 2 m and more apart that turn, each matched to some before it.
struct Wanderer : Pile {
  Wanderer() {
    core::RandomStream random(3, "wanderer");
    add({});
    for (int k = 1; k < 9; ++k) {
      std::vector<Inheritance::View> views;
      for (int v = std::max(0, k - 4); v < k; v += 1 + k % 2) {
        Matrix3d root;
        for (int i = 0; i < 9; ++i) root(i / 3, i % 3) = random.normal();
        views.push_back({v, 500 * (root * root.transpose() + 0.3 * Matrix3d::Identity())});
      }
      add(matchedTo(views, diagonal(1e-3, 2e-3, 5e-4), 0.8), {2.0 * k, std::sin(1.0 * k), 0.3 * k});
    }
  }
  /// One draw of all keyframes' errors, by the rule of Inheritance.
  std::vector<Vector3d> draw(core::RandomStream& random) const {
    const auto normal = [&] { return Vector3d(random.normal(), random.normal(), random.normal()); };
    std::vector<Vector3d> error{Vector3d::Zero()}, noise{normal()};
    for (int k = 1; k < map.size(); ++k) {
      const Inheritance& from = map.keyframe(k).inherited;
      Vector3d e = from.own.matrix().llt().matrixL() * normal();
      Matrix3d left = Matrix3d::Identity();
      for (const auto& view : from.views) {
        const Matrix3d J = moved(core::position(map.pose(view.keyframe)), core::position(map.pose(k)));
        const Matrix3d H = view.information.matrix(), of_view = J.transpose() * H * J;
        // Noise of the view's points with the covariance that is the information's inverse.
        const double length_m = std::sqrt(2 * of_view(2, 2) / of_view.topLeftCorner<2, 2>().trace());
        const Matrix3d unit = diagonal(1, 1, 1 / length_m);
        const Matrix3d root = unit * scanmatch::rootOf((unit * of_view * unit).inverse());
        const auto v = static_cast<size_t>(view.keyframe);
        e += from.gain * H * J * (error[v] + root * noise[v]);
        left -= from.gain * H;
      }
      const auto before = static_cast<size_t>(k) - 1;
      e += left * moved(core::position(map.pose(k - 1)), core::position(map.pose(k))) * error[before];
      error.push_back(e), noise.push_back(normal());
    }
    return error;
  }
};

void expectAlike(const Matrix3d& drawn, const Matrix3d& expected) {
  const Matrix3d L = expected.llt().matrixL();
  const Matrix3d alike = L.inverse() * drawn * L.inverse().transpose();
  EXPECT_LT((alike - Matrix3d::Identity()).cwiseAbs().maxCoeff(), 0.08) << drawn << "\n" << expected;
}

TEST(ErrorFlow, IsTheSpreadOfErrorsDrawnByItsRule) {
  const Wanderer wanderer;
  const ErrorFlow flow(wanderer.map, Poses::kTracked);
  const auto told = flow.covariances();
  core::RandomStream random(5, "errors");
  constexpr int kDraws = 5000;
  std::vector<Matrix3d> spread(told.size(), Matrix3d::Zero());
  Matrix3d apart = Matrix3d::Zero();
  const core::Pose2 T2 = wanderer.map.pose(2), T7 = wanderer.map.pose(7);
  const auto off = [](const core::Pose2& T, const Vector3d& e) {
    return core::Pose2{T.x + 1e-4 * e.x(), T.y + 1e-4 * e.y(), T.phi + 1e-4 * e.z()};
  };
  for (int i = 0; i < kDraws; ++i) {
    const auto errors = wanderer.draw(random);
    for (size_t k = 0; k < errors.size(); ++k) spread[k] += errors[k] * errors[k].transpose() / kDraws;
    const core::Pose2 from = core::between(T2, T7),
                      to = core::between(off(T2, errors[2]), off(T7, errors[7]));
    const Vector3d change = 1e4 * Vector3d(to.x - from.x, to.y - from.y, to.phi - from.phi);
    apart += change * change.transpose() / kDraws;
  }
  for (const size_t k : {1U, 4U, 8U}) expectAlike(spread[k], told[k]);
  expectAlike(apart, flow.relative(2, 7));
}

// A match of a view to a keyframe errs by both views' noise, and has odometry beside it.
TEST(ErrorFlow, OfFittedPosesMatchesAreMeasurements) {
  Pile pile;
  pile.add({});
  pile.add(matchedTo({{0, kHundred}}, kOwn));
  EXPECT_NEAR(pile.x(1, Poses::kFitted), 1 / (1 / 0.02 + 100), 1e-9);
  pile.map.keyframes()[0].inherited.points_err = 3;
  EXPECT_NEAR(pile.x(1, Poses::kFitted), 1 / (1 / 0.1 + 100), 1e-9) << "of a spinning lidar's view";
  pile.map.keyframes()[1].inherited.points_err = 2;
  EXPECT_NEAR(pile.x(1, Poses::kFitted), 1 / (1 / 0.13 + 100), 1e-9) << "of both views";
  // How such a lidar moved in its sweep is not known the better the more often its walls are seen.
  pile.map.keyframes()[1].noise = diagonal(0.4, 0.4, 0.4);
  EXPECT_NEAR(pile.x(1, Poses::kFitted), 1 / (1 / 0.13 + 100) + 0.75 * 0.4, 1e-9);
  EXPECT_NEAR(pile.between(0, 1, Poses::kFitted), 1 / (1 / 0.13 + 100) + 0.75 * 0.4, 1e-9);
}

TEST(ErrorFlow, OfFittedPosesWhoIsMatchedToTwoViewsMakesThemSurer) {
  Pile pile;
  pile.add({});
  pile.add(matchedTo({{0, kHundred}}, kOwn));
  const double before = pile.between(0, 1, Poses::kFitted);
  for (int i = 0; i < 10; ++i) pile.add(matchedTo({{0, kHundred}, {1, kHundred}}, kOwn));
  EXPECT_LT(pile.between(0, 1, Poses::kFitted), 0.9 * before);
  // Each lies where it saw the walls, which errs by its own points however often they are seen.
  EXPECT_GT(pile.between(0, 1, Poses::kFitted), 0.4 * before);
}

TEST(ErrorFlow, OfFittedPosesLoopsAreMeasurementsToo) {
  Pile pile;
  pile.add({});
  for (int k = 1; k <= 3; ++k) pile.add({});
  posegraph::Edge loop;
  loop.from = 0, loop.to = 3, loop.kind = posegraph::EdgeKind::kLoop;
  loop.information = kInformationScale * kHundred;
  pile.map.addLoop({loop});
  EXPECT_NEAR(pile.x(3, Poses::kFitted), 1 / (1 / 0.03 + 1 / 0.02), 1e-9);
}

/// Of a map's errors: x, y (m) and phi (rad) of all poses, then the noise of what each saw first. Dense.
Eigen::MatrixXd informationOf(const KeyframeMap& map) {
  const Eigen::Index n = map.size();
  Eigen::MatrixXd all = Eigen::MatrixXd::Zero(6 * n, 6 * n);
  using Parts = std::vector<std::pair<Eigen::Index, Matrix3d>>;
  const auto measure = [&all](const Parts& parts) {
    for (const auto& [i, J] : parts)
      for (const auto& [j, K] : parts) all.block<3, 3>(3 * i, 3 * j) += J.transpose() * K;
  };
  measure({{0, 1e6 * Matrix3d::Identity()}});
  for (Eigen::Index k = 0; k < n; ++k) measure({{n + k, Matrix3d::Identity()}});
  for (int k = 1; k < n; ++k) {
    const auto movedFrom = [&](int from) {
      return moved(core::position(map.pose(from)), core::position(map.pose(k)));
    };
    const auto& edge = map.graph().edges()[static_cast<size_t>(map.keyframe(k).odometry_edge)];
    const Matrix3d step = scanmatch::rootOf(scanmatch::turned(edge.information, -map.pose(k).phi));
    measure({{k, step}, {edge.from, -step * movedFrom(edge.from)}});
    for (const auto& view : map.keyframe(k).inherited.views) {
      const Matrix3d J = movedFrom(view.keyframe), of_view = J.transpose() * view.information.matrix() * J;
      const double length_m = std::sqrt(2 * of_view(2, 2) / of_view.topLeftCorner<2, 2>().trace());
      const Matrix3d unit = diagonal(1, 1, 1 / length_m), back = diagonal(1, 1, length_m),
                     root = (back * scanmatch::rootOf(unit * of_view * unit)).transpose();
      measure({{k, root * J.inverse()}, {view.keyframe, -root}, {n + view.keyframe, -Matrix3d::Identity()}});
    }
  }
  return all;
}

TEST(ErrorFlow, OfFittedPosesIsThatOfLeastSquares) {
  const Wanderer wanderer;
  const auto told = ErrorFlow(wanderer.map, Poses::kFitted).covariances();
  const Eigen::MatrixXd covariance = informationOf(wanderer.map).inverse();
  for (const Eigen::Index k : {1, 4, 8}) {
    const Matrix3d expected = covariance.block<3, 3>(3 * k, 3 * k);
    EXPECT_LT((told[static_cast<size_t>(k)] - expected).norm(), 1e-4 * expected.norm()) << k;
  }
}

}  // namespace
}  // namespace slam::uncertainty
