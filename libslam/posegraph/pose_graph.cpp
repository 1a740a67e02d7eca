#include "libslam/posegraph/pose_graph.h"

#include <Eigen/Eigenvalues>
#include <string>

#include "libslam/core/error.h"
#include "libslam/posegraph/edge_error.h"

namespace slam::posegraph {
namespace {

/// Of the largest entry: what the last decimal of a file may leave.
constexpr double kRounding = 1e-9;

[[noreturn]] void refuse(const char* who, const std::string& what) {
  throw core::ContractError(std::string("PoseGraph::") + who + ": " + what);
}

}  // namespace

const char* informationProblem(const Eigen::Matrix3d& information) {
  if (!information.allFinite()) return "an entry that is not finite";
  const double largest = information.cwiseAbs().maxCoeff();
  if (largest == 0) return "zero";
  if ((information - information.transpose()).cwiseAbs().maxCoeff() > kRounding * largest)
    return "not symmetric";
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(information, Eigen::EigenvaluesOnly);
  if (solver.eigenvalues()[0] < -kRounding * largest) return "indefinite";
  return "";
}

int PoseGraph::addNode(const core::Pose2& T_map_node) {
  if (!core::isFinite(T_map_node)) refuse("addNode", "a pose that is not finite");
  poses_.push_back(T_map_node);
  fixed_.push_back(0);
  return nodeCount() - 1;
}

int PoseGraph::addEdge(const Edge& edge) {
  if (edge.from != kMap) requireNode(edge.from, "addEdge");
  requireNode(edge.to, "addEdge");
  if (edge.from == edge.to) refuse("addEdge", "from node " + std::to_string(edge.to) + " to itself");
  if (!core::isFinite(edge.T_from_to)) refuse("addEdge", "a measurement that is not finite");
  const std::string problem = informationProblem(edge.information);
  if (!problem.empty()) refuse("addEdge", "information matrix: " + problem);
  edges_.push_back(edge);
  return static_cast<int>(edges_.size()) - 1;
}

void PoseGraph::setFixed(int node, bool fixed) {
  requireNode(node, "setFixed");
  fixed_[static_cast<size_t>(node)] = fixed;
}

void PoseGraph::setPose(int node, const core::Pose2& T_map_node) {
  requireNode(node, "setPose");
  if (!core::isFinite(T_map_node)) refuse("setPose", "a pose that is not finite");
  poses_[static_cast<size_t>(node)] = T_map_node;
}

void PoseGraph::setOn(int edge, bool on) {
  requireEdge(edge, "setOn");
  const auto i = static_cast<size_t>(edge);
  if (edges_[i].on != on) edges_.change(i).on = on;
}

void PoseGraph::setMeasurement(int edge, const core::Pose2& T_from_to) {
  requireEdge(edge, "setMeasurement");
  if (!core::isFinite(T_from_to)) refuse("setMeasurement", "a measurement that is not finite");
  edges_.change(static_cast<size_t>(edge)).T_from_to = T_from_to;
}

const core::Pose2& PoseGraph::pose(int node) const {
  requireNode(node, "pose");
  return poses_[static_cast<size_t>(node)];
}

bool PoseGraph::isFixed(int node) const {
  requireNode(node, "isFixed");
  return fixed_[static_cast<size_t>(node)] != 0;
}

double PoseGraph::chi2() const {
  double sum = 0;
  for (const Edge& edge : edges_)
    if (edge.on) sum += edgeChi2(edge, poses_);
  return sum;
}

double PoseGraph::chi2(int edge) const {
  requireEdge(edge, "chi2");
  return edgeChi2(edges_[static_cast<size_t>(edge)], poses_);
}

void PoseGraph::requireNode(int node, const char* who) const {
  if (node < 0 || node >= nodeCount())
    refuse(who, "node " + std::to_string(node) + " of " + std::to_string(nodeCount()));
}

void PoseGraph::requireEdge(int edge, const char* who) const {
  if (edge < 0 || edge >= static_cast<int>(edges_.size()))
    refuse(who, "edge " + std::to_string(edge) + " of " + std::to_string(edges_.size()));
}

}  // namespace slam::posegraph
