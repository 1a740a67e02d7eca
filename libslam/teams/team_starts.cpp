#include <algorithm>
#include <cmath>
#include <cstdio>

#include "libslam/core/error.h"
#include "libslam/robot/drive.h"
#include "libslam/sim/standing_room.h"
#include "libslam/teams/team.h"

namespace slam::teams {
namespace {

constexpr int kPlacesAside = 4;         // in the grid of places round the first robot
constexpr double kWallMargin_m = 0.05;  // between a disc and a wall, where nobody said where to start

struct Offset {
  double ahead_m, left_m;
};

/// The nearest first, of equals beside before behind before ahead, the left one first.
std::vector<Offset> offsets(double spacing_m) {
  std::vector<Offset> all;
  for (int ahead = -kPlacesAside; ahead <= kPlacesAside; ++ahead)
    for (int left = -kPlacesAside; left <= kPlacesAside; ++left)
      if (ahead != 0 || left != 0) all.push_back({ahead * spacing_m, left * spacing_m});
  const auto rank = [](const Offset& offset) {
    return std::make_tuple(
        std::round(1e6 * (offset.ahead_m * offset.ahead_m + offset.left_m * offset.left_m)),
        std::abs(offset.ahead_m), offset.ahead_m, -offset.left_m);
  };
  std::sort(all.begin(), all.end(), [&](const Offset& a, const Offset& b) { return rank(a) < rank(b); });
  return all;
}

bool isClearLine(const world::Plan& plan, const core::Point2& from, const core::Point2& to, double radius_m) {
  const int steps = static_cast<int>(std::ceil(core::distance(from, to) / (0.5 * plan.resolution_m)));
  for (int i = 1; i <= steps; ++i) {
    const double s = static_cast<double>(i) / steps;
    if (world::discCollides(plan, {from.x + s * (to.x - from.x), from.y + s * (to.y - from.y)}, radius_m))
      return false;
  }
  return true;
}

void requireApart(const std::vector<core::Pose2>& starts, double radius_m) {
  for (std::size_t b = 1; b < starts.size(); ++b)
    for (std::size_t a = 0; a < b; ++a) {
      if (core::distance(starts[a], starts[b]) > 2 * radius_m) continue;
      char text[160];
      std::snprintf(text, sizeof text,
                    "--starts: robots %zu and %zu stand %.3f m apart, expected more than %.3f m", a + 1,
                    b + 1, core::distance(starts[a], starts[b]), 2 * radius_m);
      throw core::InputError(text);
    }
}

}  // namespace

std::vector<core::Pose2> teamStarts(const world::Plan& plan, const TeamRequest& request) {
  const double radius_m = robot::circumscribedRadius(request.config.record.robot);
  const auto count = static_cast<std::size_t>(request.robots);
  if (!request.T_world_starts.empty()) {
    if (request.T_world_starts.size() != count)
      throw core::InputError("--starts: found " + std::to_string(request.T_world_starts.size()) +
                             " places, expected one for each of " + std::to_string(count) + " robots");
    for (std::size_t i = 0; i < count; ++i)
      sim::requireStandingRoom(plan, "start of robot " + std::to_string(i + 1), request.T_world_starts[i],
                               radius_m);
    requireApart(request.T_world_starts, radius_m);
    return request.T_world_starts;
  }
  std::vector<core::Pose2> starts{record::startPose(plan, request.config.record)};
  sim::requireStandingRoom(plan, "start pose", starts.front(), radius_m);
  for (const auto& offset : offsets(2 * radius_m + kBeside_m)) {
    if (starts.size() == count) break;
    const core::Pose2 place = starts.front() * core::Pose2{offset.ahead_m, offset.left_m, 0};
    const bool fits = sim::refusalOf(plan, place, radius_m + kWallMargin_m).empty() &&
                      isClearLine(plan, core::position(starts.front()), core::position(place), radius_m);
    if (fits) starts.push_back(place);
  }
  if (starts.size() < count)
    throw core::InputError("plan '" + plan.name + "': --robots " + std::to_string(count) +
                           ": found room for " + std::to_string(starts.size()) +
                           " round the start, expected all; --starts can place each");
  return starts;
}

}  // namespace slam::teams
