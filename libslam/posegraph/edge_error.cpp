#include "libslam/posegraph/edge_error.h"

#include "libslam/core/elementary.h"

namespace slam::posegraph {
namespace {

/// R(a z)^T as cosine and sine, and t_b - t_a.
struct Geometry {
  double c, s, dx, dy;
};

Geometry geometryOf(const core::Pose2& a, const core::Pose2& b, const core::Pose2& z) {
  return {core::cos(a.phi + z.phi), core::sin(a.phi + z.phi), b.x - a.x, b.y - a.y};
}

Eigen::Vector3d errorOf(const Geometry& g, const core::Pose2& a, const core::Pose2& b, const core::Pose2& z) {
  const auto [sz, cz] = core::sinCos(z.phi);
  return {g.c * g.dx + g.s * g.dy - (cz * z.x + sz * z.y), g.c * g.dy - g.s * g.dx - (cz * z.y - sz * z.x),
          core::wrapToPi(b.phi - a.phi - z.phi)};
}

}  // namespace

Eigen::Vector3d edgeError(const core::Pose2& T_map_a, const core::Pose2& T_map_b, const core::Pose2& T_a_b) {
  return errorOf(geometryOf(T_map_a, T_map_b, T_a_b), T_map_a, T_map_b, T_a_b);
}

Eigen::Vector3d edgeError(const Edge& edge, const std::vector<core::Pose2>& poses) {
  const core::Pose2 a = edge.from == kMap ? core::Pose2() : poses[static_cast<size_t>(edge.from)];
  return edgeError(a, poses[static_cast<size_t>(edge.to)], edge.T_from_to);
}

double edgeChi2(const Edge& edge, const std::vector<core::Pose2>& poses) {
  const Eigen::Vector3d e = edgeError(edge, poses);
  return e.dot(edge.information * e);
}

Eigen::Matrix<double, 3, 6> edgeJacobian(const core::Pose2& T_map_a, const core::Pose2& T_map_b,
                                         const core::Pose2& T_a_b) {
  const auto [c, s, dx, dy] = geometryOf(T_map_a, T_map_b, T_a_b);
  Eigen::Matrix<double, 3, 6> J;
  J << -c, -s, c * dy - s * dx, c, s, 0, s, -c, -c * dx - s * dy, -s, c, 0, 0, 0, -1, 0, 0, 1;
  return J;
}

EdgeQuadratic edgeQuadratic(const core::Pose2& T_map_a, const core::Pose2& T_map_b, const Edge& edge) {
  const Geometry g = geometryOf(T_map_a, T_map_b, edge.T_from_to);
  const Eigen::Vector3d e = errorOf(g, T_map_a, T_map_b, edge.T_from_to);
  // de/db = B = blockdiag(R(a z)^T, 1), and de/da = -B M with M = [1, 0, -dy; 0, 1, dx; 0, 0, 1].
  Eigen::Matrix3d B;
  B << g.c, g.s, 0, -g.s, g.c, 0, 0, 0, 1;
  const Eigen::Vector3d We = edge.information * e;
  EdgeQuadratic q;
  q.chi2 = e.dot(We);
  q.bb.noalias() = B.transpose() * (edge.information * B);
  q.g_b.noalias() = B.transpose() * We;
  // ab = -M' bb, aa = M' bb M, g_a = -M' g_b: M' adds dx times row 1 less dy times row 0 to row 2.
  q.ab = -q.bb;
  q.ab.row(2) -= g.dx * q.bb.row(1) - g.dy * q.bb.row(0);
  q.aa = -q.ab;
  q.aa.col(2) -= g.dx * q.ab.col(1) - g.dy * q.ab.col(0);
  q.g_a = -q.g_b;
  q.g_a[2] -= g.dx * q.g_b[1] - g.dy * q.g_b[0];
  return q;
}

}  // namespace slam::posegraph
