#include "apps/view_actions.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <iostream>
#include <memory>

#include "apps/console.h"
#include "apps/navigators_slam.h"
#include "apps/show.h"
#include "apps/user_input.h"
#include "libslam/core/error.h"
#include "libslam/explore/explore.h"
#include "libslam/files/files.h"
#include "libslam/live/drive_seat.h"
#include "libslam/live/mapped_loop.h"
#include "libslam/live/replay.h"
#include "libslam/logs/log_reader.h"
#include "libslam/logs/trajectory_io.h"
#include "libslam/mapping/map_builder.h"
#include "libslam/metrics/trajectory_error.h"
#include "libslam/reach/goal_methods.h"
#include "libslam/reach/reach_goal.h"
#include "libslam/resources/file_hash.h"
#include "libslam/resources/ini_yaml.h"
#include "libslam/resources/resources.h"
#include "libslam/run/build_map.h"
#include "libslam/run/external_method.h"
#include "libslam/score/compare.h"
#include "libslam/sim/standing_room.h"
#include "libslam/truth/truth_files.h"

namespace slam::apps {
namespace fs = std::filesystem;
namespace {

/// Instead of a method: no map, the pose by the wheels.
constexpr const char* kWheelsOnly = "odometry";

files::IniFile configOf(const Context& context, const ViewArguments& arguments) {
  return withCarries(simulationConfig(context, arguments.simulation), arguments.carries);
}

void requireSensible(const ShowFlags& flags) {
  if (flags.screenshot.empty() != (flags.at_s < 0))
    throw core::InputError("--screenshot and --at: found one of them, expected both (what, and when)");
}

int report(Shown shown, const ShowFlags& flags, const std::string& written) {
  if (shown == Shown::kPicture) std::printf("%s\n", flags.screenshot.c_str());
  if (shown == Shown::kClosed) std::printf("closed before its end: nothing was written\n");
  if (shown == Shown::kWhole && !written.empty()) std::printf("%s\n", written.c_str());
  return 0;
}

std::string nameOf(const std::string& path) {
  return fs::path(path).stem().string();
}

/// A plan with everything that starts a robot in it.
struct Start {
  std::string plan_path;
  world::Plan plan;
  resources::Manifest manifest;
};

Start startIn(const Context& context, const std::string& input) {
  Start start;
  start.plan_path = resources::resolvePlan(input);
  start.plan = world::loadPlan(start.plan_path);
  start.manifest = context.manifest();
  start.manifest.inputs[start.plan_path] = resources::fileSha256(start.plan_path);
  return start;
}

Show showOf(const Start& start, const record::RecordConfig& config, std::uint64_t seed) {
  Show what;
  what.plan = record::planOfVisit(start.plan, config.living, seed);
  what.robot_side_m = config.robot.side_m;
  what.T_scene_map = record::startPose(*what.plan, config);
  return what;
}

void refuseToOverwriteLog(const Context& context, const std::string& log_path) {
  for (const auto& path : {log_path, truth::besideLog(log_path, ".gt.tum")})
    files::refuseToOverwrite(path, context.overwrite);
}

std::string writtenText(const record::Recording& recording) {
  char text[200];
  std::snprintf(text, sizeof text, "%zu scans in %.1f s over %.1f m, %zu collisions", recording.scans,
                recording.duration_s, recording.path_length_m, recording.collisions.size());
  std::string lines = std::string(text) + "\n" + eventLines(recording);
  for (const auto& file : recording.files) lines += "  " + file + "\n";
  lines.pop_back();
  return lines;
}

}  // namespace

int viewSimulate(const Context& context, const ViewArguments& arguments) {
  requireSensible(arguments.show);
  const auto config = record::readRecordConfig(configOf(context, arguments));
  if (context.print_config) return printParameters(config.parameters, context.json), 0;
  const auto start = startIn(context, arguments.input);
  if (!context.output.empty()) refuseToOverwriteLog(context, context.output);
  const files::ScratchFolder scratch;
  const std::string log_path = context.output.empty() ? scratch / "run.rawlog" : context.output;
  Show what = showOf(start, config, context.seed);
  what.title = "simulate " + start.plan.name;
  what.method = config.strategy.name + ", wheel odometry";
  ConsoleProgress progress(context.quiet);
  std::string written;
  const auto shown = show(what, arguments.show, [&](record::StepObserver& observer, live::Stage*) {
    const auto recording =
        record::record(start.plan, config, context.seed, log_path, start.manifest, progress, &observer);
    if (!context.output.empty()) written = writtenText(recording);
  });
  return report(shown, arguments.show, written);
}

namespace {

/// The method that maps along while somebody drives; nothing for "odometry".
std::optional<mapping::MapBuilder> mapperOf(const std::string& slam, std::uint64_t seed) {
  if (slam == kWheelsOnly) return std::nullopt;
  return mapping::makeMapBuilder(mapping::loadMethodConfig(resources::configsFolder() + "/methods", slam),
                                 nameOf(slam), seed);
}

}  // namespace

int viewDrive(const Context& context, const ViewArguments& arguments) {
  requireSensible(arguments.show);
  const bool is_picture = !arguments.show.screenshot.empty();
  const auto config = record::readRecordConfig(configOf(context, arguments));
  if (context.print_config) return printParameters(config.parameters, context.json), 0;
  if (is_picture && arguments.commands.empty())
    throw core::InputError("--screenshot: nobody drives without a window, expected --commands");
  const auto start = startIn(context, arguments.input);
  const auto commands = readUserCommands(arguments.commands);
  auto mapper = mapperOf(arguments.slam, context.seed);
  const files::ScratchFolder scratch;
  const std::string log_path =
      is_picture ? scratch / "run.rawlog" : (context.output.empty() ? "run.rawlog" : context.output);
  refuseToOverwriteLog(context, log_path);
  Show what = showOf(start, config, context.seed);
  what.title = "drive " + start.plan.name;
  what.method = mapper ? "by hand; " + mapper->name : "by hand; wheel odometry";
  what.hands = live::Hands::kDrive;
  what.refusal = [&what, &config](const core::Pose2& T_world_robot) {
    return sim::refusalOf(*what.plan, T_world_robot, robot::circumscribedRadius(config.robot));
  };
  auto manifest = start.manifest;
  manifest.results["driven"] = "by hand";
  noteCommands(arguments.commands, manifest);
  ConsoleProgress progress(true);
  std::string written;
  const auto shown = show(what, arguments.show, [&](record::StepObserver& observer, live::Stage* stage) {
    live::DriveSeat seat(config.robot, 1 / config.lidar.rate_hz, commands, stage,
                         arguments.show.close && !commands.empty());
    const auto commander = [&](const sim::Sensed& sensed) { return seat.next(sensed.collided); };
    std::optional<live::MappedLoop> mapped;
    if (mapper) mapped.emplace(std::move(*mapper), observer);
    const auto recording =
        record::recordCommands(start.plan, config, context.seed, log_path, manifest, progress, commander,
                               mapped ? static_cast<record::StepObserver*>(&*mapped) : &observer);
    written = writtenText(recording);
  });
  if (shown == Shown::kPicture) return report(shown, arguments.show, "");
  std::printf("%s\nnext: rasterslam compare %s\n", written.c_str(), log_path.c_str());
  return 0;
}

int viewExplore(const Context& context, const ViewArguments& arguments) {
  requireSensible(arguments.show);
  explore::ExploreRequest request;
  request.strategies = {explore::readExploreConfig(configOf(context, arguments))};
  const auto& config = request.strategies.front().record;
  if (context.print_config) return printParameters(config.parameters, context.json), 0;
  const auto start = startIn(context, arguments.input);
  const files::ScratchFolder scratch;
  request.plan_path = start.plan_path;
  request.slam = arguments.slam;
  request.methods_folder = resources::configsFolder() + "/methods";
  request.output = context.output.empty() ? scratch / "exploration" : context.output;
  request.seed = context.seed;
  request.overwrite = context.overwrite;
  request.tables_only = context.output.empty();
  Show what = showOf(start, config, context.seed);
  what.title = "explore " + start.plan.name;
  what.method = config.strategy.name + " on " + nameOf(arguments.slam);
  ConsoleProgress progress(context.quiet);
  std::string written;
  const auto shown = show(what, arguments.show, [&](record::StepObserver& observer, live::Stage*) {
    request.observer = &observer;
    const auto result = explore::explore(request, context.manifest(), progress);
    written = table::toText(result.scores);
    if (!context.output.empty()) written += "\npictures, maps, tables: " + context.output;
  });
  return report(shown, arguments.show, written);
}

int viewNavigate(const Context& context, const ViewArguments& arguments) {
  requireSensible(arguments.show);
  reach::ReachGoalRequest request;
  request.config = reach::readReachGoalConfig(configOf(context, arguments));
  if (context.print_config) return printParameters(request.config.parameters, context.json), 0;
  request.p_world_goal = reach::parsePlace(arguments.goal, "--goal");
  const auto start = startIn(context, arguments.input);
  request.plan = record::planOfVisit(start.plan, request.config.living, context.seed);
  request.T_world_start = reach::goalStart(request.plan, request.config, arguments.start);
  request.methods = {arguments.method};
  const std::string slam = navigatorsSlam(arguments.slam, request.config.camera.has_value());
  request.slam = slam == "odometry" ? "" : slam;
  request.methods_folder = resources::configsFolder() + "/methods";
  const files::ScratchFolder scratch;
  request.output = context.output.empty() ? scratch / "navigation" : context.output;
  request.seed = context.seed;
  request.overwrite = context.overwrite;
  Show what;
  what.plan = request.plan;
  what.robot_side_m = request.config.robot.side_m;
  what.T_scene_map = request.T_world_start;
  what.goal = core::inverse(what.T_scene_map) * request.p_world_goal;
  what.title = "navigate " + start.plan.name;
  what.method = arguments.method + " on " + nameOf(slam);
  what.strategic = reach::strategicOverlay(arguments.method, request.config.navigate, request.config.robot,
                                           request.config.lidar);
  ConsoleProgress progress(context.quiet);
  std::string written;
  const auto shown = show(what, arguments.show, [&](record::StepObserver& observer, live::Stage*) {
    request.observer = &observer;
    const auto comparison = reach::reachGoal(request, start.manifest, progress);
    written = table::toText(comparison.table);
    if (!context.output.empty()) written += "\npaths, states, pictures: " + context.output;
  });
  return report(shown, arguments.show, written);
}

namespace {

/// What is known to be true of a log, laid under what is shown. `path` in the map frame, nothing for a method
/// that is to begin.
void addTruth(const std::string& log_path, const std::string& given_plan, Show& what) {
  const auto truth = truth::truthFiles(log_path, "", given_plan);
  if (!truth.trajectory.empty()) {
    what.truth = logs::readTrajectory(truth.trajectory);
    const auto first = logs::LogReader(log_path).next();
    if (first) metrics::poseAt(what.truth, first->scan.time_s, what.T_scene_map);
  }
  if (!truth.plan.empty()) what.plan = world::loadPlan(truth.plan);
}

}  // namespace

int viewRun(const Context& context, const ViewArguments& arguments) {
  requireSensible(arguments.show);
  auto config = mapping::loadMethodConfig(resources::configsFolder() + "/methods", arguments.method);
  if (!context.config.empty()) config.overrideWith(resources::readConfigFile(context.config));
  for (const auto& setting : context.settings) config.setFromArgument(setting, "--set");
  const std::string name = nameOf(arguments.method);
  if (context.print_config) return printParameters(run::methodParameters(config), context.json), 0;
  const files::ScratchFolder scratch;
  const std::string folder = context.output.empty() ? scratch / name : context.output;
  Show what;
  what.title = name + " on " + fs::path(arguments.input).filename().string();
  addTruth(arguments.input, arguments.plan, what);
  ConsoleProgress progress(context.quiet);
  std::string written;
  const auto shown = show(what, arguments.show, [&](record::StepObserver& observer, live::Stage*) {
    run::buildMap(arguments.input, config, name, context.seed, folder, context.overwrite, context.manifest(),
                  progress, {true, {}, &observer});
    if (!context.output.empty()) written = "map, path, journal: " + folder;
  });
  return report(shown, arguments.show, written);
}

int viewReplay(const Context& /*context*/, const ViewArguments& arguments) {
  requireSensible(arguments.show);
  const auto replay = live::loadReplay(arguments.input, arguments.log);
  Show what;
  what.title = "replay " + arguments.input;
  what.method = replay.method;
  addTruth(replay.log_path, arguments.plan, what);
  what.loops = replay.loops;
  const auto shown = show(what, arguments.show, [&](record::StepObserver& observer, live::Stage*) {
    live::play(replay, observer);
  });
  return report(shown, arguments.show, "");
}

}  // namespace slam::apps
