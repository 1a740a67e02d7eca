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
/// What a line foretold so many metres (or radians) ago counts a third when the lines are weighed; no piece
/// counts more than this many standard deviations.
constexpr double kJudged = 300, kTail = 3;
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
  const auto off2 = [&](double per_metre, double per_radian) {
    return square(piece_.excess_rad - per_metre * piece_.ahead_m - per_radian * piece_.turn_rad) / length;
  };
  for (auto& line : lines_)
    line.missed = core::exp(-length / kJudged) * line.missed +
                  std::min(off2(line.per_metre, line.per_radian) / scatter.variance(), square(kTail));
  const double weight =
      scatter.add(off2(per_metre_, per_radian_), core::exp(-length / kMemory)) / (scatter.assumed() * length);
  for (auto& line : lines_) addTo(line, weight, length);
  weighLines();
  endPiece();
}

/// Adds the piece at hand to a line.
void WheelHeading::addTo(Line& line, double weight, double length) const {
  const double stays = core::exp(-length / line.memory);
  line.way_way = stays * line.way_way + weight * square(piece_.ahead_m);
  line.way_turn = stays * line.way_turn + weight * piece_.ahead_m * piece_.turn_rad;
  line.turn_turn = stays * line.turn_turn + weight * square(piece_.turn_rad);
  line.way_excess = stays * line.way_excess + weight * piece_.ahead_m * piece_.excess_rad;
  line.turn_excess = stays * line.turn_excess + weight * piece_.turn_rad * piece_.excess_rad;
  // What was assumed before counts by the noise that the pieces show.
  const double a = line.way_way + driving_.variance() / driving_.assumed() / square(kSigmaPerMetre),
               d = line.turn_turn + turning_.variance() / turning_.assumed() / square(kSigmaPerRadian);
  const double determinant = a * d - line.way_turn * line.way_turn;
  line.per_metre =
      std::clamp((d * line.way_excess - line.way_turn * line.turn_excess) / determinant, -kMost, kMost);
  line.per_radian =
      std::clamp((a * line.turn_excess - line.way_turn * line.way_excess) / determinant, -kMost, kMost);
}

/// Each line counts by how well it foretold the pieces.
void WheelHeading::weighLines() {
  double least = lines_.front().missed;
  for (const auto& line : lines_) least = std::min(least, line.missed);
  double weights = 0, per_metre = 0, per_radian = 0;
  for (const auto& line : lines_) {
    const double weight = core::exp((least - line.missed) / 2);
    weights += weight;
    per_metre += weight * line.per_metre;
    per_radian += weight * line.per_radian;
  }
  per_metre_ = per_metre / weights;
  per_radian_ = per_radian / weights;
}

}  // namespace slam::wheels
