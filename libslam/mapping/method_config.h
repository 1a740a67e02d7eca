#pragma once
#include <string>
#include <vector>

#include "libslam/core/ini.h"
#include "libslam/core/parameters.h"
#include "libslam/mapping/graph_slam.h"
#include "libslam/mapping/particle_filter.h"
#include "libslam/odometry/scan_odometry.h"

namespace slam::mapping {

/// Section [method]: what kind of builder and which motion increments it is fed.
struct MethodOptions {
  std::string type;      ///< naive | icp | rbpf | particles | graph
  std::string odometry;  ///< wheel | argmax | argmax_blind | correlation | range_flow | plicp | none
  std::string lidars;    ///< logs::LogReader's words: * | labels with commas between them
  bool deskew;           ///< scans whose sweep is known are deskewed
  double sweep_s;        ///< robot::Sweep, 0: as the log states it
  bool sweep_clockwise;  ///< of sweep_s
  MethodOptions();
  static const core::ParameterTable<MethodOptions>& table();
};

/// Section [mapping]. A type reads only the rows that it uses (mappingTable).
struct MappingOptions {
  double resolution_m;
  std::string grid;                                ///< stock | exact
  std::string draw;                                ///< dots | rays; naive only
  std::string draw_after;                          ///< every_scan | moves; naive only
  double insert_distance_m, insert_angle_rad;      ///< not graph
  double localize_distance_m, localize_angle_rad;  ///< icp and rbpf
  double max_insert_range_m;
  double occupied_certainty;
  bool no_return_is_free;
  double max_map_cells;
  MappingOptions();
};
const core::ParameterTable<MappingOptions>& mappingTable(const std::string& type);

/// Section [icp]: for type icp the matcher itself, for rbpf the proposal of algorithm optimal_icp.
struct IcpOptions {
  std::string algorithm;  ///< classic | levenberg_marquardt
  int max_iterations;
  double start_distance_m, end_distance_m, shrink, start_angle_rad;
  bool only_unique_robust;
  int decimation;
  double min_goodness;
  double point_spacing_m;  ///< type icp only
  IcpOptions();
};
const core::ParameterTable<IcpOptions>& icpTable(const std::string& type);

/// Section [particles], type rbpf.
struct ParticleOptions {
  std::string algorithm;  ///< standard | optimal_icp | optimal_sampling
  int count;
  double resample_below;
  std::string resampling;
  double power_factor;
  int optimal_samples;
  double likelihood_sigma_m, likelihood_max_distance_m, likelihood_random;
  int likelihood_decimation;
  bool likelihood_cache;
  ParticleOptions();
  static const core::ParameterTable<ParticleOptions>& table();
};

/// Section [motion], types rbpf and particles: MRPT's Gaussian motion model. The standard deviations of an increment of
/// length d (metres) and turn a (radians, absolute) are
///   x, y: sigma_xy_m + sigma_xy_per_m * d + sigma_xy_per_rad * a
///   phi:  sigma_turn + sigma_turn_per_m * d + sigma_turn_per_rad * a
/// (CActionRobotMovement2D, mmGaussian). For increments of the wheels; those estimated from scans bring their
/// own spread.
struct MotionOptions {
  double sigma_xy_m, sigma_xy_per_m, sigma_xy_per_rad;
  double sigma_turn_rad, sigma_turn_per_m_rad, sigma_turn_per_rad;
  MotionOptions();
  static const core::ParameterTable<MotionOptions>& table();
};

/// All of a method's sections, checked.
struct MethodConfig {
  MethodOptions method;
  MappingOptions mapping;
  IcpOptions icp;
  ParticleOptions particles;
  ParticleFilterOptions particle_filter;
  MotionOptions motion;
  GraphOptions graph;
  odometry::ScanOdometryOptions scan_odometry;
  std::vector<core::ParameterReport> report;
};

/// The sections that a method of this type reads; of an external program too.
std::vector<std::string> methodSections(const std::string& type);

/// Errors (InputError): every misspelt, impossible or contradictory key; a section that the type does not
/// use.
MethodConfig readMethodConfig(const core::IniFile& ini);

/// The text that MRPT's builders and programs read. REQUIRES type icp or rbpf (ContractError).
std::string mrptConfigText(const MethodConfig& config, const std::string& name);

/// The section of that text that holds the builder's options.
inline constexpr const char* kMrptSection = "MappingApplication";

}  // namespace slam::mapping
