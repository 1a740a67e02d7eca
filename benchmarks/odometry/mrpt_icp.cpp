#include "benchmarks/odometry/mrpt_icp.h"

#include <mrpt/maps/CSimplePointsMap.h>
#include <mrpt/math/TPose2D.h>
#include <mrpt/obs/CObservation2DRangeScan.h>
#include <mrpt/poses/CPosePDFGaussian.h>
#include <mrpt/slam/CICP.h>

#include "libslam/lidar/mrpt_types.h"

namespace odometry_bench {
namespace {

using slam::odometry::ScanMotion;

class MrptIcp : public slam::odometry::ScanOdometry {
 public:
  explicit MrptIcp(const IcpSettings& settings) : settings_(settings) {
    auto& options = icp_.options;
    options.ICP_algorithm = mrpt::slam::icpClassic;
    options.maxIterations = static_cast<unsigned>(settings.iterations);
    options.thresholdDist = settings.threshold_m;
    options.thresholdAng = slam::core::degToRad(settings.threshold_deg);
    options.smallestThresholdDist = settings.smallest_threshold_m;
    options.ALFA = settings.shrink;
    options.onlyUniqueRobust = false;  // with it, one pair is enough for a jump to the origin
    options.corresponding_points_decimation = 1;
  }

  void reset() override { reference_.reset(), guess_ = {}; }

  ScanMotion update(const slam::lidar::Scan& scan, const slam::odometry::Commanded&) override {
    auto points = std::make_unique<mrpt::maps::CSimplePointsMap>();
    points->insertionOptions.minDistBetweenLaserPoints = static_cast<float>(settings_.point_distance_m);
    points->insertionOptions.also_interpolate = false;
    points->insertObservation(*slam::lidar::toMrpt(scan));
    ScanMotion motion;
    motion.covariance = {1e-4, 0, 0, 0, 1e-4, 0, 0, 0, 1e-4};
    if (reference_) {
      mrpt::slam::CICP::TReturnInfo info;
      const auto pdf =
          icp_.Align(reference_.get(), points.get(), mrpt::poses::CPose2D(slam::lidar::toMrpt(guess_)), info);
      motion.T_previous_current = slam::lidar::fromMrpt(pdf->getMeanVal().asTPose());
      motion.reliable = info.goodness > 0.5f;
      if (settings_.constant_velocity) guess_ = motion.T_previous_current;
    }
    reference_ = std::move(points);
    return motion;
  }

 private:
  IcpSettings settings_;
  mrpt::slam::CICP icp_;
  std::unique_ptr<mrpt::maps::CSimplePointsMap> reference_;
  slam::core::Pose2 guess_;
};

}  // namespace

std::unique_ptr<slam::odometry::ScanOdometry> makeMrptIcp(const IcpSettings& settings) {
  return std::make_unique<MrptIcp>(settings);
}

}  // namespace odometry_bench
