#pragma once
#include <cstdint>

#include "libslam/core/pose2.h"
#include "libslam/core/random.h"
#include "libslam/lidar/scan.h"
#include "libslam/movers/scene.h"
#include "libslam/rays/beam_table.h"
#include "libslam/robot/camera.h"

namespace slam::sim {

/// A camera on the robot that looks at the floor and tells free floor from the feet of obstacles; what it
/// finds is given as a narrow scan from the camera's foot, so that whatever takes a lidar's scans takes the
/// camera's.
///
/// What the original document gives: where the camera stands (XC, YC, ZC), that it looks down by a pitch, the
/// view angles FOVx and FOVy, the dead zone Ymin before it and the half width Xm(y) of the floor that it
/// sees; obstacles are points in the robot frame. What is ours, because the document does not have it: how
/// obstacles are found in the picture (here they are known, with an error of the angle under which their foot
/// is seen), the scan's bearings, the far edge and the reach, the picture's rate, and what an obstacle hides.
/// Obstacles are higher than the camera's line of sight: nothing is seen behind one, and one in the dead zone
/// hides all floor in its direction (lost readings there, not a distance). So whoever needs to know what
/// stands in the dead zone or beside the view has to remember it: obstacles::LocalObstacleMap. Pictures are
/// taken at an instant. Materials do not matter; people are seen as the lidar's rays meet them.
///
/// Stream "camera". Cost: a ray a bearing.
class CameraSensor {
 public:
  /// InputError as robot::requireSensible().
  CameraSensor(const robot::FloorCamera& camera, std::uint64_t seed);

  lidar::Scan sense(const movers::Scene& scene, const core::Pose2& T_world_robot, double time_s);

 private:
  robot::FloorCamera camera_;
  lidar::LidarOptions lidar_;
  rays::BeamTable beams_;
  core::RandomStream random_;
};

}  // namespace slam::sim
