#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>

#include "apps/commands.h"
#include "apps/console.h"
#include "apps/operation_files.h"
#include "apps/quiet.h"
#include "apps/stream_output.h"
#include "libslam/core/error.h"
#include "libslam/edit/convert.h"
#include "libslam/files/files.h"
#include "libslam/logs/log_format.h"

namespace slam::apps {
namespace {

struct ConvertArguments {
  std::string in, out, to, form, label, path = "odometry";
};

/// What a file is to become: a log, a trajectory or an operation log.
struct Target {
  std::string name;    ///< of --to
  std::string suffix;  ///< that means it
  std::optional<logs::LogFormat> log;
  logs::TrajectoryWriter::Format trajectory{};
  bool is_operations = false;
};

const std::vector<Target>& targets() {
  using Format = logs::TrajectoryWriter::Format;
  static const std::vector<Target> all = [] {
    std::vector<Target> targets;
    for (const auto& info : logs::logFormats())
      for (const auto& suffix : info.suffixes) targets.push_back({info.word, suffix, info.format});
    for (const Target& other : std::vector<Target>{{"tum", ".tum", {}, Format::kTum},
                                                   {"csv", ".csv", {}, Format::kCsv},
                                                   {"gt", ".GT.txt", {}, Format::kMrptGroundTruth},
                                                   {"operations", ".operations.txt", {}, {}, true},
                                                   {"original", ".original.txt", {}, {}, true}})
      targets.push_back(other);
    return targets;
  }();
  return all;
}

const Target& targetOf(const ConvertArguments& arguments) {
  const auto ends = [&arguments](const std::string& suffix) {
    const auto& out = arguments.out;
    return out.size() > suffix.size() && out.compare(out.size() - suffix.size(), suffix.size(), suffix) == 0;
  };
  std::string names, suffixes;
  for (const Target& target : targets()) {
    if (arguments.to.empty() ? ends(target.suffix) : arguments.to == target.name) return target;
    if (names.find(target.name) == std::string::npos) names += (names.empty() ? "" : ", ") + target.name;
    suffixes += " " + target.suffix;
  }
  if (!arguments.to.empty())
    throw core::InputError("--to: found '" + arguments.to + "', expected one of " + names);
  throw core::InputError(arguments.out + ": its name says no format, expected one of" + suffixes +
                         ", or --to with one of " + names);
}

std::optional<rawlogs::RawlogForm> formOf(const ConvertArguments& arguments, const Target& target) {
  if (arguments.form.empty()) return std::nullopt;
  if (target.log != logs::LogFormat::kRawlog)
    throw core::InputError("--form: is of rawlogs, expected none with --to " + target.name);
  if (arguments.form == "action") return rawlogs::RawlogForm::kActionFrame;
  if (arguments.form == "observation") return rawlogs::RawlogForm::kObservationOnly;
  throw core::InputError("--form: found '" + arguments.form + "', expected action or observation");
}

void print(const nlohmann::ordered_json& summary) {
  std::cout << summary.dump(2, ' ', false, nlohmann::json::error_handler_t::replace) << "\n";
}

int printReport(const Context& context, const ConvertArguments& arguments,
                const edit::ConversionReport& report) {
  if (context.json) {
    print({{"from", logs::formatName(report.from)},
           {"files", report.files},
           {"scans", report.scans_by_label},
           {"odometry_readings", report.odometry_readings},
           {"comments", report.comments},
           {"other_observations", report.other_observations},
           {"scans_left_out", report.scans_left_out},
           {"true_poses", report.true_poses},
           {"skipped", report.skipped},
           {"dropped", report.dropped}});
    return 0;
  }
  std::printf("read      %s (%s)\n", arguments.in.c_str(), logs::formatName(report.from));
  for (const auto& [label, scans] : report.scans_by_label)
    std::printf("scans     %lu from \"%s\"\n", static_cast<unsigned long>(scans), label.c_str());
  std::printf("odometry  %lu readings\n", static_cast<unsigned long>(report.odometry_readings));
  std::printf("others    %lu observations, %lu comments\n",
              static_cast<unsigned long>(report.other_observations),
              static_cast<unsigned long>(report.comments));
  if (report.true_poses > 0)
    std::printf("truth     %lu poses, beside the log\n", static_cast<unsigned long>(report.true_poses));
  if (report.scans_left_out > 0)
    std::printf("left out  %lu scans of other lidars\n", static_cast<unsigned long>(report.scans_left_out));
  if (!report.skipped.empty()) std::printf("skipped   %s\n", report.skipped.c_str());
  if (!report.dropped.empty()) std::printf("dropped   %s\n", report.dropped.c_str());
  for (const auto& file : report.files)
    std::printf("wrote     %s (%.2f MB)\n", file.c_str(),
                static_cast<double>(std::filesystem::file_size(file)) / 1e6);
  return 0;
}

int printPoses(const Context& context, const ConvertArguments& arguments, size_t poses) {
  if (context.json)
    print({{"files", {arguments.out}}, {"poses", poses}});
  else
    std::printf("wrote     %s, %zu poses\n", arguments.out.c_str(), poses);
  return 0;
}

/// Text whose first line beside remarks starts with a number, or with our own line of names.
bool isTrajectory(const std::string& path) {
  files::requireReadableFile(path);
  std::ifstream in(path, std::ios::binary);
  std::string line;
  constexpr int kMostRemarks = 1000;
  for (int i = 0; i < kMostRemarks && std::getline(in, line); ++i) {
    const size_t first = line.find_first_not_of(" \t\r");
    if (first == std::string::npos || line[first] == '#' || line[first] == '%') continue;
    return line.find_first_of("+-.0123456789", first) == first || line.compare(first, 7, "time_s,") == 0;
  }
  return false;
}

int convertOperations(const Context& context, const ConvertArguments& arguments, const std::string& to,
                      const sim::OriginalUnits& units) {
  files::refuseToOverwrite(arguments.out, context.overwrite);
  const auto [operations, is_original] = readOperationFile(arguments.in, units);
  files::writeFileAtomically(arguments.out, to == "original" ? sim::formatOriginalLog(operations, units)
                                                             : sim::formatOperations(operations));
  const auto arcs = std::count_if(operations.begin(), operations.end(),
                                  [](const sim::Operation& operation) { return operation.kind == 'a'; });
  if (arcs > 0 && to == "original")
    note(context, arguments.in + ": " + std::to_string(arcs) +
                      " arcs written as turns and moves, the original robot has none");
  if (context.json)
    print({{"from", is_original ? "original" : "operations"},
           {"files", {arguments.out}},
           {"operations", operations.size()}});
  else
    std::printf("wrote     %s, %zu operations\n", arguments.out.c_str(), operations.size());
  return 0;
}

int convert(const Context& context, const ConvertArguments& arguments, const sim::OriginalUnits& units) {
  const Target& target = targetOf(arguments);
  const auto form = formOf(arguments, target);
  if (arguments.path != "odometry" && arguments.path != "truth")
    throw core::InputError("--path: found '" + arguments.path + "', expected odometry or truth");
  const bool from_operations = isOperationFile(arguments.in);
  if (from_operations && target.is_operations)
    return convertOperations(context, arguments, target.name, units);
  if (from_operations || target.is_operations)
    throw core::InputError(arguments.in +
                           ": an operation log becomes another operation log (operations, original) "
                           "and nothing else does: found " +
                           (from_operations ? "one" : "none") + ", to become " + target.name);
  ConsoleProgress progress(context.quiet);
  if (target.log) {
    const auto report = edit::convertLog(arguments.in, arguments.out,
                                         {*target.log, form, arguments.label, context.overwrite}, progress);
    return printReport(context, arguments, report);
  }
  if (isTrajectory(arguments.in)) {
    files::refuseToOverwrite(arguments.out, context.overwrite);
    const auto trajectory = logs::readTrajectory(arguments.in);
    logs::writeTrajectory(trajectory, arguments.out, target.trajectory);
    return printPoses(context, arguments, trajectory.size());
  }
  const auto path = arguments.path == "truth" ? edit::LogPath::kTruth : edit::LogPath::kOdometry;
  return printPoses(context, arguments,
                    edit::exportTrajectory(arguments.in, path, arguments.label, arguments.out,
                                           target.trajectory, context.overwrite, progress));
}

}  // namespace

void addConvert(CLI::App& app, Context& context) {
  auto* command =
      app.add_subcommand("convert", "write a log, a trajectory or an operation log again in another format");
  auto arguments = std::make_shared<ConvertArguments>();
  command
      ->add_option("in", arguments->in,
                   "a log (told by its content, also within .gz .bz2 .xz), a trajectory (TUM, CSV, MRPT's "
                   ".GT.txt), or "
                   "an operation log of either form")
      ->required();
  command->add_option("out", arguments->out, "the file to write; its suffix says the format")
      ->required()
      ->check([command](const std::string& word) { return streamProblem(*command, word); });
  command->add_option(
      "--to", arguments->to,
      "the format, whatever the suffix: rawlog, carmen, bag, db3, mcap; a trajectory: tum, csv, "
      "gt (MRPT's .GT.txt, from the first pose); an operation log: operations (ours), original (m or t, then "
      "whole pixels or degrees, each on a line)");
  command->add_option(
      "--form", arguments->form,
      "of a rawlog: action (actions and frames, for rbpf-slam too) or observation (default: as the "
      "log is)");
  command->add_option("--label", arguments->label, "only the scans of this lidar (see 'rasterslam info')");
  command->add_option("--path", arguments->path, "of a log to a trajectory: its odometry or its truth")
      ->capture_default_str();
  const auto units = addOriginalUnits(command);
  command->add_flag("--overwrite", context.overwrite, "replace what is there");
  addQuiet(command, context);
  addJson(command, context);
  command->footer(
      "True poses of a log go beside it: STEM.truth.tum and OUT.GT.txt.\n"
      "Examples:\n"
      "  rasterslam convert intel.clf.bz2 intel.rawlog\n"
      "  rasterslam convert intel.clf.bz2 intel.rawlog --form action\n"
      "  rasterslam convert intel.rawlog intel.clf\n"
      "  rasterslam convert intel.clf.bz2 odometry.tum\n"
      "  rasterslam convert path.tum path.csv\n"
      "  rasterslam convert run.operations.txt run.original.txt --pixel 0.05");
  command->callback([&context, arguments, units] {
    context.action = [&context, arguments, units] { return convert(context, *arguments, *units); };
  });
}

}  // namespace slam::apps
