#pragma once
#include "libslam/core/pose2.h"
#include "libslam/wheels/pieces.h"

namespace slam::wheels {

/// Which steps teach. kByEach: those of which the scan told half. kByAll: where scans are frequent each one
/// tells little, and all together tell a piece of the way. REQUIRES, then, shares without what bare walls
/// only seem to tell (scanmatch::MatchEvidence): along a corridor that adds up.
enum class Told { kByEach, kByAll };

/// How long a metre of the wheels is, learnt while the robot drives: worn tyres and wrong radii make every
/// step longer or shorter by the same share, which adds up where scans do not tell the way, along a bare
/// corridor. Rotation is WheelHeading's.
///
/// The ratio of the sums of the ways over pieces of half a metre, as matched and by the wheels, of the last
/// metres more than of those before. It is the best linear estimate where noise grows with the way, and
/// unlike a regression not drawn towards zero by the wheels' own noise; pieces, and not steps, because
/// standing wheels jitter and turning ones shift. Pieces far off, of slipping wheels, count less; what was
/// assumed before counts by the noise that the pieces show. Simultaneous calibration and localisation as by
/// Roy and Thrun, ICRA 1999, with the noise estimated.
class PathScale {
 public:
  explicit PathScale(Told told) : told_(told) {}
  /// A step of the wheels (m, rad; in the robot's frame before it), its length set right.
  core::Pose2 corrected(const core::Pose2& T_wheels) const;
  /// A step: by corrected(), and as it was matched to a map; both in the robot's frame before it. `told`: of
  /// what holds the match along the way, the scan's share, in [0, 1]; the rest is odometry's own word. A
  /// piece begins and ends where little of the way is left to that.
  void learn(const core::Pose2& T_corrected, const core::Pose2& T_matched, double told);
  /// Nothing is known of a step.
  void endPiece();
  /// True way over the wheels'; 1 before anything is learnt.
  double factor() const { return factor_; }

 private:
  void beginPiece();
  Told told_;
  double factor_ = 1;
  core::Pose2 T_wheels_, T_matched_;  ///< along the piece at hand
  double driven_m_ = 0;               ///< so far
  double open_m_ = 0;                 ///< of what was driven, what scans have not told yet
  double way_m_ = 0, excess_m_ = 0;   ///< sums over the pieces, fading
  Scatter scatter_{0.01};             ///< m^2 per metre; assumed: 0.1 m on a metre
};

}  // namespace slam::wheels
