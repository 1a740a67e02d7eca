#pragma once
#include <string>

#include "libslam/files/parameters.h"

namespace slam::movers {

/// What moves in the world besides the robot; section [living]. By default nothing does.
struct LivingOptions {
  int people;
  double speed_mps,
      speed_sigma_mps;          ///< of the speeds that people like to walk at, before truncation at 2 sigma
  double radius_m;              ///< of the disc that bumps into things
  std::string body;             ///< what the lidar sees of it: disc | legs
  double pause_share, pause_s;  ///< how often a person stays at its goal, and the mean of how long
  double doors_share;           ///< of the plan's doors: those that open and close
  double door_open_s, door_closed_s;  ///< means; a single time is uniform within half of it either way
  int visit;                          ///< 1: the plan as it is; each later visit finds furniture moved
  double furniture_share;             ///< of the free-standing furniture: what moves between two visits
  LivingOptions();
  static const files::ParameterTable<LivingOptions>& table();
};

}  // namespace slam::movers
