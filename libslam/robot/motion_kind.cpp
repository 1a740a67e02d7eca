#include "libslam/robot/motion_kind.h"

#include <algorithm>
#include <cmath>

#include "libslam/core/elementary.h"

namespace slam::robot {
namespace {

constexpr double kHalfTrack_m = 0.25, kRest_m = 1e-3;
constexpr double kStraight_m = 1;  // radius of the sharpest curve that is still a move
constexpr double kDoubt = 2;       // an arc within this factor of a turn or of a move may be one that slipped
constexpr double kSlipped = 0.5;   // of a direction's sign: the period before was such an arc

double sign(double value) {
  return value > 0 ? 1 : (value < 0 ? -1 : 0);
}

}  // namespace

MotionKind kindOf(const Command& command) {
  const bool moves = command.speed_mps != 0, turns = command.turn_rate_radps != 0;
  if (!(command.duration_s > 0) || (!moves && !turns)) return MotionKind::kRest;
  if (moves && turns) return MotionKind::kArc;
  return moves ? MotionKind::kMove : MotionKind::kTurn;
}

MotionKind kindOf(const core::Pose2& T_previous_robot) {
  const double along_m = core::hypot(T_previous_robot.x, T_previous_robot.y);
  const double around_m = kHalfTrack_m * std::abs(T_previous_robot.phi);
  if (std::max(along_m, around_m) < kRest_m) return MotionKind::kRest;
  if (along_m < around_m) return MotionKind::kTurn;
  return along_m > kStraight_m * std::abs(T_previous_robot.phi) ? MotionKind::kMove : MotionKind::kArc;
}

Commanded CommandSeries::join(MotionKind kind, double along, double turn, bool may_continue) {
  const bool is_motion = kind != MotionKind::kRest && kind != MotionKind::kUnknown;
  const bool same = kind == kind_ && along == along_ && turn == turn_;
  kind_ = kind, along_ = along, turn_ = turn;
  return {kind, is_motion && same && may_continue};
}

Commanded CommandSeries::next(const Command& command, bool is_whole) {
  const MotionKind kind = kindOf(command);
  if (kind == MotionKind::kArc) return join(kind, command.speed_mps, command.turn_rate_radps, !is_whole);
  return join(kind, sign(command.speed_mps), sign(command.turn_rate_radps), !is_whole);
}

Commanded CommandSeries::next(const core::Pose2& T_previous_robot) {
  const MotionKind kind = kindOf(T_previous_robot);
  const double along = kind == MotionKind::kTurn ? 0 : sign(T_previous_robot.x);
  const double turn = kind == MotionKind::kMove ? 0 : sign(T_previous_robot.phi);
  if (kind != MotionKind::kArc) return join(kind, along, turn, true);
  // One period in a row: a real arc goes on.
  const double along_m = core::hypot(T_previous_robot.x, T_previous_robot.y);
  const double turned_rad = std::abs(T_previous_robot.phi);
  const bool may_turn =
      kind_ == MotionKind::kTurn && turn == turn_ && along_m < kDoubt * kHalfTrack_m * turned_rad;
  const bool may_move =
      kind_ == MotionKind::kMove && along == along_ && along_m > kStraight_m / kDoubt * turned_rad;
  if (!may_turn && !may_move) return join(kind, along, turn, false);
  const Commanded slipped = join(kind_, along_, turn_, true);
  along_ *= kSlipped, turn_ *= kSlipped;
  return slipped;
}

}  // namespace slam::robot
