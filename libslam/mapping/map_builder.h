#pragma once
#include <Eigen/Core>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "libslam/core/journal.h"
#include "libslam/core/pose2.h"
#include "libslam/core/progress.h"
#include "libslam/files/ini.h"
#include "libslam/files/parameters.h"
#include "libslam/gridmap/occupancy_raster.h"
#include "libslam/lidar/deskew.h"
#include "libslam/lidar/scan.h"
#include "libslam/loops/part_place.h"
#include "libslam/mapping/method_config.h"
#include "libslam/mapping/scan_deskewer.h"
#include "libslam/robot/motion_kind.h"

namespace slam::graph {
class GraphSlam;
}

namespace slam::mapping {

/// A SLAM method ready to run, and what feeds it: processScan().
struct MapBuilder {
  MapBuilder();
  MapBuilder(MapBuilder&&) noexcept;
  MapBuilder& operator=(MapBuilder&&) noexcept;
  ~MapBuilder();

  std::string name;      ///< of the configuration: "icp", "rbpf_exact"
  std::string type;      ///< one of methodTypes()
  std::string odometry;  ///< which increments it is fed: [method] odometry
  std::string lidars;    ///< whose scans it wants: [method] lidars
  std::vector<files::ParameterReport> parameters;
  std::unique_ptr<methods::SlamMethod> method;

  struct State;
  std::unique_ptr<State> state;  ///< between the scans
};

/// Makes a method from its .ini (configs/methods/NAME.ini; sections as methodSections() has them). Errors:
/// readMethodConfig()'s. Nothing is printed, whatever MRPT would like to say.
MapBuilder makeMapBuilder(const files::IniFile& config, const std::string& name, std::uint64_t seed);

/// The method as MRPT's programs know one; lives as long as it.
mrpt::slam::CMetricMapBuilder& mrptBuilder(const MapBuilder& method);

/// Goes on in a map of before (a map.simplemap) instead of an empty one, in its frame: the robot is at
/// T_map_robot at the first scan; nullopt: nobody knows where, and it is looked for in all of the map (types
/// that find themselves, with keep_map alone). keep_map: the map stays as it is, the robot is only localised
/// in it. REQUIRES that no scan was processed. Errors: InputError for a file that is no simplemap or holds no
/// scan, and for types that cannot (MethodType).
void continueMap(MapBuilder& method, const std::string& simplemap_path,
                 const std::optional<core::Pose2>& T_map_robot, bool keep_map);

/// One map of several, of which nobody knows how they lie to one another (map.simplemap each): they are found
/// in each other, joined where that is proved, and refined together, in the frame of the first. One place for
/// each map after the first; of a map that has none (is_joined) the key frames stay far away, and the result
/// is of no use. REQUIRES two maps at least, and that no scan was processed. Errors: as continueMap().
std::vector<loops::PartPlace> joinMaps(MapBuilder& method, const std::vector<std::string>& simplemap_paths,
                                       core::Progress& progress);

/// What the robot was told to do before each scan to come, the first included: for processScan() where it is
/// not told itself.
void setCommands(MapBuilder& method, std::vector<robot::Commanded> commands);

/// How the scans to come are swept, by whoever measures them; nullopt (at first): all beams at once, or
/// nobody knows. [method] sweep_s comes before it.
void setSweep(MapBuilder& method, const std::optional<lidar::Sweep>& sweep);

/// What became of the scans so far.
SweptScans sweptScans(const MapBuilder& method);

/// A scan and how it was swept, as setSweep().
struct SweptScan {
  lidar::Scan scan;
  std::optional<lidar::Sweep> sweep;
};
/// What other lidars saw at the moment of the next scan that processScan() gets, each at its own mounting
/// pose. Every type takes them in with that scan.
void addScans(MapBuilder& method, std::vector<SweptScan> others);

/// Feeds one scan. T_previous_robot is the wheels' increment since the scan before, the first scan's is taken
/// as null. Which increment the builder gets is for [method] odometry to say; `wheel` takes the one estimated
/// from the two scans (method correlation unless [scan_odometry] says otherwise) at every step for which
/// has_odometry is false. Stamps that do not grow are moved on by a millisecond, for the builder only.
/// A scan whose sweep is known (setSweep(), [method] sweep_s) is deskewed (lidar::deskewed())
/// before anything else sees it, unless [method] deskew is false. The motion is
/// the odometry's, of this step or else of the one before; without either, as at the first scan, the scan
/// stays. The other way round, correlation, range_flow and plicp take the wheels' increment, where there is
/// one, at a step that the scans leave open (a corridor, an open field); argmax, the original method, never
/// does.
/// Scans of several lidars may follow one another: increments from scans are of the lidar of the first scan,
/// at its mounting pose; a step to another one's scan goes on as the last step did.
/// `commanded` tells argmax what the robot was told to do since the scan before. Where nobody says (kUnknown,
/// and no setCommands()) the wheels' increment does, and without wheels argmax guesses, as argmax_blind
/// always does.
/// Returns the pose T_map_robot after it; the map frame is the robot's pose at the first scan
/// (which the particle filter already spreads by some millimetres).
/// The random numbers of step k come from (seed, k) alone: neither the thread nor other methods run in
/// between matter. Errors: MethodError when the motion or the pose is not finite, the grids would grow beyond
/// [mapping] max_map_cells (checked before the scan is inserted), or MRPT throws. REQUIRES at least 2 beams.
core::Pose2 processScan(MapBuilder& method, const lidar::Scan& scan, const core::Pose2& T_previous_robot,
                        bool has_odometry, const robot::Commanded& commanded = {});

/// How sure the method says that it is of the pose that processScan() gave last: covariance of x (m), y (m),
/// phi (rad) in the map frame, as getCurrentPoseEstimation() has it; what it leaves out stands with each
/// method. nullopt for naive, which says nothing.
std::optional<Eigen::Matrix3d> poseCovariance(const MapBuilder& method);

/// The same of every pose of finalPath(), as the method has it now: graph's, from its graph as a whole. Empty
/// for the other methods.
std::vector<Eigen::Matrix3d> finalCovariances(const MapBuilder& method);

/// The same of the second pose of finalPath() as the first sees it, for pairs of its poses; empty for methods
/// that do not say. Only graph does.
std::vector<Eigen::Matrix3d> relativeCovariances(const MapBuilder& method,
                                                 const std::vector<std::pair<int, int>>& poses);

/// The map as it is now.
gridmap::OccupancyRaster currentMap(const MapBuilder& method);

/// After the last scan: what a method does once it knows the whole log (graph: the loops that are left, a
/// joint refinement). currentMap() and finalPath() may change, the poses given online do not.
void finishMap(MapBuilder& method, core::Progress& progress = core::silentProgress());

/// So many threads in all, the caller's among them, may work on the method from now on; at first 1, or
/// [particles] threads. What comes out is the same, to the byte. graph takes a second one, which closes loops
/// beside the scans to come; particles takes all.
void useThreads(MapBuilder& method, int threads);
/// CPU time so far of threads other than the caller's.
double threadSeconds(const MapBuilder& method);

/// What the method says of its own work, in the order it happened; empty for the methods that say nothing.
std::vector<core::JournalEntry> journalOf(const MapBuilder& method);

/// The path that belongs to the map as it is now, where the method keeps another one than it gave online: for
/// rbpf and particles that of the most likely particle, whose map currentMap() is; for graph the poses as its
/// graph has them now. One pose for each of `online`, the poses that processScan() gave so far. Where the
/// filter only counted wheels (between two updates) the pose is that at the last update, moved on by the
/// wheels. nullopt for the other methods: there what was given online is all there is. REQUIRES online to be
/// complete.
std::optional<core::Trajectory> finalPath(const MapBuilder& method, const core::Trajectory& online);

/// Where the particles are now, map frame (rbpf: at the last update); empty for methods without.
std::vector<core::Pose2> particlePoses(const MapBuilder& method);

/// The graph of type graph, nullptr for the others. Lives as long as the method.
const graph::GraphSlam* graphSlamOf(const MapBuilder& method);

/// Writes map.yaml + map.png (ROS map_server, trinary), map.gridmap.gz (a plain COccupancyGridMap2D) and
/// map.simplemap (stock MRPT classes only) into an existing folder; of type graph that has mapped also
/// graph.g2o, its pose graph, whose node i is the i-th key frame of map.simplemap. Same input, same bytes.
/// Errors: IoError with the path.
void saveMaps(const MapBuilder& method, const std::string& folder);
/// The same where currentMap() is at hand: large ones take time and memory to make.
void saveMaps(const MapBuilder& method, const gridmap::OccupancyRaster& map, const std::string& folder);
/// A map that no method holds: map.yaml, map.png and map.gridmap.gz of these. REQUIRES a cell
/// (ContractError).
void saveRaster(const gridmap::OccupancyRaster& map, const std::string& folder);
/// Of those of saveMaps() the last two alone: of a map that is too large to be drawn.
void saveKeyFrames(const MapBuilder& method, const std::string& folder);

}  // namespace slam::mapping
