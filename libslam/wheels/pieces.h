#pragma once

/// What the files of this room share: both parts learn from pieces of the way, in the same manner. Other
/// rooms use wheel_calibration.h.
namespace slam::wheels {

/// Below this share of a match, a scan hardly told what the robot did.
constexpr double kTold = 0.5;
/// A longer step is a leap, and none of wheels.
constexpr double kMostStep_m = 20;
/// What was driven so many metres (or radians) ago counts a third.
constexpr double kMemory = 100;

/// What pieces scatter by, as the square of how far one is off over its length: what was assumed before
/// pieces showed it, and sums of weights and squares that fade.
class Scatter {
 public:
  explicit Scatter(double assumed) : assumed_(assumed) {}
  double assumed() const { return assumed_; }
  double variance() const { return (kAssumed * assumed_ + squared_) / (kAssumed + pieces_); }
  /// Takes one in; those before count `stays` of what they did. What it counts, in (0, 1]: the less the
  /// farther it is off beyond three standard deviations.
  double add(double off2, double stays) {
    const double tail = kTail * kTail * variance(), weight = off2 > tail ? tail / off2 : 1;
    pieces_ = stays * pieces_ + weight;
    squared_ = stays * squared_ + weight * off2;
    return weight;
  }

 private:
  static constexpr double kTail = 3;
  static constexpr double kAssumed = 2;  ///< pieces that what was assumed counts
  double assumed_, pieces_ = 0, squared_ = 0;
};

}  // namespace slam::wheels
