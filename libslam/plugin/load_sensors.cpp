#include <mrpt/core/initializer.h>

#include "libslam/plugin/simulated_lidar.h"

namespace {
MRPT_INITIALIZER(registerSimulatedLidar) {
  slam::plugin::registerSensors();
}
}  // namespace
