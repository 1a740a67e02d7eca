#pragma once
#include <array>

#include "libslam/core/pose2.h"
#include "libslam/wheels/pieces.h"

namespace slam::wheels {

/// How wheels turn where the robot does not, and how far they are to be believed, learnt while it drives:
/// wheels of unequal radius turn by so much per metre, a wrong base length makes every turn longer by the
/// same share. It adds up between two scans a metre or more apart, and whatever scans tell nothing of.
///
/// A line through pieces of about half a metre or half a radian, turn as matched minus turn of the wheels
/// over way and turn, of the last metres more than of those before. How far back depends on the robot: some
/// wheels turn the same for years, others otherwise on every floor. So there are lines with memories of
/// several lengths, and each counts by how well it foretold the pieces (Bayesian model averaging). What was
/// assumed before counts by the noise that the pieces show, those that mostly drive and those that mostly
/// turn; pieces far off count less.
/// Simultaneous calibration and localisation as by Roy and Thrun, ICRA 1999, with the noise estimated; the
/// two parameters are the systematic errors of Borenstein and Feng, IEEE Transactions on Robotics and
/// Automation 12(6), 1996.
class WheelHeading {
 public:
  /// A step of the wheels (m, rad; in the robot's frame before it), its turn and direction set right.
  core::Pose2 corrected(const core::Pose2& T_wheels) const;
  /// A step: by corrected(), and as it was matched to a map; both in the robot's frame before it. `told`: of
  /// what holds the match's heading, the scan's share, in [0, 1]; the rest is odometry's own word. Too little
  /// ends the piece.
  void learn(const core::Pose2& T_corrected, const core::Pose2& T_matched, double told);
  /// Nothing is known of a step.
  void endPiece() { piece_ = {}; }
  /// Standard deviation of a corrected step's turn (rad), by what the pieces showed.
  double sigma_rad(const core::Pose2& T_corrected) const;
  /// By which the robot turns farther than its wheels say, per metre ahead (rad/m); 0 before anything is
  /// learnt.
  double perMetre() const { return per_metre_; }
  /// And per radian that they say.
  double perRadian() const { return per_radian_; }

 private:
  /// Normal equations of a line, fading, and what it says.
  struct Line {
    double memory;  ///< what was driven so many metres (or radians) ago counts a third
    double way_way = 0, way_turn = 0, turn_turn = 0, way_excess = 0, turn_excess = 0;
    double per_metre = 0, per_radian = 0;
    double missed = 0;  ///< squares of how far it was off, in standard deviations, fading
  };
  /// Sums along the piece at hand. `excess`: of the matched turns over the wheels'.
  struct Piece {
    double ahead_m = 0, way_m = 0, turn_rad = 0, turned_rad = 0, excess_rad = 0;
  };
  void addPiece();
  void addTo(Line& line, double weight, double length) const;
  void weighLines();

  double per_metre_ = 0, per_radian_ = 0;
  Piece piece_;
  Scatter driving_{4e-4}, turning_{2.5e-3};  ///< assumed: 0.02 rad on a metre, 0.05 rad on a radian
  std::array<Line, 3> lines_{{{10}, {30}, {kMemory}}};
};

}  // namespace slam::wheels
