#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <functional>
#include <utility>

#include "libslam/core/error.h"
#include "libslam/mapping/graph_slam.h"

namespace slam::mapping {
namespace {

using core::Point2;
using core::Pose2;
using scanmatch::MatchResult;
using scanmatch::PatchPoint;
using scanmatch::PosePrior;

/// Neighbouring beams err together, and surfels are estimates: a point tells a fifth of what an independent one would.
constexpr double kInformationScale = 0.2;
/// Another start must explain this much more than odometry's to be taken at all.
constexpr double kStartGain = 0.02;
/// In standard deviations of odometry: a match farther from it has let it go.
constexpr double kLetGo = 3;
constexpr double kStartTurns_rad[] = {-0.15, -0.07, 0.07, 0.15};
/// The lattice of recover().
constexpr int kLatticeTurns = 10, kLatticeSteps = 4;
constexpr double kLatticeTurn_rad = 0.03, kLatticeStep_m = 0.1, kRecoverGain = 0.05;
/// Least share of the information along the worst direction of movement; below, a corridor or an open field.
constexpr double kDegenerate = 0.02;

/// Odometry's errors are taken as normal to so many standard deviations, and with the tails of Cauchy's distribution beyond.
constexpr double kTail = 2;
/// What speaks against backwards motion that was counted forwards, in nats.
constexpr double kBackwards = 1;
/// What a scan says for a pose, in nats, when all of it is explained: neighbouring beams err together.
constexpr double kNatsPerScan = 10;

/// What odometry with a step's standard deviations holds against a pose where it has another, in nats.
double heldAgainst(const Pose2& T, const Pose2& T_odometry, double sigma_xy_m, double sigma_turn_rad) {
  const double off = core::distance(T, T_odometry) / sigma_xy_m,
               turned = core::angleDifference(T.phi, T_odometry.phi) / sigma_turn_rad;
  return std::log1p((off * off + turned * turned) / (kTail * kTail));
}

}  // namespace

scanmatch::MatchOptions GraphSlam::matchOptions(int max_iterations) {
  scanmatch::MatchOptions options;
  options.kernel = kKernel;
  options.information_scale = kInformationScale;
  options.max_iterations = max_iterations;
  return options;
}

std::vector<PatchPoint> GraphSlam::pointsOf(const robot::Scan& scan) const {
  scanmatch::ScanPointOptions options;
  options.spacing_m = options_.point_spacing_m;
  options.max_range_m = options_.max_range_m;
  return patchPoints(scan, options);
}

MatchResult GraphSlam::match(const std::vector<PatchPoint>& points, const LevelMaps& maps,
                             const Pose2& T_start, const PosePrior& prior, double prior_kernel,
                             bool with_coarse) const {
  auto options = matchOptions(3);
  options.prior_kernel = prior_kernel;
  Pose2 T = T_start;
  if (with_coarse) T = alignToSurfels(points, maps.coarse, T, prior, options).T_map_robot;
  T = alignToSurfels(points, maps.middle, T, prior, options).T_map_robot;
  options.max_iterations = 10;
  return alignToSurfels(points, maps.fine, T, prior, options);
}

/// To the map of these keyframes, from a pose near the right one, without regard to any prior.
MatchResult GraphSlam::matchFreely(const std::vector<PatchPoint>& points, const std::vector<int>& keyframes,
                                   const Pose2& T_start, bool with_coarse) const {
  const LevelMaps& maps = mapOf(keyframes, core::position(T_start));
  PosePrior flat;
  flat.mean = T_start;
  flat.information.setIdentity();
  return match(points, maps, T_start, flat, 0, with_coarse);
}

/// A map of these keyframes, until the next one is asked for.
const GraphSlam::LevelMaps& GraphSlam::mapOf(const std::vector<int>& keyframes, const Point2& centre) const {
  fill(scratch_, keyframes, centre);
  return scratch_;
}

void GraphSlam::fill(LevelMaps& maps, const std::vector<int>& keyframes, const Point2& centre) const {
  for (auto* map : {&maps.fine, &maps.middle, &maps.coarse}) {
    map->clear(centre, kMapReach_m);
    for (const int k : keyframes) map->add(keyframe(k).points, graph_.pose(k));
  }
}

/// Keyframes that chains of links of at most path_m connect with `start`, within radius_m of the centre, the nearest
/// first. Chains do not lead far outside of the circle.
std::vector<int> GraphSlam::keyframesAround(int start, const Point2& centre, double path_m,
                                            double radius_m) const {
  const auto& poses = graph_.poses();
  reached_.resize(keyframes_.size(), -1);
  touched_.clear(), queue_.clear();
  reached_[static_cast<size_t>(start)] = 0;
  touched_.push_back(start);
  queue_.push_back({0, start});
  const double near2 = radius_m * radius_m, far2 = 2.25 * near2;
  std::vector<std::pair<double, int>> near;
  while (!queue_.empty()) {
    std::pop_heap(queue_.begin(), queue_.end(), std::greater<>());
    const auto [length_m, k] = queue_.back();
    queue_.pop_back();
    if (length_m > reached_[static_cast<size_t>(k)]) continue;
    const double dx = poses[static_cast<size_t>(k)].x - centre.x,
                 dy = poses[static_cast<size_t>(k)].y - centre.y;
    const double away2 = dx * dx + dy * dy;
    if (away2 <= near2 && !keyframe(k).unsure) near.push_back({away2, k});
    if (away2 > far2) continue;
    for (const Link& link : links_[static_cast<size_t>(k)]) {
      const double reach = length_m + link.length_m;
      double& best = reached_[static_cast<size_t>(link.to)];
      if (reach > path_m || (best >= 0 && best <= reach)) continue;
      if (best < 0) touched_.push_back(link.to);
      best = reach;
      queue_.push_back({reach, link.to});
      std::push_heap(queue_.begin(), queue_.end(), std::greater<>());
    }
  }
  for (const int k : touched_) reached_[static_cast<size_t>(k)] = -1;
  std::sort(near.begin(), near.end());
  std::vector<int> result;
  result.reserve(near.size());
  for (const auto& item : near) result.push_back(item.second);
  return result;
}

std::vector<int> GraphSlam::firstOf(std::vector<int> keyframes, int most) {
  if (static_cast<int>(keyframes.size()) > most) keyframes.resize(static_cast<size_t>(most));
  return keyframes;
}

/// Makes the map that the next scan is matched to of the first of these.
void GraphSlam::setMap(const std::vector<int>& near, const Point2& centre) {
  map_keyframes_ = firstOf(near, options_.map_keyframes);
  fill(maps_, map_keyframes_, centre);
  anchors_.clear();
  for (const int k : map_keyframes_)
    if (isApart(k, anchors_) && static_cast<int>(anchors_.size()) < options_.edges_per_keyframe)
      anchors_.push_back(k);
}

/// All keyframes within the radius, however they are linked, the nearest first.
std::vector<int> GraphSlam::keyframesWithin(const Point2& centre, double radius_m) const {
  std::vector<std::pair<double, int>> near;
  for (int k = 0; k < graph_.nodeCount(); ++k) {
    const double away_m = core::distance(core::position(graph_.pose(k)), centre);
    if (away_m <= radius_m && !keyframe(k).unsure) near.push_back({away_m, k});
  }
  std::sort(near.begin(), near.end());
  std::vector<int> keyframes;
  keyframes.reserve(near.size());
  for (const auto& item : near) keyframes.push_back(item.second);
  return keyframes;
}

/// For a map that is finished.
void GraphSlam::setMapNear(const Point2& centre) {
  setMap(keyframesWithin(centre, options_.map_radius_m), centre);
}

/// The best pose on a lattice around the predicted one, refined without regard to odometry.
std::optional<MatchResult> GraphSlam::recover(const std::vector<PatchPoint>& points, const Pose2& predicted,
                                              const Pose2& matched) const {
  Pose2 best = matched;
  const double before = surfelScore(points, maps_.middle, matched, kKernel, 2);
  double best_score = before;
  for (int turn = -kLatticeTurns; turn <= kLatticeTurns; ++turn)
    for (int x = -kLatticeSteps; x <= kLatticeSteps; ++x)
      for (int y = -kLatticeSteps; y <= kLatticeSteps; ++y) {
        const Pose2 candidate{predicted.x + kLatticeStep_m * x, predicted.y + kLatticeStep_m * y,
                              predicted.phi + kLatticeTurn_rad * turn};
        const double score = surfelScore(points, maps_.middle, candidate, kKernel, 2);
        if (score > best_score) best_score = score, best = candidate;
      }
  if (!(best_score > before)) return std::nullopt;
  PosePrior weak;
  weak.mean = best;
  weak.information.diagonal() << 10, 10, 10;
  return match(points, maps_, best, weak, 0, false);
}

/// Matches a scan to the map around. Fills in its points and the information that they give, map axes.
GraphSlam::Step GraphSlam::track(const robot::Scan& scan, const Pose2& T_previous_robot, bool has_odometry,
                                 std::vector<PatchPoint>& points, Eigen::Matrix3d& information) {
  points = pointsOf(scan);
  const Pose2 T_before = currentPose();
  const auto [increment, sigma_xy, sigma_turn] = predict(T_previous_robot, has_odometry);
  const Pose2 predicted = T_before * increment;

  Pose2 start = predicted;
  const double own = surfelScore(points, maps_.coarse, predicted, kKernel, kStride);
  double best = own + kStartGain;
  const auto consider = [&](const Pose2& candidate) {
    const double score = surfelScore(points, maps_.coarse, candidate, kKernel, kStride);
    if (score > best) best = score, start = candidate;
  };
  consider(T_before * T_previous_robot_);
  // Some robots count backwards motion forwards, and turns as they are.
  const Pose2 backwards = T_before * Pose2{-increment.x, -increment.y, increment.phi};
  consider(backwards);
  const Pose2 T_wheels = by_wheels_.value_or(T_before) * increment;
  if (by_wheels_) consider(T_wheels);
  for (const double turn : kStartTurns_rad) consider({predicted.x, predicted.y, predicted.phi + turn});
  if (!has_odometry || best > own + options_.distrust_gain)
    if (const auto motion = motionFromScans(scan)) consider(T_before * *motion);

  PosePrior prior;
  prior.mean = predicted;
  prior.information = poseInformation(sigma_xy, sigma_turn);
  MatchResult result = match(points, maps_, predicted, prior, options_.odometry_kernel, true);
  bool distrusted = false;
  const auto unlikely = [&](const Pose2& T) {
    const auto by = [&](const Pose2& T_odometry) { return heldAgainst(T, T_odometry, sigma_xy, sigma_turn); };
    const double held = std::min(by(predicted), kBackwards + by(backwards));
    return by_wheels_ ? std::min(held, by(T_wheels)) : held;
  };
  // How far the scan before contradicts a pose: from where that was matched, or where wheels have it.
  const auto broken = [&](const Pose2& T) {
    const double matched = brokenBy(points, core::between(T_before, T));
    return by_wheels_ ? std::min(matched, brokenBy(points, core::between(*by_wheels_, T))) : matched;
  };
  // A pose is better when scan, map and the scan before say more for it than odometry says against it.
  const auto isBetter = [&](const MatchResult& other, double least_gain) {
    const double against = unlikely(other.T_map_robot) - unlikely(result.T_map_robot);
    const double least = std::max(least_gain, against / kNatsPerScan);
    const double gained = gain(points, other.T_map_robot, result.T_map_robot);
    const double less_broken = broken(result.T_map_robot) - broken(other.T_map_robot);
    if (other.score >= options_.recover_score) return gained + std::max(less_broken, 0.0) > least;
    // Wheels are worth more than an explanation of less than half.
    if (has_odometry && toldScore(points, other.T_map_robot) < options_.lost_score) return false;
    return gained + less_broken > least;
  };
  if (core::distance(result.T_map_robot, predicted) > kLetGo * sigma_xy) {
    // Odometry is let go for a better match only, not along a corridor that holds nothing.
    const auto held = match(points, maps_, predicted, prior, 0, true);
    const MatchResult free = std::exchange(result, held);
    if (isBetter(free, kStartGain)) result = free;
  }
  if (best > own + kStartGain) {
    const bool contradicted = best > own + options_.distrust_gain;
    PosePrior elsewhere = prior;
    if (contradicted) {
      elsewhere.mean = start;
      elsewhere.information = poseInformation(3 * sigma_xy + 0.1, 3 * sigma_turn + 0.05);
    }
    const auto other = match(points, maps_, start, elsewhere, options_.odometry_kernel, true);
    if (isBetter(other, kStartGain)) {
      result = other;
      distrusted = contradicted;
      if (distrusted) note("distrusted", best - own);
    }
  }
  const auto isPoor = [&] {
    return result.score < options_.recover_score &&
           toldScore(points, result.T_map_robot) < options_.recover_score;
  };
  if (isPoor()) {
    const auto other = recover(points, predicted, result.T_map_robot);
    if (other && isBetter(*other, kRecoverGain)) {
      result = *other;
      distrusted = true;
      note("rematched", result.score);
    }
  }
  const bool is_poor = isPoor();
  if (is_poor) note("poor", result.score);
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d> movement(result.information.topLeftCorner<2, 2>(),
                                                                Eigen::EigenvaluesOnly);
  const double share = movement.eigenvalues()(1) > 0
                           ? std::max(movement.eigenvalues()(0), 0.0) / movement.eigenvalues()(1)
                           : 0;
  if (share < kDegenerate) note("degenerate", share);

  odometry_holds_ = odometry_holds_ && has_odometry && !distrusted;
  const auto isFarFrom = [&](const Pose2& T) {
    return core::distance(result.T_map_robot, T) > kLetGo * sigma_xy ||
           std::abs(core::angleDifference(result.T_map_robot.phi, T.phi)) > kLetGo * sigma_turn;
  };
  followWheels(T_wheels, has_odometry && isFarFrom(predicted), isFarFrom(T_wheels), !is_poor);
  information = result.information;
  T_previous_robot_ = core::between(T_before, result.T_map_robot);
  T_keyframe_robot_ = core::between(graph_.pose(lastKeyframe()), result.T_map_robot);
  T_odometry_ = T_odometry_ * increment;
  path_m_ += std::hypot(T_previous_robot_.x, T_previous_robot_.y);
  Step step;
  step.T_map_robot = result.T_map_robot;
  step.score = result.score;
  step.match_covariance = kMatchCovarianceScale * covarianceOf(result.posterior_information);
  step.pose_covariance = mapCovariance(core::position(step.T_map_robot)) + step.match_covariance;
  return step;
}

/// Where odometry alone has the robot since it was let go, for as long as it may have been right after all. It was not when
/// some scans in a row are explained; it was when the robot is there again, and then the keyframes in between lie wrong.
/// Meanwhile they do not vouch for themselves.
void GraphSlam::followWheels(const Pose2& T_wheels, bool let_go, bool is_elsewhere, bool is_explained) {
  if (!by_wheels_ && !let_go) return;
  if (!by_wheels_) unsure_from_ = graph_.nodeCount(), explained_ = 0, let_go_m_ = path_m_;
  by_wheels_ = T_wheels;
  explained_ = is_explained ? explained_ + 1 : 0;
  // Beyond the map from before nothing will tell.
  const bool is_right =
      explained_ >= options_.loop_confirmations || path_m_ - let_go_m_ > options_.map_radius_m / 2;
  if (is_right)
    forgetWheels();
  else if (!is_elsewhere)
    by_wheels_.reset();
}

/// What was matched since odometry was let go is believed.
void GraphSlam::forgetWheels() {
  if (!by_wheels_) return;
  for (int k = unsure_from_; k < graph_.nodeCount(); ++k) keyframes_[static_cast<size_t>(k)].unsure = false;
  by_wheels_.reset();
}

/// Puts odometry's word in place of a match.
void GraphSlam::keepTo(const Pose2& predicted, const Pose2& increment, Step& step) {
  step.T_map_robot = predicted;
  step.match_covariance +=
      held_back_ * covarianceOf(poseInformation(options_.odometry_xy_m, options_.odometry_turn_rad));
  step.pose_covariance += step.match_covariance;
  T_previous_robot_ = increment;
  T_keyframe_robot_ = core::between(graph_.pose(lastKeyframe()), predicted);
}

/// Share of a scan's points that fall on a mapped surface, or near one.
double GraphSlam::knownShare(const std::vector<PatchPoint>& points, const Pose2& T_map_robot) const {
  const Point2 origin = maps_.coarse.origin();
  int known = 0;
  for (const auto& point : points) {
    const Point2 p_map = T_map_robot * position(point);
    known += maps_.coarse.at(p_map.x - origin.x, p_map.y - origin.y) != nullptr;
  }
  return points.empty() ? 0 : static_cast<double>(known) / static_cast<double>(points.size());
}

}  // namespace slam::mapping
