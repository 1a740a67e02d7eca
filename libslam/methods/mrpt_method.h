#pragma once
#include <mrpt/maps/CMultiMetricMap.h>
#include <mrpt/obs/CActionRobotMovement2D.h>
#include <mrpt/slam/CMetricMapBuilder.h>

#include <memory>
#include <vector>

#include "libslam/builders/mapping_options.h"
#include "libslam/methods/motion_options.h"
#include "libslam/methods/slam_method.h"

namespace slam::methods {

/// A method that is fed in MRPT's own way, with an action and a frame of observations for each step; MRPT's
/// or ours. It is stopped (MethodError) before its grids grow beyond [mapping] max_map_cells, and MRPT's
/// generator is seeded for each step.
class MrptMethod : public SlamMethod {
 public:
  MrptMethod(std::unique_ptr<mrpt::slam::CMetricMapBuilder> builder, const builders::MappingOptions& mapping,
             const MotionOptions& motion, std::uint64_t seed);

  core::Pose2 process(const MethodStep& step) override;
  mrpt::slam::CMetricMapBuilder& mrptBuilder() const override { return *builder_; }
  void continueMap(const mrpt::maps::CSimpleMap& key_frames, const std::optional<core::Pose2>& T_map_robot,
                   bool keep_map) override;

 protected:
  /// Gives the builder a step's scans, and its motion. Errors: MethodError.
  virtual void feed(const MethodStep& step,
                    const std::shared_ptr<mrpt::obs::CActionRobotMovement2D>& action) const;
  /// Cells of all grids once they reach so far around the place, in the map frame.
  virtual double cellsWith(const core::Point2& centre, double reach_m) const;
  /// How far from the robot the scan can change a grid.
  virtual double reach(const lidar::Scan& scan) const;
  const builders::MappingOptions& mapping() const { return mapping_; }

 private:
  void requireBoundedMap(const core::Pose2& T_map_robot, double reach_m) const;

  std::unique_ptr<mrpt::slam::CMetricMapBuilder> builder_;
  builders::MappingOptions mapping_;
  mrpt::obs::CActionRobotMovement2D::TMotionModelOptions motion_model_;
  std::uint64_t seed_;
  core::Pose2 T_map_robot_;
};

/// Cells of a rectangle once it also holds the square of this reach.
struct GridExtent {
  double x_min, x_max, y_min, y_max, resolution_m;
  double cellsWith(const core::Point2& centre, double reach_m) const;
};
/// Of all grids in it, once they reach so far.
double cellsOf(const mrpt::maps::CMultiMetricMap& maps, const core::Point2& centre, double reach_m);

double farthestReturn(const lidar::Scan& scan);

/// MRPT's exceptions carry a stack trace; one line of it says what happened.
std::string firstLine(const std::string& text);

}  // namespace slam::methods
