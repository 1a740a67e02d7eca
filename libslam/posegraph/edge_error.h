#pragma once
#include <Eigen/Core>
#include <vector>

#include "libslam/posegraph/pose_graph.h"

namespace slam::posegraph {

/// The error of a measurement z of b seen from a, as PoseGraph defines it.
Eigen::Vector3d edgeError(const core::Pose2& T_map_a, const core::Pose2& T_map_b, const core::Pose2& T_a_b);

Eigen::Vector3d edgeError(const Edge& edge, const std::vector<core::Pose2>& poses);
double edgeChi2(const Edge& edge, const std::vector<core::Pose2>& poses);

/// The quadratic that an edge's chi2 is near the present poses: with steps d_a, d_b added to (x, y, phi) of
/// its ends, chi2 + 2 (g_a d_a + g_b d_b) + d' H d, where H = [aa, ab; ab', bb] leaves the error's curvature
/// out (Gauss-Newton).
struct EdgeQuadratic {
  double chi2;
  Eigen::Vector3d g_a, g_b;
  Eigen::Matrix3d aa, ab, bb;
};
/// de/d(a, b), columns as in EdgeQuadratic.
Eigen::Matrix<double, 3, 6> edgeJacobian(const core::Pose2& T_map_a, const core::Pose2& T_map_b,
                                         const core::Pose2& T_a_b);
EdgeQuadratic edgeQuadratic(const core::Pose2& T_map_a, const core::Pose2& T_map_b, const Edge& edge);

}  // namespace slam::posegraph
