#pragma once
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "libslam/core/ini.h"
#include "libslam/core/parameters.h"
#include "libslam/core/pose2.h"
#include "libslam/robot/scan.h"

namespace mrpt::slam {
class CMetricMapBuilder;
}
namespace mrpt::obs {
class CActionCollection;
class CSensoryFrame;
}  // namespace mrpt::obs

namespace slam::mapping {

/// A SLAM method ready to run: MRPT's interface, and what feeds it.
struct MapBuilder {
  std::unique_ptr<mrpt::slam::CMetricMapBuilder> builder;
  std::string name;      ///< of the configuration: "icp", "rbpf_fixed"
  std::string type;      ///< naive | icp | rbpf
  std::string odometry;  ///< which increments it is fed: wheel | argmax | correlation
  std::vector<core::ParameterReport> parameters;
};

/// Makes a method from its .ini (configs/methods/NAME.ini; sections [method], [mapping], and the type's own).
/// Strict: every misspelt or impossible key is an InputError. Seeds MRPT's generator of the calling thread.
MapBuilder makeMapBuilder(const core::IniFile& config, const std::string& name, std::uint64_t seed);

/// The method's configuration as MRPT's own icp-slam / rbpf-slam programs read it; makeMapBuilder uses the
/// same text, so both run with the same numbers. InputError for a type that no MRPT program runs.
std::string toMrptConfig(const core::IniFile& config, const std::string& name);

/// All methods in a folder of configurations, sorted; "naive" and so on.
std::vector<std::string> methodNames(const std::string& methods_folder);
core::IniFile loadMethodConfig(const std::string& methods_folder, const std::string& name_or_path);

/// Feeds one scan: increment since the last scan as the method's [method] odometry wants it.
/// Returns the pose T_map_robot after it.
core::Pose2 processScan(MapBuilder& method, const robot::Scan& scan, const core::Pose2& T_previous_robot,
                        bool has_odometry);

/// The map as probabilities on a raster, whatever the method holds inside: for pictures, the ROS map and the
/// scores.
struct OccupancyRaster {
  int columns = 0, rows = 0;
  double resolution_m = 0.05;
  double x_min_m = 0, y_min_m = 0;  ///< lower left corner in the map frame
  std::vector<float> occupancy;     ///< row-major from the bottom, 0 free .. 1 occupied, exactly 0.5 unknown
};
OccupancyRaster currentMap(const MapBuilder& method);

/// Writes map.yaml + map.png (ROS), map.gridmap.gz, map.simplemap and map.3Dscene (stock MRPT classes only)
/// into a folder.
void saveMaps(const MapBuilder& method, const core::Trajectory& estimate, const std::string& folder);

/// Registers our map classes with MRPT, so that an .ini can name them: mapping::registerMaps(). Also done by
/// loading librasterslam-mrpt.so into a stock program (LD_PRELOAD).
void registerMaps();

}  // namespace slam::mapping
