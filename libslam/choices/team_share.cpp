#include "libslam/choices/team_share.h"

#include <algorithm>
#include <limits>

namespace slam::choices {
namespace {

constexpr int kDirections = 360;
constexpr double kWait_s = 1.0;
constexpr double kShortestWay_m = 0.5;

}  // namespace

void closeTaken(paths::FreeSpace& looking, const std::vector<Teammate>& team, double unknown_path_m) {
  const paths::LookShape all_round{-core::kPi, 2 * core::kPi, kTaken_m, true};
  std::vector<std::size_t> taken;
  for (const auto& mate : team) {
    if (!mate.goal) continue;
    for (const auto& [cell, area_m2] :
         paths::expectedCells(looking, *mate.goal, all_round, 0, unknown_path_m, kDirections))
      taken.push_back(cell);
  }
  for (const std::size_t cell : taken)
    if (looking.state[cell] == paths::kUnknownCell) looking.state[cell] = paths::kOccupiedCell;
}

bool isAnyOnItsWay(const std::vector<Teammate>& team) {
  return std::any_of(team.begin(), team.end(),
                     [](const Teammate& mate) { return mate.is_heard && mate.goal; });
}

void keepWellPlaced(std::vector<Viewpoint>& viewpoints, const std::vector<paths::PathPlanner>& theirs,
                    const std::vector<Teammate>& who) {
  std::vector<int> ranks;
  int best = std::numeric_limits<int>::max();
  for (const auto& viewpoint : viewpoints) {
    int rank = 0;
    for (std::size_t i = 0; i < theirs.size(); ++i) {
      if (!theirs[i].isReached(viewpoint.node)) continue;
      const double cost_m = theirs[i].cost(viewpoint.node);
      rank += cost_m < viewpoint.cost_m || (cost_m == viewpoint.cost_m && who[i].goes_first);
    }
    ranks.push_back(rank);
    best = std::min(best, rank);
  }
  std::size_t i = 0;
  viewpoints.erase(std::remove_if(viewpoints.begin(), viewpoints.end(),
                                  [&](const Viewpoint&) { return ranks[i++] > best; }),
                   viewpoints.end());
}

Decision waitingForOthers(const std::string& reason) {
  Decision decision;
  decision.wait_s = kWait_s;
  decision.reason = reason;
  return decision;
}

Decision comingAfter(Decision decision, const core::Pose2& T_map_robot) {
  std::vector<double> legs_m;
  double length_m = 0;
  core::Point2 from = core::position(T_map_robot);
  for (const auto& to : decision.path) {
    legs_m.push_back(core::distance(from, to));
    length_m += legs_m.back();
    from = to;
  }
  if (length_m < kBehind_m + kShortestWay_m) return waitingForOthers("waits: others aim at all that is left");
  double rest_m = length_m - kBehind_m;
  std::vector<core::Point2> path;
  from = core::position(T_map_robot);
  for (std::size_t i = 0; i < legs_m.size(); ++i) {
    const core::Point2& to = decision.path[i];
    if (rest_m <= legs_m[i]) {
      const double s = legs_m[i] > 0 ? rest_m / legs_m[i] : 1;
      path.push_back({from.x + s * (to.x - from.x), from.y + s * (to.y - from.y)});
      break;
    }
    path.push_back(to);
    rest_m -= legs_m[i];
    from = to;
  }
  decision.path = std::move(path);
  decision.goal = decision.path.back();
  decision.comes_after = true;
  decision.reason = "comes after others: " + decision.reason;
  return decision;
}

}  // namespace slam::choices
