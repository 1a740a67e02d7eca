#pragma once
#include <Eigen/Core>
#include <Eigen/LU>
#include <vector>

#include "libslam/uncertainty/error_flow.h"
#include "tests/keyframes/drawn_map.h"

/// Maps whose keyframes inherit what a test wants them to.
namespace slam::uncertainty::test_maps {

using keyframes::Inheritance;
using keyframes::test_maps::diagonal;

/// Of a match to these views that takes over all that they say, or the given share of it.
inline Inheritance matchedTo(const std::vector<Inheritance::View>& views, const Eigen::Matrix3d& own,
                             double taken = 1) {
  Eigen::Matrix3d all = Eigen::Matrix3d::Zero();
  for (const auto& view : views) all += view.information.matrix();
  Inheritance inherited;
  inherited.views = views;
  inherited.gain = taken * all.inverse();
  inherited.own = own;
  return inherited;
}

/// Keyframes in one place, so that no turn shows as a shift, each reached from the one before by odometry of
/// 10 cm and 10 mrad.
struct Pile {
  keyframes::KeyframeMap map{keyframes::GraphOptions{}};
  int add(const Inheritance& inherited, const core::Pose2& T = {}) {
    const int k = map.size();
    keyframes::test_maps::addKeyframe(map, T, keyframes::test_maps::roundRoom(5), k, -1);
    map.keyframes().back().inherited = inherited;
    if (k == 0) return k;
    posegraph::Edge edge;
    edge.from = k - 1, edge.to = k, edge.T_from_to = core::between(map.pose(k - 1), T);
    edge.information = diagonal(100, 100, 1e4);
    map.keyframes().back().odometry_edge = map.graph().addEdge(edge);
    return k;
  }
  double x(int k, Poses poses = Poses::kTracked) const {
    return ErrorFlow(map, poses).covariances()[static_cast<size_t>(k)](0, 0);
  }
  double between(int a, int b, Poses poses = Poses::kTracked) const {
    return ErrorFlow(map, poses).relative(a, b)(0, 0);
  }
};

inline const Eigen::Matrix3d kHundred = diagonal(100, 100, 100), kOwn = diagonal(0.002, 0.002, 0.002);

}  // namespace slam::uncertainty::test_maps
