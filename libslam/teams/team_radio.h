#pragma once
#include <memory>
#include <optional>
#include <vector>

#include "libslam/core/pose2.h"
#include "libslam/gridmap/occupancy_raster.h"
#include "libslam/strategies/strategy.h"

namespace slam::teams {

/// What one robot of a team says of itself, in its own map frame.
struct RobotNews {
  double time_s = -1;  ///< below 0: never heard
  core::Pose2 T_map_robot;
  std::optional<core::Point2> goal;  ///< see choices::Teammate
  std::shared_ptr<const gridmap::OccupancyRaster>
      map;  ///< the newest that was sent; may be older than the rest
  double map_time_s = -1;
};

/// What each robot of a team knows of the others: what it hears now, and the newest of what it once heard.
/// How their map frames lie to each other is known from the start.
class TeamRadio {
 public:
  /// T_world_starts: only where they stand to each other is used.
  TeamRadio(const std::vector<core::Pose2>& T_world_starts, double range_m);

  /// Who hears whom now, in one hop or more.
  void listen(const std::vector<core::Point2>& places);
  bool hears(std::size_t robot, std::size_t other) const { return group_[robot] == group_[other]; }
  /// What a robot says; all that hear it know.
  void tell(std::size_t robot, const RobotNews& news);
  /// Maps, which are asked for only when one is needed: the newest of every robot in hearing, and what those
  /// know of robots that are not. `map_of` is called for each in hearing but the asker.
  template <class MapOf>
  void fetchMaps(std::size_t robot, double time_s, const MapOf& map_of) {
    for (std::size_t other = 0; other < known_.size(); ++other) {
      if (other == robot || !hears(robot, other)) continue;
      known_[robot][other].map = map_of(other);
      known_[robot][other].map_time_s = time_s;
      passOn(other, robot);
    }
  }

  /// The others, in the frame of `robot`; those never heard are left out, and goals older than kRemembers_s.
  std::vector<choices::Teammate> teamOf(std::size_t robot, double time_s) const;
  /// The robot's own map with what it has of the others'.
  gridmap::OccupancyRaster mapOf(std::size_t robot, const gridmap::OccupancyRaster& own) const;
  /// T_robot_other of the two map frames.
  core::Pose2 frameOf(std::size_t robot, std::size_t other) const;

 private:
  void passOn(std::size_t from, std::size_t to);

  std::vector<core::Pose2> starts_;
  double range_m_;
  std::vector<std::size_t> group_;             ///< robots with the same number hear each other
  std::vector<std::vector<RobotNews>> known_;  ///< [who][of whom]
};

}  // namespace slam::teams
