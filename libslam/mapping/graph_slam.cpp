#include "libslam/mapping/graph_slam.h"

#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <functional>

#include "libslam/core/error.h"
#include "libslam/posegraph/marginals.h"
#include "libslam/scanmatch/scan_points.h"

namespace slam::mapping {
namespace {

using core::Point2;
using core::Pose2;
using scanmatch::MatchResult;
using scanmatch::PatchPoint;
using scanmatch::PosePrior;

/// In standard deviations of a surfel: farther points hardly count.
constexpr double kKernel = 3;
/// Neighbouring beams err together, and surfels are estimates: a point tells a fifth of what an independent one would.
constexpr double kInformationScale = 0.2;
/// Starts are compared on every third point of the coarse map.
constexpr int kStartStride = 3;
/// Another start must explain this much more than odometry's to be taken at all.
constexpr double kStartGain = 0.02;
/// In standard deviations of odometry: a match farther from it has let it go.
constexpr double kLetGo = 3;
/// Keyframes that are asked what of a scan they should have seen.
constexpr size_t kStartViewers = 4;
constexpr double kStartTurns_rad[] = {-0.15, -0.07, 0.07, 0.15};
/// The lattice of recover().
constexpr int kLatticeTurns = 10, kLatticeSteps = 4;
constexpr double kLatticeTurn_rad = 0.03, kLatticeStep_m = 0.1, kRecoverGain = 0.05;
/// Least share of the information along the worst direction of movement; below, a corridor or an open field.
constexpr double kDegenerate = 0.02;
/// An edge of odometry that was not to be trusted.
constexpr double kDistrustedFactor = 5;
/// Errors of matches that share a map are not independent, as the graph takes them to be. Both factors make the poses'
/// mean normalised squared error 1 over 56 simulated runs in rooms and corridors; benchmarks/results/consistency.txt has
/// other runs than those.
constexpr double kGraphCovarianceScale = 3, kMatchCovarianceScale = 0.8;
/// A robot that is carried away: scans in a row that contradict the map, and the conflict of each. On the annotated logs
/// (36 thousand scans) five such scans in a row are the most.
constexpr int kLostScans = 8;
constexpr double kLostConflict = 0.15;
/// In a finished map: where less of a scan than this falls on what is mapped, the robot has left it.
constexpr double kLeastKnown = 0.5;
/// How far that may have been, and what it counts as driven.
constexpr double kGap_m = 30, kGap_rad = 3, kGapPath_m = 1000;
/// In JournalEntry::other_scan: a keyframe that was known before.
constexpr int kOfEarlierRun = -1;
/// While lost in a finished map, it is searched for at every so many scans.
constexpr int kRelocateEvery = 5;
/// Two partners of a keyframe are this many keyframes apart: neighbours would say the same twice.
constexpr int kPartnerStep = 3;

Eigen::Matrix3d diagonal(double sigma_xy, double sigma_turn) {
  return Eigen::Vector3d(1 / (sigma_xy * sigma_xy), 1 / (sigma_xy * sigma_xy), 1 / (sigma_turn * sigma_turn))
      .asDiagonal();
}

bool isApart(int keyframe, const std::vector<int>& others) {
  return std::none_of(others.begin(), others.end(),
                      [&](int other) { return std::abs(other - keyframe) < kPartnerStep; });
}

}  // namespace

Eigen::Matrix3d edgeInformation(const Eigen::Matrix3d& information, double phi_rad) {
  Eigen::Matrix3d turn = Eigen::Matrix3d::Identity();
  turn(0, 0) = turn(1, 1) = std::cos(phi_rad);
  turn(1, 0) = std::sin(phi_rad), turn(0, 1) = -turn(1, 0);
  const Eigen::Matrix3d body = turn.transpose() * information * turn;
  // Rounding leaves a direction that is open a little below zero.
  const double floor = 1e-6 + 1e-9 * body.trace();
  return 0.5 * (body + body.transpose()) + floor * Eigen::Matrix3d::Identity();
}

GraphOptions::GraphOptions() {
  table().setDefaults(*this);
}

const core::ParameterTable<GraphOptions>& GraphOptions::table() {
  using O = GraphOptions;
  static const core::ParameterTable<O> kTable(
      "graph",
      {{"point_spacing_m", &O::point_spacing_m, 0.05, 0.0, 10.0,
        "points of one scan are at least this far apart"},
       {"max_range_m", &O::max_range_m, 40.0, 0.1, 1000.0, "farther returns are not matched"},
       {"cell_m", &O::cell_m, 0.1, 0.01, 2.0,
        "cell of the finest surfel map; two more have double and fourfold cells"},
       {"blur_m", &O::blur_m, 0.02, 0.001, 1.0, "standard deviation added to the finest surfels"},
       {"odometry_xy_m", &O::odometry_xy_m, 0.02, 1e-4, 10.0, "standard deviation of an increment, always"},
       {"odometry_xy_per_m", &O::odometry_xy_per_m, 0.1, 0.0, 10.0, "and per metre driven"},
       {"odometry_turn_deg", &O::odometry_turn_rad, 0.573, 1e-3, 90.0, "of its turn, always"},
       {"odometry_turn_per_rad", &O::odometry_turn_per_rad, 0.2, 0.0, 10.0, "and per angle turned"},
       {"odometry_kernel", &O::odometry_kernel, 2.0, 0.0, 100.0,
        "standard deviations beyond which odometry loses its hold; 0: never"},
       {"distrust_gain", &O::distrust_gain, 0.1, 0.0, 1.0,
        "odometry is dropped when another start explains this much more of the scan"},
       {"recover_score", &O::recover_score, 0.65, 0.0, 1.0,
        "a match that explains less is searched for around"},
       {"lost_score", &O::lost_score, 0.5, 0.0, 1.0,
        "scans that explain less and contradict the map, or in a finished map explain less: the robot is "
        "lost"},
       {"keyframe_distance_m", &O::keyframe_distance_m, 0.3, 0.0, 100.0,
        "travel after which a scan becomes a keyframe"},
       {"keyframe_angle_deg", &O::keyframe_angle_rad, 17.2, 0.0, 360.0, "turn after which it does"},
       {"keyframe_score", &O::keyframe_score, 0.75, 0.0, 1.0,
        "it does, too, when the map explains less of it"},
       {"map_keyframes", &O::map_keyframes, 40, 1, 10000,
        "a scan is matched to so many keyframes, the nearest"},
       {"map_radius_m", &O::map_radius_m, 8.0, 0.1, 1000.0, "within this distance"},
       {"map_path_m", &O::map_path_m, 25.0, 0.1, 1e6, "and this length of links"},
       {"edges_per_keyframe", &O::edges_per_keyframe, 8, 1, 100,
        "a keyframe's match is shared among so many edges"},
       {"link_conflict", &O::link_conflict, 0.2, 0.0, 1.0,
        "no edge to a keyframe that sees through more of the points"},
       {"link_agreed", &O::link_agreed, 0.3, 0.0, 1.0, "or that sees less of them"},
       {"loops", &O::loops, true, "look for places seen again"},
       {"loop_every_m", &O::loop_every_m, 0.5, 0.01, 1000.0, "travel between two searches"},
       {"loop_reach_m", &O::loop_reach_m, 1.5, 0.0, 1000.0, "a place is searched for within this distance"},
       {"loop_reach_per_m", &O::loop_reach_per_m, 0.03, 0.0, 1.0, "and so much more per metre of path to it"},
       {"loop_reach_most_m", &O::loop_reach_most_m, 25.0, 0.1, 1000.0, "but not farther"},
       {"loop_path_m", &O::loop_path_m, 4.0, 0.1, 100.0,
        "the scans of this length of path are searched for together"},
       {"loop_search_score", &O::loop_search_score, 0.5, 0.0, 1.0,
        "least score of a place on the search's raster"},
       {"loop_score", &O::loop_score, 0.6, 0.0, 1.0, "and of the same after matching"},
       {"loop_confirm_score", &O::loop_confirm_score, 0.6, 0.0, 1.0,
        "least score of each keyframe that confirms it"},
       {"loop_conflict", &O::loop_conflict, 0.1, 0.0, 1.0,
        "most of its points that old beams may pass through"},
       {"loop_confirmations", &O::loop_confirmations, 3, 1, 100, "keyframes that must confirm a loop"},
       {"loop_confirm_m", &O::loop_confirm_m, 1.0, 0.0, 100.0, "over at least this path"},
       {"loop_distinctness", &O::loop_distinctness, 0.03, 0.0, 100.0,
        "sum over them of how much more they explain than moved along the place's open direction"},
       {"loop_chi2_per_m", &O::loop_chi2_per_m, 20.0, 0.0, 1e6,
        "a loop that costs the graph more per metre of path it closes is wrong"},
       {"refine_rounds", &O::refine_rounds, 0, 0, 100,
        "at the end all keyframes are matched to one another again so many times"}});
  return kTable;
}

GraphSlam::LevelMaps::LevelMaps(const GraphOptions& o)
    : fine(o.cell_m, o.blur_m),
      middle(2 * o.cell_m, o.blur_m + 0.02),
      coarse(4 * o.cell_m, o.blur_m + 0.07) {}

GraphSlam::GraphSlam(const GraphOptions& options) : options_(options), maps_(options) {}

void GraphSlam::note(const char* event, double value, int other_keyframe, const std::string& detail) {
  journal_.push_back({static_cast<int>(records_.size()), event, value,
                      other_keyframe < 0 ? -1 : keyframe(other_keyframe).scan, detail});
}

Pose2 GraphSlam::currentPose() const {
  return graph_.pose(lastKeyframe()) * T_keyframe_robot_;
}

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
    if (away2 <= near2) near.push_back({away2, k});
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

std::vector<int> GraphSlam::nearestKeyframes(std::vector<int> near) const {
  if (static_cast<int>(near.size()) > options_.map_keyframes)
    near.resize(static_cast<size_t>(options_.map_keyframes));
  return near;
}

/// Makes the map that the next scan is matched to of the first of these.
void GraphSlam::setMap(const std::vector<int>& near, const Point2& centre) {
  map_keyframes_ = nearestKeyframes(near);
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
    if (away_m <= radius_m) near.push_back({away_m, k});
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

/// Of the local map's place in the map, as a pose at a point has it from there: what the keyframes that share a match have
/// in common, for they have been found from one another.
Eigen::Matrix3d GraphSlam::mapCovariance(const Point2& at) const {
  Eigen::Matrix3d sum = Eigen::Matrix3d::Zero();
  for (const int k : anchors_) {
    Eigen::Matrix3d J = Eigen::Matrix3d::Identity();
    J(0, 2) = graph_.pose(k).y - at.y, J(1, 2) = at.x - graph_.pose(k).x;
    sum += J * keyframe(k).covariance * J.transpose();
  }
  return anchors_.empty() ? sum : Eigen::Matrix3d(sum / static_cast<double>(anchors_.size()));
}

void GraphSlam::link(int a, int b) {
  const double length_m = core::distance(graph_.pose(a), graph_.pose(b));
  links_[static_cast<size_t>(a)].push_back({b, length_m});
  links_[static_cast<size_t>(b)].push_back({a, length_m});
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
  const Pose2 increment = has_odometry ? T_previous_robot : T_previous_robot_;
  const double move_m = std::hypot(increment.x, increment.y), turn_rad = std::abs(increment.phi);
  const double unknown = has_odometry ? 0 : 0.5;
  const double sigma_xy = options_.odometry_xy_m + options_.odometry_xy_per_m * move_m + unknown;
  const double sigma_turn = options_.odometry_turn_rad + options_.odometry_turn_per_rad * turn_rad + unknown;
  const Pose2 predicted = T_before * increment;

  Pose2 start = predicted;
  const double own = surfelScore(points, maps_.coarse, predicted, kKernel, kStartStride);
  double best = own + kStartGain;
  const auto consider = [&](const Pose2& candidate) {
    const double score = surfelScore(points, maps_.coarse, candidate, kKernel, kStartStride);
    if (score > best) best = score, start = candidate;
  };
  consider(T_before * T_previous_robot_);
  // Some robots count backwards motion forwards.
  consider(T_before * core::inverse(increment));
  for (const double turn : kStartTurns_rad) consider({predicted.x, predicted.y, predicted.phi + turn});

  PosePrior prior;
  prior.mean = predicted;
  prior.information = diagonal(sigma_xy, sigma_turn);
  MatchResult result = match(points, maps_, predicted, prior, options_.odometry_kernel, true);
  bool distrusted = false;
  if (core::distance(result.T_map_robot, predicted) > kLetGo * sigma_xy) {
    // Odometry is let go for a better match only, not along a corridor that holds nothing.
    const auto held = match(points, maps_, predicted, prior, 0, true);
    if (!(gain(points, result.T_map_robot, held.T_map_robot) > kStartGain)) result = held;
  }
  if (best > own + kStartGain) {
    const bool contradicted = best > own + options_.distrust_gain;
    PosePrior elsewhere = prior;
    if (contradicted) {
      elsewhere.mean = start;
      elsewhere.information = diagonal(3 * sigma_xy + 0.1, 3 * sigma_turn + 0.05);
    }
    const auto other = match(points, maps_, start, elsewhere, options_.odometry_kernel, true);
    if (gain(points, other.T_map_robot, result.T_map_robot) > kStartGain) {
      result = other;
      distrusted = contradicted;
      if (distrusted) note("distrusted", best - own);
    }
  }
  if (result.score < options_.recover_score) {
    const auto other = recover(points, predicted, result.T_map_robot);
    if (other && gain(points, other->T_map_robot, result.T_map_robot) > kRecoverGain) {
      result = *other;
      distrusted = true;
      note("rematched", result.score);
    }
  }
  if (result.score < options_.recover_score) note("poor", result.score);
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d> movement(result.information.topLeftCorner<2, 2>(),
                                                                Eigen::EigenvaluesOnly);
  const double share =
      movement.eigenvalues()(1) > 0 ? movement.eigenvalues()(0) / movement.eigenvalues()(1) : 0;
  if (share < kDegenerate) note("degenerate", share);

  odometry_holds_ = odometry_holds_ && has_odometry && !distrusted;
  information = result.information;
  T_previous_robot_ = core::between(T_before, result.T_map_robot);
  T_keyframe_robot_ = core::between(graph_.pose(lastKeyframe()), result.T_map_robot);
  T_odometry_ = T_odometry_ * increment;
  path_m_ += std::hypot(T_previous_robot_.x, T_previous_robot_.y);
  Step step;
  step.T_map_robot = result.T_map_robot;
  step.score = result.score;
  step.match_covariance = kMatchCovarianceScale * result.posterior_information.inverse();
  step.pose_covariance = mapCovariance(core::position(step.T_map_robot)) + step.match_covariance;
  return step;
}

GraphSlam::Step GraphSlam::process(const robot::Scan& scan, const Pose2& T_previous_robot,
                                   bool has_odometry) {
  if (scan.ranges_m.size() < 2) throw core::ContractError("GraphSlam: a scan of fewer than 2 beams");
  Step step;
  if (keyframes_.empty()) {
    addKeyframe(scan, pointsOf(scan), {}, Eigen::Matrix3d::Zero(), Eigen::Matrix3d::Zero());
    step.is_keyframe = true;
  } else {
    std::vector<PatchPoint> points;
    Eigen::Matrix3d information;
    const Pose2 increment = has_odometry ? T_previous_robot : T_previous_robot_;
    const Pose2 predicted = currentPose() * increment;
    step = track(scan, T_previous_robot, has_odometry, points, information);
    if (contradictsMap(points, step)) {
      // A glitch passes, or somebody who stands before the lidar; a robot that was carried away does not come back.
      ++torn_scans_;
      keepTo(predicted, increment, step);
      if (torn_scans_ == kLostScans) startElsewhere(step.score);
    } else {
      torn_scans_ = 0;
    }
    const bool is_held_back = torn_scans_ > 0 && torn_scans_ < kLostScans;
    step.is_keyframe = !is_held_back &&
                       (torn_scans_ == kLostScans ||
                        std::hypot(T_keyframe_robot_.x, T_keyframe_robot_.y) > options_.keyframe_distance_m ||
                        std::abs(T_keyframe_robot_.phi) > options_.keyframe_angle_rad ||
                        step.score < options_.keyframe_score);
    if (step.is_keyframe && part_begins_ == graph_.nodeCount()) {
      // What was held back belongs to the new part, too.
      for (int i = kLostScans - 1; i >= 1; --i) {
        auto& record = records_[records_.size() - static_cast<size_t>(i)];
        const Pose2 T_map_robot = graph_.pose(record.keyframe) * record.T_keyframe_robot;
        record = {graph_.nodeCount(), core::between(step.T_map_robot, T_map_robot), record.match_covariance};
      }
    }
    if (step.is_keyframe) {
      addKeyframe(scan, std::move(points), step.T_map_robot, information, step.pose_covariance);
      step.pose_covariance = keyframe(lastKeyframe()).covariance;
    }
    step.T_map_robot = currentPose();
  }
  records_.push_back({lastKeyframe(), T_keyframe_robot_, step.match_covariance});
  return step;
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

/// Whether most of a scan lies where the keyframes nearest have seen that there is nothing.
bool GraphSlam::contradictsMap(const std::vector<PatchPoint>& points, const Step& step) const {
  if (points.empty() || !(step.score < options_.lost_score)) return false;
  const size_t viewers = std::min<size_t>(map_keyframes_.size(), kStartViewers);
  double conflict = 0;
  for (size_t i = 0; i < viewers; ++i)
    conflict +=
        view(map_keyframes_[i], core::between(graph_.pose(map_keyframes_[i]), step.T_map_robot), points)
            .conflict();
  return viewers > 0 && conflict > kLostConflict * static_cast<double>(viewers);
}

/// Puts odometry's word in place of a match.
void GraphSlam::keepTo(const Pose2& predicted, const Pose2& increment, Step& step) {
  step.T_map_robot = predicted;
  step.match_covariance +=
      torn_scans_ * diagonal(options_.odometry_xy_m, options_.odometry_turn_rad).inverse();
  step.pose_covariance += step.match_covariance;
  T_previous_robot_ = increment;
  T_keyframe_robot_ = core::between(graph_.pose(lastKeyframe()), predicted);
}

/// The next keyframe begins a part of the map whose place in the rest is not known.
void GraphSlam::startElsewhere(double score) {
  note("lost", score);
  part_begins_ = graph_.nodeCount();
  hypotheses_.clear();
  map_keyframes_.clear(), anchors_.clear();
  path_m_ += kGapPath_m;
  searched_m_ = path_m_;
}

GraphSlam::Step GraphSlam::localise(const robot::Scan& scan, const Pose2& T_previous_robot,
                                    bool has_odometry) {
  if (keyframes_.empty()) throw core::ContractError("GraphSlam: localise() without a map");
  std::vector<PatchPoint> points;
  Eigen::Matrix3d information;
  const Pose2 increment = has_odometry ? T_previous_robot : T_previous_robot_;
  const Pose2 predicted = currentPose() * increment;
  Step step = track(scan, T_previous_robot, has_odometry, points, information);
  odometry_holds_ = false;
  // Outside of the map, or carried away: what little fits would lead astray. Who has walked out is not looked for; his
  // wheels will bring him back.
  const bool was_carried = contradictsMap(points, step);
  const bool is_torn = was_carried || knownShare(points, predicted) < kLeastKnown;
  if (is_torn) {
    if (++torn_scans_ == kLostScans) note("lost", step.score);
    keepTo(predicted, increment, step);
  }
  if (was_carried && torn_scans_ >= kLostScans && torn_scans_ % kRelocateEvery == 0)
    if (const auto found = relocate(points)) {
      step.T_map_robot = found->T_map_robot;
      note("recovered", found->score);
      torn_scans_ = 0;
    }
  if (!is_torn) {
    if (torn_scans_ >= kLostScans) note("recovered", step.score);
    torn_scans_ = 0;
  }
  T_keyframe_robot_ = core::between(graph_.pose(lastKeyframe()), step.T_map_robot);
  setMapNear(core::position(step.T_map_robot));
  records_.push_back({lastKeyframe(), T_keyframe_robot_, step.match_covariance});
  return step;
}

void GraphSlam::addKnownKeyframe(const robot::Scan& scan, const Pose2& T_map_robot) {
  if (!records_.empty()) throw core::ContractError("GraphSlam: known keyframes come before the first scan");
  const Pose2 T_last = keyframes_.empty() ? Pose2{} : graph_.pose(lastKeyframe());
  T_odometry_ = core::between(T_last, T_map_robot);
  path_m_ += std::hypot(T_odometry_.x, T_odometry_.y);
  const bool loops = std::exchange(options_.loops, false);
  addKeyframe(scan, pointsOf(scan), T_map_robot, diagonal(0.02, 0.005), Eigen::Matrix3d::Zero());
  keyframes_.back().scan = kOfEarlierRun;
  options_.loops = loops;
}

void GraphSlam::startAt(const Pose2& T_map_robot) {
  if (keyframes_.empty()) throw core::ContractError("GraphSlam: startAt() without a map");
  T_keyframe_robot_ = core::between(graph_.pose(lastKeyframe()), T_map_robot);
  T_previous_robot_ = {};
  odometry_holds_ = false;
  setMapNear(core::position(T_map_robot));
}

double GraphSlam::View::conflict() const {
  return agreed + passed == 0 ? 0 : static_cast<double>(passed) / (agreed + passed);
}

GraphSlam::Sight GraphSlam::sight(int viewer, const Point2& p_lidar) const {
  // Half of what two walls are apart at least; and beams are compared with their neighbours.
  constexpr double kSame_m = 0.3;
  const auto& ranges = keyframe(viewer).ranges_m;
  double angle = std::atan2(p_lidar.y, p_lidar.x) - geometry_.first_angle_rad;
  if (angle < 0) angle += 2 * core::kPi;
  const auto beam = std::lround(angle / geometry_.step_rad);
  if (beam < 1 || beam + 1 >= static_cast<long>(ranges.size())) return Sight::kUnseen;
  const double distance_m = std::hypot(p_lidar.x, p_lidar.y);
  double off_m = 1e9, nearest_m = 1e9;
  for (long b = beam - 1; b <= beam + 1; ++b) {
    const float range_m = ranges[static_cast<size_t>(b)];
    if (!robot::isReturn(range_m)) continue;
    off_m = std::min(off_m, std::abs(range_m - distance_m));
    nearest_m = std::min(nearest_m, static_cast<double>(range_m));
  }
  if (off_m < kSame_m) return Sight::kAgreed;
  return nearest_m < 1e9 && nearest_m > distance_m + kSame_m ? Sight::kPassed : Sight::kUnseen;
}

GraphSlam::View GraphSlam::view(int viewer, const Pose2& T_viewer_points,
                                const std::vector<PatchPoint>& points) const {
  const Pose2 T_lidar_points = core::inverse(geometry_.T_robot_lidar) * T_viewer_points;
  View result;
  for (const auto& point : points) {
    const Sight seen = sight(viewer, T_lidar_points * position(point));
    if (seen == Sight::kAgreed) ++result.agreed;
    if (seen == Sight::kPassed) ++result.passed;
  }
  return result;
}

/// By how much more of the scan a pose explains than another, by the points of which both say something: those that fall
/// on a surface, and those that beams have gone through. What falls into the unknown, or between two beams of a keyframe
/// far along a wall, says nothing against a pose.
double GraphSlam::gain(const std::vector<PatchPoint>& points, const Pose2& T_map_robot,
                       const Pose2& T_map_other) const {
  const size_t viewers = std::min<size_t>(map_keyframes_.size(), kStartViewers);
  const Pose2 T_lidar_base = core::inverse(geometry_.T_robot_lidar);
  const Point2 origin = maps_.fine.origin();
  const auto says = [&](const Pose2& T, const PatchPoint& point) {
    const Point2 p_map = T * position(point);
    bool agreed = false;
    for (size_t i = 0; i < viewers; ++i) {
      const Pose2& T_map_viewer = graph_.pose(map_keyframes_[i]);
      const Sight seen = sight(map_keyframes_[i], T_lidar_base * (core::inverse(T_map_viewer) * p_map));
      if (seen == Sight::kPassed) return true;
      agreed = agreed || seen == Sight::kAgreed;
    }
    return agreed && maps_.fine.at(p_map.x - origin.x, p_map.y - origin.y) != nullptr;
  };
  std::vector<PatchPoint> telling;
  for (size_t p = 0; p < points.size(); p += kStartStride)
    if (says(T_map_robot, points[p]) && says(T_map_other, points[p])) telling.push_back(points[p]);
  return surfelScore(telling, maps_.fine, T_map_robot, kKernel, 1) -
         surfelScore(telling, maps_.fine, T_map_other, kKernel, 1);
}

/// The keyframes that a match is shared among: the nearest, not two in a row, and only those whose beams agree.
std::vector<int> GraphSlam::partnersOf(int k, const std::vector<int>& near, const Pose2& T_map_robot) const {
  std::vector<int> partners;
  const auto& points = keyframe(k).points;
  for (const int other : near) {
    if (other == k) continue;
    if (!isApart(other, partners)) continue;
    if (other != k - 1) {
      const View seen = view(other, core::between(graph_.pose(other), T_map_robot), points);
      if (seen.conflict() > options_.link_conflict ||
          seen.agreed < options_.link_agreed * static_cast<double>(points.size()))
        continue;
    }
    partners.push_back(other);
    if (static_cast<int>(partners.size()) == options_.edges_per_keyframe) break;
  }
  return partners;
}

/// What the scans cannot see, odometry has to hold; where it was wrong, the matched motion stands in for it, weakly.
int GraphSlam::addOdometryEdge(int k) {
  posegraph::Edge edge;
  edge.from = k - 1, edge.to = k;
  edge.T_from_to = odometry_holds_ ? T_odometry_ : core::between(graph_.pose(k - 1), graph_.pose(k));
  const double factor = odometry_holds_ ? 1 : kDistrustedFactor;
  const double move_m = std::hypot(edge.T_from_to.x, edge.T_from_to.y),
               turn_rad = std::abs(edge.T_from_to.phi);
  edge.information =
      k == part_begins_
          ? diagonal(kGap_m, kGap_rad)
          : diagonal(factor * (options_.odometry_xy_m + options_.odometry_xy_per_m * move_m),
                     factor * (options_.odometry_turn_rad + options_.odometry_turn_per_rad * turn_rad));
  return graph_.addEdge(edge);
}

void GraphSlam::addKeyframe(const robot::Scan& scan, std::vector<PatchPoint> points, const Pose2& T_map_robot,
                            const Eigen::Matrix3d& information, const Eigen::Matrix3d& covariance) {
  if (keyframes_.empty()) geometry_ = scan, geometry_.ranges_m.clear();
  const int k = graph_.addNode(T_map_robot);
  keyframes_.push_back({static_cast<int>(records_.size()), scan.time_s, std::move(points), scan.ranges_m,
                        path_m_, -1, covariance});
  links_.emplace_back();
  if (k == 0) {
    graph_.setFixed(0);
  } else {
    keyframes_.back().odometry_edge = addOdometryEdge(k);
    if (k == part_begins_)
      keyframes_.back().covariance = diagonal(kGap_m, kGap_rad).inverse();
    else
      link(k - 1, k);
    const auto partners = partnersOf(k, map_keyframes_, T_map_robot);
    const Eigen::Matrix3d share = edgeInformation(information, T_map_robot.phi) /
                                  static_cast<double>(std::max<size_t>(partners.size(), 1));
    for (const int partner : partners) {
      posegraph::Edge edge;
      edge.from = partner, edge.to = k;
      edge.T_from_to = core::between(graph_.pose(partner), T_map_robot);
      edge.information = share;
      graph_.addEdge(edge);
      link(partner, k);
    }
  }
  T_keyframe_robot_ = {};
  T_odometry_ = {};
  odometry_holds_ = true;
  if (options_.loops && k > 0) closeLoops();
  const Point2 centre = core::position(currentPose());
  setMap(keyframesAround(k, centre, options_.map_path_m, options_.map_radius_m), centre);
}

robot::Scan GraphSlam::keyframeScan(int k) const {
  robot::Scan scan = geometry_;
  scan.time_s = keyframe(k).time_s;
  scan.ranges_m = keyframe(k).ranges_m;
  return scan;
}

std::vector<Pose2> GraphSlam::poses() const {
  std::vector<Pose2> result;
  result.reserve(records_.size());
  for (const auto& record : records_)
    result.push_back(graph_.pose(record.keyframe) * record.T_keyframe_robot);
  return result;
}

std::vector<Eigen::Matrix3d> GraphSlam::keyframeCovariances() const {
  auto covariances = posegraph::Marginals(graph_).all();
  for (auto& covariance : covariances) covariance *= kGraphCovarianceScale;
  return covariances;
}

std::vector<Eigen::Matrix3d> GraphSlam::covariances() const {
  std::vector<Eigen::Matrix3d> result;
  if (records_.empty()) return result;
  const auto keyframes = keyframeCovariances();
  result.reserve(records_.size());
  for (const auto& record : records_) {
    const auto& T = graph_.pose(record.keyframe);
    const Pose2 at = T * record.T_keyframe_robot;
    Eigen::Matrix3d J = Eigen::Matrix3d::Identity();
    J(0, 2) = T.y - at.y, J(1, 2) = at.x - T.x;
    result.push_back(J * keyframes[static_cast<size_t>(record.keyframe)] * J.transpose() +
                     kGraphCovarianceScale / kMatchCovarianceScale * record.match_covariance);
  }
  return result;
}

void GraphSlam::finish() {
  if (keyframes_.empty()) return;
  if (options_.loops) searchRemainingLoops();
  if (options_.refine_rounds > 0) refine();
}

}  // namespace slam::mapping
