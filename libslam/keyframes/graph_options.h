#pragma once
#include "libslam/files/parameters.h"

namespace slam::keyframes {

/// Section [graph].
struct GraphOptions {
  double point_spacing_m, max_range_m;
  double cell_m, blur_m;
  double odometry_xy_m, odometry_xy_per_m, odometry_turn_rad, odometry_turn_per_rad, odometry_kernel;
  double distrust_gain, recover_score, lost_score;
  double keyframe_distance_m, keyframe_angle_rad, keyframe_score, known_views;
  int map_keyframes;
  double map_radius_m, map_path_m;
  int edges_per_keyframe;
  double link_conflict, link_agreed;
  bool loops;
  double loop_every_m, loop_reach_m, loop_reach_per_m, loop_reach_most_m;
  double loop_path_m, loop_search_score, loop_score, loop_confirm_score, loop_conflict;
  int loop_confirmations;
  double loop_confirm_m, loop_distinctness, loop_innovation, loop_work;
  int refine_rounds;
  GraphOptions();
  static const files::ParameterTable<GraphOptions>& table();
};

}  // namespace slam::keyframes
