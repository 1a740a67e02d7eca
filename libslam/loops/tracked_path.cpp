#include "libslam/loops/tracked_path.h"

#include <utility>

#include "libslam/core/error.h"
#include "libslam/keyframes/keyframe_map.h"
#include "libslam/keyframes/matching.h"
#include "libslam/keyframes/search.h"
#include "libslam/loops/loop_closer.h"
#include "libslam/scanmatch/information.h"
#include "libslam/uncertainty/error_flow.h"
#include "libslam/uncertainty/error_sources.h"
#include "libslam/uncertainty/inheriting.h"
#include "libslam/uncertainty/pose_error.h"
#include "libslam/uncertainty/relative_error.h"

namespace slam::loops {

using core::Pose2;

TrackedPath::TrackedPath(const keyframes::GraphOptions& options)
    : map_(std::make_unique<keyframes::KeyframeMap>(options)),
      loops_(std::make_unique<LoopCloser>(*map_)),
      here_(options.cell_m, options.blur_m, true) {}

TrackedPath::~TrackedPath() = default;

void TrackedPath::nextScan(double moved_m) {
  if (has_begun_) map_->nextScan();
  has_begun_ = true;
  map_->drive(moved_m);
}

bool TrackedPath::addKeyframe(const std::vector<lidar::Scan>& seen, const Placed& placed) {
  if (!has_begun_ || seen.empty()) throw core::ContractError("TrackedPath: a keyframe without a scan");
  const auto& options = map_->options();
  std::vector<int> near;
  if (placed.is_matched && anchor_ >= 0)
    near = keyframes::firstOf(map_->keyframesAround(anchor_, core::position(placed.T_map_robot),
                                                    options.map_path_m, options.map_radius_m),
                              options.map_keyframes);
  if (placed.is_explained && isKnownGround(seen.front(), placed.T_map_robot, near)) {
    anchor_ = near.front();
    T_anchor_robot_ = core::between(map_->pose(anchor_), placed.T_map_robot);
    return false;
  }
  insert(seen, placed, near);
  if (!options.loops || size() == 1) return false;
  if (loops_->closeLoops()) return loops_->completeClosing();
  // The tracker may put the newest keyframes elsewhere before the next one comes.
  return loops_->completeSearching() && loops_->completeClosing();
}

/// Whether the keyframes around see all that a scan sees, often enough, so that one more tells nothing.
bool TrackedPath::isKnownGround(const lidar::Scan& scan, const Pose2& T_map_robot,
                                const std::vector<int>& near) const {
  const double enough = map_->options().known_views;
  return enough > 0 && !near.empty() && !loops_->isFollowing() &&
         map_->viewsOf(scan, T_map_robot, near) >= enough;
}

void TrackedPath::insert(const std::vector<lidar::Scan>& seen, const Placed& placed,
                         const std::vector<int>& near) {
  keyframes::Keyframe keyframe{};
  for (const auto& scan : seen) {
    const auto points = keyframes::pointsOf(scan, map_->options());
    keyframe.points.insert(keyframe.points.end(), points.begin(), points.end());
  }
  keyframe.view_centre = keyframes::centreOf(keyframe.points);
  keyframe.scan = map_->scan();
  keyframe.seen = seen.front();
  keyframe.path_m = map_->path_m();
  keyframe.odometry_edge = -1;
  const int k = map_->size();
  if (seen.size() > 1) others_[k].assign(seen.begin() + 1, seen.end());
  scanmatch::MatchEvidence evidence;
  if (!near.empty()) evidence = evidenceFrom(near, keyframe.points, placed);
  keyframe.noise.setZero();
  if (k > 0) follow(evidence, placed, keyframe);
  map_->graph().addNode(placed.T_map_robot);
  map_->keyframes().push_back(std::move(keyframe));
  map_->links().addKeyframe();
  if (k == 0) {
    map_->graph().setFixed(0);
  } else {
    addOdometryEdge(k, placed);
    map_->setErrors(k, uncertainty::inheritedErrors(*map_, k, static_cast<std::uint64_t>(k)));
    map_->link(anchor_, k);
    // What was driven on known ground is no way from one to the other.
    if (anchor_ != k - 1) map_->addClosure(anchor_, k);
    const Pose2& T = placed.T_map_robot;
    const auto partners = map_->partnersOf(k, near, T);
    map_->tie(k, partners, T, keyframes::toldInformation(evidence), static_cast<double>(partners.size()));
  }
  anchor_ = k;
  T_anchor_robot_ = {};
}

/// What a scan tells of its pose among these keyframes.
scanmatch::MatchEvidence TrackedPath::evidenceFrom(const std::vector<int>& near,
                                                   const std::vector<scanmatch::PatchPoint>& points,
                                                   const Placed& placed) {
  const Pose2& T_map_robot = placed.T_map_robot;
  here_.clear(core::position(T_map_robot), keyframes::kMapReach_m);
  for (const int k : near) here_.add(map_->keyframe(k).points, map_->pose(k), k);
  auto evidence = evidenceOf(points, here_, T_map_robot, keyframes::kKernel);
  map_->pointNoise().add(evidence);
  if (placed.open) {
    const Eigen::Vector3d along(placed.open->x, placed.open->y, 0);
    const Eigen::Matrix3d across = Eigen::Matrix3d::Identity() - along * along.transpose();
    for (auto& view : evidence.by_view) view.information = across * view.information * across;
    evidence.beyond_slope = across * evidence.beyond_slope * across;
  }
  return evidence;
}

/// What the next keyframe inherits, as if its scan had been matched with the motion since the last call as
/// its prior.
void TrackedPath::follow(const scanmatch::MatchEvidence& evidence, const Placed& placed,
                         keyframes::Keyframe& next) {
  const Pose2 T_before = map_->pose(anchor_) * T_anchor_robot_;
  const Eigen::Matrix3d odometry = scanmatch::turned(placed.odometry_covariance, -T_before.phi);
  const Eigen::Matrix3d posterior = keyframes::matchOptions(1).information_scale * evidence.information() +
                                    scanmatch::covarianceOf(odometry);
  uncertainty::PoseError error = uncertainty::errorAfterMatch(*map_, evidence, posterior);
  if (placed.noise) raiseNoise(error, *placed.noise);
  uncertainty::Inheriting inheriting;
  inheriting.carryOn(error, keyframes::moved(core::position(T_before), core::position(placed.T_map_robot)),
                     odometry);
  next.inherited = inheriting.of(evidence);
  next.noise = error.noise;
  noteFirst(*map_, error);
}

void TrackedPath::addOdometryEdge(int k, const Placed& placed) {
  posegraph::Edge edge;
  edge.from = anchor_, edge.to = k;
  edge.T_from_to = T_anchor_robot_ * placed.T_before_robot;
  edge.information = scanmatch::edgeInformation(scanmatch::covarianceOf(placed.odometry_covariance),
                                                placed.T_before_robot.phi);
  map_->keyframes().back().odometry_edge = map_->graph().addEdge(edge);
}

bool TrackedPath::finish() {
  if (size() == 0 || !map_->options().loops) return false;
  bool have_moved = false;
  loops_->searchRemainingLoops(0, [&] { have_moved = true; });
  return have_moved;
}

int TrackedPath::size() const {
  return map_->size();
}

int TrackedPath::scan(int k) const {
  return map_->keyframe(k).scan;
}

const Pose2& TrackedPath::pose(int k) const {
  return map_->pose(k);
}

Eigen::Matrix3d TrackedPath::covariance(int k) const {
  return scanmatch::withoutNegatives(map_->errorsOf(k).covariance(), keyframes::kLeastShare, 0);
}

std::vector<Pose2> TrackedPath::poses() const {
  return map_->graph().poses();
}

std::vector<Eigen::Matrix3d> TrackedPath::covariances() const {
  return size() == 0 ? std::vector<Eigen::Matrix3d>{}
                     : uncertainty::ErrorFlow(*map_, uncertainty::Poses::kTracked).covariances();
}

std::vector<Eigen::Matrix3d> TrackedPath::relativeCovariances(
    const std::vector<std::pair<uncertainty::HungScan, uncertainty::HungScan>>& scans) const {
  std::vector<Eigen::Matrix3d> result;
  if (scans.empty()) return result;
  const uncertainty::RelativeError error(*map_, uncertainty::Poses::kTracked);
  result.reserve(scans.size());
  for (const auto& [first, second] : scans) result.push_back(error.covariance(first, second));
  return result;
}

std::vector<lidar::Scan> TrackedPath::seen(int k) const {
  std::vector<lidar::Scan> scans = {map_->keyframe(k).seen};
  if (const auto others = others_.find(k); others != others_.end())
    scans.insert(scans.end(), others->second.begin(), others->second.end());
  return scans;
}

void TrackedPath::setPose(int k, const Pose2& T_map_robot) {
  auto& graph = map_->graph();
  const Pose2 T_was_is = core::between(graph.pose(k), T_map_robot);
  graph.setPose(k, T_map_robot);
  const int count = static_cast<int>(graph.edges().size());
  for (int e = std::max(map_->keyframe(k).odometry_edge, 0); e < count; ++e) {
    const auto& edge = graph.edges()[static_cast<size_t>(e)];
    const bool is_odometry = map_->keyframe(edge.to).odometry_edge == e;
    if (is_odometry || (edge.from != k && edge.to != k)) continue;
    graph.setMeasurement(e,
                         edge.to == k ? edge.T_from_to * T_was_is : core::inverse(T_was_is) * edge.T_from_to);
  }
}

const std::vector<core::JournalEntry>& TrackedPath::journal() const {
  return map_->journal();
}

}  // namespace slam::loops
