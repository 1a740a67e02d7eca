#pragma once
#include <functional>
#include <optional>
#include <vector>

#include "libslam/core/pose2.h"
#include "libslam/keyframes/keyframe_map.h"
#include "libslam/lidar/scan.h"
#include "libslam/tracking/local_map.h"
#include "libslam/tracking/motion.h"
#include "libslam/tracking/unskewer.h"

namespace slam::tracking {

/// What is known of a scan's pose before it is matched; map frame.
struct Expected {
  Prediction step;
  bool has_odometry;
  core::Pose2 T_before, predicted;
  core::Pose2 backwards;  ///< should odometry's metres be those of a motion backwards
  core::Pose2 by_wheels;  ///< where odometry leads that was let go, see Tracker::noteMatch()
};

/// Where a scan lies in the map around the robot. For the rooms of graph SLAM only.
///
/// A match begins at the best of several starts: odometry's, the last motion, odometry with its metres
/// backwards, turned a little, and what the two scans alone say. Odometry holds it as a robust prior, and is
/// let go where another place explains so much more that odometry's error, of which long tails are expected,
/// is the likelier. A match that explains too little is searched for on a lattice.
class Tracker {
 public:
  using Points = std::vector<scanmatch::PatchPoint>;
  /// `map` has to stay where it is.
  explicit Tracker(keyframes::KeyframeMap& map);

  Motion& motion() { return motion_; }
  const Motion& motion() const { return motion_; }
  LocalMap& around() { return around_; }
  const LocalMap& around() const { return around_; }

  /// After Motion::begin().
  Expected expect(const core::Pose2& T_map_before, const core::Pose2& T_previous_robot,
                  bool has_odometry) const;
  struct Match {
    scanmatch::MatchResult result;
    bool is_odometry_dropped;
  };
  /// The best match of a scan to the map around.
  Match match(const lidar::Scan& scan, const Points& points, const Expected& expected);
  /// A scan that was deskewed set right, from a match to the map around that takes it as it is (see
  /// Unskewer). Nothing of one that was not deskewed, or is poorly explained.
  std::optional<Unskewer::Unskewed> unskew(const lidar::Scan& scan, const Points& points,
                                           const Expected& expected, const scanmatch::MatchResult& matched);
  /// After a match is taken. Where it has let odometry go, odometry alone is followed, too, for as long as it
  /// may have been right after all. It was not when some scans in a row are explained; it was when the robot
  /// is there again, and then the keyframes in between lie wrong. Meanwhile they do not vouch for themselves.
  void noteMatch(const core::Pose2& T_map_robot, const Points& points, const Expected& expected,
                 bool is_explained);
  bool isFollowingWheels() const { return by_wheels_.has_value(); }
  /// What was matched since odometry was let go is believed.
  void forgetWheels();

 private:
  /// Where matching begins, and how much more than from odometry's pose is explained there.
  struct Start {
    core::Pose2 T_map_robot;
    double gain;
  };
  /// Another start must explain this much more than odometry's to be taken at all.
  static constexpr double kStartGain = 0.02;
  using Consider = std::function<void(const core::Pose2&)>;
  // starts.cpp
  Start bestStart(const lidar::Scan& scan, const Points& points, const Expected& expected) const;
  void turnAbout(const Expected& expected, const Consider& consider) const;
  void slide(const Expected& expected, const core::Pose2& motion, const Consider& consider) const;

  double unlikely(const core::Pose2& T_map_robot, const Expected& expected) const;
  double brokenAt(const core::Pose2& T_map_robot, const Points& points, const Expected& expected) const;
  bool isBetter(const scanmatch::MatchResult& other, const scanmatch::MatchResult& than, double least_gain,
                const Points& points, const Expected& expected) const;
  void stayWithWheels(const Points& points, const Expected& expected, scanmatch::MatchResult& result) const;
  bool isToldByScans(const core::Pose2& T_map_robot, const Points& points, const Expected& expected) const;
  void followWheels(const core::Pose2& T_wheels, bool lets_go, bool is_elsewhere, bool is_explained);

  // look_around.cpp: a scan that is poorly explained
  bool lookAround(const Points& points, const Expected& expected, scanmatch::MatchResult& result);
  std::optional<scanmatch::MatchResult> recover(const Points& points, const core::Pose2& predicted,
                                                const core::Pose2& matched) const;
  std::vector<core::Pose2> placesWithinReach(const Points& points, const Expected& expected) const;

  keyframes::KeyframeMap* map_;
  const keyframes::GraphOptions* options_;
  Motion motion_;
  LocalMap around_;
  Unskewer unskewer_;
  std::optional<core::Pose2> by_wheels_;  ///< map frame: where odometry leads that was let go
  int unsure_from_ = 0;                   ///< keyframe; meanwhile
  int explained_ = 0;                     ///< scans in a row
  double let_go_m_ = 0;                   ///< driven then
};

}  // namespace slam::tracking
