#pragma once
#include <Eigen/Core>
#include <vector>

#include "libslam/posegraph/graph_system.h"
#include "libslam/posegraph/pose_graph.h"

namespace slam::posegraph {

/// Of T_a_b = T_map_a^-1 * T_map_b: of b's x, y (m) and phi (rad) as a sees them. `joint`: of both poses'
/// errors in the map's frame, rows 0-2 `a`, rows 3-5 `b`.
Eigen::Matrix3d relativeCovariance(const Eigen::Matrix<double, 6, 6>& joint, const core::Pose2& T_map_a,
                                   const core::Pose2& T_map_b);

/// How sure a graph is of its poses: covariances at its present poses, from its edges that are on.
/// First-order, so true after optimize() and for errors well below a radian. Rows and columns are x (m), y
/// (m), phi (rad).
///
/// A snapshot: later changes of the graph do not reach it.
class Marginals {
 public:
  /// Cost: that of one step of optimize(). Errors: InputError as optimize(); MethodError when the edges leave
  /// some direction of some pose open, or hold it by no more than rounding.
  explicit Marginals(const PoseGraph& graph);

  /// Of the pose in the map's frame; zero for a fixed node. Here and below: REQUIRES nodes of the graph
  /// (ContractError). Cost: one chain of the elimination tree; all() is cheaper for many.
  Eigen::Matrix3d covariance(int node) const;
  /// One per node.
  std::vector<Eigen::Matrix3d> all() const;
  /// Joint covariance of two poses: rows 0-2 `a`, rows 3-5 `b`, both in the map's frame.
  Eigen::Matrix<double, 6, 6> joint(int a, int b) const;
  /// Of both poses, see relativeCovariance().
  Eigen::Matrix3d relative(int a, int b) const;

 private:
  sparse::BlockCholesky::HalfColumn halfColumn(int node) const;
  std::vector<core::Pose2> poses_;
  GraphSystem system_;
};

}  // namespace slam::posegraph
