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

posegraph::PoseGraph KeyframeMap::witnesses() const {
  posegraph::PoseGraph result;
  for (const Pose2& T : graph_.poses()) result.addNode(T);
  result.setFixed(0);
  const auto& edges = graph_.edges();
  const auto add = [&](posegraph::Edge edge, const Eigen::Matrix3d& information) {
    edge.T_from_to = core::between(graph_.pose(edge.from), graph_.pose(edge.to));
    edge.information = scanmatch::edgeInformation(information, 0);
    result.addEdge(edge);
  };
  for (int k = 1; k < graph_.nodeCount(); ++k) {
    posegraph::Edge known = edges[static_cast<size_t>(keyframe(k).odometry_edge)];
    if (keyframe(k).matched_to >= 0)
      known.from = keyframe(k).matched_to, known.information = keyframe(k).information;
    add(known, known.information);
  }
  // A loop's edges were added in a row, some for each of its keyframes.
  const double variance = kBothViews * point_noise_.variance() * matchOptions(1).information_scale;
  for (size_t loop = 0; loop < loop_begins_.size(); ++loop) {
    const auto first = static_cast<size_t>(loop_begins_[loop]);
    const auto end =
        loop + 1 < loop_begins_.size() ? static_cast<size_t>(loop_begins_[loop + 1]) : edges.size();
    const auto isOfLoop = [&](size_t i) { return i < end && edges[i].kind == posegraph::EdgeKind::kLoop; };
    int confirmations = 0;
    for (size_t i = first; isOfLoop(i); ++i) confirmations += i == first || edges[i].to != edges[i - 1].to;
    for (size_t i = first; isOfLoop(i); ++i)
      if (edges[i].on) add(edges[i], edges[i].information / (variance * confirmations));
  }
  return result;
}

std::vector<Eigen::Matrix3d> KeyframeMap::keyframeCovariances() const {
  // Leaps of odometry may leave a pose held by no more than rounding.
  auto covariances = posegraph::Marginals(witnesses(), posegraph::Marginals::Open::kBounded).all();
  for (auto& covariance : covariances) covariance = scanmatch::withoutNegatives(covariance, kLeastShare, 0);
  return covariances;
}

}  // namespace slam::keyframes
