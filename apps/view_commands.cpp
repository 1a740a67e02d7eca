#include "apps/view_commands.h"

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
#include "libslam/core/files.h"
#include "libslam/core/resources.h"
#include "libslam/explore/explore.h"
#include "libslam/explore/goal_methods.h"
#include "libslam/explore/reach_goal.h"
#include "libslam/live/drive_seat.h"
#include "libslam/live/mapped_loop.h"
#include "libslam/live/replay.h"
#include "libslam/logs/log_reader.h"
#include "libslam/logs/trajectory_io.h"
#include "libslam/mapping/map_builder.h"
#include "libslam/metrics/trajectory_error.h"
#include "libslam/record/truth_files.h"
#include "libslam/run/build_map.h"
#include "libslam/run/external_method.h"
#include "libslam/score/compare.h"
#include "libslam/sim/standing_room.h"

namespace slam::apps {
namespace fs = std::filesystem;
namespace {

/// Instead of a method: no map, the pose by the wheels.
constexpr const char* kWheelsOnly = "odometry";

struct ViewArguments {
  std::string input;  ///< plan, log or folder
  std::string method, slam = kExplorersSlam, log, plan, start = "auto", goal, commands;
  SimulationFlags simulation;
  std::vector<std::string> carries;
  ShowFlags show;
};

core::IniFile configOf(const Context& context, const ViewArguments& arguments) {
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
  core::Manifest manifest;
};

Start startIn(const Context& context, const std::string& input) {
  Start start;
  start.plan_path = core::resolvePlan(input);
  start.plan = world::loadPlan(start.plan_path);
  start.manifest = context.manifest();
  start.manifest.inputs[start.plan_path] = core::fileSha256(start.plan_path);
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
  for (const auto& path : {log_path, record::logStem(log_path) + ".gt.tum"})
    core::refuseToOverwrite(path, context.overwrite);
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

int viewSimulate(const Context& context, const ViewArguments& arguments) {
  requireSensible(arguments.show);
  const auto config = record::readRecordConfig(configOf(context, arguments));
  if (context.print_config) return printParameters(config.parameters, context.json), 0;
  const auto start = startIn(context, arguments.input);
  if (!context.output.empty()) refuseToOverwriteLog(context, context.output);
  const core::ScratchFolder scratch;
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

/// The method that maps along while somebody drives; nothing for "odometry".
std::optional<mapping::MapBuilder> mapperOf(const std::string& slam, std::uint64_t seed) {
  if (slam == kWheelsOnly) return std::nullopt;
  return mapping::makeMapBuilder(mapping::loadMethodConfig(core::configsFolder() + "/methods", slam),
                                 nameOf(slam), seed);
}

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
  const core::ScratchFolder scratch;
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
  const core::ScratchFolder scratch;
  request.plan_path = start.plan_path;
  request.slam = arguments.slam;
  request.methods_folder = core::configsFolder() + "/methods";
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
  explore::ReachGoalRequest request;
  request.config = explore::readReachGoalConfig(configOf(context, arguments));
  if (context.print_config) return printParameters(request.config.parameters, context.json), 0;
  request.p_world_goal = explore::parsePlace(arguments.goal, "--goal");
  const auto start = startIn(context, arguments.input);
  request.plan = record::planOfVisit(start.plan, request.config.living, context.seed);
  request.T_world_start = explore::goalStart(request.plan, request.config, arguments.start);
  request.methods = {arguments.method};
  const std::string slam = navigatorsSlam(arguments.slam, request.config.camera.has_value());
  request.slam = slam == "odometry" ? "" : slam;
  request.methods_folder = core::configsFolder() + "/methods";
  const core::ScratchFolder scratch;
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
  what.strategic = explore::strategicOverlay(arguments.method, request.config.navigate, request.config.robot,
                                             request.config.lidar);
  ConsoleProgress progress(context.quiet);
  std::string written;
  const auto shown = show(what, arguments.show, [&](record::StepObserver& observer, live::Stage*) {
    request.observer = &observer;
    const auto comparison = explore::reachGoal(request, start.manifest, progress);
    written = table::toText(comparison.table);
    if (!context.output.empty()) written += "\npaths, states, pictures: " + context.output;
  });
  return report(shown, arguments.show, written);
}

/// What is known to be true of a log, laid under what is shown. `path` in the map frame, nothing for a method
/// that is to begin.
void addTruth(const std::string& log_path, const std::string& given_plan, Show& what) {
  const auto truth = record::truthFiles(log_path, "", given_plan);
  if (!truth.trajectory.empty()) {
    what.truth = logs::readTrajectory(truth.trajectory);
    const auto first = logs::LogReader(log_path).next();
    if (first) metrics::poseAt(what.truth, first->scan.time_s, what.T_scene_map);
  }
  if (!truth.plan.empty()) what.plan = world::loadPlan(truth.plan);
}

int viewRun(const Context& context, const ViewArguments& arguments) {
  requireSensible(arguments.show);
  auto config = mapping::loadMethodConfig(core::configsFolder() + "/methods", arguments.method);
  if (!context.config.empty()) config.overrideWith(core::IniFile::load(context.config));
  for (const auto& setting : context.settings) config.setFromArgument(setting, "--set");
  const std::string name = nameOf(arguments.method);
  if (context.print_config) return printParameters(run::methodParameters(config), context.json), 0;
  const core::ScratchFolder scratch;
  const std::string folder = context.output.empty() ? scratch / name : context.output;
  Show what;
  what.title = name + " on " + fs::path(arguments.input).filename().string();
  addTruth(arguments.input, arguments.plan, what);
  ConsoleProgress progress(context.quiet);
  std::string written;
  const auto shown = show(what, arguments.show, [&](record::StepObserver& observer, live::Stage*) {
    run::buildMap(arguments.input, config, name, context.seed, folder, context.overwrite, context.manifest(),
                  progress, true, {}, &observer);
    if (!context.output.empty()) written = "map, path, journal: " + folder;
  });
  return report(shown, arguments.show, written);
}

int viewReplay(const Context&, const ViewArguments& arguments) {
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

void addWindowSize(CLI::App* command, ShowFlags& flags) {
  command->add_option("--size", flags.size, "of the window, WIDTHxHEIGHT in pixels")
      ->delimiter('x')
      ->expected(2)
      ->check(CLI::Range(480, 7680))
      ->default_str("1280x800");
}

void addShowFlags(CLI::App* command, ShowFlags& flags) {
  command->add_option("--speed", flags.speed, "times the robot's time, 0.125 to 64; 0 = as fast as it goes")
      ->check(CLI::Range(0.0, live::Playback::kFastest))
      ->capture_default_str();
  command->add_flag("--paused", flags.paused, "begin paused");
  command->add_flag("--close", flags.close, "close the window at the end");
  addWindowSize(command, flags);
  command->add_option("--screenshot", flags.screenshot,
                      "a PNG to write instead of opening a window; needs no display");
  command
      ->add_option("--at", flags.at_s, "of the screenshot: seconds of the robot's time since the first scan")
      ->check(CLI::NonNegativeNumber);
}

std::string keysText(live::Hands hands) {
  std::string text;
  for (const auto& key : live::keysOf(hands)) text += "\n  " + padded(key.key, 12) + key.meaning;
  return text;
}

using Action = int (*)(const Context&, const ViewArguments&);

std::shared_ptr<ViewArguments> onCall(CLI::App* command, Context& context, Action action) {
  auto arguments = std::make_shared<ViewArguments>();
  command->callback([&context, arguments, action] {
    context.action = [&context, arguments, action] { return action(context, *arguments); };
  });
  return arguments;
}

constexpr const char* kPlanMeaning = "bmp, png, pgm, jpg, a ROS map yaml, or a world by name";

}  // namespace

void addViewCommands(CLI::App& app, Context& context) {
  auto* view = app.add_subcommand("view", "watch a robot live in a window, or drive it by hand");
  view->require_subcommand(1);
  view->footer("Keys:" + keysText(live::Hands::kWatch) +
               "\nExit codes: as rasterslam's; 1 without a display (--screenshot needs none).\n"
               "'rasterslam view --mrpt FILE' shows a file in MRPT's own viewer instead.\n"
               "'rasterslam view COMMAND --help' shows examples.");

  auto* drive = view->add_subcommand("drive", "drive by the arrow keys; writes a rawlog and its truth");
  auto driving = onCall(drive, context, viewDrive);
  drive->add_option("plan", driving->input, kPlanMeaning)->required();
  addOutput(drive, context, "the rawlog to write (default run.rawlog)");
  addSeed(drive, context);
  drive->add_option("--lidar", driving->simulation.lidars,
                    "a lidar by name (see 'rasterslam list lidars') or an .ini file");
  addSensorFlag(drive, driving->simulation);
  driving->slam = "naive";
  drive
      ->add_option("--slam", driving->slam,
                   "the method whose map grows and whose pose is shown, or odometry for none")
      ->capture_default_str();
  addCommands(drive, driving->commands);
  addCarry(drive, driving->carries);
  drive->add_option("--duration", driving->simulation.duration_s, "longest recording, seconds")
      ->check(isDuration);
  addStartFlag(drive, driving->simulation);
  drive->add_option("--form", driving->simulation.form, "form of the rawlog: action or observation");
  addConfig(drive, context);
  driving->show.speed = 1;
  addShowFlags(drive, driving->show);
  drive->footer(
      "Keys:" + keysText(live::Hands::kDrive) +
      "\nThe files are those of 'rasterslam simulate'; closing the window saves them, Ctrl-C does not.\n"
      "--commands come first; --close ends the drive after them.\n"
      "Examples:\n"
      "  rasterslam view drive flat -o run.rawlog --set living.people=3\n"
      "  rasterslam view drive flat --slam graph --commands drive.txt\n"
      "  rasterslam view drive flat --commands drive.txt --screenshot map.png --at 20");

  auto* simulate = view->add_subcommand("simulate", "watch 'rasterslam simulate'");
  auto simulating = onCall(simulate, context, viewSimulate);
  simulate->add_option("plan", simulating->input, kPlanMeaning)->required();
  addOutput(simulate, context, "the rawlog to write (default: none)");
  addSeed(simulate, context);
  addSimulationFlags(simulate, simulating->simulation);
  addCarry(simulate, simulating->carries);
  addConfig(simulate, context);
  addShowFlags(simulate, simulating->show);
  simulate->footer("Example:\n  rasterslam view simulate office_loop --set living.people=8 --speed 8");

  auto* explore = view->add_subcommand("explore", "watch 'rasterslam explore' with one strategy");
  auto exploring = onCall(explore, context, viewExplore);
  explore->add_option("plan", exploring->input, kPlanMeaning)->required();
  explore
      ->add_option("--slam", exploring->slam, "the method that estimates pose and map, or truth (reference)")
      ->capture_default_str();
  addOutput(explore, context, "folder to write (default: none)");
  addSeed(explore, context);
  addSimulationFlags(explore, exploring->simulation);
  addCarry(explore, exploring->carries);
  addConfig(explore, context);
  addShowFlags(explore, exploring->show);
  explore->footer(
      "Examples:\n"
      "  rasterslam view explore flat --strategy information_gain --slam particles\n"
      "  rasterslam view explore flat --strategy quadrant --screenshot flat.png --at 60");

  auto* navigate = view->add_subcommand("navigate", "watch 'rasterslam navigate' with one method");
  auto navigating = onCall(navigate, context, viewNavigate);
  navigating->slam.clear();
  navigating->method = "tangent";
  navigate->add_option("plan", navigating->input, kPlanMeaning)->required();
  navigate->add_option("--start", navigating->start, "x_m,y_m,yaw_deg in the world frame, or auto")
      ->capture_default_str();
  navigate->add_option("--goal", navigating->goal, "x_m,y_m in the world frame")->required();
  navigate->add_option("--method", navigating->method, "bug1, bug2, tangent, lidar_bug or mrpt_reactive")
      ->capture_default_str();
  navigate->add_option("--slam", navigating->slam, kNavigatorsSlamMeaning);
  navigate->add_option("--lidar", navigating->simulation.lidars,
                       "a lidar by name (see 'rasterslam list lidars') or an .ini file");
  addSensorFlag(navigate, navigating->simulation);
  addCarry(navigate, navigating->carries);
  addOutput(navigate, context, "folder to write (default: none)");
  addSeed(navigate, context);
  addConfig(navigate, context);
  addShowFlags(navigate, navigating->show);
  navigate->footer("Example:\n  rasterslam view navigate office_loop --goal 3,2 --method bug2 --speed 8");

  auto* run_method = view->add_subcommand("run", "watch 'rasterslam run': a method at work on a log");
  auto running = onCall(run_method, context, viewRun);
  run_method->add_option("method", running->method, "a name of 'rasterslam list methods', or an .ini file")
      ->required();
  run_method->add_option("log", running->input, "a log: MRPT rawlog, CARMEN, ...")->required();
  run_method->add_option("--plan", running->plan, "true plan to show (default: the one the log was made in)");
  addOutput(run_method, context, "folder to write (default: none)");
  addSeed(run_method, context);
  addConfig(run_method, context);
  addShowFlags(run_method, running->show);
  run_method->footer(
      "Examples:\n"
      "  rasterslam view run graph run.rawlog --speed 16\n"
      "  rasterslam view run rbpf_exact intel.clf -o out");

  auto* replay =
      view->add_subcommand("replay", "watch a finished run again: the scans at the poses of its final path");
  auto replaying = onCall(replay, context, viewReplay);
  replay->add_option("folder", replaying->input, "what 'rasterslam run' or 'explore' wrote")->required();
  replay->add_option("--log", replaying->log, "the run's log, where it is no longer in its place");
  replay->add_option("--plan", replaying->plan, "true plan to show (default: the one the log was made in)");
  addShowFlags(replay, replaying->show);
  replay->footer("Example:\n  rasterslam view replay out --speed 16");
}

}  // namespace slam::apps
