#pragma once
#include <cstdint>
#include <limits>
#include <string>
#include <vector>

#include "libslam/core/pose2.h"
#include "libslam/core/progress.h"
#include "libslam/explore/explore.h"
#include "libslam/resources/manifest.h"
#include "libslam/table/table.h"
#include "libslam/world/plan.h"

namespace slam::teams {

inline constexpr int kMostRobots = 4;

/// Several robots that explore one plan together.
struct TeamRequest {
  std::string plan_path;
  explore::ExploreConfig config;  ///< of every robot; its start is the first one's
  std::string slam;               ///< as ExploreRequest::slam; each robot has one of its own
  std::string methods_folder;
  std::string output;
  std::uint64_t seed = 1;
  int robots = 2;
  /// Robots no farther apart than this hear each other, and pass on what they hear from others; walls do not
  /// matter. 0: nobody hears anybody.
  double radio_range_m = std::numeric_limits<double>::infinity();
  std::vector<core::Pose2> T_world_starts;  ///< of each robot; empty: beside the first
  int threads = 1;           ///< robots' sensing and mapping side by side; changes nothing but the time
  bool tables_only = false;  ///< no folder per robot
  bool overwrite = false;
};

/// What the team did together, scored on the truth.
struct TeamScores {
  explore::ExplorationEnd end = explore::ExplorationEnd::kFailed;
  metrics::ExplorationFigures figures{};  ///< of what any robot has seen; paths are their sum
  double explorable_m2 = 0;
  double path_sum_m = 0, path_longest_m = 0;
  double overlap = 0;  ///< of the explored area, the share that more than one robot has seen
  double wall_collisions = 0, robot_collisions = 0;
  double gave_way = 0;           ///< how often a robot drove out of another one's way
  score::Evaluation evaluation;  ///< of the merged map, laid on the truth by the first robot's path
};

struct TeamReport {
  TeamScores team;
  std::vector<explore::Exploration> robots;
  table::Table scores;  ///< for people: a row for each robot and notes on the team
  int failed = 0;       ///< robots whose method failed
};

/// The closed loop of explore() for a team in one world: each robot has its own sensors, odometry, method and
/// map, its own random streams (the first one's are those of a robot alone), and sees the others as discs,
/// but for those whose marks it sees (sim::sightings()), whose beams it leaves out of its map. All start at
/// once; within a period they drive one after the other and then look.
///
/// Frames: how the robots stand to each other at the start is known to them, nothing after that; where
/// another one is follows from its own estimate. A robot decides on its own map, filled with what it has of
/// the others' (gridmap::filledFrom()), and knows their places and goals; out of range it goes on with the
/// newest that it had, for goals at most kRemembers_s. Who takes what: choices/team_share.h, for the
/// strategies on the map; the others heed nobody. Who lets whom pass: navigate::RightOfWay.
///
/// The exploration ends when every robot has finished, or with [simulation] duration_s, or when the referee's
/// patience (section [exploration]) is over for every robot, new area being what no robot had seen.
///
/// Writes into `output`, which appears whole or not at all:
///   robot1/ robot2/ ..    the files of a single exploration, see explore()
///   map.yaml .png .gridmap.gz   gridmap::merged() of all maps at the end, in the first one's frame
///   exploration.json      TeamScores, and each robot's path and share
///   team.csv              after every scan: time, explored area of the team, each robot's path
///   scores.* runs.csv     a row per robot: rasterslam report
///   path.png coverage.png all paths; explored share of the team and of each robot
///   manifest.json
/// Same request, same bytes (but for the times in the manifests and cost.*), whatever the threads.
///
/// Errors: as explore(); InputError for robots out of 1 .. kMostRobots, a negative range, starts that are not
/// one for each robot, overlap or lie in a wall, no room for all beside the first, and what only one robot
/// can have: people and doors that move, being carried, returning to the start.
TeamReport exploreTeam(const TeamRequest& request, resources::Manifest manifest, core::Progress& progress);
inline constexpr double kRemembers_s = 60.0;

/// Where the robots start: the first as its configuration says, the others with its heading at the free
/// places nearest to it that it could reach in a straight line, kBeside_m between the discs. Errors:
/// InputError, see exploreTeam().
std::vector<core::Pose2> teamStarts(const world::Plan& plan, const TeamRequest& request);
inline constexpr double kBeside_m = 0.3;

}  // namespace slam::teams
