#include "libslam/wheels/wheel_calibration.h"

namespace slam::wheels {

core::Pose2 WheelCalibration::corrected(const core::Pose2& T_wheels) const {
  return heading_.corrected(scale_.corrected(T_wheels));
}

void WheelCalibration::learn(const core::Pose2& T_corrected, const core::Pose2& T_matched, double way_told,
                             double turn_told) {
  if (!core::isFinite(T_corrected) || !core::isFinite(T_matched)) return endPiece();
  heading_.learn(T_corrected, T_matched, turn_told);
  scale_.learn(T_corrected, T_matched, way_told);
}

void WheelCalibration::endPiece() {
  scale_.endPiece();
  heading_.endPiece();
}

}  // namespace slam::wheels
