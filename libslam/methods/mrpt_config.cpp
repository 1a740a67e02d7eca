#include "libslam/methods/mrpt_config.h"

#include <cmath>
#include <utility>

#include "libslam/core/pose2.h"

namespace slam::methods {

IcpRows icpRows() {
  return {
      {"algorithm", &IcpOptions::algorithm, "classic", {"classic", "levenberg_marquardt"}, "MRPT's CICP"},
      {"max_iterations", &IcpOptions::max_iterations, 80, 1, 10000, "at most"},
      {"start_distance_m", &IcpOptions::start_distance_m, 0.3, 0.001, 100.0,
       "largest distance of a pair at the start"},
      {"end_distance_m", &IcpOptions::end_distance_m, 0.05, 0.001, 100.0,
       "largest distance of a pair at which the match ends"},
      {"shrink", &IcpOptions::shrink, 0.8, 0.01, 0.99, "factor on the distance after each convergence"},
      {"start_angle_deg", &IcpOptions::start_angle_rad, 5.0, 0.0, 90.0,
       "widens the distance of a pair far from the robot"},
      {"only_unique_robust", &IcpOptions::only_unique_robust, false,
       "pairs must be nearest both ways; with the classic algorithm a single pair then throws the pose to "
       "the origin"},
      {"decimation", &IcpOptions::decimation, 2, 1, 1000, "every n-th point of the scan"},
      {"min_goodness", &IcpOptions::min_goodness, 0.4, 0.0, 1.0,
       "share of paired points below which odometry is used instead"}};
}

IcpRows icpPointRows() {
  return {{"point_spacing_m", &IcpOptions::point_spacing_m, 0.05, 0.001, 10.0,
           "smallest distance between points of the map"}};
}

files::ParameterTable<IcpOptions> icpTable(const std::vector<IcpRows>& rows) {
  IcpRows all;
  for (const auto& some : rows) all.insert(all.end(), some.begin(), some.end());
  return {"icp", std::move(all)};
}

IcpOptions::IcpOptions() {
  static const auto kAll = icpTable({icpRows(), icpPointRows()});
  kAll.setDefaults(*this);
}

void MrptConfig::setDegrees(const std::string& key, double angle_rad) {
  set(key, std::round(core::radToDeg(angle_rad) * 1e9) / 1e9);
}

void writeProgramKeys(const std::string& program, MrptConfig& out) {
  // The programs delete every file of their log folder at the start, hence a name that nobody else has.
  out.set("logOutput_dir", "LOG_rasterslam_" + program);
  out.set("rawlog_offset", "0");
  out.set("LOG_FREQUENCY", "1000000");
  out.set("SAVE_3D_SCENE", "false");
  out.set("SAVE_POSE_LOG", "false");
  out.set("CAMERA_3DSCENE_FOLLOWS_ROBOT", "false");
}

void writeIcpKeys(const IcpOptions& icp, MrptConfig& out) {
  out.set("ICP_algorithm", icp.algorithm == "classic" ? "icpClassic" : "icpLevenbergMarquardt");
  out.set("maxIterations", icp.max_iterations);
  out.set("minAbsStep_trans", "1e-6");
  out.set("minAbsStep_rot", "1e-6");
  out.set("thresholdDist", icp.start_distance_m);
  out.setDegrees("thresholdAng_DEG", icp.start_angle_rad);
  out.set("ALFA", icp.shrink);
  out.set("smallestThresholdDist", icp.end_distance_m);
  out.set("onlyUniqueRobust", icp.only_unique_robust);
  out.set("corresponding_points_decimation", icp.decimation);
}

std::string gridName(const builders::MappingOptions& mapping) {
  return mapping.grid == "exact" ? "unbiasedGridMap" : "occupancyGrid";
}

std::string gridSection(const builders::MappingOptions& mapping) {
  return std::string(kMrptSection) + "_" + gridName(mapping) + "_00_";
}

void writeGridSections(const builders::MappingOptions& mapping, MrptConfig& out) {
  out.section(gridSection(mapping) + "creationOpts");
  out.set("resolution", mapping.resolution_m);
  out.section(gridSection(mapping) + "insertOpts");
  out.set("maxDistanceInsertion", mapping.max_insert_range_m);
  out.set("maxOccupancyUpdateCertainty", mapping.occupied_certainty);
  out.set("considerInvalidRangesAsFreeSpace", mapping.no_return_is_free);
}

}  // namespace slam::methods
