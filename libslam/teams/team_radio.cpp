#include "libslam/teams/team_radio.h"

#include <numeric>

#include "libslam/gridmap/fused_raster.h"
#include "libslam/teams/team.h"

namespace slam::teams {

TeamRadio::TeamRadio(const std::vector<core::Pose2>& T_world_starts, double range_m)
    : starts_(T_world_starts),
      range_m_(range_m),
      group_(starts_.size()),
      known_(starts_.size(), std::vector<RobotNews>(starts_.size())) {
  std::iota(group_.begin(), group_.end(), std::size_t{0});
}

void TeamRadio::listen(const std::vector<core::Point2>& places) {
  std::iota(group_.begin(), group_.end(), std::size_t{0});
  for (std::size_t a = 0; a < places.size(); ++a)
    for (std::size_t b = 0; b < a; ++b) {
      if (!(range_m_ > 0) || core::distance(places[a], places[b]) > range_m_) continue;
      const std::size_t from = group_[a], to = group_[b];
      for (auto& group : group_)
        if (group == from) group = to;
    }
}

void TeamRadio::tell(std::size_t robot, const RobotNews& news) {
  for (std::size_t other = 0; other < known_.size(); ++other) {
    if (other == robot || !hears(other, robot)) continue;
    auto& known = known_[other][robot];
    known.time_s = news.time_s;
    known.T_map_robot = news.T_map_robot;
    known.goal = news.goal;
  }
}

void TeamRadio::passOn(std::size_t from, std::size_t to) {
  for (std::size_t third = 0; third < known_.size(); ++third) {
    if (third == to || hears(third, to)) continue;
    const RobotNews& told = known_[from][third];
    RobotNews& known = known_[to][third];
    if (told.map_time_s > known.map_time_s) known.map = told.map, known.map_time_s = told.map_time_s;
    if (told.time_s > known.time_s)
      known.time_s = told.time_s, known.T_map_robot = told.T_map_robot, known.goal = told.goal;
  }
}

core::Pose2 TeamRadio::frameOf(std::size_t robot, std::size_t other) const {
  return core::between(starts_[robot], starts_[other]);
}

std::vector<choices::Teammate> TeamRadio::teamOf(std::size_t robot, double time_s) const {
  std::vector<choices::Teammate> team;
  for (std::size_t other = 0; other < known_.size(); ++other) {
    const RobotNews& known = known_[robot][other];
    if (other == robot || known.time_s < 0) continue;
    const core::Pose2 T_robot_other = frameOf(robot, other);
    choices::Teammate mate;
    mate.p_map = T_robot_other * core::position(known.T_map_robot);
    mate.is_heard = hears(robot, other);
    mate.goes_first = other < robot;
    if (known.goal && time_s - known.time_s <= kRemembers_s) mate.goal = T_robot_other * *known.goal;
    if (mate.is_heard || mate.goal) team.push_back(mate);
  }
  return team;
}

gridmap::OccupancyRaster TeamRadio::mapOf(std::size_t robot, const gridmap::OccupancyRaster& own) const {
  std::vector<gridmap::PlacedRaster> others;
  for (std::size_t other = 0; other < known_.size(); ++other)
    if (known_[robot][other].map) others.push_back({known_[robot][other].map.get(), frameOf(robot, other)});
  return others.empty() ? own : gridmap::filledFrom(own, others);
}

}  // namespace slam::teams
