#include "libslam/live/snapshot_maker.h"

#include <algorithm>
#include <cmath>

#include "libslam/core/numbers.h"
#include "libslam/graph/graph_slam.h"
#include "libslam/metrics/trajectory_error.h"

namespace slam::live {
namespace {

using core::kNaN;
constexpr double kEventShown_s = 2;
constexpr double kStrategicShown_m = 2;  // of a direction: what is farther away decides nothing

bool isSame(const choices::Decision& a, const choices::Decision& b) {
  return a.turn_rad == b.turn_rad && a.distance_m == b.distance_m && a.reason == b.reason &&
         a.path.size() == b.path.size() && a.goal.x == b.goal.x && a.goal.y == b.goal.y;
}

void addGraph(const graph::GraphSlam& graph, viewer::Snapshot& snapshot) {
  snapshot.nodes.clear(), snapshot.edges.clear(), snapshot.loops.clear();
  const auto& poses = graph.graph().poses();
  for (const auto& pose : poses) snapshot.nodes.push_back(core::position(pose));
  for (const auto& edge : graph.graph().edges()) {
    if (!edge.on || edge.from == posegraph::kMap) continue;
    const viewer::Connection connection = {snapshot.nodes[static_cast<size_t>(edge.from)],
                                           snapshot.nodes[static_cast<size_t>(edge.to)]};
    (edge.kind == posegraph::EdgeKind::kLoop ? snapshot.loops : snapshot.edges).push_back(connection);
  }
}

}  // namespace

SnapshotMaker::SnapshotMaker(std::string title, std::string method, const core::Pose2& T_scene_map)
    : around_(zone_), collided_at_s_(-kEventShown_s), carried_at_s_(-kEventShown_s) {
  now_.title = std::move(title);
  now_.method = std::move(method);
  now_.T_scene_map = T_scene_map;
}

void SnapshotMaker::add(const record::Step& step) {
  now_.time_s = step.time_s;
  ++now_.scans;
  now_.scan = step.scan;
  now_.T_map_robot = step.T_map_robot;
  now_.note = step.note;
  online_.push_back({step.scan.time_s, step.T_map_robot});
  while (now_.loops.size() < known_loops_.size() &&
         known_loops_[now_.loops.size()].first < static_cast<int>(now_.scans))
    now_.loops.push_back(known_loops_[now_.loops.size()].second);
  takeTruth(step);
  lookAround(step);
  lookStrategically(step.scan);
  followDecision(step);
  if (step.time_s - collided_at_s_ < kEventShown_s) now_.note = "bumped into something";
  if (step.time_s - carried_at_s_ < kEventShown_s) now_.note = "the robot was kidnapped";
}

void SnapshotMaker::takeTruth(const record::Step& step) {
  if (step.simulator) {
    const auto& simulator = *step.simulator;
    now_.T_scene_truth = simulator.truth();
    if (simulator.collisions().size() > now_.collisions) collided_at_s_ = step.time_s;
    now_.collisions = simulator.collisions().size();
    if (simulator.carries().size() > carries_) {
      carries_ = simulator.carries().size();
      carried_at_s_ = step.time_s;
      now_.truth.push_back({step.scan.time_s, {kNaN, kNaN, 0}});  // breaks the line
    }
    now_.people.clear();
    for (const auto& body : simulator.scene().bodies()) now_.people.push_back({body.p, body.radius_m});
  } else {
    core::Pose2 truth;
    now_.T_scene_truth.reset();
    if (metrics::poseAt(known_truth_, step.scan.time_s, truth)) now_.T_scene_truth = truth;
  }
  if (now_.T_scene_truth) now_.truth.push_back({step.scan.time_s, *now_.T_scene_truth});
}

void SnapshotMaker::lookAround(const record::Step& step) {
  const obstacles::LidarView view(step.scan, sector_);
  around_.update(step.T_previous_robot, view, view.obstacles());
  const auto& points = around_.points();
  const auto border = points.begin() + static_cast<std::ptrdiff_t>(around_.rememberedCount());
  now_.obstacles = viewer::LocalObstacles{view.outline(sector_.reach_m),
                                          {border, points.end()},
                                          {points.begin(), border},
                                          zone_.front_m,
                                          zone_.rear_m,
                                          zone_.width_m};
}

void SnapshotMaker::setStrategicView(double stop_radius_m, std::vector<double> directions_rad) {
  now_.strategic = viewer::StrategicView{stop_radius_m, {}};
  strategic_rad_ = std::move(directions_rad);
}

void SnapshotMaker::lookStrategically(const lidar::Scan& scan) {
  if (!now_.strategic) return;
  now_.strategic->projected.clear();
  for (const double direction_rad : strategic_rad_) {
    const auto aside = [&](size_t i) {
      return std::abs(core::wrapToPi(scan.angle(i) + scan.T_robot_lidar.phi - direction_rad));
    };
    size_t nearest = 0;
    for (size_t i = 1; i < scan.ranges_m.size(); ++i)
      if (aside(i) < aside(nearest)) nearest = i;
    if (scan.ranges_m.empty() || aside(nearest) > scan.step_rad) continue;  // out of the field of view
    const double range_m = scan.ranges_m[nearest];
    const double shown_m =
        lidar::isReturn(scan.ranges_m[nearest]) ? std::min(range_m, kStrategicShown_m) : kStrategicShown_m;
    const double angle_rad = scan.angle(nearest);
    now_.strategic->projected.push_back(scan.T_robot_lidar * core::polar(shown_m, angle_rad));
  }
}

void SnapshotMaker::followDecision(const record::Step& step) {
  if (!step.decision) return;
  const auto& decision = *step.decision;
  if (!decision_ || !isSame(*decision_, decision)) {
    decision_ = decision;
    T_map_decided_ = step.T_map_robot;
  }
  viewer::Candidates candidates;
  const bool on_map = !decision.path.empty();
  for (const auto& place : decision.alternatives)
    candidates.places.push_back(on_map ? place : T_map_decided_ * place);
  candidates.goal =
      on_map ? decision.goal : T_map_decided_ * core::polar(decision.distance_m, decision.turn_rad);
  candidates.path = {core::position(T_map_decided_)};
  if (on_map)
    candidates.path.insert(candidates.path.end(), decision.path.begin(), decision.path.end());
  else
    candidates.path.push_back(candidates.goal);
  now_.candidates = std::move(candidates);
  if (now_.note.empty()) now_.note = decision.reason;
}

viewer::Snapshot SnapshotMaker::snapshot(const mapping::MapBuilder* method, bool with_map) {
  if (!method) {
    now_.path = online_;
    return now_;
  }
  now_.particles = mapping::particlePoses(*method);
  if (with_map) {
    now_.map = std::make_shared<gridmap::OccupancyRaster>(mapping::currentMap(*method));
    now_.path = mapping::finalPath(*method, online_).value_or(online_);
    if (const auto* graph = mapping::graphSlamOf(*method)) addGraph(*graph, now_);
  } else if (now_.path.size() < online_.size()) {
    now_.path.insert(now_.path.end(), online_.begin() + static_cast<std::ptrdiff_t>(now_.path.size()),
                     online_.end());
  }
  return now_;
}

}  // namespace slam::live
