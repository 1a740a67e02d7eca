#include "libslam/keyframes/graph_options.h"

#include <vector>

namespace slam::keyframes {
namespace {

using O = GraphOptions;
using Rows = std::vector<files::ParameterTable<O>::Row>;

Rows trackingRows() {
  return {{"point_spacing_m", &O::point_spacing_m, 0.05, 0.0, 10.0,
           "points of one scan are at least this far apart"},
          {"max_range_m", &O::max_range_m, 40.0, 0.1, 1000.0, "farther returns are not matched"},
          {"cell_m", &O::cell_m, 0.1, 0.01, 2.0,
           "cell of the finest surfel map; two more have double and fourfold cells"},
          {"blur_m", &O::blur_m, 0.02, 0.001, 1.0, "standard deviation added to the finest surfels"},
          {"odometry_xy_m", &O::odometry_xy_m, 0.02, 1e-4, 10.0,
           "standard deviation of an increment over 0.2 s; it grows with the root of time"},
          {"odometry_xy_per_m", &O::odometry_xy_per_m, 0.1, 0.0, 10.0, "and per metre driven"},
          {"odometry_turn_deg", &O::odometry_turn_rad, 0.573, 1e-3, 90.0, "of its turn over 0.2 s"},
          {"odometry_turn_per_rad", &O::odometry_turn_per_rad, 0.2, 0.0, 10.0, "and per angle turned"},
          {"odometry_kernel", &O::odometry_kernel, 2.0, 0.0, 100.0,
           "standard deviations beyond which odometry loses its hold; 0: never"},
          {"distrust_gain", &O::distrust_gain, 0.1, 0.0, 1.0,
           "odometry is dropped when another start explains this much more of the scan"},
          {"recover_score", &O::recover_score, 0.65, 0.0, 1.0,
           "a match that explains less is searched for around"},
          {"lost_score", &O::lost_score, 0.5, 0.0, 1.0,
           "a scan of which the map explains less, and that contradicts it, counts as lost"},
          {"keyframe_distance_m", &O::keyframe_distance_m, 0.3, 0.0, 100.0,
           "travel after which a scan becomes a keyframe"},
          {"keyframe_angle_deg", &O::keyframe_angle_rad, 17.2, 0.0, 360.0, "turn after which it does"},
          {"keyframe_score", &O::keyframe_score, 0.75, 0.0, 1.0,
           "it does, too, when the map explains less of it"},
          {"known_views", &O::known_views, 8.0, 0.0, 1e6,
           "but not where so many from nearby see the same, and explain it; 0: always"}};
}

Rows mapRows() {
  return {{"map_keyframes", &O::map_keyframes, 40, 1, 10000,
           "a scan is matched to so many keyframes, those nearest by place and view"},
          {"map_radius_m", &O::map_radius_m, 8.0, 0.1, 1000.0, "within this distance"},
          {"map_path_m", &O::map_path_m, 25.0, 0.1, 1e6, "and this length of links"},
          {"edges_per_keyframe", &O::edges_per_keyframe, 8, 1, 100,
           "a keyframe's match is shared among so many edges"},
          {"link_conflict", &O::link_conflict, 0.2, 0.0, 1.0,
           "no edge to a keyframe that sees through more of the points"},
          {"link_agreed", &O::link_agreed, 0.3, 0.0, 1.0, "or that sees less of them"}};
}

Rows loopRows() {
  return {
      {"loops", &O::loops, true, "look for places seen again"},
      {"loop_every_m", &O::loop_every_m, 0.5, 0.01, 1000.0, "travel between two searches"},
      {"loop_reach_m", &O::loop_reach_m, 1.5, 0.0, 1000.0, "a place is searched for within this distance"},
      {"loop_reach_per_m", &O::loop_reach_per_m, 0.03, 0.0, 1.0, "and so much more per metre of path to it"},
      {"loop_reach_most_m", &O::loop_reach_most_m, 25.0, 0.1, 1000.0, "but not farther"},
      {"loop_path_m", &O::loop_path_m, 4.0, 0.1, 100.0,
       "the scans of this length of path are searched for together"},
      {"loop_search_score", &O::loop_search_score, 0.5, 0.0, 1.0,
       "least score of a place on the search's raster"},
      {"loop_score", &O::loop_score, 0.6, 0.0, 1.0,
       "and of the same after matching; less where even the map around explains little of a scan"},
      {"loop_confirm_score", &O::loop_confirm_score, 0.6, 0.0, 1.0,
       "least score of each keyframe that confirms it; less where even the map around explains little"},
      {"loop_conflict", &O::loop_conflict, 0.1, 0.0, 1.0,
       "most of its points that old beams may pass through"},
      {"loop_confirmations", &O::loop_confirmations, 3, 1, 100, "keyframes that must confirm a loop"},
      {"loop_confirm_m", &O::loop_confirm_m, 1.0, 0.0, 100.0, "over at least this path"},
      {"loop_distinctness", &O::loop_distinctness, 0.03, 0.0, 100.0,
       "sum over them of how much more they explain than moved along the place's open direction"},
      {"loop_innovation", &O::loop_innovation, 20.0, 0.0, 1e9,
       "a loop is wrong that lies farther, squared, from where the path between has it, in four of that "
       "path's standard deviations; up to twice that, unless many scans confirm it"},
      {"loop_work", &O::loop_work, 20.0, 1e-3, 1e9,
       "what a scan waits for at most while a place is searched for or all poses are found anew: million "
       "multiplications, 5 a millisecond; as many times as keyframe_distance_m lies between two scans"},
      {"refine_rounds", &O::refine_rounds, 3, 0, 100,
       "at the end all scans are fitted together so many times, or until nothing moves"}};
}

}  // namespace

GraphOptions::GraphOptions() {
  table().setDefaults(*this);
}

const files::ParameterTable<GraphOptions>& GraphOptions::table() {
  static const files::ParameterTable<O> kTable("graph", [] {
    Rows rows = trackingRows();
    for (const Rows& more : {mapRows(), loopRows()}) rows.insert(rows.end(), more.begin(), more.end());
    return rows;
  }());
  return kTable;
}

}  // namespace slam::keyframes
