#include "libslam/graph/tracked_path.h"

#include <utility>

#include "libslam/core/error.h"
#include "libslam/graph/keyframe_map.h"
#include "libslam/graph/loop_closer.h"
#include "libslam/graph/matching.h"
#include "libslam/scanmatch/information.h"

namespace slam::graph {

using core::Pose2;

TrackedPath::TrackedPath(const GraphOptions& options)
    : map_(std::make_unique<KeyframeMap>(options)), loops_(std::make_unique<LoopCloser>(*map_)) {}

TrackedPath::~TrackedPath() = default;

void TrackedPath::nextScan(double moved_m) {
  if (has_begun_) map_->nextScan();
  has_begun_ = true;
  map_->drive(moved_m);
}

bool TrackedPath::addKeyframe(const std::vector<robot::Scan>& seen, const Placed& placed) {
  if (!has_begun_ || seen.empty()) throw core::ContractError("TrackedPath: a keyframe without a scan");
  std::vector<scanmatch::PatchPoint> points;
  for (const auto& scan : seen) {
    const auto more = pointsOf(scan, map_->options());
    points.insert(points.end(), more.begin(), more.end());
  }
  const int k = map_->graph().addNode(placed.T_map_robot);
  Keyframe keyframe{};
  keyframe.scan = map_->scan();
  keyframe.seen = seen.front();
  keyframe.points = std::move(points);
  keyframe.path_m = map_->path_m();
  keyframe.odometry_edge = -1;
  keyframe.noise.setZero();
  keyframe.covariance = placed.covariance;
  keyframe.root = scanmatch::rootOf(placed.covariance);
  keyframe.matched_to = placed.hangs_on;
  keyframe.information =
      scanmatch::turned(scanmatch::covarianceOf(placed.covariance_since), placed.T_map_robot.phi);
  map_->keyframes().push_back(std::move(keyframe));
  map_->links().addKeyframe();
  if (k == 0) {
    map_->graph().setFixed(0);
    return false;
  }
  addOdometryEdge(k, placed);
  map_->link(k - 1, k);
  if (!placed.match_information.isZero()) addMatchEdges(k, placed);
  if (!loops_->closeLoops()) return false;
  return loops_->completeClosing();
}

void TrackedPath::addOdometryEdge(int k, const Placed& placed) {
  posegraph::Edge edge;
  edge.from = k - 1, edge.to = k;
  edge.T_from_to = placed.T_before_robot;
  edge.information = scanmatch::edgeInformation(scanmatch::covarianceOf(placed.odometry_covariance),
                                                placed.T_before_robot.phi);
  map_->keyframes().back().odometry_edge = map_->graph().addEdge(edge);
}

/// The scan was matched to what the keyframes around it have drawn.
void TrackedPath::addMatchEdges(int k, const Placed& placed) {
  const auto& options = map_->options();
  const auto near = firstOf(map_->keyframesAround(k - 1, core::position(placed.T_map_robot),
                                                  options.map_path_m, options.map_radius_m),
                            options.map_keyframes);
  const auto partners = map_->partnersOf(k, near, placed.T_map_robot);
  for (const int partner : partners) {
    posegraph::Edge edge;
    edge.from = partner, edge.to = k;
    edge.T_from_to = core::between(map_->pose(partner), placed.T_map_robot);
    edge.information = scanmatch::edgeInformation(placed.match_information, placed.T_map_robot.phi) /
                       static_cast<double>(partners.size());
    map_->graph().addEdge(edge);
    map_->link(partner, k);
  }
}

bool TrackedPath::finish() {
  if (size() == 0) return false;
  bool have_moved = false;
  loops_->searchRemainingLoops(0, [&] { have_moved = true; });
  return loops_->closeRest() || have_moved;
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

const Eigen::Matrix3d& TrackedPath::covariance(int k) const {
  return map_->keyframe(k).covariance;
}

std::vector<Pose2> TrackedPath::poses() const {
  return map_->graph().poses();
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

}  // namespace slam::graph
