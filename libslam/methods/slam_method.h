#pragma once
#include <Eigen/Core>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "libslam/core/journal.h"
#include "libslam/core/pose2.h"
#include "libslam/core/progress.h"
#include "libslam/gridmap/occupancy_raster.h"
#include "libslam/lidar/scan.h"
#include "libslam/loops/part_place.h"
#include "libslam/odometry/scan_odometry.h"

namespace mrpt::maps {
class CSimpleMap;
}
namespace mrpt::slam {
class CMetricMapBuilder;
}

namespace slam::graph {
class GraphSlam;
}

namespace slam::methods {

/// What is known of the robot's motion since the scan before.
struct StepMotion {
  core::Pose2 T_previous_robot;
  bool is_known = true;  ///< false: nobody says; of types that go on alone (MethodType) only
  std::optional<odometry::ScanMotion>
      from_scans;  ///< where the scans say it, with their spread; else the wheels do
};

/// One moment of a log, as a method gets it.
struct MethodStep {
  std::uint64_t number = 0;                ///< 0: the first
  double time_s = 0;                       ///< grows from step to step, also where the scans' stamps do not
  const lidar::Scan& scan;                 ///< deskewed; at least 2 beams
  const std::vector<lidar::Scan>& others;  ///< what other lidars saw at the same moment, deskewed
  const StepMotion& motion;
};

/// One SLAM method: scans and motions in, pose and map out. A new one is a class of its own with a MethodType
/// that makes it, and a line in methodTypes(). Everything that all methods share (where motions come from,
/// deskewing, limits of a log) is done before, in MapBuilder.
///
/// The map frame is the robot's pose at the first scan. Random numbers come from (seed, step number) alone.
/// Errors of process(): MethodError, of which the caller says the step.
class SlamMethod {
 public:
  virtual ~SlamMethod() = default;

  /// Returns T_map_robot after the step.
  virtual core::Pose2 process(const MethodStep& step) = 0;

  /// The same method as MRPT's programs know one; holds map and key frames.
  virtual mrpt::slam::CMetricMapBuilder& mrptBuilder() const = 0;

  /// Of x (m), y (m), phi (rad) in the map frame at the last step; nullopt: the method does not say.
  virtual std::optional<Eigen::Matrix3d> poseCovariance() const;
  virtual gridmap::OccupancyRaster map() const;

  /// Goes on in key frames of before instead of an empty map; keep_map: is only localised in them. nullopt:
  /// nobody knows where. REQUIRES a type that can (MethodType), and that no step was processed.
  virtual void continueMap(const mrpt::maps::CSimpleMap& key_frames,
                           const std::optional<core::Pose2>& T_map_robot, bool keep_map);
  /// Other maps of before beside that one: finds their places in it and in one another, and makes one map of
  /// all that have one. One for each. REQUIRES a type that can (MethodType), and that no step was processed.
  virtual std::vector<loops::PartPlace> joinMaps(const std::vector<mrpt::maps::CSimpleMap>& maps,
                                                 core::Progress& progress);
  /// After the last step. Errors: what `progress` throws; what there is then is whole.
  virtual void finish(core::Progress& /*progress*/) {}
  /// So many threads in all, the caller's among them, may work from now on. What comes out is the same.
  virtual void useThreads(int /*threads*/) {}
  /// CPU time so far of threads other than the caller's.
  virtual double threadSeconds() const { return 0; }

  /// In the order that it happened; scans are counted in steps.
  virtual std::vector<core::JournalEntry> journal() const { return {}; }
  /// The path that belongs to the map as it is now, one pose for each of `online`; nullopt: that given
  /// online.
  virtual std::optional<core::Trajectory> finalPath(const core::Trajectory& /*online*/) const { return {}; }
  /// Of each pose of finalPath(); empty: the method does not say.
  virtual std::vector<Eigen::Matrix3d> finalCovariances() const { return {}; }
  /// How sure finalPath() is of the second pose as the first sees it, for pairs of steps; empty: it does not
  /// say.
  virtual std::vector<Eigen::Matrix3d> relativeCovariances(
      const std::vector<std::pair<int, int>>& /*steps*/) const {
    return {};
  }
  virtual std::vector<core::Pose2> particlePoses() const { return {}; }
  /// nullptr: the method keeps none.
  virtual const graph::GraphSlam* graph() const { return nullptr; }
};

/// No console, no wall clock: for every builder of MRPT's kind.
void silence(mrpt::slam::CMetricMapBuilder& builder);

/// Throws MethodError: "... is not finite".
void requireFinite(const core::Pose2& pose, const char* what);

}  // namespace slam::methods
