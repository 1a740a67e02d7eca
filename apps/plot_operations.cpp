#include <cmath>
#include <cstdio>
#include <filesystem>
#include <iostream>
#include <set>

#include "apps/operation_files.h"
#include "apps/plot.h"
#include "libslam/core/error.h"
#include "libslam/logs/log_reader.h"
#include "libslam/logs/trajectory_io.h"
#include "libslam/pictures/picture.h"
#include "libslam/resources/resources.h"
#include "libslam/score/compare.h"
#include "libslam/truth/truth_files.h"
#include "libslam/world/plan.h"

namespace slam::apps {
namespace {

struct OperationsArguments {
  std::string file, truth, plan, log;
};

constexpr double kDot_m = 0.05;  // of the naive map: a pixel of its picture

/// "a/run.operations.txt" -> "a/run.rawlog": the log that it was written beside; "" for another name.
std::string logBeside(const std::string& operations_path) {
  const std::string suffix = ".operations.txt";
  const bool ends_so =
      operations_path.size() > suffix.size() &&
      operations_path.compare(operations_path.size() - suffix.size(), suffix.size(), suffix) == 0;
  return ends_so ? operations_path.substr(0, operations_path.size() - suffix.size()) + ".rawlog" : "";
}

/// The naive map: every return of the scan after every move, at the replayed pose; `T_map_robot` has one pose
/// more than there are operations. Of several in one cell of the map one is kept.
std::vector<core::Point2> naiveDots(const std::string& log_path,
                                    const std::vector<sim::Operation>& operations,
                                    const core::Trajectory& T_map_robot) {
  std::vector<core::Point2> dots;
  std::set<std::pair<long, long>> cells;
  logs::LogReader log(log_path);
  std::uint64_t number = 0;
  size_t next = 0;
  const auto scanAfter = [&](size_t i) {
    return operations[i].scan_after > 0 ? operations[i].scan_after : i + 1;
  };
  for (; next < operations.size(); ++number) {
    const auto entry = log.next();
    if (!entry) break;
    if (number < scanAfter(next)) continue;
    const core::Pose2 pose = T_map_robot[++next].pose;
    if (operations[next - 1].kind == 't') continue;
    for (const auto& p_robot : lidar::scanPoints(entry->scan)) {
      const core::Point2 dot = pose * p_robot;
      const std::pair<long, long> cell{std::lround(dot.x / kDot_m), std::lround(dot.y / kDot_m)};
      if (cells.insert(cell).second) dots.push_back(dot);
    }
  }
  if (next < operations.size())
    throw core::InputError(log_path + ": holds " + std::to_string(number) +
                           " scans, expected more: the operation log names scan " +
                           std::to_string(scanAfter(operations.size() - 1)));
  return dots;
}

/// Where the truth, the plan and the scans are, as given or as they stand beside the file.
OperationsArguments completed(OperationsArguments arguments) {
  const std::string log = logBeside(arguments.file);
  const bool truth_given = !arguments.truth.empty();
  if (!truth_given && !log.empty()) arguments.truth = truth::findTruth(log);
  // MRPT's own form of the truth begins at the origin, as the replay does: nothing to lay it on.
  if (!truth_given && std::filesystem::path(arguments.truth).extension() != ".tum") arguments.truth.clear();
  if (arguments.plan.empty() && !log.empty() && !arguments.truth.empty())
    arguments.plan = truth::findPlan(log);
  if (!arguments.plan.empty() && arguments.truth.empty())
    throw core::InputError("--plan needs --truth: the operation log does not say where the robot began");
  if (arguments.log.empty() && std::filesystem::exists(log)) arguments.log = log;
  return arguments;
}

int plotOperations(const Context& context, const OperationsArguments& given, const sim::OriginalUnits& units,
                   const PaperArguments& how) {
  const auto [path, paper] = picturePlace(context, how, "operations.png");
  const auto operations = readOperationFile(given.file, units).operations;
  auto replayed = sim::replayOperations(operations);
  const double length_m = core::pathLength(replayed);
  const core::Pose2 end = replayed.back().pose;
  const auto arguments = completed(given);

  world::Plan plan;
  std::vector<pictures::DrawnPath> paths;
  if (!arguments.truth.empty()) {
    const auto truth = logs::readTum(arguments.truth);
    for (auto& stamped : replayed) stamped.pose = truth.front().pose * stamped.pose;
    paths.push_back({truth, "truth", true});
  }
  if (!arguments.plan.empty()) plan = world::loadPlan(resources::resolvePlan(arguments.plan));
  paths.push_back({replayed, "operations replayed", false});
  pictures::DrawnMarks dots{{}, "returns after moves: the naive map", true};
  if (!arguments.log.empty()) dots.places = naiveDots(arguments.log, operations, replayed);
  pictures::drawMap(plan, paths, "Dead reckoning of " + arguments.file, path, dots, paper);
  char line[160];
  std::snprintf(line, sizeof line, "%zu operations, path %.2f m, end at x %.2f m, y %.2f m, yaw %.1f deg\n  ",
                operations.size(), length_m, end.x, end.y, core::radToDeg(end.phi));
  sayPicture(context,
             {{"file", path},
              {"operations", operations.size()},
              {"path_length_m", length_m},
              {"end_pose", {end.x, end.y, end.phi}},
              {"dots", dots.places.size()},
              {"truth", arguments.truth},
              {"plan", arguments.plan}},
             line + path);
  return 0;
}

}  // namespace

void addPlotOperations(CLI::App& plot, Context& context) {
  auto* command =
      plot.add_subcommand("operations", "replay an operation log: the original dead reckoning, and its map");
  auto arguments = std::make_shared<OperationsArguments>();
  command
      ->add_option("file", arguments->file,
                   "what 'rasterslam simulate' wrote, run.operations.txt, or one in the original form")
      ->required();
  command->add_option("--log", arguments->log,
                      "the scans, drawn as dots after every move (default: the log beside the file)");
  command->add_option("--truth", arguments->truth, "true path, TUM (default: the one beside the file)");
  command->add_option("--plan", arguments->plan,
                      "true plan (default: the one that the log was simulated in)");
  const auto units = addOriginalUnits(command);
  const auto how = addPicture(command, context, "operations.png");
  command->footer("Example:\n  rasterslam plot operations run.operations.txt -o operations.png");
  command->callback([&context, arguments, units, how] {
    context.action = [&context, arguments, units, how] {
      return plotOperations(context, *arguments, *units, *how);
    };
  });
}

}  // namespace slam::apps
