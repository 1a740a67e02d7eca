#pragma once
#include <Eigen/Core>

namespace slam::tracking {

/// By how much a step's error differs from what is assumed of it, in variance: distance and turn apart, by
/// all matches so far. Where scans hold a match, what it moves the predicted pose by is the step's error and
/// the scans' noise; what the latter leaves is the step's (variance components: Helmert 1907). For what is
/// told of poses, not for matching: a step that is wrong once has to be allowed for.
class StepVariance {
 public:
  /// `moved`: from the predicted pose to the matched one, x, y (m), phi (rad), map frame. `gain`: share of
  /// the step's error that the match took away. `assumed`: covariance of the step. `noise`: of the match;
  /// `noise_before`: of the one before.
  void add(const Eigen::Vector3d& moved, const Eigen::Matrix3d& gain, const Eigen::Matrix3d& assumed,
           const Eigen::Matrix3d& noise, const Eigen::Matrix3d& noise_before);
  /// A step's covariance, by what is known now.
  Eigen::Matrix3d of(const Eigen::Matrix3d& assumed) const;

 private:
  struct Component {
    double sum, count;
    double share() const;
  };
  static constexpr double kAssumed = 10;  ///< as if so many steps had been as assumed
  Component way_{kAssumed, kAssumed}, turn_{kAssumed, kAssumed};
};

}  // namespace slam::tracking
