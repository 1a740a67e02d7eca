#include "libslam/methods/slam_method.h"

#include <mrpt/core/Clock.h>
#include <mrpt/maps/COccupancyGridMap2D.h>
#include <mrpt/maps/CSimpleMap.h>
#include <mrpt/math/TPose2D.h>
#include <mrpt/poses/CPose3D.h>
#include <mrpt/poses/CPose3DPDF.h>
#include <mrpt/poses/CPosePDFGaussian.h>
#include <mrpt/slam/CMetricMapBuilder.h>

#include <array>
#include <string>

#include "libslam/builders/map_grid.h"
#include "libslam/core/error.h"
#include "libslam/gridmap/mrpt_grid.h"
#include "libslam/lidar/mrpt_types.h"

namespace slam::methods {
namespace {

/// MRPT's ICP stamps a start pose with the clock, and then takes the odometry of a log from the past for
/// stale.
class StoppedClock {
 public:
  StoppedClock() {
    mrpt::Clock::setSimulatedTime(mrpt::Clock::fromDouble(1));
    mrpt::Clock::setActiveClock(mrpt::Clock::Source::Simulated);
  }
  ~StoppedClock() { mrpt::Clock::setActiveClock(before_); }
  StoppedClock(const StoppedClock&) = delete;
  StoppedClock& operator=(const StoppedClock&) = delete;

 private:
  mrpt::Clock::Source before_ = mrpt::Clock::getActiveClock();
};

}  // namespace

std::optional<Eigen::Matrix3d> SlamMethod::poseCovariance() const {
  mrpt::math::CMatrixDouble66 spatial;  // x, y, z, yaw, pitch, roll
  mrpt::poses::CPose3D mean;
  mrptBuilder().getCurrentPoseEstimation()->getCovarianceAndMean(spatial, mean);
  constexpr std::array<int, 3> kPlanar = {0, 1, 3};
  Eigen::Matrix3d covariance;
  for (int row = 0; row < 3; ++row)
    for (int column = 0; column < 3; ++column)
      covariance(row, column) =
          spatial(kPlanar[static_cast<size_t>(row)], kPlanar[static_cast<size_t>(column)]);
  return covariance;
}

gridmap::OccupancyRaster SlamMethod::map() const {
  return gridmap::fromMrpt(*builders::gridOf(mrptBuilder()));
}

void SlamMethod::continueMap(const mrpt::maps::CSimpleMap& key_frames,
                             const std::optional<core::Pose2>& T_map_robot, bool keep_map) {
  mrpt::poses::CPosePDFGaussian start;
  start.mean = mrpt::poses::CPose2D(lidar::toMrpt(T_map_robot.value_or(core::Pose2{})));
  const StoppedClock clock;
  mrptBuilder().initialize(key_frames, T_map_robot ? &start : nullptr);
  mrptBuilder().options.enableMapUpdating = !keep_map;
}

std::vector<loops::PartPlace> SlamMethod::joinMaps(const std::vector<mrpt::maps::CSimpleMap>& /*maps*/,
                                                   core::Progress& /*progress*/) {
  throw core::ContractError("joinMaps(): of a type that joins none");
}

void silence(mrpt::slam::CMetricMapBuilder& builder) {
  builder.setVerbosityLevel(mrpt::system::LVL_ERROR);
  builder.logging_enable_console_output = false;
}

void requireFinite(const core::Pose2& pose, const char* what) {
  if (!core::isFinite(pose)) throw core::MethodError(std::string(what) + " is not finite");
}

}  // namespace slam::methods
