#include "libslam/odometry/methods.h"
namespace slam::odometry {
std::unique_ptr<ScanOdometry> makeRangeFlowOdometry(const ScanOdometryOptions& options) {
  return makeCorrelationOdometry(options);
}
}
