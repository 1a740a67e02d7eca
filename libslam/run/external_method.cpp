#include "libslam/run/external_method.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <limits>
#include <optional>
#include <sstream>

#include "libslam/core/elementary.h"
#include "libslam/core/error.h"
#include "libslam/core/files.h"
#include "libslam/core/manifest.h"
#include "libslam/logs/convert.h"
#include "libslam/logs/log_format.h"
#include "libslam/logs/log_reader.h"
#include "libslam/mapping/map_builder.h"
#include "libslam/process/command_files.h"
#include "libslam/process/measured_process.h"

namespace slam::run {
namespace fs = std::filesystem;
namespace {

constexpr double kStampTolerance_s = 1e-4;
/// Of a quaternion's length: what four decimals round away.
constexpr double kUnitTolerance = 1e-3;
/// No robot of ours drives so far.
constexpr double kFarthest_m = 1e6;
constexpr size_t kMostViolations = 20;
/// Of a trajectory file: remarks, and some lines for each scan.
constexpr std::uintmax_t kLeastPathBytes = 1 << 20, kPoseBytes = 1000;
const char* const kPlaceholders[] = {"log", "output", "scans", "workdir", "seed", "here"};

/// "configs/plugins/mine.ini:4" -> "/home/me/configs/plugins".
std::string folderOf(const core::IniFile::Entry& entry) {
  const std::string file = entry.origin.substr(0, entry.origin.rfind(':'));
  return fs::absolute(file).parent_path().string();
}

std::string keyText(const core::IniFile::Entry& entry, const std::string& key) {
  return entry.origin + ": section [method], key '" + key + "': ";
}

/// {name} by what `value_of` says; braces around anything else stay, being the shell's.
template <class ValueOf>
std::string replaced(const std::string& command, ValueOf value_of) {
  std::string line;
  for (size_t at = 0; at < command.size();) {
    const size_t end = command[at] == '{' ? command.find('}', at) : std::string::npos;
    const std::string name = end == std::string::npos ? "" : command.substr(at + 1, end - at - 1);
    const std::optional<std::string> value = name.empty() ? std::nullopt : value_of(name);
    line += value ? *value : command.substr(at, 1);
    at = value ? end + 1 : at + 1;
  }
  return line;
}

void requireUsableCommand(const core::IniFile::Entry& entry) {
  bool writes = false;
  replaced(entry.value, [&](const std::string& name) -> std::optional<std::string> {
    const bool is_word = name.find_first_not_of("abcdefghijklmnopqrstuvwxyz_") == std::string::npos;
    const std::vector<std::string> known(std::begin(kPlaceholders), std::end(kPlaceholders));
    if (is_word && std::find(known.begin(), known.end(), name) == known.end())
      throw core::InputError(keyText(entry, "command") + "found '{" + name +
                             "}', expected {log}, {output}, {scans}, {workdir}, {seed} or {here}" +
                             core::didYouMean(name, known));
    writes = writes || name == "output";
    return std::nullopt;
  });
  if (!writes)
    throw core::InputError(keyText(entry, "command") +
                           "found no {output}, expected it where the program is told "
                           "which trajectory to write");
}

struct Files {
  std::string folder, log, output, scans;
};

std::string commandLine(const ExternalMethod& method, const Files& files, std::uint64_t seed) {
  return replaced(method.options.command, [&](const std::string& name) -> std::optional<std::string> {
    const auto quoted = [](const std::string& word) { return core::shellQuoted({word}); };
    if (name == "log") return quoted(files.log);
    if (name == "output") return quoted(files.output);
    if (name == "scans") return quoted(files.scans);
    if (name == "workdir") return quoted(files.folder);
    if (name == "here") return quoted(method.folder);
    if (name == "seed") return std::to_string(seed);
    return std::nullopt;
  });
}

std::vector<ScanPlace> readScans(const std::string& log_path, std::string& label) {
  logs::LogReader log(log_path);
  std::vector<ScanPlace> scans;
  while (const auto entry = log.next()) scans.push_back({entry->scan.time_s, entry->T_odom_robot});
  label = log.sensorLabel();
  if (scans.empty()) throw core::InputError(log_path + ": holds 0 laser scans, expected at least 1");
  return scans;
}

std::string scansText(const std::vector<ScanPlace>& scans) {
  std::string text;
  char line[160];
  for (const auto& scan : scans) {
    const auto& pose = scan.T_odom_robot;
    std::snprintf(line, sizeof line, "%.6f %.9f %.9f %.9f\n", scan.time_s, pose.x, pose.y, pose.phi);
    text += line;
  }
  return text;
}

/// The log as the program wants it, in a folder of its own: the truth that the conversion leaves beside it
/// goes.
void writeLog(const ExternalMethod& method, const std::string& log_path, const std::string& label,
              const Files& files, core::Progress& progress) {
  logs::LogConversion conversion;
  conversion.label = label;
  const std::string& wanted = method.options.log;
  if (wanted == "carmen")
    conversion.to = logs::LogFormat::kCarmen;
  else
    conversion.form =
        wanted == "action" ? logs::RawlogForm::kActionFrame : logs::RawlogForm::kObservationOnly;
  const auto report = logs::convertLog(log_path, files.log, conversion, progress);
  for (const auto& file : report.files)
    if (!fs::equivalent(file, files.log)) fs::remove(file);
}

/// Its last line that says something.
std::string lastWords(const std::string& printed) {
  std::istringstream lines(printed);
  std::string last;
  for (std::string line; std::getline(lines, line);)
    if (line.find_first_not_of(" \t\r=-") != std::string::npos) last = core::trimmed(line);
  return last.empty() ? "it printed nothing" : "it last printed: " + last.substr(0, 200);
}

/// Removes the folder however its use ends.
class WorkFolder {
 public:
  explicit WorkFolder(std::string path) : path_(std::move(path)) { fs::create_directories(path_ + "/run"); }
  ~WorkFolder() {
    std::error_code error;
    fs::remove_all(path_, error);
  }
  WorkFolder(const WorkFolder&) = delete;
  WorkFolder& operator=(const WorkFolder&) = delete;

 private:
  std::string path_;
};

/// The scan with the stamp, from `scans` in the order of stamps: (stamp, place in the log).
using ByStamp = std::vector<std::pair<double, size_t>>;

ByStamp byStamp(const std::vector<ScanPlace>& scans) {
  ByStamp order;
  for (size_t i = 0; i < scans.size(); ++i) order.emplace_back(scans[i].time_s, i);
  std::sort(order.begin(), order.end());
  return order;
}

/// The nearest scan to a stamp that is not `taken` yet; where all near ones are, the nearest.
ByStamp::value_type nearestScan(const ByStamp& order, double time_s, const std::vector<bool>& taken) {
  auto at =
      std::lower_bound(order.begin(), order.end(), std::make_pair(time_s - kStampTolerance_s, size_t{0}));
  auto best = at == order.end() ? std::prev(at) : at;
  if (at != order.begin() && std::abs(std::prev(at)->first - time_s) < std::abs(best->first - time_s))
    best = std::prev(at);
  for (; at != order.end() && at->first <= time_s + kStampTolerance_s; ++at) {
    const bool is_nearer = std::abs(at->first - time_s) < std::abs(best->first - time_s);
    if (!taken[at->second] && (taken[best->second] || is_nearer)) best = at;
  }
  return *best;
}

/// Eight numbers, whatever they are; false for anything else.
bool parseEight(const std::string& line, double (&numbers)[8]) {
  std::istringstream words(line);
  std::string word;
  for (double& number : numbers) {
    if (!(words >> word)) return false;
    char* end = nullptr;
    number = std::strtod(word.c_str(), &end);  // "nan" too: that it is not finite is said apart
    if (*end != '\0') return false;
  }
  return !(words >> word);
}

/// What a trajectory's lines say wrong, and right.
class PathChecker {
 public:
  PathChecker(const std::vector<ScanPlace>& scans, std::string name)
      : name_(std::move(name)), order_(byStamp(scans)), taken_(scans.size()), poses_(scans.size()) {}

  void readLine(const std::string& text, int number) {
    const std::string line = core::trimmed(text);
    if (line.empty() || line[0] == '#') return;
    line_ = number;
    double n[8];
    if (!parseEight(line, n))
      return violated("found '" + line.substr(0, 60) + "', expected 8 numbers: time x y z qx qy qz qw");
    if (!std::all_of(std::begin(n), std::end(n), [](double value) { return std::isfinite(value); }))
      return violated("found '" + line.substr(0, 60) + "', expected finite numbers");
    if (std::max(std::abs(n[1]), std::abs(n[2])) > kFarthest_m)
      return violated("found '" + line.substr(0, 60) + "', expected x and y within 1000 km");
    const double length = std::sqrt(n[4] * n[4] + n[5] * n[5] + n[6] * n[6] + n[7] * n[7]);
    if (std::abs(length - 1) > kUnitTolerance)
      return violated("found a quaternion of length " + core::formatNumber(length) + ", expected 1");
    take(n[0],
         {n[1], n[2], core::atan2(2 * (n[7] * n[6] + n[4] * n[5]), 1 - 2 * (n[5] * n[5] + n[6] * n[6]))});
  }

  std::vector<std::string> violations() {
    if (lines_ == 0 && violations_.empty())
      violations_.push_back(name_ + ": holds 0 poses, expected at least 1");
    if (unnamed_ > 0)
      violations_.push_back(name_ + ": and " + std::to_string(unnamed_) +
                            " more lines that break the contract");
    return violations_;
  }
  const std::vector<std::optional<core::Pose2>>& poses() const { return poses_; }

 private:
  void violated(const std::string& what) {
    if (violations_.size() < kMostViolations)
      violations_.push_back(name_ + ":" + std::to_string(line_) + ": " + what);
    else
      ++unnamed_;
  }

  void take(double time_s, const core::Pose2& pose) {
    char text[160];
    const auto [scan_time_s, scan] = nearestScan(order_, time_s, taken_);
    if (std::abs(scan_time_s - time_s) > kStampTolerance_s) {
      std::snprintf(text, sizeof text,
                    "found the stamp %.6f, which is no scan's of the log; the nearest is %.6f", time_s,
                    scan_time_s);
      return violated(text);
    }
    if (taken_[scan]) {
      std::snprintf(text, sizeof text, "found a second pose for the scan with the stamp %.6f, expected one",
                    time_s);
      return violated(text);
    }
    const bool runs_back = lines_ > 0 && time_s < last_time_s_ && scan < last_scan_;
    if (runs_back) {
      std::snprintf(text, sizeof text,
                    "found the stamp %.6f behind %.6f, expected the order of stamps or of the log's scans",
                    time_s, last_time_s_);
      return violated(text);
    }
    ++lines_;
    last_time_s_ = time_s;
    last_scan_ = scan;
    taken_[scan] = true;
    poses_[scan] = pose;
  }

  std::string name_;
  ByStamp order_;
  std::vector<bool> taken_;
  std::vector<std::optional<core::Pose2>> poses_;
  std::vector<std::string> violations_;
  int line_ = 0, lines_ = 0, unnamed_ = 0;
  double last_time_s_ = 0;
  size_t last_scan_ = 0;
};

/// The pose at `scan` between the given ones at `before` and `after`: the odometry from the one, and of what
/// it then misses the other by the share of the scans passed.
core::Pose2 filled(const std::vector<ScanPlace>& scans, const std::vector<std::optional<core::Pose2>>& poses,
                   std::optional<size_t> before, size_t scan, std::optional<size_t> after) {
  const auto moved = [&](size_t from, size_t to) {
    return *poses[from] * core::between(scans[from].T_odom_robot, scans[to].T_odom_robot);
  };
  if (!before) return moved(*after, scan);
  if (!after) return moved(*before, scan);
  const core::Pose2 missing = core::between(moved(*before, *after), *poses[*after]);
  const double share = static_cast<double>(scan - *before) / static_cast<double>(*after - *before);
  return moved(*before, scan) * core::interpolate({}, missing, share);
}

double logSeconds(const std::vector<ScanPlace>& scans) {
  const auto order = byStamp(scans);
  return order.back().first - order.front().first;
}

}  // namespace

ExternalOptions::ExternalOptions() {
  table().setDefaults(*this);
}

const core::ParameterTable<ExternalOptions>& ExternalOptions::table() {
  using O = ExternalOptions;
  static const core::ParameterTable<O> kTable(
      "method",
      {{"type", &O::type, "external", {"external"}, "another program: see 'rasterslam plugin --help'"},
       {"command",
        &O::command,
        "",
        {},
        "a line of the shell with {log}, {output}, {scans}, {workdir}, {seed}, {here}"},
       {"log",
        &O::log,
        "action",
        {"action", "observation", "carmen"},
        "the form in which it is given the log"},
       {"time_limit_s", &O::time_limit_s, 3600.0, 0.1, 1e6, "of the clock; then it is killed"},
       {"memory_limit_mb", &O::memory_limit_mb, 4000.0, 1.0, 1e6,
        "resident, of all its processes; then it is killed"}});
  return kTable;
}

bool isExternal(const core::IniFile& config) {
  const auto* type = config.find("method", "type");
  return type != nullptr && type->value == "external";
}

ExternalMethod readExternalMethod(const core::IniFile& config) {
  ExternalMethod method;
  core::rejectUnknownSections(config, {"method", "mapping"});
  core::readParameters(config, ExternalOptions::table(), method.options, &method.parameters);
  const auto* command = config.find("method", "command");
  if (command == nullptr || command->value.empty())
    throw core::InputError(
        config.find("method", "type")->origin +
        ": section [method]: key 'command' is missing, expected the line that starts the program");
  requireUsableCommand(*command);
  method.folder = folderOf(*command);
  method.drawing.set("method", "type", "naive", "built-in");
  method.drawing.set("mapping", "draw", "rays", "built-in");
  method.drawing.set("mapping", "grid", "exact", "built-in");
  for (const auto& [section, keys] : config.sections())
    for (const auto& [key, entry] : keys)
      if (section == "mapping") method.drawing.set(section, key, entry.value, entry.origin);
  for (const auto& line : mapping::readMethodConfig(method.drawing).report)
    if (line.section == "mapping") method.parameters.push_back(line);
  return method;
}

core::IniFile withFixedFolder(core::IniFile config) {
  const auto* command = config.find("method", "command");
  if (command == nullptr) return config;
  const core::IniFile::Entry entry = *command;
  const std::string line = replaced(entry.value, [&](const std::string& name) -> std::optional<std::string> {
    return name == "here" ? std::optional(core::shellQuoted({folderOf(entry)})) : std::nullopt;
  });
  config.set("method", "command", line, entry.origin);
  return config;
}

std::map<std::string, std::string> programFiles(const core::IniFile& config) {
  const auto fixed = withFixedFolder(config);
  const auto* command = fixed.find("method", "command");
  return command == nullptr ? std::map<std::string, std::string>() : process::filesOfCommand(command->value);
}

std::vector<core::ParameterReport> methodParameters(const core::IniFile& config) {
  if (isExternal(config)) return readExternalMethod(config).parameters;
  return mapping::readMethodConfig(config).report;
}

CheckedPath checkPath(const std::string& text, const std::string& name, const std::vector<ScanPlace>& scans) {
  PathChecker checker(scans, name);
  std::istringstream lines(text);
  int number = 0;
  for (std::string line; std::getline(lines, line);) checker.readLine(line, ++number);
  CheckedPath checked;
  checked.violations = checker.violations();
  if (!checked.violations.empty()) return checked;

  const auto& poses = checker.poses();
  std::vector<std::optional<size_t>> after(scans.size());
  for (size_t i = scans.size(); i-- > 0;)
    after[i] = poses[i] ? std::optional<size_t>(i) : i + 1 < scans.size() ? after[i + 1] : std::nullopt;
  std::optional<size_t> before;
  for (size_t i = 0; i < scans.size(); ++i) {
    if (poses[i]) before = i;
    checked.filled_poses += poses[i] ? 0 : 1;
    checked.path.push_back(
        {scans[i].time_s, poses[i] ? *poses[i] : filled(scans, poses, before, i, after[i])});
  }
  const core::Pose2 T_map_first = checked.path.front().pose;
  for (auto& stamped : checked.path) stamped.pose = core::between(T_map_first, stamped.pose);
  return checked;
}

ExternalRun runExternalMethod(const ExternalMethod& method, const std::string& log_path, std::uint64_t seed,
                              const std::string& work_folder, core::Progress& progress) {
  const std::string folder = fs::absolute(work_folder).string();
  const WorkFolder work(folder);
  const Files files{folder + "/run",
                    folder + "/" + (method.options.log == "carmen" ? "log.clf" : "log.rawlog"),
                    folder + "/trajectory.tum", folder + "/scans.txt"};
  std::string label;
  const auto scans = readScans(log_path, label);
  writeLog(method, log_path, label, files, progress);
  core::writeFileAtomically(files.scans, scansText(scans));

  progress.begin("running " + method.options.command.substr(0, method.options.command.find(' ')));
  const auto outcome =
      process::runMeasured(commandLine(method, files, seed), files.folder,
                           {method.options.time_limit_s, method.options.memory_limit_mb}, progress);
  progress.end();

  ExternalRun run;
  run.printed = outcome.printed;
  run.cost.mean_ms_per_scan = 1000 * outcome.cpu_s / static_cast<double>(scans.size());
  run.cost.p99_ms_per_scan = std::numeric_limits<double>::quiet_NaN();
  run.cost.peak_memory_mb = outcome.peak_memory_mb;
  run.cost.real_time_factor = logSeconds(scans) / outcome.cpu_s;
  if (!outcome.limit.empty()) {
    run.violations.push_back("the program was stopped: " + outcome.limit);
    return run;
  }
  if (outcome.killed)
    run.violations.push_back("the program was killed by signal " + std::to_string(outcome.exit_code - 128) +
                             "; " + lastWords(run.printed));
  else if (outcome.exit_code != 0)
    run.violations.push_back("the program ended with exit code " + std::to_string(outcome.exit_code) +
                             ", expected 0; " + lastWords(run.printed));
  if (!fs::is_regular_file(files.output)) {
    run.violations.emplace_back("{output}: the program did not write it, expected a trajectory in TUM form");
    return run;
  }
  // A line of eight numbers takes some 80 bytes; what is far longer is no path of these scans, and is not
  // read.
  const auto bytes = fs::file_size(files.output), most = kLeastPathBytes + kPoseBytes * scans.size();
  if (bytes > most) {
    run.violations.push_back("{output}: found " + std::to_string(bytes) + " bytes, expected at most " +
                             std::to_string(most) + " for the poses of " + std::to_string(scans.size()) +
                             " scans");
    return run;
  }
  auto checked = checkPath(core::readTextFile(files.output), "{output}", scans);
  run.violations.insert(run.violations.end(), checked.violations.begin(), checked.violations.end());
  if (run.violations.empty()) run.path = std::move(checked.path);
  run.filled_poses = checked.filled_poses;
  return run;
}

}  // namespace slam::run
