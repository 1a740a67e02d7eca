#pragma once
#include <Eigen/Core>
#include <vector>

#include "libslam/core/pose2.h"
#include "libslam/threads/shared_pieces.h"

namespace slam::posegraph {

/// How far an edge is trusted.
enum class EdgeKind {
  kOdometry,  ///< follows from the log's order: never switched off
  kLoop       ///< a place recognised: may be wrong, and a robust optimisation may switch it off
};

/// In Edge::from: the map's own frame, not a node. An edge from there is a prior on the pose of `to`.
inline constexpr int kMap = -1;

/// A measurement of where node `to` is, seen from node `from`.
struct Edge {
  int from = kMap, to = 0;
  core::Pose2 T_from_to;
  /// Inverse covariance of the error below; rows and columns x (m), y (m), phi (rad); symmetric, positive
  /// semidefinite, not zero.
  Eigen::Matrix3d information = Eigen::Matrix3d::Identity();
  EdgeKind kind = EdgeKind::kOdometry;
  bool on = true;  ///< false: counts for nothing
};

/// In the order in which they were added.
using Edges = threads::SharedPieces<Edge>;

/// What an optimisation works on: poses to be found, and measurements between them. Plain data with its
/// rules; see optimize() and Marginals for what can be done with it.
///
/// The error of an edge is e = (R(z)^T (R(a)^T (t_b - t_a) - t_z), angle(b) - angle(a) - angle(z) in (-pi,
/// pi]) with a, b the poses of its ends and z its measurement: T_from_to^-1 * T_from_to(estimated), which is
/// g2o's EDGE_SE2 (Kümmerle et al., "g2o: a general framework for graph optimization", ICRA 2011). Its chi2
/// is e' * information * e, and the graph's chi2 the sum over the edges that are on.
///
/// Only differences of poses are measured, so something must hold the graph in place: at least one fixed
/// node, or a prior, in each connected part.
///
/// A copy shares the edges with what it was copied from, see threads::SharedPieces.
class PoseGraph {
 public:
  /// Returns the node's number: 0, 1, 2 ... REQUIRES a finite pose (ContractError).
  int addNode(const core::Pose2& T_map_node);
  /// Returns the edge's number: 0, 1, 2 ... REQUIRES two different nodes that exist (or kMap in `from`),
  /// finite numbers, and information that is symmetric (to 1e-9 of its largest entry), not zero and not
  /// indefinite (ContractError).
  int addEdge(const Edge& edge);

  /// A fixed node keeps its pose. REQUIRES that the node exists (ContractError), as all below.
  void setFixed(int node, bool fixed = true);
  void setPose(int node, const core::Pose2& T_map_node);
  void setOn(int edge, bool on);
  /// REQUIRES a finite measurement (ContractError).
  void setMeasurement(int edge, const core::Pose2& T_from_to);

  int nodeCount() const { return static_cast<int>(poses_.size()); }
  const std::vector<core::Pose2>& poses() const { return poses_; }
  const core::Pose2& pose(int node) const;
  bool isFixed(int node) const;
  const Edges& edges() const { return edges_; }

  /// Over the edges that are on.
  double chi2() const;
  /// Of one edge, on or off, at the present poses.
  double chi2(int edge) const;

 private:
  void requireNode(int node, const char* who) const;
  void requireEdge(int edge, const char* who) const;
  std::vector<core::Pose2> poses_;
  std::vector<char> fixed_;
  Edges edges_;
};

/// What is wrong with an information matrix ("an entry that is not finite", "not symmetric", "zero",
/// "indefinite"), or "" when an edge may carry it.
const char* informationProblem(const Eigen::Matrix3d& information);

}  // namespace slam::posegraph
