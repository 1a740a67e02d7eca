#pragma once
#include <string>
#include <vector>

#include "libslam/core/pose2.h"
#include "libslam/draw/canvas.h"

namespace slam::pictures {

/// What a robot knows of the obstacles around it at one moment, in the robot frame (x ahead, y left).
struct ObstaclePanel {
  std::string title, subtitle;
  std::vector<core::Point2> visible;      ///< outline of what the sensor looks over
  std::vector<core::Point2> seen;         ///< obstacles seen now
  std::vector<core::Point2> remembered;   ///< obstacles that it has turned away from
  std::vector<core::Point2> true_places;  ///< where obstacles really are; may be empty
};

/// The local zone of every panel and what the robot looks like in it, metres.
struct ObstacleZone {
  double front_m = 4, rear_m = 2, width_m = 5;  ///< all positive
  double robot_side_m = 0.3;                    ///< of the square footprint
  double obstacle_radius_m = 0.05;              ///< of the rings round true places
};

/// The original picture of the local obstacle map, moment by moment: the local zone from above with ahead up,
/// grey where only memory knows, white where the sensor looks; obstacles seen now, obstacles remembered, and
/// rings where they really are. Under the rules of the pictures in picture.h. REQUIRES 1 to 12 panels and a
/// zone with an area (ContractError).
void drawObstacles(const std::vector<ObstaclePanel>& panels, const ObstacleZone& zone,
                   const std::string& title, const std::string& file, const draw::Paper& paper = {});

}  // namespace slam::pictures
