#pragma once
#include <optional>
#include <vector>

#include "libslam/core/pose2.h"
#include "libslam/keyframes/keyframe_map.h"
#include "libslam/lidar/scan.h"
#include "libslam/wheels/leaps.h"
#include "libslam/wheels/silence.h"
#include "libslam/wheels/steady_motion.h"
#include "libslam/wheels/way_sign.h"
#include "libslam/wheels/wheel_calibration.h"

namespace slam::tracking {

/// A step as odometry has it, or else the motion before, and standard deviations.
struct Prediction {
  core::Pose2 T_previous_robot;  ///< m, rad: the robot in its frame at the scan before
  double sigma_xy_m, sigma_turn_rad;
};

/// The last scan of a lidar, and how the robot has moved from there to the scan before the one at hand.
struct Seen {
  lidar::Scan scan;
  core::Pose2 T_seen_robot;
};

/// Two scans that contradict each other by more than this: the motion between them is wrong.
inline constexpr double kBroken = 0.5;

/// What is known of a robot's motion from one scan to the next before the new one is matched: odometry set
/// right by what the drive so far showed, or that the robot goes on as it did, and the last scan of the same
/// lidar. Each of several lidars is known by its mounting. For the rooms of graph SLAM only.
///
/// Per scan: begin(), whatever else, setStep(), end().
class Motion {
 public:
  /// Journal entries go to the map, which has to stay where it is.
  explicit Motion(keyframes::KeyframeMap& map) : map_(&map), options_(&map.options()) {}

  /// A new scan. Whether there is odometry, which is none where it leaps or says nothing.
  bool begin(const lidar::Scan& scan, const core::Pose2& T_previous_robot, bool has_odometry);
  /// What the scan at hand has shown of the step, or what stands in for it. Before that, see step().
  void setStep(const core::Pose2& T_previous_robot) { T_previous_robot_ = T_previous_robot; }
  /// After the scan was taken in.
  void end(const lidar::Scan& scan);
  /// The robot was put somewhere: nothing goes on.
  void restart();

  /// The last step as it was found; after begin() without odometry as the motion before goes on.
  const core::Pose2& step() const { return T_previous_robot_; }
  /// Since the scan before, s.
  double period_s() const { return period_s_; }
  /// A step of the wheels, set right.
  core::Pose2 corrected(const core::Pose2& T_wheels) const { return wheels_.corrected(T_wheels); }
  /// The step that odometry has, or else step(), and how far it may be off: in the robot's frame before it.
  Prediction predict(const core::Pose2& T_previous_robot, bool has_odometry) const;
  /// Between two scans; of an indoor robot, and no farther than where little is seen twice.
  double farthestMove() const;
  /// Standard deviation of a step's turn, by what the drive so far showed. Wheels and lidar keep different
  /// time: what wheels say of a turn may belong to the step before or after.
  double sigmaOfWheels_rad(const core::Pose2& T_wheels) const;
  /// Whether wheels that slip may have said such a step of another one: they turn without the robot, which
  /// goes no farther than they do.
  bool isSlip(const core::Pose2& T_previous_robot, const Prediction& by_wheels) const;

  /// The last scan of the lidar that made the one at hand; null without one that says anything.
  const Seen* before() const;
  /// The robot's motion since the scan before, from this scan and the last one of its lidar alone; nothing
  /// where they leave it open. Dear, and asked more than once.
  std::optional<core::Pose2> fromScans(const lidar::Scan& scan) const;
  /// Whether fromScans() was asked of the scan at hand.
  bool isFoundFromScans() const { return has_motion_; }
  /// How far a scan and the last one of its lidar contradict each other after a motion, 0..1: of the points
  /// that the one before speaks of, those in whose place it saw that there is nothing. It has to speak of
  /// most of them; what is missing there counts, too. 0 without a scan before.
  double brokenBy(const std::vector<scanmatch::PatchPoint>& points,
                  const core::Pose2& T_previous_robot) const;

  /// A matched step beside what odometry says. `is_believed`: else only whether the robot went the other way.
  void learn(const core::Pose2& T_corrected, const core::Pose2& T_matched, double way_told, double turn_told,
             bool is_believed);
  /// Nothing is learnt of a step.
  void learnNothing() { wheels_.endPiece(); }
  /// What speaks against wheels that count backwards motion forwards, in nats.
  double againstBackwards() const { return way_sign_.against(); }
  /// What was learnt of the wheels, for the journal.
  void noteWheels() const;

 private:
  bool goOn(const lidar::Scan& scan, const core::Pose2& T_previous_robot, bool has_odometry);
  std::optional<core::Pose2> find(const lidar::Scan& scan) const;

  keyframes::KeyframeMap* map_;
  const keyframes::GraphOptions* options_;
  core::Pose2 T_previous_robot_;
  wheels::WheelCalibration wheels_{wheels::Told::kByAll};
  wheels::Leaps leaps_;
  wheels::Silence silence_;
  wheels::WaySign way_sign_;
  wheels::SteadyMotion steady_;
  double turn_rad_ = 0, turned_before_rad_ = 0;  ///< by odometry, to the scan at hand and to the one before
  std::vector<Seen> seen_;                       ///< one per lidar
  int before_ = -1;                  ///< of these, the one of the scan at hand; -1: its lidar is new
  mutable bool has_motion_ = false;  ///< of the scan at hand: find() was asked
  mutable std::optional<core::Pose2> motion_;  ///< and gave this
  double previous_time_s_ = 0;                 ///< of the last scan of any
  double period_s_ = 0, mean_period_s_ = 0;    ///< from the scan before to the last one
};

}  // namespace slam::tracking
