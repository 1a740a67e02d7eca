#include <algorithm>
#include <cstdio>
#include <iostream>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>

#include "apps/commands.h"
#include "apps/console.h"
#include "apps/edited_log.h"
#include "libslam/core/error.h"
#include "libslam/edit/log_edit.h"
#include "libslam/files/files.h"
#include "libslam/record/record.h"
#include "libslam/run/scan_odometry_log.h"
#include "libslam/run/told_commands.h"
#include "libslam/score/compare.h"
#include "libslam/truth/cut_truth.h"
#include "libslam/truth/truth_files.h"

namespace slam::apps {
namespace {

double number(const std::string& text, const char* flag, const char* expected) {
  double value = 0;
  if (!files::parseNumber(text, value))
    throw core::InputError(std::string(flag) + ": found '" + text + "', expected " + expected);
  return value;
}

std::optional<edit::LogMoment> moment(const std::string& text, const char* flag) {
  if (text.empty()) return std::nullopt;
  const bool is_absolute = text[0] == '@';
  const double seconds = number(is_absolute ? text.substr(1) : text, flag,
                                "seconds after the log's first stamp, or @ and seconds since 1970");
  return edit::LogMoment{seconds, is_absolute};
}

struct CutArguments {
  std::string log, from, to;
  bool salvage = false;
};

int cut(const Context& context, const CutArguments& arguments) {
  files::refuseToOverwrite(context.output, context.overwrite);
  edit::CutOptions options;
  options.from = moment(arguments.from, "--from");
  options.to = moment(arguments.to, "--to");
  options.salvage = arguments.salvage;
  if (!options.from && !options.to && !options.salvage)
    throw core::InputError("cut: found neither --from nor --to nor --salvage, expected one of them");
  if (!truth::findTruth(arguments.log).empty())
    for (const std::string end : {".gt.tum", ".manifest.json"})
      files::refuseToOverwrite(truth::besideLog(context.output, end), context.overwrite);
  ConsoleProgress progress(context.quiet);
  const auto counts = edit::cutLog(arguments.log, context.output, options, progress);
  return reportEditedLog(context, counts, truth::keepTruth(arguments.log, context.output));
}

struct FilterArguments {
  std::string log, mount, odometry, form;
  std::vector<std::string> keep_labels, drop_labels, shifts;
  bool drop_truth = false;
  int every = 1;
  double no_return_m = 0, step_deg = 0;
};

core::Pose2 mountOf(const std::string& text) {
  const char* expected = "X,Y,DEG (metres ahead, metres left, degrees counter-clockwise)";
  const size_t first = text.find(','),
               second = text.find(',', first == std::string::npos ? first : first + 1);
  if (second == std::string::npos)
    throw core::InputError("--mount: found '" + text + "', expected " + expected);
  return {number(text.substr(0, first), "--mount", expected),
          number(text.substr(first + 1, second - first - 1), "--mount", expected),
          core::degToRad(number(text.substr(second + 1), "--mount", expected))};
}

edit::FilterOptions filterOptions(const FilterArguments& arguments) {
  edit::FilterOptions options;
  options.keep_labels = arguments.keep_labels;
  options.drop_labels = arguments.drop_labels;
  options.drop_truth = arguments.drop_truth;
  options.every = static_cast<std::uint64_t>(arguments.every);
  if (arguments.no_return_m > 0) options.no_return_m = arguments.no_return_m;
  if (arguments.step_deg > 0) options.step_rad = core::degToRad(arguments.step_deg);
  if (!arguments.mount.empty()) options.mount = mountOf(arguments.mount);
  for (const auto& shift : arguments.shifts) {
    const size_t at = shift.rfind('=');
    if (at == std::string::npos)
      throw core::InputError("--shift: found '" + shift + "', expected LABEL=SECONDS");
    options.shift_s[shift.substr(0, at)] = number(shift.substr(at + 1), "--shift", "LABEL=SECONDS");
  }
  return options;
}

/// Whether anything but the odometry is to be done.
bool editsObservations(const edit::FilterOptions& options) {
  return !options.keep_labels.empty() || !options.drop_labels.empty() || options.drop_truth ||
         options.every > 1 || options.no_return_m || options.step_rad || options.mount ||
         !options.shift_s.empty();
}

run::ScanOdometryLogOptions odometryOptions(const FilterArguments& arguments) {
  run::ScanOdometryLogOptions options;
  const auto names = odometry::scanOdometryNames();
  if (std::find(names.begin(), names.end(), arguments.odometry) == names.end()) {
    std::string known;
    for (const auto& name : names) known += (known.empty() ? "" : ", ") + name;
    throw core::InputError("--odometry: found '" + arguments.odometry + "', expected one of " + known +
                           core::didYouMean(arguments.odometry, names));
  }
  options.odometry.method = arguments.odometry;
  if (arguments.form == "action")
    options.form = rawlogs::RawlogForm::kActionFrame;
  else if (arguments.form == "observation")
    options.form = rawlogs::RawlogForm::kObservationOnly;
  else if (!arguments.form.empty())
    throw core::InputError("--form: found '" + arguments.form + "', expected action or observation");
  return options;
}

/// What the robot was commanded to do before each scan in turn: by the operation log beside the log, as long
/// as all scans are those of the log; else by its wheels.
run::CommandBefore commandsBefore(const std::string& log_path, bool all_scans) {
  const auto told = all_scans ? run::commandsOfLog(log_path) : std::nullopt;
  if (!told)
    return [series = robot::CommandSeries()](const lidar::Scan&,
                                             const std::optional<core::Pose2>& wheels) mutable {
      return wheels ? series.next(*wheels) : odometry::Commanded();
    };
  return [told, scan = std::size_t{0}](const lidar::Scan&, const std::optional<core::Pose2>&) mutable {
    return scan < told->size() ? (*told)[scan++] : odometry::Commanded();
  };
}

int reportOdometry(const Context& context, const std::string& method,
                   const run::ScanOdometryLogReport& report) {
  if (context.json) {
    std::cout << nlohmann::ordered_json{{"output", context.output},        {"odometry", method},
                                        {"label", report.label},           {"motions", report.motions},
                                        {"unreliable", report.unreliable}, {"replaced", report.replaced},
                                        {"written", report.written},       {"skipped", report.skipped}}
                     .dump(2, ' ', false, nlohmann::ordered_json::error_handler_t::replace)
              << "\n";
    return 0;
  }
  const auto n = [](std::uint64_t count) { return static_cast<unsigned long>(count); };
  std::printf("%s odometry of %lu scans of '%s', %lu of them unreliable\n", method.c_str(), n(report.motions),
              report.label.c_str(), n(report.unreliable));
  std::printf("%lu movements of the log's own odometry left out, %lu objects written\n", n(report.replaced),
              n(report.written));
  if (!report.skipped.empty()) printWrapped("not read: ", report.skipped);
  std::printf("  %s\n", context.output.c_str());
  return 0;
}

int filter(const Context& context, const FilterArguments& arguments) {
  files::refuseToOverwrite(context.output, context.overwrite);
  const auto options = filterOptions(arguments);
  ConsoleProgress progress(context.quiet);
  if (arguments.odometry.empty()) {
    if (!arguments.form.empty())
      throw core::InputError("--form: goes with --odometry; 'rasterslam convert' changes the form alone");
    return reportEditedLog(context, edit::filterLog(arguments.log, context.output, options, progress));
  }
  auto odometry = odometryOptions(arguments);
  if (arguments.odometry == "argmax")
    odometry.commanded = commandsBefore(arguments.log, !editsObservations(options));
  std::string log = arguments.log;
  const files::PendingFile filtered(context.output + ".filtered");  // never committed
  if (editsObservations(options)) {
    edit::filterLog(log, filtered.path(), options, progress);
    log = filtered.path();
  }
  return reportOdometry(context, arguments.odometry,
                        run::writeScanOdometry(log, context.output, odometry, progress));
}

void addCut(CLI::App& app, Context& context) {
  auto* command = app.add_subcommand(
      "cut", "a part of a log by time, with its truth and plan; the rest stays byte for byte");
  auto arguments = std::make_shared<CutArguments>();
  command->add_option("log", arguments->log, "a log of any format that is read here")->required();
  command->add_option("--from", arguments->from,
                      "first moment kept: seconds after the log's first stamp, or @SECONDS since 1970");
  command->add_option("--to", arguments->to, "first moment dropped again, likewise");
  command->add_flag("--salvage", arguments->salvage, "of a log that breaks off, keep what comes before");
  addEditedLog(command, context);
  command->footer(
      "Objects without a stamp go with the one before. An action stays with its frame.\n"
      "Examples:\n"
      "  rasterslam cut run.rawlog --from 60 --to 120 -o minute.rawlog\n"
      "  rasterslam cut intel.clf.bz2 --from @976053000 -o end.rawlog\n"
      "  rasterslam cut broken.rawlog --salvage -o whole.rawlog");
  command->callback(
      [&context, arguments] { context.action = [&context, arguments] { return cut(context, *arguments); }; });
}

void addFilter(CLI::App& app, Context& context) {
  auto* command = app.add_subcommand("filter",
                                     "a log without some of its observations, with wrong statements mended, "
                                     "or with odometry from its scans");
  auto arguments = std::make_shared<FilterArguments>();
  command->add_option("log", arguments->log, "a log of any format that is read here")->required();
  command->add_option("--keep-label", arguments->keep_labels, "keep these sensors alone")->delimiter(',');
  command->add_option("--drop-label", arguments->drop_labels, "drop these sensors")->delimiter(',');
  command->add_flag("--drop-truth", arguments->drop_truth, "drop the true poses");
  command->add_option("--every", arguments->every, "keep every so many-th scan of each lidar")
      ->check(CLI::PositiveNumber);
  command
      ->add_option("--no-return", arguments->no_return_m,
                   "readings from here on, metres, met nothing; sets the maximum range")
      ->check(CLI::PositiveNumber);
  command
      ->add_option("--step", arguments->step_deg,
                   "angle between two readings, degrees, about the same middle")
      ->check(CLI::PositiveNumber);
  command->add_option("--mount", arguments->mount, "X,Y,DEG: the lidar's pose on the robot");
  command
      ->add_option("--shift", arguments->shifts, "LABEL=SECONDS: added to the stamps of a sensor; repeatable")
      ->take_all()
      ->expected(1);
  command->add_option("--odometry", arguments->odometry,
                      "argmax, argmax_blind, correlation, range_flow or plicp: odometry from the scans in "
                      "place of the log's own");
  command->add_option(
      "--form", arguments->form,
      "with --odometry: action or observation (default: as the log is); rbpf-slam needs action");
  addEditedLog(command, context);
  command->footer(
      "--no-return, --step and --mount are about all 2D scans of the log. The motion of dropped steps of\n"
      "an action / sensory frame log goes to the next step kept. What is not touched stays byte for byte,\n"
      "except with --odometry, which writes all objects anew: scans keep their readings, stamps and labels.\n"
      "--odometry comes last, of the lidar with the most scans, and leaves out all movements of the log.\n"
      "Actions carry mean, covariance and a motion model of that spread; observations the mean. argmax is\n"
      "told whether the robot moved or turned: by the operation log beside the log while all its scans are\n"
      "kept, else by the wheels; argmax_blind guesses.\n"
      "Examples:\n"
      "  rasterslam filter run.rawlog --every 5 -o thin.rawlog\n"
      "  rasterslam filter mit.clf.xz --shift FLASER_ODOMETRY=0.629 -o mit.rawlog\n"
      "  rasterslam filter run.rawlog --no-return 81.83 --mount 0.1,0,0 -o mended.rawlog\n"
      "  rasterslam filter scans.rawlog --odometry plicp --form action -o run.rawlog && rbpf-slam my.ini "
      "run.rawlog");
  command->callback([&context, arguments] {
    context.action = [&context, arguments] { return filter(context, *arguments); };
  });
}

}  // namespace

void addEditing(CLI::App& app, Context& context) {
  addCut(app, context);
  addFilter(app, context);
}

}  // namespace slam::apps
