#include "@name@.h"

@Name@::@Name@() {
  slam::odometry::ScanOdometryOptions options;
  options.method = "plicp";
  odometry_ = slam::odometry::makeScanOdometry(options);
}

// Edit here: this is dead reckoning by the library's own ICP between consecutive scans. It forgets every scan
// but the last, so it drifts; a map to match against would hold it.
slam::core::Pose2 @Name@::update(const slam::lidar::Scan& scan, const slam::core::Pose2& T_previous_current) {
  const auto motion = odometry_->update(scan);
  if (!is_first_) T_map_robot_ = T_map_robot_ * (motion.reliable ? motion.T_previous_current : T_previous_current);
  is_first_ = false;
  return T_map_robot_;
}
