#include "libslam/reach/reach_goal.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <limits>
#include <sstream>

#include "libslam/core/error.h"
#include "libslam/files/files.h"
#include "libslam/files/word_list.h"
#include "libslam/goals/surroundings.h"
#include "libslam/logs/trajectory_io.h"
#include "libslam/mapping/map_builder.h"
#include "libslam/reach/goal_methods.h"
#include "libslam/reach/goal_picture.h"
#include "libslam/record/recorder.h"
#include "libslam/record/sensor.h"
#include "libslam/run/log_feed.h"
#include "libslam/sim/simulator.h"
#include "libslam/table/latex.h"
#include "libslam/truth/carry_file.h"
#include "libslam/world/shortest_path.h"

namespace slam::reach {
namespace {

using goals::GoalStatus;

std::string describe(const core::Point2& p) {
  char text[64];
  std::snprintf(text, sizeof text, "(%.3f m, %.3f m)", p.x, p.y);
  return text;
}

/// nullptr for a method of the library.
const OwnNavigator* ownOf(const ReachGoalRequest& request, const std::string& method) {
  for (const auto& own : request.own)
    if (own.name == method) return &own;
  return nullptr;
}

void requirePossible(const ReachGoalRequest& request) {
  const auto& plan = request.plan;
  const core::Point2 cell = world::pointToCells(plan, request.p_world_goal);
  const auto fail = [&](const std::string& found) {
    throw core::InputError("plan '" + plan.name + "': goal " + describe(request.p_world_goal) + " is " +
                           found + ", expected a place on the floor");
  };
  const double column = std::floor(cell.x), row = std::floor(cell.y);
  if (!(column >= 0 && row >= 0 && column < plan.columns && row < plan.rows)) fail("outside the plan");
  if (plan.at(static_cast<int>(column), static_cast<int>(row)) == world::Cell::kOccupied) fail("in a wall");
  if (request.methods.empty())
    throw core::InputError("--method: found nothing, expected at least one method");
  for (size_t i = 0; i < request.methods.size(); ++i) {
    if (!ownOf(request, request.methods[i])) requireGoalMethod(request.methods[i]);
    for (size_t j = 0; j < i; ++j)
      if (request.methods[i] == request.methods[j])
        throw core::InputError("--method: '" + request.methods[i] + "' is named twice");
  }
}

/// Where the robot believes to be: the wheels' odometry, or a SLAM method that is fed what is sensed.
class PoseSource {
 public:
  explicit PoseSource(const ReachGoalRequest& request) {
    if (request.slam.empty()) return;
    builder_ = mapping::makeMapBuilder(mapping::loadMethodConfig(request.methods_folder, request.slam),
                                       request.slam, request.seed);
  }
  core::Pose2 update(const sim::Sensed& sensed) {
    if (!builder_) return sensed.T_odom_robot;
    run::tellSensors(*builder_, sensed);
    return mapping::processScan(*builder_, sensed.scan, sensed.T_previous_robot, true, commanded_);
  }
  /// What the robot is told to do next.
  void tell(const robot::Command& command) { commanded_ = commands_.next(command); }
  const mapping::MapBuilder* method() const { return builder_ ? &*builder_ : nullptr; }

 private:
  std::optional<mapping::MapBuilder> builder_;
  robot::CommandSeries commands_;
  robot::Commanded commanded_ = robot::MotionKind::kRest;
};

/// What a recorder is to know of a drive.
record::RecordConfig recordConfigOf(const ReachGoalConfig& config) {
  record::RecordConfig record;
  record.robot = config.robot;
  record.lidar = config.lidar;
  record.camera = config.camera;
  record.odometry = config.odometry;
  record.living = config.living;
  record.carries = config.carries;
  record.parameters = config.parameters;
  return record;
}

/// True when no way leads to the goal for the disc with the clearance that the methods keep.
bool isOutOfReach(const ReachGoalRequest& request) {
  const auto& config = request.config;
  const goals::Surroundings keeps(config.robot, config.navigate.clearance_m, 1 / config.lidar.rate_hz);
  return !world::shortestPath(request.plan, core::position(request.T_world_start), request.p_world_goal,
                              keeps.followRadius() + config.lidar.sigma_m, config.navigate.goal_tolerance_m);
}

std::string resultOf(const GoalRun& run) {
  if (run.right) return goals::statusName(run.status);
  switch (run.status) {
    case GoalStatus::kReached:
      return "missed";
    case GoalStatus::kUnreachable:
      return "wrong: unreachable";
    default:
      return goals::statusName(run.status);
  }
}

table::Table tableOf(const ReachGoalRequest& request, const GoalComparison& comparison, bool out_of_reach) {
  table::Table table;
  table.caption = "Drives from " + describe(core::position(request.T_world_start)) + " to " +
                  describe(request.p_world_goal) + " in " + request.plan.name + ", pose from " +
                  (request.slam.empty() ? "odometry" : request.slam);
  table.columns = {{"method", "method", 0},
                   {"result", "result", 0},
                   {"time_s", "time (s)", 1},
                   {"path_m", "path (m)", 2},
                   {"shortest_m", "shortest (m)", 2},
                   {"ratio", "ratio", 2},
                   {"goal_distance_m", "to the goal (m)", 3},
                   {"state_changes", "state changes", 0},
                   {"collisions", "collisions", 0}};
  const double shortest_m = comparison.shortest_m.value_or(std::numeric_limits<double>::quiet_NaN());
  for (const auto& run : comparison.runs) {
    // The way of a drive that did not arrive is no longer or shorter way to the goal.
    const bool arrived = run.right && run.status == GoalStatus::kReached && shortest_m > 0;
    const double ratio = arrived ? run.path_m / shortest_m : std::numeric_limits<double>::quiet_NaN();
    table.rows.push_back({run.method, resultOf(run), run.time_s, run.path_m, shortest_m, ratio,
                          run.goal_distance_m, static_cast<double>(run.changes.size()),
                          static_cast<double>(run.collisions)});
    table.notes.push_back(run.method + ": " + run.reason + ".");
    for (const auto& carry : run.carries)
      table.notes.push_back(run.method + ": " + truth::carryText(carry, sim::Simulator::kStartTime_s) + ".");
    if (run.carries_left > 0)
      table.notes.push_back(run.method + ": " + std::to_string(run.carries_left) +
                            " of the carries came after the end.");
  }
  table.notes.push_back(comparison.shortest_m
                            ? "Shortest: of the disc around the footprint, in the true plan."
                            : "No way of the disc around the footprint leads to the goal in the true plan.");
  if (comparison.shortest_m && out_of_reach)
    table.notes.push_back("With the clearance that the methods keep, no way leads there.");
  return table;
}

/// Every change of the step, also those that the next one of the same period undid.
void addChanges(const goals::GoalStep& step, double time_s, const core::Pose2& T_world_robot,
                std::vector<StateChange>& changes) {
  std::vector<core::Point2> p_world_projected;
  for (const auto& p_robot : step.p_robot_projected) p_world_projected.push_back(T_world_robot * p_robot);
  const auto add = [&](const std::string& to, const std::string& why) {
    const std::string from = changes.empty() ? "" : changes.back().to;
    if (to != from)
      changes.push_back({time_s, from, to, why, core::position(T_world_robot), p_world_projected});
  };
  if (changes.empty() && !step.changes.empty()) add(step.changes.front().from, "start");
  for (const auto& change : step.changes) add(change.to, change.why);
  add(step.state, step.reason);
}

std::string statesCsv(const GoalRun& run) {
  constexpr const char* kDirections[] = {"ahead", "left_ahead", "left", "right", "right_ahead"};
  size_t projected = 0;
  for (const auto& change : run.changes) projected = std::max(projected, change.p_world_projected.size());
  table::Table table;
  table.columns = {{"time_s", ""}, {"from", ""}, {"to", ""}, {"why", ""}, {"x_m", ""}, {"y_m", ""}};
  for (size_t d = 0; d < projected; ++d) {
    table.columns.push_back({std::string(kDirections[d]) + "_x_m", ""});
    table.columns.push_back({std::string(kDirections[d]) + "_y_m", ""});
  }
  for (const auto& change : run.changes) {
    table.rows.push_back(
        {change.time_s, change.from, change.to, change.why, change.p_world.x, change.p_world.y});
    const core::Point2 nowhere{std::numeric_limits<double>::quiet_NaN(),
                               std::numeric_limits<double>::quiet_NaN()};
    for (size_t d = 0; d < projected; ++d) {
      const auto& p = d < change.p_world_projected.size() ? change.p_world_projected[d] : nowhere;
      table.rows.back().emplace_back(p.x);
      table.rows.back().emplace_back(p.y);
    }
  }
  return table::toCsv(table);
}

void writeRun(const ReachGoalRequest& request, const GoalRun& run, const std::string& folder) {
  std::filesystem::create_directories(folder);
  logs::writeTum(run.truth, folder + "/truth.tum");
  logs::writeTum(run.estimate, folder + "/trajectory.tum");
  files::writeFileAtomically(folder + "/states.csv", statesCsv(run));
  drawGoalRun(request, run, run.method + ": " + resultOf(run), folder + "/path.png");
}

}  // namespace

core::Point2 parsePlace(const std::string& text, const std::string& flag) {
  const auto numbers = files::parseNumberList(text);
  if (numbers.size() != 2)
    throw core::InputError(flag + ": found '" + text + "', expected two numbers: x_m,y_m");
  return {numbers[0], numbers[1]};
}

core::Pose2 parsePose(const std::string& text, const std::string& flag) {
  const auto numbers = files::parseNumberList(text);
  if (numbers.size() != 3)
    throw core::InputError(flag + ": found '" + text + "', expected three numbers: x_m,y_m,yaw_deg");
  return {numbers[0], numbers[1], core::wrapToPi(core::degToRad(numbers[2]))};
}

core::Pose2 goalStart(const world::Plan& plan, const ReachGoalConfig& config, const std::string& text) {
  if (text != "auto") return parsePose(text, "--start");
  const double radius_m = robot::circumscribedRadius(config.robot);
  for (const double clearance_m : {radius_m + 0.3, radius_m})
    if (const auto pose = world::findStartPose(plan, clearance_m)) return *pose;
  throw core::InputError(plan.name + ": no free place for a robot of side " +
                         files::formatNumber(config.robot.side_m) + " m");
}

ReachGoalConfig readReachGoalConfig(const files::IniFile& given) {
  std::vector<std::string> known = {"robot",    "odometry",  "living",    "events",
                                    "navigate", "lidar_bug", "obstacles", "mrpt_reactive"};
  const auto sensors = record::sensorSections(given);
  known.insert(known.end(), sensors.begin(), sensors.end());
  files::rejectUnknownSections(given, known);
  ReachGoalConfig config;
  auto* report = &config.parameters;
  files::readParameters(given, robot::RobotOptions::table(), config.robot, report);
  const auto sensor = record::readSensor(given, config.robot, report);
  config.lidar = sensor.lidar, config.camera = sensor.camera;
  if (!sensor.other_lidars.empty())
    throw core::InputError("section [lidar " + sensor.other_lidars.front().label +
                           "]: a robot that drives to a goal carries one lidar, expected [lidar] alone");
  const auto ini = record::withCameraDefaults(given, sensor.camera, config.robot);
  files::readParameters(ini, robot::OdometryOptions::table(), config.odometry, report);
  files::readParameters(ini, movers::LivingOptions::table(), config.living, report);
  config.carries = sim::readCarries(ini, report);
  files::readParameters(ini, goals::NavigateOptions::table(), config.navigate, report);
  files::readParameters(ini, goals::LidarBugOptions::table(), config.navigate.lidar_bug, report);
  files::readParameters(ini, obstacles::LocalObstacleOptions::table(), config.navigate.obstacles, report);
  files::readParameters(ini, mrptnav::ReactiveOptions::table(), config.mrpt_reactive, report);
  sim::requireBefore(config.carries, config.navigate.time_limit_s);
  return config;
}

GoalRun driveToGoal(const ReachGoalRequest& request, const std::string& method, core::Progress& progress,
                    const std::string& folder, const resources::Manifest& manifest) {
  const auto& config = request.config;
  const double period_s = 1 / config.lidar.rate_hz;
  sim::Simulator simulator(request.plan, config.robot, config.lidar, config.odometry, request.T_world_start,
                           request.seed, sim::Simulator::kStartTime_s, config.living, config.camera);
  simulator.carryAt(config.carries);
  std::optional<record::Recorder> recorder;
  if (!folder.empty()) recorder.emplace(folder + "/run.rawlog", recordConfigOf(config));
  const core::Point2 p_start_goal = core::inverse(request.T_world_start) * request.p_world_goal;
  const goals::GoalTask task{p_start_goal, config.robot, period_s};
  const OwnNavigator* own = ownOf(request, method);
  const auto navigator = own ? own->make(config.navigate, task)
                             : makeGoalMethod(method, config.navigate, config.mrpt_reactive, task);
  PoseSource pose_source(request);
  GoalRun run;
  run.method = method;
  progress.begin(method + " in " + request.plan.name);
  const double start_s = simulator.time_s();
  sim::Sensed sensed = simulator.sense();
  if (recorder) recorder->begin(simulator, sensed);
  sim::DrivenPath path;
  while (true) {
    // Stamps count from 1970 and hold no more than a fraction of a microsecond.
    const double elapsed_s = std::round(1e3 * (simulator.time_s() - start_s)) / 1e3;
    run.truth.push_back({simulator.time_s(), simulator.truth()});
    path.add(simulator.truth(), simulator.carries());
    progress.update(elapsed_s / config.navigate.time_limit_s, elapsed_s);
    goals::GoalStep step;
    try {
      const core::Pose2 T_start_robot = pose_source.update(sensed);
      run.estimate.push_back({simulator.time_s(), request.T_world_start * T_start_robot});
      step = navigator->next(sensed.scan, T_start_robot, sensed.collided);
    } catch (const core::MethodError& error) {
      step = {{}, GoalStatus::kGaveUp, "gave up", std::string("the SLAM method failed: ") + error.what()};
      if (run.estimate.empty()) run.estimate.push_back(run.truth.front());
    }
    addChanges(step, elapsed_s, simulator.truth(), run.changes);
    run.status = step.status;
    run.reason = step.reason;
    if (request.observer)
      request.observer->onStep({elapsed_s, sensed.scan, sensed.T_previous_robot,
                                core::between(request.T_world_start, run.estimate.back().pose),
                                pose_source.method(), &simulator, nullptr,
                                step.state + (step.reason.empty() ? "" : ": " + step.reason)});
    if (step.status != GoalStatus::kMoving) break;
    pose_source.tell(step.command);
    sensed = simulator.step(step.command);
    if (recorder) recorder->add(step.command, simulator, sensed);
  }
  progress.end();
  run.time_s = std::round(1e3 * (simulator.time_s() - start_s)) / 1e3;
  run.path_m = path.length_m();
  run.goal_distance_m = core::distance(core::position(simulator.truth()), request.p_world_goal);
  run.collisions = simulator.collisions().size();
  run.carries = simulator.carries();
  run.carries_left = simulator.waitingCarries();
  if (recorder) recorder->finish(simulator, request.seed, manifest);
  return run;
}

GoalComparison reachGoal(const ReachGoalRequest& request, resources::Manifest manifest,
                         core::Progress& progress) {
  requirePossible(request);
  files::PendingFolder output(request.output, request.overwrite);
  GoalComparison comparison;
  const double radius_m = robot::circumscribedRadius(request.config.robot);
  if (const auto path =
          world::shortestPath(request.plan, core::position(request.T_world_start), request.p_world_goal,
                              radius_m, request.config.navigate.goal_tolerance_m))
    comparison.shortest_m = path->length_m;
  const bool out_of_reach = isOutOfReach(request);

  for (const auto& method : request.methods) {
    const auto wall_start = std::chrono::steady_clock::now();
    const std::string folder = output.path() + "/" + method;
    std::filesystem::create_directory(folder);
    GoalRun run = driveToGoal(request, method, progress, folder, manifest);
    manifest.times_s[method] =
        std::chrono::duration<double>(std::chrono::steady_clock::now() - wall_start).count();
    run.right = (run.status == GoalStatus::kReached && run.goal_distance_m <= kArrived_m) ||
                (run.status == GoalStatus::kUnreachable && (!comparison.shortest_m || out_of_reach));
    comparison.wrong += !run.right;
    writeRun(request, run, folder);
    comparison.runs.push_back(std::move(run));
  }
  drawGoalRuns(request, comparison.runs, output.path() + "/paths.png");
  comparison.table = tableOf(request, comparison, out_of_reach);
  const std::string scores = output.path() + "/scores";
  files::writeFileAtomically(scores + ".txt", table::toText(comparison.table));
  files::writeFileAtomically(scores + ".md", table::toMarkdown(comparison.table));
  files::writeFileAtomically(
      scores + ".tex", table::toLatex(comparison.table, {"tab:scores", {{"ratio", table::Best::kSmallest}}}));
  files::writeFileAtomically(scores + ".csv", table::toCsv(comparison.table));
  files::writeFileAtomically(scores + ".json", table::toJson(comparison.table));

  manifest.seed = request.seed;
  for (const auto& line : request.config.parameters)
    manifest.config[line.section + "." + line.info.key] = line.value;
  manifest.files["METHOD/run.rawlog"] = "what the robot sensed, with its truth beside it: rasterslam compare";
  manifest.files["METHOD/truth.tum"] = "true path, TUM form, world frame";
  manifest.files["METHOD/trajectory.tum"] = "the path by the pose that the method was given, world frame";
  manifest.files["METHOD/states.csv"] =
      "every change of state: time, from, to, why, true place; of lidar_bug the places "
      "projected in its five directions";
  manifest.files["METHOD/path.png"] = "the true path, coloured by state";
  manifest.files["paths.png"] = "the true paths of all methods";
  manifest.files["scores.txt"] = "the table; also .md, .tex, .csv, .json";
  for (const auto& run : comparison.runs) manifest.results[run.method] = resultOf(run);
  manifest.results["goal_x_m"] = files::formatNumber(request.p_world_goal.x);
  manifest.results["goal_y_m"] = files::formatNumber(request.p_world_goal.y);
  resources::writeManifest(manifest, output.path() + "/manifest.json");
  output.commit();
  return comparison;
}

}  // namespace slam::reach
