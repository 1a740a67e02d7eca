#include "libslam/reach/goal_picture.h"

#include <algorithm>
#include <limits>

#include "libslam/pictures/picture.h"
#include "libslam/reach/goal_methods.h"
#include "libslam/truth/carry_file.h"

namespace slam::reach {
namespace {

/// A cross, as a path of two strokes.
pictures::DrawnPath goalMark(const core::Point2& p, double size_m) {
  const auto at = [&](double dx, double dy) {
    return core::StampedPose{0, {p.x + dx * size_m, p.y + dy * size_m, 0}};
  };
  return {{at(-1, -1), at(1, 1), at(0, 0), at(-1, 1), at(1, -1)}, "goal"};
}

double markSize(const world::Plan& plan) {
  return 0.012 * plan.resolution_m * std::max(plan.columns, plan.rows);
}

/// The steps of one manoeuvre share a colour: the palette has eight.
std::string manoeuvreOf(const std::string& state) {
  for (std::string manoeuvre : {"AVOID", "OPEN", "STUCK"})
    if (state.compare(0, manoeuvre.size(), manoeuvre) == 0) return manoeuvre;
  return state;
}

/// The true path cut where the state changes, each piece under its state's name.
std::vector<pictures::DrawnPath> piecesByState(const GoalRun& run) {
  std::vector<pictures::DrawnPath> pieces;
  size_t next = 0;
  for (const auto& pose : truth::brokenAtCarries(run.truth, run.carries)) {
    const double time_s = pose.time_s - run.truth.front().time_s;
    while (next < run.changes.size() && run.changes[next].time_s <= time_s + 1e-9) {
      if (!pieces.empty()) pieces.back().path.push_back(pose);
      pieces.push_back({{}, manoeuvreOf(run.changes[next++].to)});
    }
    if (!pieces.empty()) pieces.back().path.push_back(pose);
  }
  return pieces;
}

/// The original method's stop radius, dashed, and its strategic directions, as they lay where it first met an
/// obstacle, or where it began.
pictures::DrawnPath overlayOf(const StrategicOverlay& overlay, const ReachGoalRequest& request,
                              const GoalRun& run) {
  constexpr int kDashes = 16, kPieces = 4;
  double met_s = 0;
  for (auto change = run.changes.rbegin(); change != run.changes.rend(); ++change)
    if (const auto to = manoeuvreOf(change->to); to == "AVOID" || to == "STUCK") met_s = change->time_s;
  core::Pose2 T_world_robot = run.truth.front().pose;
  for (const auto& pose : run.truth)
    if (pose.time_s - run.truth.front().time_s <= met_s + 1e-9) T_world_robot = pose.pose;
  const double reach_m = request.config.navigate.lidar_bug.obstacle_range_m;
  const auto at = [&](double angle_rad, double range_m) {
    const auto p = T_world_robot * core::polar(range_m, angle_rad);
    return core::StampedPose{0, {p.x, p.y, 0}};
  };
  const core::StampedPose gap{0, {std::numeric_limits<double>::quiet_NaN(), 0, 0}};
  pictures::DrawnPath drawn{{}, "stop radius, strategic directions"};
  for (const double direction_rad : overlay.directions_rad) {
    for (const double range_m : {overlay.stop_radius_m, reach_m})
      drawn.path.push_back(at(direction_rad, range_m));
    drawn.path.push_back(gap);
  }
  for (int i = 0; i < kDashes; ++i) {
    for (int j = 0; j <= kPieces; ++j)
      drawn.path.push_back(at(2 * core::kPi * (i + 0.6 * j / kPieces) / kDashes, overlay.stop_radius_m));
    drawn.path.push_back(gap);
  }
  return drawn;
}

}  // namespace

void drawGoalRun(const ReachGoalRequest& request, const GoalRun& run, const std::string& title,
                 const std::string& path) {
  auto paths = piecesByState(run);
  // The first path is on top and says where it started.
  const auto second = [&paths] { return paths.begin() + (paths.empty() ? 0 : 1); };
  paths.insert(second(), goalMark(request.p_world_goal, markSize(request.plan)));
  const auto& config = request.config;
  if (const auto overlay = strategicOverlay(run.method, config.navigate, config.robot, config.lidar))
    paths.insert(second(), overlayOf(*overlay, request, run));
  pictures::drawMap(request.plan, paths, title, path);
}

void drawGoalRuns(const ReachGoalRequest& request, const std::vector<GoalRun>& runs,
                  const std::string& path) {
  std::vector<pictures::DrawnPath> paths;
  paths.reserve(runs.size() + 1);
  for (const auto& run : runs) paths.push_back({truth::brokenAtCarries(run.truth, run.carries), run.method});
  paths.push_back(goalMark(request.p_world_goal, markSize(request.plan)));
  pictures::drawMap(request.plan, paths, request.plan.name, path);
}

}  // namespace slam::reach
