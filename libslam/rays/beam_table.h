#pragma once
#include <vector>

#include "libslam/core/pose2.h"

namespace slam::rays {

/// Where the beams of a lidar point: made once per lidar, so that a scan costs no sine and cosine per beam.
/// Beam i is at first_angle_rad + i * step_rad in the lidar frame. Any order, any angle; the fast casters
/// like neighbours in the table to be neighbours in the world.
class BeamTable {
 public:
  BeamTable() = default;
  /// beams <= 0 makes an empty table. Angles that are not finite: ContractError.
  BeamTable(double first_angle_rad, double step_rad, int beams);

  int size() const { return static_cast<int>(cosines_.size()); }
  double firstAngle() const { return first_angle_rad_; }
  double step() const { return step_rad_; }
  const double* cosines() const { return cosines_.data(); }
  const double* sines() const { return sines_.data(); }

 private:
  double first_angle_rad_ = 0, step_rad_ = 0;
  std::vector<double> cosines_, sines_;
};

/// A rotation by its cosine and sine.
struct Rotation {
  explicit Rotation(double angle_rad);
  double cosine, sine;

  /// The beam as seen from the frame that this rotation turns into: the products and the sum are rounded one
  /// by one, here and in every caster.
  core::Point2 operator*(const core::Point2& beam) const {
    return {cosine * beam.x - sine * beam.y, sine * beam.x + cosine * beam.y};
  }
};

}  // namespace slam::rays
