#include "libslam/wheels/wheel_heading.h"

#include <algorithm>
#include <cmath>

#include "libslam/core/elementary.h"

namespace slam::wheels {
namespace {

/// What wheels are taken to be wrong by before anything is learnt, rad per metre and per radian; and the most
/// that is no slip.
constexpr double kSigmaPerMetre = 0.05, kSigmaPerRadian = 0.05, kMost = 0.2;
/// A piece ends so far from where it began (m or rad), or after so much to and fro.
constexpr double kPiece = 0.5, kToAndFro = 2;
/// More than half a turn between two scans may have been one the other way round.
constexpr double kMostTurn_rad = 3;

double square(double x) {
  return x * x;
}

}  // namespace

core::Pose2 WheelHeading::corrected(const core::Pose2& T_wheels) const {
  const double more = per_metre_ * T_wheels.x + per_radian_ * T_wheels.phi;
  if (more == 0) return T_wheels;
  // Along an arc the chord turns by half of the turn.
  const auto [s, c] = core::sinCos(more / 2);
  return {c * T_wheels.x - s * T_wheels.y, s * T_wheels.x + c * T_wheels.y,
          core::wrapToPi(T_wheels.phi + more)};
}

double WheelHeading::sigma_rad(const core::Pose2& T) const {
  return std::sqrt(driving_.variance() * core::hypot(T.x, T.y) + turning_.variance() * std::abs(T.phi));
}

void WheelHeading::learn(const core::Pose2& T_corrected, const core::Pose2& T_matched, double told) {
  const double step_m = core::hypot(T_corrected.x, T_corrected.y);
  if (!(told >= kTold) || !(step_m < kMostStep_m) || !(std::abs(T_corrected.phi) < kMostTurn_rad))
    return endPiece();
  // The wheels' own turn and way ahead; the chord's turn by the correction is of second order.
  const double turn_rad = (T_corrected.phi - per_metre_ * T_corrected.x) / (1 + per_radian_);
  piece_.ahead_m += T_corrected.x;
  piece_.way_m += std::abs(T_corrected.x);
  piece_.turn_rad += turn_rad;
  piece_.turned_rad += std::abs(turn_rad);
  piece_.excess_rad += core::angleDifference(T_matched.phi, T_corrected.phi) + (T_corrected.phi - turn_rad);
  const double net = std::max(std::abs(piece_.ahead_m), std::abs(piece_.turn_rad));
  if (net >= kPiece || piece_.way_m + piece_.turned_rad >= kToAndFro) addPiece();
}

void WheelHeading::addPiece() {
  const double length = piece_.way_m + piece_.turned_rad;
  Scatter& scatter = piece_.way_m >= piece_.turned_rad ? driving_ : turning_;
  const double off_rad = piece_.excess_rad - per_metre_ * piece_.ahead_m - per_radian_ * piece_.turn_rad;
  const double stays = core::exp(-length / kMemory);
  const double weight = scatter.add(square(off_rad) / length, stays) / (scatter.assumed() * length);
  way_way_ = stays * way_way_ + weight * square(piece_.ahead_m);
  way_turn_ = stays * way_turn_ + weight * piece_.ahead_m * piece_.turn_rad;
  turn_turn_ = stays * turn_turn_ + weight * square(piece_.turn_rad);
  way_excess_ = stays * way_excess_ + weight * piece_.ahead_m * piece_.excess_rad;
  turn_excess_ = stays * turn_excess_ + weight * piece_.turn_rad * piece_.excess_rad;
  // What was assumed before counts by the noise that the pieces show.
  const double a = way_way_ + driving_.variance() / driving_.assumed() / square(kSigmaPerMetre),
               d = turn_turn_ + turning_.variance() / turning_.assumed() / square(kSigmaPerRadian);
  const double determinant = a * d - way_turn_ * way_turn_;
  per_metre_ = std::clamp((d * way_excess_ - way_turn_ * turn_excess_) / determinant, -kMost, kMost);
  per_radian_ = std::clamp((a * turn_excess_ - way_turn_ * way_excess_) / determinant, -kMost, kMost);
  endPiece();
}

}  // namespace slam::wheels
