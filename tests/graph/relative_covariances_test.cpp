#include <gtest/gtest.h>

#include <cmath>
#include <utility>

#include "libslam/graph/graph_slam.h"
#include "tests/graph/drawn_drives.h"

namespace slam::graph {
namespace {

using test_drives::drive;
using test_drives::lapsAround;
using test_drives::ring;

TEST(RelativeCovariances, SayHowSurePosesAreOfOneAnother) {
  const auto log = drive(ring(), lapsAround(1), {}, 0);
  GraphSlam graph{keyframes::GraphOptions()};
  for (size_t i = 0; i < log.scans.size(); ++i) graph.process(log.scans[i], log.increments[i], true);
  graph.finish();
  const auto poses = graph.poses();
  const int last = static_cast<int>(poses.size()) - 1;
  EXPECT_TRUE(graph.relativeCovariances({}).empty());
  // As the first pose, which is given, sees the others, so the map does.
  const auto of_map = graph.covariances();
  const auto of_first = graph.relativeCovariances({{0, 17}, {0, last}});
  for (const auto& [seen, scan] : {std::pair(of_first[0], 17), {of_first[1], last}}) {
    const Eigen::Matrix3d& expected = of_map[static_cast<size_t>(scan)];
    EXPECT_LT((seen - expected).cwiseAbs().maxCoeff(), 1e-6 * expected.cwiseAbs().maxCoeff()) << scan;
  }
  // To and fro it is the same.
  for (const auto& [a, b] : {std::pair(5, 6), {8, 31}, {13, last}, {last, 40}}) {
    const auto told = graph.relativeCovariances({{a, b}, {b, a}});
    const core::Pose2 T = core::between(poses[static_cast<size_t>(a)], poses[static_cast<size_t>(b)]);
    const double s = std::sin(T.phi), c = std::cos(T.phi);
    Eigen::Matrix3d J;  // of the inverse
    J << -c, -s, s * T.x - c * T.y, s, -c, c * T.x + s * T.y, 0, 0, -1;
    const Eigen::Matrix3d back = J * told[0] * J.transpose();
    EXPECT_LT((back - told[1]).cwiseAbs().maxCoeff(), 1e-6 * back.cwiseAbs().maxCoeff()) << a << ", " << b;
  }
}

}  // namespace
}  // namespace slam::graph
