#include "libslam/mapping/map_builder.h"

#include <mrpt/maps/CSimpleMap.h>

#include <cmath>
#include <utility>

#include "libslam/core/error.h"
#include "libslam/mapping/simple_map.h"
#include "libslam/mapping/step_motion.h"
#include "libslam/methods/mrpt_method.h"

namespace slam::mapping {

struct MapBuilder::State {
  State(const MethodConfig& config, const methods::MethodType& method_type)
      : type(method_type),
        motions(config.method, config.scan_odometry, method_type.goes_on_alone),
        deskewer(config.method, method_type.goes_on_alone) {}

  const methods::MethodType& type;
  StepMotions motions;
  ScanDeskewer deskewer;
  StepHistory history;
  std::uint64_t steps = 0;
  double time_s = 0;                   ///< of the last step, as the method saw it
  std::optional<lidar::Sweep> sweep;   ///< of the scans to come, as told
  std::vector<SweptScan> told_others;  ///< addScans(), for the next step
};

MapBuilder::MapBuilder() = default;
MapBuilder::MapBuilder(MapBuilder&&) noexcept = default;
MapBuilder& MapBuilder::operator=(MapBuilder&&) noexcept = default;
MapBuilder::~MapBuilder() = default;

namespace {

/// ICP's builder ignores odometry that is not newer than its last match, and complains on the console.
double growingTime(double time_s, double last_time_s, bool is_first) {
  if (std::isfinite(time_s) && (is_first || time_s > last_time_s)) return time_s;
  return last_time_s + 1e-3;
}

/// The scans of the other lidars at this step, deskewed.
std::vector<lidar::Scan> takeOthers(MapBuilder::State& state, const core::Pose2& T_previous_robot,
                                    bool has_odometry) {
  std::vector<lidar::Scan> others;
  for (auto& told : std::exchange(state.told_others, {})) {
    auto corrected =
        state.deskewer.deskewed(state.history, told.scan, told.sweep, T_previous_robot, has_odometry);
    others.push_back(corrected ? std::move(*corrected) : std::move(told.scan));
  }
  return others;
}

}  // namespace

MapBuilder makeMapBuilder(const files::IniFile& config, const std::string& name, std::uint64_t seed) {
  const MethodConfig read = readMethodConfig(config);
  MapBuilder method;
  method.name = name;
  method.type = read.method.type;
  method.odometry = read.method.odometry;
  method.lidars = read.method.lidars;
  method.parameters = read.report;
  method.method = read.make(name, seed);
  method.state = std::make_unique<MapBuilder::State>(read, methodType(method.type));
  return method;
}

mrpt::slam::CMetricMapBuilder& mrptBuilder(const MapBuilder& method) {
  return method.method->mrptBuilder();
}

void continueMap(MapBuilder& method, const std::string& simplemap_path,
                 const std::optional<core::Pose2>& T_map_robot, bool keep_map) {
  const methods::MethodType& type = method.state->type;
  const auto continues = [](const methods::MethodType& one) { return one.continues_maps; };
  const auto finds = [](const methods::MethodType& one) { return one.finds_itself; };
  if (!type.continues_maps)
    throw core::InputError("method " + method.name + " of type " + method.type +
                           " cannot go on in a map, expected type " + methodTypesWhich(continues));
  if (!T_map_robot && (!type.finds_itself || !keep_map))
    throw core::InputError("method " + method.name + " of type " + method.type +
                           " has to be told where in the map the log begins (--start): only type " +
                           methodTypesWhich(finds) + " finds a robot anywhere, and only with --localise");
  const auto map = loadSimpleMap(simplemap_path);
  try {
    method.method->continueMap(map, T_map_robot, keep_map);
  } catch (const core::MethodError&) {
    throw;
  } catch (const std::exception& error) {
    throw core::InputError(simplemap_path + ": cannot be gone on with: " + methods::firstLine(error.what()));
  }
  method.state->history.T_map_robot = T_map_robot.value_or(core::Pose2{});
}

std::vector<loops::PartPlace> joinMaps(MapBuilder& method, const std::vector<std::string>& simplemap_paths,
                                       core::Progress& progress) {
  const auto joins = [](const methods::MethodType& one) { return one.joins_maps; };
  if (!method.state->type.joins_maps)
    throw core::InputError("method " + method.name + " of type " + method.type +
                           " joins no maps, expected type " + methodTypesWhich(joins));
  continueMap(method, simplemap_paths.at(0), core::Pose2{}, false);
  std::vector<mrpt::maps::CSimpleMap> others;
  for (size_t i = 1; i < simplemap_paths.size(); ++i) others.push_back(loadSimpleMap(simplemap_paths[i]));
  return method.method->joinMaps(others, progress);
}

void addScans(MapBuilder& method, std::vector<SweptScan> others) {
  method.state->told_others = std::move(others);
}

void setCommands(MapBuilder& method, std::vector<robot::Commanded> commands) {
  method.state->motions.setCommands(std::move(commands));
}

void setSweep(MapBuilder& method, const std::optional<lidar::Sweep>& sweep) {
  method.state->sweep = sweep;
}

SweptScans sweptScans(const MapBuilder& method) {
  return method.state->deskewer.counts();
}

core::Pose2 processScan(MapBuilder& method, const lidar::Scan& raw_scan, const core::Pose2& T_previous_robot,
                        bool has_odometry, const robot::Commanded& commanded) {
  MapBuilder::State& state = *method.state;
  state.motions.noteCommand(commanded, state.steps, T_previous_robot, has_odometry);
  const std::optional<lidar::Scan> corrected =
      state.deskewer.deskewed(state.history, raw_scan, state.sweep, T_previous_robot, has_odometry);
  const core::Pose2 T_moved = state.deskewer.movedInstead().value_or(T_previous_robot);
  const std::vector<lidar::Scan> others = takeOthers(state, T_moved, has_odometry);
  state.history.last_had_odometry = has_odometry;
  const lidar::Scan& scan = corrected ? *corrected : raw_scan;
  state.time_s = growingTime(scan.time_s, state.time_s, state.steps == 0);
  try {
    const methods::StepMotion motion = state.motions.next(state.history, scan, T_moved, has_odometry);
    const core::Pose2 T_map_robot = method.method->process({state.steps, state.time_s, scan, others, motion});
    methods::requireFinite(T_map_robot, "the pose");
    const core::Pose2 T_last_robot = core::between(state.history.T_map_robot, T_map_robot);
    state.history.note(scan, state.motions.asFed(motion, T_last_robot), T_map_robot);
  } catch (const core::MethodError& error) {
    throw core::MethodError("method " + method.name + ", scan " + std::to_string(state.steps + 1) + ": " +
                            error.what());
  }
  ++state.steps;
  return state.history.T_map_robot;
}

std::optional<Eigen::Matrix3d> poseCovariance(const MapBuilder& method) {
  return method.method->poseCovariance();
}

std::vector<Eigen::Matrix3d> finalCovariances(const MapBuilder& method) {
  return method.method->finalCovariances();
}

std::vector<Eigen::Matrix3d> relativeCovariances(const MapBuilder& method,
                                                 const std::vector<std::pair<int, int>>& poses) {
  return method.method->relativeCovariances(poses);
}

gridmap::OccupancyRaster currentMap(const MapBuilder& method) {
  return method.method->map();
}

void finishMap(MapBuilder& method, core::Progress& progress) {
  method.method->finish(progress);
}

void useThreads(MapBuilder& method, int threads) {
  method.method->useThreads(threads);
}

double threadSeconds(const MapBuilder& method) {
  return method.method->threadSeconds();
}

std::vector<core::JournalEntry> journalOf(const MapBuilder& method) {
  return method.method->journal();
}

std::optional<core::Trajectory> finalPath(const MapBuilder& method, const core::Trajectory& online) {
  return method.method->finalPath(online);
}

std::vector<core::Pose2> particlePoses(const MapBuilder& method) {
  return method.method->particlePoses();
}

const graph::GraphSlam* graphSlamOf(const MapBuilder& method) {
  return method.method->graph();
}

}  // namespace slam::mapping
