#include "libslam/posegraph/edge_error.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>

#include "libslam/core/random.h"

namespace slam::posegraph {
namespace {

using core::kPi;

core::Pose2 anyPose(core::RandomStream& random) {
  core::Pose2 pose;
  pose.x = random.uniform(-10, 10), pose.y = random.uniform(-10, 10), pose.phi = random.uniform(-kPi, kPi);
  return pose;
}

TEST(EdgeError, IsWhereTheEstimateIsSeenFromTheMeasurement) {
  // a looks along y; b is 2 m ahead of it, turned left by 90 degrees. Measured: 1 m ahead, 0.5 m left, turned
  // by 80.
  const core::Pose2 a{1, 1, kPi / 2}, b{1, 3, kPi}, z{1, 0.5, core::degToRad(80)};
  const Eigen::Vector3d e = edgeError(a, b, z);
  // Left over in a's frame: (1, -0.5), which the measured frame, turned by 80 degrees, sees so:
  const double c = std::cos(z.phi), s = std::sin(z.phi);
  EXPECT_NEAR(e[0], c * 1 + s * -0.5, 1e-15);
  EXPECT_NEAR(e[1], -s * 1 + c * -0.5, 1e-15);
  EXPECT_NEAR(e[2], core::degToRad(10), 1e-15);

  core::RandomStream random(1, "poses");
  for (int i = 0; i < 100; ++i) {
    const core::Pose2 p = anyPose(random), q = anyPose(random), m = anyPose(random);
    const core::Pose2 expected = core::between(m, core::between(p, q));
    const Eigen::Vector3d got = edgeError(p, q, m);
    EXPECT_NEAR(got[0], expected.x, 1e-13);
    EXPECT_NEAR(got[1], expected.y, 1e-13);
    EXPECT_NEAR(std::remainder(got[2] - expected.phi, 2 * kPi), 0, 1e-13);
  }
}

TEST(EdgeError, TakesTheShorterWayRound) {
  EXPECT_NEAR(edgeError({0, 0, 3}, {0, 0, -3}, {})[2], 2 * kPi - 6, 1e-15);
  EXPECT_NEAR(edgeError({0, 0, 3}, {0, 0, -3}, {0, 0, 2 * kPi})[2], 2 * kPi - 6, 1e-14);
}

TEST(EdgeError, ItsQuadraticHasTheSlopeAndTheJacobianThatDifferencesHave) {
  core::RandomStream random(2, "poses");
  for (int i = 0; i < 50; ++i) {
    const core::Pose2 a = anyPose(random), b = anyPose(random);
    Edge edge;
    core::Pose2 off = anyPose(random);
    edge.T_from_to = core::between(a, b) * core::Pose2{0.1 * off.x, 0.1 * off.y, 0.3 * off.phi};
    const Eigen::Matrix3d root = Eigen::Matrix3d::NullaryExpr([&] { return random.uniform(-1, 1); });
    edge.information = root * root.transpose() + Eigen::Matrix3d::Identity();

    Eigen::Matrix<double, 3, 6> J;
    constexpr double kStep = 1e-6;
    for (int k = 0; k < 6; ++k) {
      const auto shifted = [&](double by) {
        core::Pose2 p = a, q = b;
        double* const numbers[] = {&p.x, &p.y, &p.phi, &q.x, &q.y, &q.phi};
        *numbers[k] += by;
        return edgeError(p, q, edge.T_from_to);
      };
      J.col(k) = (shifted(kStep) - shifted(-kStep)) / (2 * kStep);
    }
    // Central differences of numbers about 10 lose 1e-16 * 10 / 1e-6.
    constexpr double kTolerance = 1e-8;
    EXPECT_LT((edgeJacobian(a, b, edge.T_from_to) - J).cwiseAbs().maxCoeff(), kTolerance);

    const Eigen::Vector3d e = edgeError(a, b, edge.T_from_to);
    const EdgeQuadratic q = edgeQuadratic(a, b, edge);
    EXPECT_NEAR(q.chi2, e.dot(edge.information * e), 1e-12 * q.chi2);
    Eigen::Matrix<double, 6, 1> gradient;
    gradient << q.g_a, q.g_b;
    const double scale = J.norm() * J.norm() * edge.information.norm();
    EXPECT_LT((gradient - J.transpose() * (edge.information * e)).norm(), kTolerance * scale);
    Eigen::Matrix<double, 6, 6> hessian;
    hessian << q.aa, q.ab, q.ab.transpose(), q.bb;
    EXPECT_LT((hessian - J.transpose() * edge.information * J).norm(), kTolerance * scale);
  }
}

}  // namespace
}  // namespace slam::posegraph
