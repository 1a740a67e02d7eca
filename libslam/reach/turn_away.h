#pragma once
#include <string>
#include <vector>

#include "libslam/core/pose2.h"
#include "libslam/draw/canvas.h"
#include "libslam/files/ini.h"
#include "libslam/files/parameters.h"
#include "libslam/obstacles/camera_view.h"
#include "libslam/obstacles/lidar_view.h"
#include "libslam/obstacles/local_obstacle_map.h"

namespace slam::reach {

/// Section [turn_away].
struct TurnAwayOptions {
  std::string sensor;    ///< camera | lidar
  double turn_rad;       ///< how far the robot turns away, left positive
  double turn_step_rad;  ///< per tick
  double travel_m;       ///< how far it then drives
  double travel_step_m;  ///< per tick
  TurnAwayOptions();
  static const files::ParameterTable<TurnAwayOptions>& table();
};

/// All that decides the experiment: sections [turn_away] [obstacles] [camera] [sector]; strict.
struct TurnAwayConfig {
  TurnAwayOptions experiment;
  obstacles::LocalObstacleOptions map;
  obstacles::CameraOptions camera;
  obstacles::SectorOptions sector;
  std::vector<files::ParameterReport> parameters;  ///< every value and where it came from
};
TurnAwayConfig readTurnAwayConfig(const files::IniFile& config);

/// What the robot knows at one moment of the experiment, in the robot frame of then.
struct TurnAwayMoment {
  std::string what;  ///< "turned by 45 deg"
  core::Pose2 T_start_robot;
  std::vector<core::Point2> visible;           ///< outline of what the sensor looks over
  std::vector<core::Point2> seen, remembered;  ///< the local obstacle map
  std::vector<core::Point2> posts;             ///< where the obstacles really are, all of them
};

/// The original experiment of the local obstacle map: posts of kPostRadius_m stand in front of the robot, it
/// turns away from them, drives on and turns back; they leave the visible area and stay in memory where they
/// are, until they leave the local zone. The robot knows its motion exactly. The camera sees a post as a
/// point; the lidar (720 beams all round, 8 m) its face. Six moments: the start, a quarter,
/// half and all of the turn, after the drive, after turning back.
std::vector<TurnAwayMoment> turnAway(const TurnAwayConfig& config);
inline constexpr double kPostRadius_m = 0.05;

/// Draws the moments (pictures::drawObstacles()).
void drawTurnAway(const std::vector<TurnAwayMoment>& moments, const TurnAwayConfig& config,
                  const std::string& file, const draw::Paper& paper = {});

}  // namespace slam::reach
