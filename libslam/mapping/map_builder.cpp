#include "libslam/mapping/map_builder.h"

#include <mrpt/config/CConfigFileMemory.h>
#include <mrpt/core/Clock.h>
#include <mrpt/maps/COccupancyGridMap2D.h>
#include <mrpt/maps/CSimpleMap.h>
#include <mrpt/math/TPose2D.h>
#include <mrpt/obs/CActionCollection.h>
#include <mrpt/obs/CActionRobotMovement2D.h>
#include <mrpt/obs/CObservation2DRangeScan.h>
#include <mrpt/obs/CSensoryFrame.h>
#include <mrpt/poses/CPose3D.h>
#include <mrpt/poses/CPose3DPDF.h>
#include <mrpt/poses/CPosePDFGaussian.h>
#include <mrpt/random/RandomGenerators.h>
#include <mrpt/slam/CMetricMapBuilderICP.h>
#include <mrpt/slam/CMetricMapBuilderRBPF.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <optional>
#include <sstream>

#include "libslam/core/error.h"
#include "libslam/core/files.h"
#include "libslam/core/ini_yaml.h"
#include "libslam/core/random.h"
#include "libslam/mapping/graph_map_builder.h"
#include "libslam/mapping/map_grid.h"
#include "libslam/mapping/method_config.h"
#include "libslam/mapping/mrpt_compat.h"
#include "libslam/mapping/naive_map_builder.h"
#include "libslam/mapping/particle_map_builder.h"
#include "libslam/robot/deskew.h"
#include "libslam/robot/mrpt_types.h"

namespace slam::mapping {

using mrpt::maps::COccupancyGridMap2D;
using mrpt::obs::CActionRobotMovement2D;
using mrpt::slam::CMetricMapBuilderICP;
using mrpt::slam::CMetricMapBuilderRBPF;

struct MapBuilder::State {
  MethodConfig config;
  std::uint64_t seed = 0;
  std::uint64_t steps = 0;
  double builder_time_s = 0;  ///< stamp of the last step, as the builder saw it
  core::Pose2 T_map_robot;
  CActionRobotMovement2D::TMotionModelOptions motion_model;
  std::unique_ptr<odometry::ScanOdometry> scan_odometry;
  std::optional<robot::Scan> previous_scan;
  std::optional<robot::Scan> reference_scan;  ///< the last one of the lidar of the first
  core::Pose2 T_reference_previous;           ///< the motion fed since that one
  std::optional<robot::Sweep> sweep;          ///< of the scans to come, as told
  std::vector<SweptScan> told_others;         ///< addScans(), for the next step
  std::vector<robot::Scan> others;            ///< of the step at work, deskewed
  std::vector<size_t> graph_steps;            ///< which of the graph's scans is that of each step
  SweptScans swept;
  core::Pose2 T_previous_last;     ///< the last step, as the method has it
  double last_period_s = 0;        ///< how long it took
  bool last_had_odometry = false;  ///< and whether the log gave odometry for it
  bool scan_odometry_saw_previous = false;
  robot::Commanded commanded;              ///< at this step
  std::vector<robot::Commanded> commands;  ///< of all steps, where they are known; may be empty
  robot::CommandSeries wheels_commands;    ///< what the wheels' increments say of it where nobody else does
  std::vector<size_t> updates;  ///< of the particles' paths: the scan at which each of their poses stood
};

MapBuilder::MapBuilder() = default;
MapBuilder::MapBuilder(MapBuilder&&) noexcept = default;
MapBuilder& MapBuilder::operator=(MapBuilder&&) noexcept = default;
MapBuilder::~MapBuilder() = default;

namespace {

constexpr double kMostPeriods = 3;  // that a last motion is taken to go on for

void silence(mrpt::system::COutputLogger& logger) {
  logger.setVerbosityLevel(mrpt::system::LVL_ERROR);
  logger.logging_enable_console_output = false;
}

std::unique_ptr<mrpt::slam::CMetricMapBuilder> makeIcpBuilder(const mrpt::config::CConfigFileBase& config) {
  auto builder = std::make_unique<CMetricMapBuilderICP>();
  builder->ICP_options.loadFromConfigFile(config, kMrptSection);
  builder->ICP_params.loadFromConfigFile(config, "ICP");
  silence(*builder);
  // No start pose: MRPT would stamp it with the wall clock, and then ignore the odometry of a log from the
  // past until the first accepted match.
  builder->initialize();
  return builder;
}

std::unique_ptr<mrpt::slam::CMetricMapBuilder> makeRbpfBuilder(const mrpt::config::CConfigFileBase& config) {
  CMetricMapBuilderRBPF::TConstructionOptions options;
  options.loadFromConfigFile(config, kMrptSection);
  auto builder = std::make_unique<CMetricMapBuilderRBPF>(options);
  silence(*builder);
  // The particles' own logger, which reports every rejected match of every particle.
  silence(builder->mapPDF);
  builder->initialize();
  return builder;
}

std::unique_ptr<mrpt::slam::CMetricMapBuilder> makeBuilder(const MethodConfig& config,
                                                           const std::string& name, std::uint64_t seed) {
  if (config.method.type == "naive") {
    auto builder = std::make_unique<NaiveMapBuilder>(config.mapping);
    silence(*builder);
    return builder;
  }
  if (config.method.type == "particles") {
    auto builder = std::make_unique<ParticleMapBuilder>(config, seed);
    silence(*builder);
    return builder;
  }
  if (config.method.type == "graph") {
    auto builder = std::make_unique<GraphMapBuilder>(config.mapping, config.graph);
    silence(*builder);
    return builder;
  }
  registerMaps();
  const mrpt::config::CConfigFileMemory text(mrptConfigText(config, name));
  return config.method.type == "icp" ? makeIcpBuilder(text) : makeRbpfBuilder(text);
}

CActionRobotMovement2D::TMotionModelOptions motionModel(const MotionOptions& motion) {
  CActionRobotMovement2D::TMotionModelOptions model;
  // The Gaussian model: Thrun's would draw samples whenever the action is copied.
  model.modelSelection = CActionRobotMovement2D::mmGaussian;
  auto& gaussian = model.gaussianModel;
  gaussian.a1 = motion.sigma_xy_per_m;
  gaussian.a2 = motion.sigma_xy_per_rad;
  gaussian.a3 = motion.sigma_turn_per_m_rad;
  gaussian.a4 = motion.sigma_turn_per_rad;
  gaussian.minStdXY = motion.sigma_xy_m;
  gaussian.minStdPHI = motion.sigma_turn_rad;
  return model;
}

bool isReference(const MapBuilder::State& state, const robot::Scan& scan) {
  if (!state.reference_scan) return true;
  const core::Pose2 &a = state.reference_scan->T_robot_lidar, &b = scan.T_robot_lidar;
  return a.x == b.x && a.y == b.y && a.phi == b.phi;
}

/// The last step goes on, as long as it is to this scan.
core::Pose2 lastMotionUntil(const MapBuilder::State& state, const robot::Scan& scan) {
  if (!state.previous_scan || !(state.last_period_s > 0)) return {};
  const double period_s = scan.time_s - state.previous_scan->time_s;
  return core::interpolate({}, state.T_previous_last,
                           std::clamp(period_s / state.last_period_s, 0.0, kMostPeriods));
}

/// The motion since the scan before, from the scans. The estimator may have slept while the wheels did the
/// work: then it is shown the previous scan first.
odometry::ScanMotion motionFromScans(MapBuilder::State& state, const robot::Scan& scan) {
  if (!isReference(state, scan)) {
    odometry::ScanMotion motion;
    motion.T_previous_current = lastMotionUntil(state, scan);
    return motion;
  }
  if (!state.scan_odometry) state.scan_odometry = odometry::makeScanOdometry(state.config.scan_odometry);
  if (!state.scan_odometry_saw_previous && state.reference_scan) {
    state.scan_odometry->reset();
    state.scan_odometry->update(*state.reference_scan);
  }
  state.scan_odometry_saw_previous = true;
  auto motion = state.scan_odometry->update(scan, state.commanded);
  const auto& passed = state.T_reference_previous;
  const bool is_next = passed.x == 0 && passed.y == 0 && passed.phi == 0;
  if (!is_next) motion.T_previous_current = core::between(passed, motion.T_previous_current);
  return motion;
}

std::string stepText(const MapBuilder& method) {
  return "method " + method.name + ", scan " + std::to_string(method.state->steps + 1) + ": ";
}

void requireFinite(const MapBuilder& method, const core::Pose2& pose, const char* what) {
  if (!core::isFinite(pose)) throw core::MethodError(stepText(method) + what + " is not finite");
}

/// The action for the builder, still without its stamp.
std::shared_ptr<CActionRobotMovement2D> makeAction(MapBuilder& method, const robot::Scan& scan,
                                                   const core::Pose2& T_previous_robot, bool has_odometry) {
  MapBuilder::State& state = *method.state;
  const bool is_first = state.steps == 0;
  const bool from_scans = state.config.method.odometry != "wheel" || (!has_odometry && !is_first);
  if (from_scans) {
    const odometry::ScanMotion motion = motionFromScans(state, scan);
    requireFinite(method, motion.T_previous_current, "the motion estimated from the scans");
    // The original method stays what it was: how far, it never asks the wheels.
    const std::string& odometry = state.config.method.odometry;
    const bool ask_wheels =
        !motion.reliable && has_odometry && odometry != "argmax" && odometry != "argmax_blind";
    if (!ask_wheels || is_first) return odometry::toMrptAction(motion, state.builder_time_s);
  } else if (isReference(state, scan)) {
    state.scan_odometry_saw_previous = false;
  }
  const core::Pose2 increment = is_first ? core::Pose2{} : T_previous_robot;
  requireFinite(method, increment, "the odometry");
  auto action = CActionRobotMovement2D::Create();
  action->computeFromOdometry(mrpt::poses::CPose2D(robot::toMrpt(increment)), state.motion_model);
  return action;
}

/// Extent of one grid in metres.
struct Extent {
  double x_min, x_max, y_min, y_max, resolution_m;
};

double cellsWith(const Extent& grid, const core::Point2& centre, double reach_m) {
  const double width_m = std::max(grid.x_max, centre.x + reach_m) - std::min(grid.x_min, centre.x - reach_m);
  const double height_m = std::max(grid.y_max, centre.y + reach_m) - std::min(grid.y_min, centre.y - reach_m);
  return width_m * height_m / (grid.resolution_m * grid.resolution_m);
}

void addGrids(const mrpt::maps::CMultiMetricMap& maps, std::vector<Extent>& grids) {
  for (const auto& map : maps)
    if (const auto* grid = dynamic_cast<const COccupancyGridMap2D*>(&*map))
      grids.push_back(
          {grid->getXMin(), grid->getXMax(), grid->getYMin(), grid->getYMax(), grid->getResolution()});
}

std::vector<Extent> gridsOf(const mrpt::slam::CMetricMapBuilder& builder) {
  std::vector<Extent> grids;
  if (const auto* rbpf = dynamic_cast<const CMetricMapBuilderRBPF*>(&builder)) {
    for (const auto& particle : rbpf->mapPDF.m_particles) addGrids(particle.d->mapTillNow, grids);
  } else {
    addGrids(compat::asReference(builder.getCurrentlyBuiltMetricMap()), grids);
  }
  return grids;
}

/// Cells of a particle filter's maps, and what their directories would weigh in cells when they reached so far.
double cellsOf(const ParticleFilter& filter, const core::Point2& centre, double reach_m) {
  const gridmap::GridArea area = filter.map().area();
  const Extent extent{area.x_min_m, area.x_max_m, area.y_min_m, area.y_max_m, filter.map().cellSize()};
  const core::Point2 p_raster = ParticleFilter::rasterFromMap() * centre;
  const double directory = cellsWith(extent, p_raster, reach_m) / gridmap::Grid::cellsPerDirectoryEntry();
  return filter.cells() + filter.particles() * directory;
}

/// How far from the robot the scan can change the grid.
double reachOf(const MapBuilder::State& state, const robot::Scan& scan) {
  double farthest_m = 0;
  for (const float range_m : scan.ranges_m)
    if (robot::isReturn(range_m)) farthest_m = std::max(farthest_m, static_cast<double>(range_m));
  const double mount_m = std::hypot(scan.T_robot_lidar.x, scan.T_robot_lidar.y);
  const auto& mapping = state.config.mapping;
  if (state.config.method.type == "naive" && mapping.draw == "dots") return farthest_m + mount_m;
  return std::min(mapping.max_insert_range_m, std::max(farthest_m, scan.max_range_m)) + mount_m;
}

double reach(const MapBuilder::State& state, const robot::Scan& scan) {
  double reach_m = reachOf(state, scan);
  for (const auto& other : state.others) reach_m = std::max(reach_m, reachOf(state, other));
  return reach_m;
}

/// MRPT's grids grow without limit and end the program when memory does: a diverging method has to be stopped
/// before it inserts.
void requireBoundedMap(const MapBuilder& method, const core::Pose2& T_map_robot, double reach_m) {
  double cells = 0;
  if (const auto* particles = dynamic_cast<const ParticleMapBuilder*>(method.builder.get())) {
    cells = cellsOf(particles->filter(), core::position(T_map_robot), reach_m);
  } else {
    for (const Extent& grid : gridsOf(*method.builder))
      cells += cellsWith(grid, core::position(T_map_robot), reach_m);
  }
  const double limit = method.state->config.mapping.max_map_cells;
  if (!(cells <= limit)) throw core::MethodError(stepText(method) + tooManyCells(cells, limit));
}

/// MRPT's exceptions carry a stack trace; one line of it says what happened.
std::string firstLine(const std::string& text) {
  std::istringstream lines(text);
  std::string line;
  while (std::getline(lines, line))
    if (line.find_first_not_of(" \t=") != std::string::npos) return line;
  return text;
}

void feed(MapBuilder& method, const std::shared_ptr<CActionRobotMovement2D>& action,
          const robot::Scan& scan) {
  const auto stamp = mrpt::Clock::fromDouble(method.state->builder_time_s);
  action->timestamp = stamp;
  mrpt::obs::CActionCollection actions;
  actions.insert(*action);
  mrpt::obs::CSensoryFrame frame;
  const auto insert = [&](const robot::Scan& seen) {
    auto observation = robot::toMrpt(seen);
    observation->timestamp = stamp;
    // MRPT's ICP counts the way since the last insertion lidar by lidar, by their labels.
    if (frame.size() > 0) observation->sensorLabel += " " + std::to_string(frame.size() + 1);
    frame.insert(observation);
  };
  insert(scan);
  for (const auto& other : method.state->others) insert(other);
  try {
    method.builder->processActionObservation(actions, frame);
  } catch (const std::exception& error) {
    throw core::MethodError(stepText(method) + "MRPT: " + firstLine(error.what()));
  }
}

/// ICP's builder ignores odometry that is not newer than its last match, and complains on the console.
double growingTime(double time_s, double last_time_s, bool is_first) {
  if (std::isfinite(time_s) && (is_first || time_s > last_time_s)) return time_s;
  return last_time_s + 1e-3;
}

/// MRPT draws from one generator per thread. It is replaced, not only seeded: a normal number that it has in
/// store would survive the seeding.
void seedMrpt(const MapBuilder::State& state) {
  core::RandomStream stream(state.seed, "mapping step " + std::to_string(state.steps));
  mrpt::random::getRandomGenerator() =
      mrpt::random::CRandomGenerator(static_cast<uint32_t>(stream.bits() >> 32));
}

/// MRPT's ICP stamps a start pose with the clock, and then takes the odometry of a log from the past for stale.
class StoppedClock {
 public:
  StoppedClock() {
    mrpt::Clock::setSimulatedTime(mrpt::Clock::fromDouble(1));
    mrpt::Clock::setActiveClock(mrpt::Clock::Source::Simulated);
  }
  ~StoppedClock() { mrpt::Clock::setActiveClock(before_); }
  StoppedClock(const StoppedClock&) = delete;
  StoppedClock& operator=(const StoppedClock&) = delete;

 private:
  mrpt::Clock::Source before_ = mrpt::Clock::getActiveClock();
};

mrpt::maps::CSimpleMap loadKeyFrames(const std::string& path) {
  core::requireReadableFile(path);
  mrpt::maps::CSimpleMap map;
  bool loaded = false;
  try {
    loaded = map.loadFromFile(path);
  } catch (const std::exception&) {
  }
  if (!loaded) throw core::InputError(path + ": is no MRPT simplemap");
  if (map.empty()) throw core::InputError(path + ": holds 0 key frames, expected at least 1");
  return map;
}

/// What the robot did in a time.
struct RecentMotion {
  core::Pose2 T_previous_robot;
  double period_s;
};

/// The motion up to the scan: the odometry's, else that of the step before where that one had odometry. A motion that is itself
/// from skewed scans would make it worse.
std::optional<RecentMotion> motionUpTo(const MapBuilder::State& state, const robot::Scan& scan,
                                       const core::Pose2& T_previous_robot, bool has_odometry) {
  if (!state.previous_scan) return std::nullopt;
  const double period_s = scan.time_s - state.previous_scan->time_s;
  if (has_odometry && period_s > 0 && core::isFinite(T_previous_robot))
    return RecentMotion{T_previous_robot, period_s};
  if (state.last_had_odometry && state.last_period_s > 0)
    return RecentMotion{state.T_previous_last, state.last_period_s};
  return std::nullopt;
}

/// The scan without what the robot's motion did to it, where the method wants that and it can be known.
std::optional<robot::Scan> deskew(MapBuilder::State& state, const robot::Scan& scan,
                                  std::optional<robot::Sweep> sweep, const core::Pose2& T_previous_robot,
                                  bool has_odometry) {
  const MethodOptions& options = state.config.method;
  if (options.sweep_s > 0) sweep = robot::Sweep{options.sweep_s, options.sweep_clockwise};
  if (!sweep || !(sweep->duration_s > 0)) return std::nullopt;
  state.swept.swept += state.previous_scan.has_value();
  if (!options.deskew) return std::nullopt;
  const auto motion = motionUpTo(state, scan, T_previous_robot, has_odometry);
  if (!motion) return std::nullopt;
  ++state.swept.set_right;
  return robot::deskewed(scan, motion->T_previous_robot, motion->period_s, *sweep);
}

/// The scans of the other lidars at this step, deskewed.
void takeOthers(MapBuilder::State& state, const core::Pose2& T_previous_robot, bool has_odometry) {
  state.others.clear();
  for (auto& told : std::exchange(state.told_others, {})) {
    auto corrected = deskew(state, told.scan, told.sweep, T_previous_robot, has_odometry);
    state.others.push_back(corrected ? std::move(*corrected) : std::move(told.scan));
  }
}

/// Remembers the step that ends with this scan; T_previous_robot is what the method was fed.
void noteStep(MapBuilder::State& state, const robot::Scan& scan, const core::Pose2& T_previous_robot,
              const core::Pose2& T_map_robot) {
  if (isReference(state, scan)) {
    state.reference_scan = scan;
    state.T_reference_previous = {};
  } else {
    state.T_reference_previous = state.T_reference_previous * T_previous_robot;
  }
  const double period_s = state.previous_scan ? scan.time_s - state.previous_scan->time_s : 0;
  if (period_s > 0) {
    state.T_previous_last = core::between(state.T_map_robot, T_map_robot);
    state.last_period_s = period_s;
  }
  state.T_map_robot = T_map_robot;
  state.previous_scan = scan;
}

GraphMapBuilder* graphOf(const MapBuilder& method) {
  return dynamic_cast<GraphMapBuilder*>(method.builder.get());
}

void processInGraph(MapBuilder& method, GraphMapBuilder& graph, const robot::Scan& scan,
                    const core::Pose2& T_previous_robot, bool has_odometry) {
  MapBuilder::State& state = *method.state;
  // Where there is no odometry the graph knows better than two scans alone.
  core::Pose2 increment = T_previous_robot;
  if (state.config.method.odometry == "none") {
    has_odometry = false;
  } else if (state.config.method.odometry != "wheel") {
    increment = motionFromScans(state, scan).T_previous_current;
    has_odometry = true;
  }
  if (state.steps > 0 && has_odometry) requireFinite(method, increment, "the odometry");
  core::Pose2 T_map_robot = graph.processScan(scan, increment, has_odometry);
  for (const auto& other : state.others) T_map_robot = graph.processScan(other, {}, true);
  requireFinite(method, T_map_robot, "the pose");
  const size_t last = state.graph_steps.empty() ? 0 : state.graph_steps.back() + 1;
  state.graph_steps.push_back(last + state.others.size());
  noteStep(state, scan, has_odometry ? increment : core::between(state.T_map_robot, T_map_robot),
           T_map_robot);
  ++state.steps;
}

const mrpt::maps::CMultiMetricMapPDF* particlesOf(const MapBuilder& method) {
  const auto* rbpf = dynamic_cast<const CMetricMapBuilderRBPF*>(method.builder.get());
  return rbpf != nullptr ? &rbpf->mapPDF : nullptr;
}

/// Every particle's path grows by one pose when the filter is updated, which is not at every scan.
void noteUpdate(MapBuilder& method) {
  const auto* particles = particlesOf(method);
  if (particles == nullptr || particles->m_particles.empty()) return;
  MapBuilder::State& state = *method.state;
  while (state.updates.size() < particles->m_particles.front().d->robotPath.size())
    state.updates.push_back(state.steps);
}

}  // namespace

MapBuilder makeMapBuilder(const core::IniFile& config, const std::string& name, std::uint64_t seed) {
  MapBuilder method;
  method.state = std::make_unique<MapBuilder::State>();
  MapBuilder::State& state = *method.state;
  state.config = readMethodConfig(config);
  state.seed = seed;
  state.motion_model = motionModel(state.config.motion);
  method.name = name;
  method.type = state.config.method.type;
  method.odometry = state.config.method.odometry;
  method.lidars = state.config.method.lidars;
  method.parameters = state.config.report;
  method.builder = makeBuilder(state.config, name, seed);
  return method;
}

void continueMap(MapBuilder& method, const std::string& simplemap_path,
                 const std::optional<core::Pose2>& T_map_robot, bool keep_map) {
  if (method.type == "naive" || method.type == "rbpf")
    throw core::InputError("method " + method.name + " of type " + method.type +
                           " cannot go on in a map, expected type graph, particles or icp");
  if (!T_map_robot && (method.type != "graph" || !keep_map))
    throw core::InputError(
        "method " + method.name + " of type " + method.type +
        " has to be told where in the map the log begins (--start): only type graph finds a robot "
        "anywhere, and only with --localise");
  const auto map = loadKeyFrames(simplemap_path);
  mrpt::poses::CPosePDFGaussian start;
  start.mean = mrpt::poses::CPose2D(robot::toMrpt(T_map_robot.value_or(core::Pose2{})));
  try {
    const StoppedClock clock;
    method.builder->initialize(map, T_map_robot ? &start : nullptr);
    if (!T_map_robot) graphOf(method)->startAnywhere();
  } catch (const core::MethodError&) {
    throw;
  } catch (const std::exception& error) {
    throw core::InputError(simplemap_path + ": cannot be gone on with: " + firstLine(error.what()));
  }
  method.builder->options.enableMapUpdating = !keep_map;
  method.state->T_map_robot = T_map_robot.value_or(core::Pose2{});
}

std::string toMrptConfig(const core::IniFile& config, const std::string& name) {
  const MethodConfig read = readMethodConfig(config);
  if (read.method.type != "icp" && read.method.type != "rbpf") {
    const auto* given = config.find("method", "type");
    throw core::InputError((given != nullptr ? given->origin : name) +
                           ": section [method], key 'type': found '" + read.method.type +
                           "', expected icp or rbpf: no MRPT program runs the " + read.method.type +
                           " method");
  }
  return mrptConfigText(read, name);
}

void addScans(MapBuilder& method, std::vector<SweptScan> others) {
  method.state->told_others = std::move(others);
}

void setCommands(MapBuilder& method, std::vector<robot::Commanded> commands) {
  method.state->commands = std::move(commands);
}

void setSweep(MapBuilder& method, const std::optional<robot::Sweep>& sweep) {
  method.state->sweep = sweep;
}

SweptScans sweptScans(const MapBuilder& method) {
  return method.state->swept;
}

core::Pose2 processScan(MapBuilder& method, const robot::Scan& raw_scan, const core::Pose2& T_previous_robot,
                        bool has_odometry, const robot::Commanded& commanded) {
  MapBuilder::State& state = *method.state;
  state.commanded = commanded;
  if (commanded.kind == robot::MotionKind::kUnknown) {
    if (state.steps < state.commands.size())
      state.commanded = state.commands[state.steps];
    else if (has_odometry)
      state.commanded = state.wheels_commands.next(T_previous_robot);
  }
  const std::optional<robot::Scan> corrected =
      deskew(state, raw_scan, state.sweep, T_previous_robot, has_odometry);
  takeOthers(state, T_previous_robot, has_odometry);
  state.last_had_odometry = has_odometry;
  const robot::Scan& scan = corrected ? *corrected : raw_scan;
  state.builder_time_s = growingTime(scan.time_s, state.builder_time_s, state.steps == 0);

  if (auto* graph = graphOf(method)) {
    processInGraph(method, *graph, scan, T_previous_robot, has_odometry);
    return state.T_map_robot;
  }

  const auto action = makeAction(method, scan, T_previous_robot, has_odometry);
  const core::Pose2 increment = robot::fromMrpt(action->poseChange->getMeanVal().asTPose());
  const double reach_m = reach(state, scan);
  requireBoundedMap(method, state.T_map_robot * increment, reach_m);

  seedMrpt(state);
  feed(method, action, scan);

  const auto pose = method.builder->getCurrentPoseEstimation()->getMeanVal();
  const core::Pose2 T_map_robot{pose.x(), pose.y(), pose.yaw()};
  requireFinite(method, T_map_robot, "the pose");
  requireBoundedMap(method, T_map_robot, 0);
  noteStep(state, scan, increment, T_map_robot);
  noteUpdate(method);
  ++state.steps;
  return state.T_map_robot;
}

std::optional<Eigen::Matrix3d> poseCovariance(const MapBuilder& method) {
  if (method.type == "naive") return std::nullopt;
  mrpt::math::CMatrixDouble66 spatial;  // x, y, z, yaw, pitch, roll
  mrpt::poses::CPose3D mean;
  method.builder->getCurrentPoseEstimation()->getCovarianceAndMean(spatial, mean);
  constexpr std::array<int, 3> kPlanar = {0, 1, 3};
  Eigen::Matrix3d covariance;
  for (int row = 0; row < 3; ++row)
    for (int column = 0; column < 3; ++column)
      covariance(row, column) =
          spatial(kPlanar[static_cast<size_t>(row)], kPlanar[static_cast<size_t>(column)]);
  return covariance;
}

std::vector<Eigen::Matrix3d> finalCovariances(const MapBuilder& method) {
  const auto* graph = graphOf(method);
  if (graph == nullptr) return {};
  const auto of_scans = graph->graph().covariances();
  std::vector<Eigen::Matrix3d> covariances;
  for (const size_t scan : method.state->graph_steps) covariances.push_back(of_scans.at(scan));
  return covariances;
}

void finishMap(MapBuilder& method) {
  auto* graph = graphOf(method);
  if (graph != nullptr && graph->options.enableMapUpdating) graph->finish();
}

namespace {

/// The graph counts scans, others count steps, which may be of several scans.
std::vector<JournalEntry> byStep(std::vector<JournalEntry> journal, const std::vector<size_t>& graph_steps) {
  const auto stepOf = [&](int scan) {
    const auto step = std::lower_bound(graph_steps.begin(), graph_steps.end(), static_cast<size_t>(scan));
    return static_cast<int>(step - graph_steps.begin());
  };
  for (auto& entry : journal) {
    if (entry.scan >= 0) entry.scan = stepOf(entry.scan);
    if (entry.other_scan >= 0) entry.other_scan = stepOf(entry.other_scan);
  }
  return journal;
}

}  // namespace

std::vector<JournalEntry> journalOf(const MapBuilder& method) {
  if (const auto* graph = graphOf(method)) return byStep(graph->graph().journal(), method.state->graph_steps);
  if (const auto* particles = dynamic_cast<const ParticleMapBuilder*>(method.builder.get()))
    return particles->filter().journal();
  return {};
}

std::optional<core::Trajectory> finalPath(const MapBuilder& method, const core::Trajectory& online) {
  if (const auto* graph = graphOf(method)) {
    const auto poses = graph->graph().poses();
    const auto& graph_steps = method.state->graph_steps;
    if (online.size() != graph_steps.size())
      throw core::ContractError("finalPath: expected the " + std::to_string(graph_steps.size()) +
                                " poses given online");
    core::Trajectory path = online;
    for (size_t i = 0; i < path.size(); ++i) path[i].pose = poses.at(graph_steps[i]);
    return path;
  }
  if (const auto* filter = dynamic_cast<const ParticleMapBuilder*>(method.builder.get())) {
    core::Trajectory path = filter->filter().path();
    if (online.size() != path.size())
      throw core::ContractError("finalPath: expected the " + std::to_string(path.size()) +
                                " poses given online");
    for (size_t i = 0; i < path.size(); ++i) path[i].time_s = online[i].time_s;
    return path;
  }
  const auto* particles = particlesOf(method);
  if (particles == nullptr) return std::nullopt;
  const auto& updates = method.state->updates;
  if (online.size() != method.state->steps || updates.empty())
    throw core::ContractError("finalPath: expected the " + std::to_string(method.state->steps) +
                              " poses given online");
  const auto best = std::max_element(particles->m_particles.begin(), particles->m_particles.end(),
                                     [](const auto& a, const auto& b) { return a.log_w < b.log_w; });
  core::Trajectory path = online;
  for (size_t i = 0; i < updates.size(); ++i) {
    const core::Pose2 T_map_robot = robot::fromMrpt(mrpt::math::TPose2D(best->d->robotPath[i]));
    const size_t end = i + 1 < updates.size() ? updates[i + 1] : path.size();
    for (size_t scan = updates[i]; scan < end; ++scan)
      path[scan].pose = T_map_robot * core::between(online[updates[i]].pose, online[scan].pose);
  }
  return path;
}

std::vector<core::Pose2> particlePoses(const MapBuilder& method) {
  if (const auto* filter = dynamic_cast<const ParticleMapBuilder*>(method.builder.get()))
    return filter->filter().poses();
  std::vector<core::Pose2> poses;
  if (const auto* particles = particlesOf(method))
    for (const auto& particle : particles->m_particles)
      if (!particle.d->robotPath.empty())
        poses.push_back(robot::fromMrpt(mrpt::math::TPose2D(particle.d->robotPath.back())));
  return poses;
}

const GraphSlam* graphSlamOf(const MapBuilder& method) {
  const auto* graph = graphOf(method);
  return graph ? &graph->graph() : nullptr;
}

std::vector<std::string> methodNames(const std::string& methods_folder) {
  std::error_code error;
  std::filesystem::directory_iterator files(methods_folder, error);
  if (error) throw core::InputError(methods_folder + ": cannot be read as a folder: " + error.message());
  std::vector<std::string> names;
  for (const auto& file : files)
    if (file.path().extension() == ".ini") names.push_back(file.path().stem().string());
  std::sort(names.begin(), names.end());
  return names;
}

namespace {

core::IniFile loadOwnConfig(const std::string& methods_folder, const std::string& name_or_path) {
  const bool is_path = name_or_path.find('/') != std::string::npos || core::isConfigFile(name_or_path);
  if (is_path) return core::IniFile::load(name_or_path);
  const auto names = methodNames(methods_folder);
  if (std::find(names.begin(), names.end(), name_or_path) == names.end())
    throw core::InputError("unknown method '" + name_or_path + "'" + core::didYouMean(name_or_path, names));
  return core::IniFile::load((std::filesystem::path(methods_folder) / (name_or_path + ".ini")).string());
}

/// The file, laid over the method that its [method] base names. `depth`: how many files led here.
core::IniFile withBase(const std::string& methods_folder, core::IniFile own, int depth) {
  const auto* base = own.find("method", "base");
  if (base == nullptr) return own;
  constexpr int kDeepest = 8;
  if (depth >= kDeepest)
    throw core::InputError(base->origin + ": key 'base': more than " + std::to_string(kDeepest) +
                           " methods on top of one another, expected an end");
  core::IniFile config;
  try {
    config = withBase(methods_folder, loadOwnConfig(methods_folder, base->value), depth + 1);
  } catch (const core::InputError& error) {
    if (depth > 0) throw;
    throw core::InputError(base->origin + ": key 'base': " + error.what());
  }
  for (const auto& [section, entries] : own.sections())
    for (const auto& [key, entry] : entries)
      if (section != "method" || key != "base") config.set(section, key, entry.value, entry.origin);
  return config;
}

}  // namespace

core::IniFile loadMethodConfig(const std::string& methods_folder, const std::string& name_or_path) {
  return withBase(methods_folder, loadOwnConfig(methods_folder, name_or_path), 0);
}

}  // namespace slam::mapping
