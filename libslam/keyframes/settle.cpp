#include <algorithm>

#include "libslam/keyframes/keyframe_map.h"
#include "libslam/keyframes/matching.h"
#include "libslam/keyframes/search.h"

namespace slam::keyframes {

using core::Point2;
using core::Pose2;

Eigen::Matrix3d moved(const Point2& from, const Point2& to) {
  Eigen::Matrix3d J = Eigen::Matrix3d::Identity();
  J(0, 2) = from.y - to.y, J(1, 2) = to.x - from.x;
  return J;
}

void PointNoise::add(const scanmatch::MatchEvidence& evidence) {
  squared_ += evidence.squared, pulled_ += evidence.pulled, dimensions_ += evidence.dimensions;
  for (size_t lag = 0; lag < lagged_.size(); ++lag) lagged_[lag] += evidence.lagged[lag];
}

double PointNoise::variance() const {
  return dimensions_ > 0 && squared_ > 0 ? squared_ / dimensions_ * shared() : 1;
}

double PointNoise::varianceOfPull() const {
  return dimensions_ > 0 && squared_ > 0 ? pulled_ / dimensions_ * shared() : 1;
}

/// By how much more sums of neighbouring points vary than if these were independent (Newey and West,
/// Econometrica 55, 1987: triangular weights keep it positive).
double PointNoise::shared() const {
  const double lags = static_cast<double>(lagged_.size()) + 1;
  double common = 1;
  for (size_t lag = 0; lag < lagged_.size(); ++lag)
    common += 2 * (1 - static_cast<double>(lag + 1) / lags) * lagged_[lag] / squared_;
  return std::max(common, 1.0);
}

/// A loop's edges were added in a row, some for each of its keyframes.
std::vector<LoopEdge> KeyframeMap::loopEdges() const {
  const double variance = kBothViews * point_noise_.variance() * matchOptions(1).information_scale;
  const posegraph::Edges& edges = graph_.edges();
  std::vector<LoopEdge> result;
  for (size_t loop = 0; loop < loop_begins_.size(); ++loop) {
    const auto first = static_cast<size_t>(loop_begins_[loop]);
    const auto end =
        loop + 1 < loop_begins_.size() ? static_cast<size_t>(loop_begins_[loop + 1]) : edges.size();
    const auto isOfLoop = [&](size_t i) { return i < end && edges[i].kind == posegraph::EdgeKind::kLoop; };
    int confirmations = 0;
    for (size_t i = first; isOfLoop(i); ++i) confirmations += i == first || edges[i].to != edges[i - 1].to;
    for (size_t i = first; isOfLoop(i); ++i)
      if (edges[i].on) result.push_back({i, 1 / (variance * confirmations)});
  }
  return result;
}

namespace {

/// Draws of scans' errors are numbered otherwise: from 0 on.
constexpr std::uint64_t kOfNoise = std::uint64_t{1} << 63;

std::uint64_t noiseDraw(int k) {
  return kOfNoise + static_cast<std::uint64_t>(k);
}

}  // namespace

ErrorSamples KeyframeMap::errorsOf(int k) const {
  ErrorSamples noise, result = keyframe(k).surfaces;
  noise.addNew(keyframe(k).noise, noiseDraw(k));
  result.add(-Eigen::Matrix3d::Identity(), noise);
  return result;
}

void KeyframeMap::setErrors(int k, const ErrorSamples& errors) {
  Keyframe& one = keyframes_[static_cast<size_t>(k)];
  one.surfaces = errors;
  one.surfaces.addNew(one.noise, noiseDraw(k));
}

void KeyframeMap::settle(const Settled& found) {
  const int count = static_cast<int>(found.poses.size());
  std::vector<Pose2> T_from(static_cast<size_t>(size()));
  for (int k = count; k < size(); ++k)
    T_from[static_cast<size_t>(k)] = core::between(pose(keyframeBefore(k)), pose(k));
  for (int k = 0; k < size(); ++k)
    graph_.setPose(k, k < count ? found.poses[static_cast<size_t>(k)]
                                : pose(keyframeBefore(k)) * T_from[static_cast<size_t>(k)]);
  if (!found.errors.empty()) takeOver(found.errors);
  links_.measure(graph_.poses());
  ++revision_;
}

/// What the first keyframes err by, found anew. What came since errs by as much more as before.
void KeyframeMap::takeOver(const std::vector<ErrorSamples>& errors) {
  const int count = static_cast<int>(errors.size());
  std::vector<ErrorSamples> change(static_cast<size_t>(size() - count));
  for (int k = count; k < size(); ++k) {
    const int from = keyframeBefore(k);
    const Eigen::Matrix3d carried = moved(core::position(pose(from)), core::position(pose(k)));
    ErrorSamples& of_k = change[static_cast<size_t>(k - count)];
    if (from < count) {
      of_k.add(carried, errors[static_cast<size_t>(from)]);
      of_k.add(-carried, errorsOf(from));
    } else {
      of_k.add(carried, change[static_cast<size_t>(from - count)]);
    }
    keyframes_[static_cast<size_t>(k)].surfaces.add(Eigen::Matrix3d::Identity(), of_k);
  }
  for (int k = 0; k < count; ++k) setErrors(k, errors[static_cast<size_t>(k)]);
}

}  // namespace slam::keyframes
