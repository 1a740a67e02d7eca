#pragma once
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "libslam/core/pose2.h"

namespace slam::choices {

/// What a strategy decides and why. Without a path: turn by turn_rad, then drive distance_m. With a path:
/// drive along its waypoints; turn and distance are then not used.
struct Decision {
  double turn_rad = 0;
  double distance_m = 0;  ///< 0: only turn
  double ray_m = 0;       ///< length of the ray that it drives along; 0: along none
  bool finished = false;  ///< nothing left to explore; `reason` says what remains out of reach
  double score = 0;       ///< of the choice, in the strategy's own measure
  std::string reason;     ///< "longest ray 7.31 m at 42 deg"
  /// Where the other candidates are: in the map frame when the strategy needs a map, else in the robot frame.
  std::vector<core::Point2> alternatives;
  std::vector<core::Point2>
      path;           ///< map frame, from the first waypoint after the robot to the goal; or empty
  core::Point2 goal;  ///< map frame, path.back(); meaningless without a path
  std::optional<core::Point2> look_at;  ///< map frame: at the goal, turn until the lidar covers this
  bool comes_after = false;  ///< it drives after others to what they aim at: its goal is not its own
  double wait_s = 0;         ///< above 0: stand for so long and decide again, for others are on their way
  /// How uncertain the pose was (m, by its covariance), NaN where the SLAM method does not say;
  /// and above 0 by how much less it was there where this goes back to for a loop, see Certainty.
  double spread_m = std::numeric_limits<double>::quiet_NaN(), certainty_m = 0;
};

/// Another robot of a team, as far as it is known, in this robot's map frame.
struct Teammate {
  core::Point2 p_map;                ///< where it was when it was last heard
  std::optional<core::Point2> goal;  ///< where it drives to; nothing: it waits or has finished
  bool is_heard = true;              ///< now; else all this is of the past
  bool goes_first = false;           ///< of two who are as near to a place, it takes it
};

}  // namespace slam::choices
