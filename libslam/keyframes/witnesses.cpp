#include <algorithm>

#include "libslam/keyframes/keyframe_map.h"
#include "libslam/keyframes/matching.h"
#include "libslam/keyframes/search.h"
#include "libslam/posegraph/marginals.h"
#include "libslam/scanmatch/information.h"

namespace slam::keyframes {

using core::Point2;
using core::Pose2;

Eigen::Matrix3d moved(const Point2& from, const Point2& to) {
  Eigen::Matrix3d J = Eigen::Matrix3d::Identity();
  J(0, 2) = from.y - to.y, J(1, 2) = to.x - from.x;
  return J;
}

void PointNoise::add(const scanmatch::MatchEvidence& evidence) {
  squared_ += evidence.squared, dimensions_ += evidence.dimensions;
  for (size_t lag = 0; lag < lagged_.size(); ++lag) lagged_[lag] += evidence.lagged[lag];
}

/// With what neighbouring points have in common (Newey and West, Econometrica 55, 1987: triangular weights
/// keep it positive).
double PointNoise::variance() const {
  if (!(dimensions_ > 0) || !(squared_ > 0)) return 1;
  const double lags = static_cast<double>(lagged_.size()) + 1;
  double common = 1;
  for (size_t lag = 0; lag < lagged_.size(); ++lag)
    common += 2 * (1 - static_cast<double>(lag + 1) / lags) * lagged_[lag] / squared_;
  return squared_ / dimensions_ * std::max(common, 1.0);
}

Known KeyframeMap::knownFrom(int k) const {
  if (keyframe(k).matched_to >= 0) return {keyframe(k).matched_to, keyframe(k).information};
  const posegraph::Edge& edge = graph_.edges()[static_cast<size_t>(keyframe(k).odometry_edge)];
  return {edge.from, edge.information};
}

Witnesses KeyframeMap::witnesses() const {
  Witnesses result;
  result.known.reserve(keyframes_.size());
  for (int k = 1; k < graph_.nodeCount(); ++k) result.known.push_back(knownFrom(k));
  result.loop_begins = loop_begins_;
  result.variance = loopVariance();
  return result;
}

namespace {

std::vector<LoopEdge> loopEdgesOf(const posegraph::Edges& edges, const std::vector<int>& loop_begins,
                                  double variance) {
  std::vector<LoopEdge> result;
  // A loop's edges were added in a row, some for each of its keyframes.
  for (size_t loop = 0; loop < loop_begins.size(); ++loop) {
    const auto first = static_cast<size_t>(loop_begins[loop]);
    const auto end =
        loop + 1 < loop_begins.size() ? static_cast<size_t>(loop_begins[loop + 1]) : edges.size();
    const auto isOfLoop = [&](size_t i) { return i < end && edges[i].kind == posegraph::EdgeKind::kLoop; };
    int confirmations = 0;
    for (size_t i = first; isOfLoop(i); ++i) confirmations += i == first || edges[i].to != edges[i - 1].to;
    for (size_t i = first; isOfLoop(i); ++i)
      if (edges[i].on) result.push_back({i, 1 / (variance * confirmations)});
  }
  return result;
}

}  // namespace

double KeyframeMap::loopVariance() const {
  return kBothViews * point_noise_.variance() * matchOptions(1).information_scale;
}

std::vector<LoopEdge> KeyframeMap::loopEdges() const {
  return loopEdgesOf(graph_.edges(), loop_begins_, loopVariance());
}

posegraph::PoseGraph witnessGraph(const posegraph::PoseGraph& graph, const std::vector<Pose2>& poses,
                                  const Witnesses& witnesses) {
  posegraph::PoseGraph result;
  for (const Pose2& T : poses) result.addNode(T);
  result.setFixed(0);
  const auto& edges = graph.edges();
  const auto add = [&](posegraph::Edge edge, const Eigen::Matrix3d& information) {
    edge.T_from_to = core::between(result.pose(edge.from), result.pose(edge.to));
    edge.information = scanmatch::edgeInformation(information, 0);
    result.addEdge(edge);
  };
  for (int k = 1; k < result.nodeCount(); ++k) {
    const Known& known = witnesses.known[static_cast<size_t>(k) - 1];
    posegraph::Edge edge;
    edge.from = known.from, edge.to = k;
    add(edge, known.information);
  }
  for (const LoopEdge& loop : loopEdgesOf(edges, witnesses.loop_begins, witnesses.variance))
    add(edges[loop.edge], loop.share * edges[loop.edge].information);
  return result;
}

std::vector<Eigen::Matrix3d> covariancesOf(const posegraph::Marginals& ways) {
  auto covariances = ways.all();
  for (auto& covariance : covariances) covariance = scanmatch::withoutNegatives(covariance, kLeastShare, 0);
  return covariances;
}

/// Of a keyframe against the one that it is known from; map frame.
Eigen::Matrix3d KeyframeMap::stepCovariance(int k, const Known& known) const {
  return scanmatch::turned(scanmatch::covarianceOf(scanmatch::edgeInformation(known.information, 0)),
                           -pose(k).phi);
}

void KeyframeMap::settle(const Settled& found) {
  const std::vector<Pose2> before = graph_.poses();
  const int count = static_cast<int>(found.poses.size());
  for (int k = 0; k < size(); ++k) {
    Keyframe& one = keyframes_[static_cast<size_t>(k)];
    if (k < count) {
      const auto i = static_cast<size_t>(k);
      graph_.setPose(k, found.poses[i]);
      one.covariance = found.covariances[i], one.root = found.roots[i];
      continue;
    }
    const int from = keyframeBefore(k);
    const Pose2 T_from_k = core::between(before[static_cast<size_t>(from)], before[static_cast<size_t>(k)]);
    graph_.setPose(k, pose(from) * T_from_k);
    // As witnesses have it: it is known from one, and no loop was closed since.
    const Known known = knownFrom(k);
    const Eigen::Matrix3d J = moved(core::position(pose(known.from)), core::position(pose(k)));
    one.covariance = scanmatch::withoutNegatives(
        J * keyframe(known.from).covariance * J.transpose() + stepCovariance(k, known), kLeastShare, 0);
    one.root = scanmatch::rootOf(one.covariance + one.noise);
  }
  settled_ = found.ways;
  links_.measure(graph_.poses());
  ++revision_;
}

/// A keyframe that came since is known from one other, and tells nothing of it: its error is that one's,
/// moved, and one of its own. So both ways back are followed until they meet, or are known together.
Eigen::Matrix3d KeyframeMap::wayCovariance(int a, int b) const {
  struct End {
    int at;
    Eigen::Matrix3d own = Eigen::Matrix3d::Zero();  ///< of the end's error, map frame
  };
  const int settled = settled_ ? settled_->nodeCount() : 1;
  End ends[2] = {{a}, {b}};
  while (ends[0].at != ends[1].at && std::max(ends[0].at, ends[1].at) >= settled) {
    End& end = ends[ends[1].at > ends[0].at];
    const Point2 here = core::position(pose(end.at)), of_end = core::position(pose(&end == ends ? a : b));
    const Known known = knownFrom(end.at);
    const Eigen::Matrix3d J = moved(here, of_end);
    end.own += J * stepCovariance(end.at, known) * J.transpose();
    end.at = known.from;
  }
  Eigen::Matrix<double, 6, 6> joint = Eigen::Matrix<double, 6, 6>::Zero();
  // What both have in common moves them as one.
  if (ends[0].at != ends[1].at) {
    Eigen::Matrix<double, 6, 6> J = Eigen::Matrix<double, 6, 6>::Zero();
    J.topLeftCorner<3, 3>() = moved(core::position(pose(ends[0].at)), core::position(pose(a)));
    J.bottomRightCorner<3, 3>() = moved(core::position(pose(ends[1].at)), core::position(pose(b)));
    joint = J * settled_->joint(ends[0].at, ends[1].at) * J.transpose();
  }
  joint.topLeftCorner<3, 3>() += ends[0].own;
  joint.bottomRightCorner<3, 3>() += ends[1].own;
  return posegraph::relativeCovariance(joint, pose(a), pose(b));
}

}  // namespace slam::keyframes
