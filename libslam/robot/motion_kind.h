#pragma once
#include "libslam/core/pose2.h"
#include "libslam/robot/drive.h"

namespace slam::robot {

/// What the robot was told to do between two scans. A robot that commands itself knows it; only how far it
/// went is for the scans to say.
enum class MotionKind {
  kUnknown,  ///< nobody said
  kRest,     ///< no command: it stood
  kMove,     ///< along the heading, ahead or back
  kTurn,     ///< in place
  kArc       ///< both at once; the original robot has no such command
};

/// The command that a scan ended or interrupted.
struct Commanded {
  MotionKind kind = MotionKind::kUnknown;
  bool continues = false;  ///< the same command as at the scan before: several scans were taken during it
  Commanded() = default;
  Commanded(MotionKind of_kind, bool still_the_same = false) : kind(of_kind), continues(still_the_same) {}
};

/// kRest for a command without speed or without duration.
MotionKind kindOf(const Command& command);

/// The kind that an increment of the wheels shows, for logs that do not say what was commanded: a turn when
/// its centre of rotation lies within half the track, 0.25 m, so that the wheels went opposite ways; a move
/// when it lies farther than 1 m away; else an arc. Rest is below a millimetre, of the robot and of its
/// wheels by the turn. Half the track of robots that carry such lidars is 0.1 to 0.4 m. The odometry of a
/// turn in place moves by some centimetres per radian, that of a move turns by some degrees per metre: both
/// are a tenth of what would make them arcs.
MotionKind kindOf(const core::Pose2& T_previous_robot);

/// Puts the commands of single scan periods together to whole ones. A drive is told anew at every scan; what
/// the original document calls a command, move(step) or turn(angle), is a run of such periods: of one kind
/// and one direction, an arc also of one curvature, without a rest between.
class CommandSeries {
 public:
  /// The command that led to the next scan. `is_whole`: one of its own, even where the one before was alike.
  Commanded next(const Command& command, bool is_whole = false);
  /// The same by the wheels alone. An arc never continues: its curvature is not known well enough.
  Commanded next(const core::Pose2& T_previous_robot);

 private:
  Commanded join(MotionKind kind, double along, double turn, bool may_continue);
  MotionKind kind_ = MotionKind::kUnknown;
  double along_ = 0, turn_ = 0;
};

}  // namespace slam::robot
